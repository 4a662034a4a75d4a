"""VTK's picture of the deformed bodies, as a program: grid, picture."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pyvista

from anisocontact.base.figure_style import GREY
from anisocontact.results.report.shape import LABEL, caption, magnification, round_box, surfaces

#: The scale of colours.
_BAR = {
    "title": LABEL,
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


def _main(source: str, picture: str) -> None:
    grid: Any = pyvista.read(source)
    scale = magnification(grid)
    skin, before = surfaces(grid, scale)
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=[1200, 800])
    plotter.set_background("white")
    plotter.add_mesh(
        skin,
        scalars="size",
        cmap="viridis",
        scalar_bar_args=_BAR,
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
        **{f"{axis}title": f"{axis} [length]" for axis in "xyz"},
        **{f"n_{axis}labels": int(n) for axis, n in zip("xyz", labels, strict=True)},
    )
    plotter.add_text(caption(scale), position="upper_edge", font_size=11, color="black")
    plotter.view_vector((-0.55, -1.0, 0.6), viewup=(0.0, 0.0, 1.0))
    plotter.reset_camera(bounds=np.column_stack([low, high]).reshape(-1).tolist())
    plotter.screenshot(picture)
    plotter.close()


if __name__ == "__main__":
    _main(sys.argv[1], sys.argv[2])
