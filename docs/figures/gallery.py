"""Pictures of the gallery, from the results folders of the examples.

Run, after `anisocontact run examples/ironing/case.toml -o results/ironing` and the like:

    python docs/figures/gallery.py ironing results/ironing
"""

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")

import numpy as np
import pyvista as pv
from PIL import Image

from anisocontact.results import Results

HERE = Path(__file__).parent
INK, GREY, STEEL, ACCENT = "#222222", "#8a8f98", "#c8ccd2", "#b91c1c"
SIZE = (1200, 700)


class Scene:
    """A state of a run in space.

    Args:
        folder: Results folder.
        index: Which of the written states.
    """

    def __init__(self, folder: Path, index: int = -1) -> None:
        results = Results(folder)
        self.history = results.history
        self.points = results.contact(index)
        self.bodies = dict(
            zip(results.summary["bodies"], parts(results.fields(index)), strict=True)
        )
        self.plotter: Any = pv.Plotter(off_screen=True, window_size=list(SIZE))
        self.plotter.set_background("white")
        self.plotter.enable_anti_aliasing("ssaa")

    def body(self, name: str, **style: Any) -> None:
        """A deformed body with the edges of its cells."""
        skin = self.bodies[name].extract_surface(
            algorithm="dataset_surface", nonlinear_subdivision=2
        )
        if "scalars" not in style:
            style = {"color": STEEL} | style
        self.plotter.add_mesh(
            skin, smooth_shading=True, split_sharp_edges=True, ambient=0.3, **style
        )
        edges = (
            self.bodies[name]
            .separate_cells()
            .extract_surface(algorithm="dataset_surface", nonlinear_subdivision=2)
        )
        lines = edges.extract_feature_edges(
            feature_angle=40, boundary_edges=True, manifold_edges=False, non_manifold_edges=False
        )
        self.plotter.add_mesh(lines, color=INK, line_width=0.6, opacity=0.35)

    def rigid(self, mesh: pv.PolyData, **style: Any) -> None:
        """A rigid surface."""
        self.plotter.add_mesh(mesh, **({"color": STEEL, "smooth_shading": True} | style))

    def lines(self, segments: list[np.ndarray], colour: str = GREY, width: float = 2.0) -> None:
        """Lines through given points each, (n, 3)."""
        for points in segments:
            self.plotter.add_mesh(pv.lines_from_points(points), color=colour, line_width=width)

    def arrow(self, start: Any, vector: Any, colour: str = ACCENT, label: str = "") -> None:
        """A thick arrow with a label at its tip."""
        start, vector = np.asarray(start, float), np.asarray(vector, float)
        length = float(np.linalg.norm(vector))
        arrow = pv.Arrow(
            start, vector, scale=length, shaft_radius=0.03, tip_radius=0.08, tip_length=0.25
        )
        self.plotter.add_mesh(arrow, color=colour, ambient=0.4)
        if label:
            self.label(start + 1.12 * vector, label, colour)

    def label(self, place: Any, text: str, colour: str = INK) -> None:
        """Text at a place in space."""
        self.plotter.add_point_labels(
            np.atleast_2d(place),
            [text],
            text_color=colour,
            font_size=26,
            shape=None,
            show_points=False,
            always_visible=True,
        )

    def tractions(
        self, scale: float, every: int = 1, number: int = 0, colour: str = ACCENT
    ) -> None:
        """Tangential tractions on the slave as arrows, `scale` length per stress."""
        data = self.points
        chosen = (data["status"] > 0) & (data["contact"] == number)
        some = pv.PolyData(np.asarray(data.points)[chosen][::every])
        some["t"] = data["traction_t"][chosen][::every]
        glyph = some.glyph(
            orient="t", scale="t", factor=scale, geom=pv.Arrow(tip_radius=0.14, shaft_radius=0.05)
        )
        self.plotter.add_mesh(glyph, color=colour, ambient=0.4)

    def save(self, name: str, view: Any, zoom: float = 1.0, up: Any = (0, 0, 1)) -> Path:
        """Write the picture, its colours reduced so that it stays small."""
        self.plotter.view_vector(view, viewup=up)
        self.plotter.camera.zoom(zoom)
        image = Image.fromarray(self.plotter.screenshot(return_img=True))
        self.plotter.close()
        path = HERE / f"example-{name}.png"
        image.quantize(192, dither=Image.Dither.NONE).save(path, optimize=True)
        return path


def parts(grid: pv.UnstructuredGrid) -> list[pv.UnstructuredGrid]:
    """Each body, deformed."""
    numbers = np.asarray(grid.cell_data["body"])
    return [
        grid.extract_cells(np.flatnonzero(numbers == i)).warp_by_vector("displacement")
        for i in range(int(numbers.max()) + 1)
    ]


def bar(title: str) -> dict[str, Any]:
    """A scale beside the picture."""
    return {
        "title": title + "\n",
        "color": INK,
        "vertical": True,
        "fmt": "%.2g",
        "n_labels": 4,
        "position_x": 0.89,
        "position_y": 0.25,
        "width": 0.05,
        "height": 0.5,
        "title_font_size": 22,
        "label_font_size": 22,
    }


def ironing(folder: Path) -> Path:
    """The die half way, the stress of the block, its grain."""
    scene = Scene(folder, index=len(Results(folder).times) // 3)
    style = {"cmap": "viridis", "clim": (0.0, 0.6)}
    scene.body("block", scalars="von_mises", scalar_bar_args=bar("von Mises [MPa]"), **style)
    scene.body("die")
    grain = np.array([np.cos(np.pi / 6), np.sin(np.pi / 6), 0.0])
    for x in np.arange(-3.0, 44.0, 2.0):
        a = np.array([x, -2.0, 0.01])
        scene.lines([np.stack([a, a + 4.0 * grain / grain[1]])], colour="white", width=1.0)
    return scene.save("ironing", (-0.6, -1.0, 0.8), zoom=1.5)


PICTURES: dict[str, Callable[[Path], Path]] = {"ironing": ironing}


if __name__ == "__main__":
    print(PICTURES[sys.argv[1]](Path(sys.argv[2])))
