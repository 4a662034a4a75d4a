"""What the picture of the deformed bodies shows; as a program VTK's picture: grid, picture.

A program of its own that imports what it draws with and nothing else.
"""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, Any

import numpy as np

from anisocontact.base.figure_style import GREY

if TYPE_CHECKING:
    import pyvista

__all__ = ["LABEL", "caption", "in_plane", "magnification", "round_box", "surfaces"]

#: Largest displacement in the picture as a share of the size of the bodies.
VISIBLE = 0.1
LABEL = "displacement [{}]"
#: The scale of colours.
_BAR = {
    "color": "black",
    "fmt": "%.3g",
    "n_labels": 5,
    "vertical": True,
    "position_x": 0.86,
    "position_y": 0.2,
    "width": 0.06,
    "height": 0.6,
    "title_font_size": 20,
    "label_font_size": 20,
}


def magnification(grid: pyvista.UnstructuredGrid) -> float:
    """A round number >= 1 that makes the displacement visible; 1 if it is so as it is."""
    largest = float(np.linalg.norm(grid.point_data["displacement"], axis=1).max())
    if largest == 0.0:
        return 1.0
    wanted = VISIBLE * float(grid.length) / largest
    if wanted < 3.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(wanted))
    return next(f * power for f in (5.0, 2.0, 1.0) if f * power <= wanted * (1.0 + 1e-12))


def surfaces(
    grid: pyvista.UnstructuredGrid, scale: float
) -> tuple[pyvista.PolyData, pyvista.PolyData]:
    """Surface of the bodies as triangles: deformed, with the `size` of the movement, and not."""
    grid = grid.copy()
    grid.point_data["size"] = np.linalg.norm(grid.point_data["displacement"], axis=1)
    skin: pyvista.PolyData = grid.extract_surface(algorithm="dataset_surface").triangulate()
    return skin.warp_by_vector("displacement", factor=scale), skin


def in_plane(before: pyvista.PolyData) -> bool:
    """Whether the bodies are meshed in the plane z = 0, which is then seen from the front."""
    return bool(before.bounds[4] == before.bounds[5])


def caption(scale: float) -> str:
    """Heading of the picture: how much the displacement is magnified."""
    times = "true to scale" if scale == 1.0 else f"displacement times {scale:g}"
    return f"{times}; grey: before"


def round_box(*meshes: pyvista.PolyData) -> tuple[Any, Any, Any]:
    """Box of round numbers around meshes: low and high corner, number of labels along each axis."""
    corners = np.concatenate([np.reshape(mesh.bounds, (3, 2)).T for mesh in meshes])
    low, high = corners.min(axis=0), corners.max(axis=0)
    least = float((high - low).max()) / 8.0
    power = 10.0 ** math.floor(math.log10(least))
    step = next(f * power for f in (1.0, 2.0, 5.0, 10.0) if f * power >= least)
    # What sticks out by a tenth of a step needs no further one.
    low, high = np.floor(low / step + 0.1) * step, np.ceil(high / step - 0.1) * step
    return low, high, np.rint((high - low) / step).astype(int) + 1


def _main(source: str, picture: str, length: str) -> None:
    import pyvista

    grid: Any = pyvista.read(source)
    scale = magnification(grid)
    skin, before = surfaces(grid, scale)
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=[1200, 800])
    plotter.set_background("white")
    plotter.add_mesh(
        skin,
        scalars="size",
        cmap="viridis",
        scalar_bar_args=_BAR | {"title": LABEL.format(length)},
        smooth_shading=True,
        split_sharp_edges=True,
        ambient=0.25,
    )
    plotter.add_mesh(before, color=GREY, opacity=0.12)
    plotter.add_silhouette(before, color=GREY, line_width=2)
    low, high, labels = round_box(skin, before)
    plotter.show_bounds(
        bounds=np.column_stack([low, high]).reshape(-1).tolist(),
        color="black",
        location="outer",
        font_size=13,
        fmt="%.6g",
        **{f"{axis}title": f"{axis} [{length}]" for axis in "xyz"},
        **{f"n_{axis}labels": int(n) for axis, n in zip("xyz", labels, strict=True)},
    )
    plotter.add_text(caption(scale), position="upper_edge", font_size=11, color="black")
    if in_plane(before):
        plotter.view_xy()
    else:
        plotter.view_vector((-0.55, -1.0, 0.6), viewup=(0.0, 0.0, 1.0))
    plotter.reset_camera(bounds=np.column_stack([low, high]).reshape(-1).tolist())
    plotter.screenshot(picture)
    plotter.close()


if __name__ == "__main__":
    _main(*sys.argv[1:])
