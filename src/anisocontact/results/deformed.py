"""What pictures of the deformed bodies show; as a program VTK's pictures of a grid.

A program of its own that imports what it draws with and nothing else.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.figure_style import GREY

if TYPE_CHECKING:
    import pyvista

    from anisocontact.results.scene import Scene

__all__ = [
    "SHOWN",
    "Shown",
    "caption",
    "colours_of",
    "in_plane",
    "magnification",
    "round_box",
    "surfaces",
]

Floats = npt.NDArray[np.float64]

#: Largest displacement in the picture as a share of the size of the bodies.
VISIBLE = 0.1


@dataclass(frozen=True)
class Shown:
    """What is drawn on the bodies.

    Args:
        array: The array of the grid that it is made of.
        label: Of the scale of colours, with a place for the unit.
        dimension: Of the unit.
        value: Makes a number for each node.
        colours: Name of the scale of colours; one with a middle has zero there.
        cut: Whether bodies are cut open at the largest value, towards who looks at them.
    """

    array: str
    label: str
    dimension: str
    value: Callable[[Floats], Floats]
    colours: str = "viridis"
    cut: bool = False

    def limits(self, values: Floats) -> tuple[float, float]:
        """Ends of the scale of colours."""
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        largest = max(abs(low), abs(high)) or 1.0
        return (-largest, largest) if self.colours == "RdBu_r" else (min(low, 0.0), largest)


def _further(principal: Floats) -> Floats:
    """The principal stress that is largest in size, with its sign."""
    ends = principal[:, [0, -1]]
    return np.asarray(np.take_along_axis(ends, abs(ends).argmax(axis=1)[:, None], axis=1)[:, 0])


#: Pictures of the bodies by their names.
SHOWN = {
    "deformed": Shown(
        "displacement", "displacement [{}]", "length", lambda u: np.linalg.norm(u, axis=1)
    ),
    "von_mises": Shown(
        "von_mises", "equivalent stress [{}]", "stress", lambda s: s, "inferno", cut=True
    ),
    "principal_stress": Shown(
        "principal_stress", "principal stress [{}]", "stress", _further, "RdBu_r", cut=True
    ),
}
#: Size of the bodies in the picture, over all of it: labels of axes have the rest.
ROOM = 0.86


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
    grid: pyvista.UnstructuredGrid, scale: float, shown: Shown
) -> tuple[pyvista.PolyData, pyvista.PolyData]:
    """Surface of the bodies as triangles: deformed, with the `value` that is shown, and not."""
    grid = grid.copy()
    values = shown.value(np.asarray(grid.point_data[shown.array], dtype=float))
    grid.point_data["value"] = values
    before = _skin(grid)
    cut = shown.cut and not in_plane(before)
    skin = _skin(_opened(grid, values)) if cut else before
    return skin.warp_by_vector("displacement", factor=scale), before


def _skin(grid: pyvista.DataSet) -> pyvista.PolyData:
    skin: pyvista.PolyData = grid.extract_surface(algorithm="dataset_surface").triangulate()
    return skin


def _opened(grid: pyvista.UnstructuredGrid, values: Floats) -> pyvista.DataSet:
    """Bodies without what is in front of the largest value, along y."""
    place = grid.points[int(np.nanargmax(abs(values)))]
    behind: pyvista.DataSet = grid.clip(normal="y", origin=place, invert=False)
    return behind if behind.n_cells else grid


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


def colours_of(name: str) -> str:
    """A scale of colours by its name, in hexadecimal: Matplotlib is slow to import for that."""
    from matplotlib import colormaps

    found = colormaps[name](np.linspace(0.0, 1.0, 256), bytes=True)
    return np.asarray(found, dtype=np.uint8).tobytes().hex()


def _main(source: str, *pictures: str) -> None:
    """Draw a grid: names of pictures, each with its file, two units and its colours."""
    import pyvista

    from anisocontact.results.scene import Scene

    grid: Any = pyvista.read(source)
    scene = Scene(1200, 800)
    for i in range(0, len(pictures), 5):
        name, picture, unit, length, colours = pictures[i : i + 5]
        scene.clear()
        _add(scene, grid, SHOWN[name], unit, length, bytes.fromhex(colours))
        scene.write(picture)


def _add(scene: Scene, grid: Any, shown: Shown, unit: str, length: str, colours: bytes) -> None:
    """Add what is shown on a grid to a scene."""
    scale = magnification(grid)
    skin, before = surfaces(grid, scale, shown)
    bar = scene.add_coloured(
        skin,
        "value",
        np.frombuffer(colours, dtype=np.uint8).reshape(-1, 4),
        shown.limits(skin.point_data["value"]),
        ambient=0.6 if shown.cut else 0.25,
    )
    red, green, blue = (int(GREY[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    grey = (red, green, blue)
    if not shown.cut:  # colours that are read as numbers stay what they are
        scene.add_plain(before, grey, opacity=0.12)
    scene.add_outline(before, grey, width=2.0)
    low, high, labels = round_box(skin, before)
    scene.add_axes(low, high, labels, length)
    scene.add_bar(bar, shown.label.format(unit))
    scene.add_heading(caption(scale))
    if in_plane(before):
        scene.look(low, high, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), ROOM)
    else:
        scene.look(low, high, (-0.55, -1.0, 0.6), (0.0, 0.0, 1.0), ROOM)


if __name__ == "__main__":
    _main(*sys.argv[1:])
