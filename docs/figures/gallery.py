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
import vtk
from PIL import Image, ImageOps

from anisocontact.results import Results

HERE = Path(__file__).parent
INK, GREY, STEEL, TEAL, ACCENT = "#222222", "#6b7280", "#d3d7dd", "#5eb8ad", "#b91c1c"
MATT = {"ambient": 0.35, "diffuse": 0.65, "specular": 0.0}
SIZE = (1400, 800)
MARGIN = 12  # pixels


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
        self.plotter.enable_depth_peeling()
        # Lines on a surface are in front of it.
        vtk.vtkMapper.SetResolveCoincidentTopologyToPolygonOffset()

    def body(self, name: str, **style: Any) -> None:
        """A deformed body with the edges of its cells."""
        surface = {"algorithm": "dataset_surface", "nonlinear_subdivision": 2}
        skin = self.bodies[name].extract_surface(**surface)
        if "scalars" not in style:
            style = {"color": STEEL} | style
        self.plotter.add_mesh(skin, smooth_shading=True, split_sharp_edges=True, **(MATT | style))
        if style.get("opacity", 1.0) == 1.0:
            cells = self.bodies[name].separate_cells().extract_surface(**surface)
            lines = cells.extract_feature_edges(40, manifold_edges=False, non_manifold_edges=False)
            self.plotter.add_mesh(lines, color=INK, line_width=0.6, opacity=0.15)

    def rigid(self, mesh: pv.PolyData, **style: Any) -> None:
        """A rigid surface."""
        even = {"color": STEEL, "smooth_shading": True, "split_sharp_edges": True}
        self.plotter.add_mesh(mesh, **(MATT | even | style))

    def lines(self, segments: list[np.ndarray], colour: str = GREY, width: float = 2.0) -> None:
        """Lines through given points each, (n, 3)."""
        for points in segments:
            self.plotter.add_mesh(pv.lines_from_points(points), color=colour, line_width=width)

    def arrow(self, start: Any, vector: Any, colour: str = ACCENT, label: str = "") -> None:
        """A thick arrow with a label at its tip."""
        start, vector = np.asarray(start, float), np.asarray(vector, float)
        length = float(np.linalg.norm(vector))
        shape = {"shaft_radius": 0.03, "tip_radius": 0.08, "tip_length": 0.25}
        arrow = pv.Arrow(start=start, direction=vector, scale=length, **shape)
        self.plotter.add_mesh(arrow, color=colour, ambient=0.4)
        if label:
            self.label(start + 1.12 * vector, label, colour)

    def label(self, place: Any, text: str, colour: str = INK) -> None:
        """Text at a place in space."""
        self.plotter.add_point_labels(
            np.atleast_2d(np.asarray(place, float)),
            [text],
            text_color=colour,
            font_size=26,
            shape=None,
            show_points=False,
            always_visible=True,
        )

    def save(self, name: str, view: Any, zoom: float = 1.0) -> Path:
        """Write the picture, without its margins, its colours reduced so that it stays small."""
        self.plotter.view_vector(view, viewup=(0, 0, 1))
        self.plotter.camera.zoom(zoom)
        image = Image.fromarray(self.plotter.screenshot(return_img=True))
        self.plotter.close()
        image = ImageOps.expand(image.crop(ImageOps.invert(image).getbbox()), MARGIN, "white")
        path = HERE / f"example-{name}.png"
        image.quantize(256, dither=Image.Dither.NONE).save(path, optimize=True)
        return path


def parts(grid: pv.UnstructuredGrid) -> list[pv.UnstructuredGrid]:
    """Each body, deformed."""
    numbers = np.asarray(grid.cell_data["body"])
    return [
        grid.extract_cells(np.flatnonzero(numbers == i)).warp_by_vector("displacement")
        for i in range(int(numbers.max()) + 1)
    ]


def bar(title: str, labels: int = 4) -> dict[str, Any]:
    """A scale beside the picture."""
    return {
        "title": title + "\n",
        "color": INK,
        "vertical": True,
        "fmt": "%.2g",
        "n_labels": labels,
        "position_x": 0.9,
        "position_y": 0.25,
        "width": 0.05,
        "height": 0.5,
        "title_font_size": 22,
        "label_font_size": 22,
    }


def marks(angle: float, low: Any, high: Any, spacing: float, z: float) -> list[np.ndarray]:
    """Parallel lines at an angle in degrees within a rectangle, at a height."""
    along = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    across = np.array([-along[1], along[0]])
    low, high = np.asarray(low, float), np.asarray(high, float)
    reach = np.linalg.norm(high - low)
    lines = []
    for offset in np.arange(-reach, reach, spacing):
        x = 0.5 * (low + high) + offset * across + np.linspace(-reach, reach, 2001)[:, None] * along
        inside = x[np.all((x > low) & (x < high), axis=1)]
        if len(inside) > 1:
            lines.append(np.column_stack([inside[[0, -1]], [z, z]]))
    return lines


def ironing(folder: Path) -> Path:
    """The die on its way, the stress of the block, its grain."""
    scene = Scene(folder, index=len(Results(folder).times) // 2)
    stress(scene, "block", "GnBu", 0.24)
    scene.body("die")
    scene.lines(marks(30, (-4, -2), (44, 2), 1.0, 0.01), width=2.0)
    x, y, z = scene.bodies["die"].center
    scene.arrow((x, y, z + 0.6), (6, 0, 0), ACCENT, "way")
    return scene.save("ironing", (-0.7, -1.0, 0.8), zoom=1.6)


def stress(scene: Scene, body: str, colours: str, top: float) -> None:
    """A body in the colours of its stress."""
    scale = bar("von Mises [MPa]", 5)
    scene.body(body, scalars="von_mises", cmap=colours, clim=(0.0, top), scalar_bar_args=scale)


def belt(folder: Path) -> Path:
    """Both belts on the drum in the colours of their stress, which is that along the belt."""
    scene = Scene(folder)
    axis = {"center": (0, -1, 0), "direction": (0, 1, 0)}
    scene.rigid(pv.Cylinder(**axis, radius=49.9, height=50, resolution=120))
    for name in ("along", "across"):
        stress(scene, name, "YlOrRd", 3.0)
    for name, y, shift in (("along", -9, -12), ("across", 9, 5)):
        pulled = -scene.history[f"reactions.{name}.head.z"][-1] / 5.0
        scene.arrow((50.3, y, -24), (0, 0, -8 * pulled))
        scene.label((50.3, y + shift, -30 - 4 * pulled), f"{pulled:.2f}", ACCENT)
    return scene.save("belt", (0.75, -1.0, 0.55), zoom=1.1)


def thread(folder: Path) -> Path:
    """The ring on the bar, where it started, the grooves and the path of a point."""
    results = Results(folder)
    scene = Scene(folder)
    axis = {"center": (0, 0, 6), "direction": (0, 0, 1)}
    scene.rigid(pv.Cylinder(**axis, radius=9.97, height=32, resolution=120))
    angle = np.linspace(0, 2 * np.pi, 400)
    for start in np.arange(-80, 80, 4.0):
        z = start + 40 * angle / (2 * np.pi)
        groove = np.column_stack([10.02 * np.cos(angle), 10.02 * np.sin(angle), z])
        inside = (z > -10) & (z < 22)
        if inside.sum() > 1:
            scene.lines([groove[inside]], GREY, 2.0)
    scene.body("ring", color=TEAL)
    start = results.fields(0)
    skin = start.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=2)
    scene.rigid(skin, color=TEAL, opacity=0.25)
    states = [results.fields(i) for i in range(len(results.times))]
    point = states[0].find_closest_point((5.0, -12.0, 8.0))
    path = np.array([g.points[point] + g.point_data["displacement"][point] for g in states])
    scene.lines([path * (1.02, 1.02, 1.0) + (0, 0, 0.1)], ACCENT, 6)
    return scene.save("thread", (1.0, -0.6, 0.5), zoom=1.05)


def polar_plate(folder: Path) -> Path:
    """The disc, the rings of the plate, and the forces on the disc along its way."""
    scene = Scene(folder, index=len(Results(folder).times) // 3)
    plate = pv.Disc(center=(0, 0, -0.05), inner=0.0, outer=26, normal=(0, 0, 1), c_res=120)
    scene.rigid(plate, color="#eef0f2")
    angle = np.linspace(0, 2 * np.pi, 200)
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    scene.lines([r * ring for r in np.arange(1.0, 26.0)], "#a3aab5", 1.0)
    scene.body("disc", color=TEAL)
    scene.lines([np.array([[-20.0, 7.0, 0.02], [20.0, 7.0, 0.02]])], INK, 2)
    history = scene.history
    for row in range(3, len(history["time"]), 5):
        x = history["displacements.disc.top.x"][row] - 20.0
        force = [history[f"contacts.0.force.{axis}"][row] for axis in "xy"]
        scene.arrow((x, 7, 0.3), (0.06 * force[0], 0.06 * force[1], 0))
    scene.label((0, 12, 0), "force on the disc", ACCENT)
    return scene.save("polar-plate", (-0.2, -1.0, 1.3), zoom=1.15)


def ball_on_sheet(folder: Path) -> Path:
    """The pin at the end of its way, the stress of the sheet, the brush marks."""
    scene = Scene(folder)
    stress(scene, "sheet", "GnBu", 1.6)
    scene.lines(marks(30, (-4, -4), (14, 8), 0.6, 0.01), width=2.0)
    scene.body("ball", opacity=0.4, culling="back")
    way = np.column_stack([scene.history[f"displacements.ball.top.{axis}"] for axis in "xyz"])
    scene.lines([np.column_stack([way[:, :2], np.full(len(way), 0.05)])], ACCENT, 6)
    scene.arrow((*way[-1, :2], 3.0), (5, 0, 0), INK, "drag")
    return scene.save("ball-on-sheet", (-0.4, -1.0, 0.6), zoom=1.1)


def corrugated(folder: Path) -> Path:
    """The sheets drawn apart, with the stress where they touch."""
    scene = Scene(folder)
    scene.bodies["upper"].points += (0, 0, 2.5)
    stress(scene, "lower", "GnBu", 12.0)
    scene.body("upper", color="#f3d98b")
    return scene.save("corrugated", (-0.5, -1.0, 1.0), zoom=1.0)


def tribometer(folder: Path) -> Path:
    """The pin on its track, the brush lines, and the friction on the pin round the turn."""
    scene = Scene(folder)
    disc = pv.Disc(center=(-10, 0, -0.05), inner=0.0, outer=15, normal=(0, 0, 1), c_res=120)
    scene.rigid(disc, color="#eef0f2")
    for y in np.arange(-14.0, 14.5, 1.0):
        half = np.sqrt(225.0 - y * y)
        scene.lines([np.array([[-10 - half, y, 0], [-10 + half, y, 0]])], "#a3aab5", 1.0)
    history = scene.history
    place = np.column_stack([history[f"rigid.head.translation.{axis}"] for axis in "xy"])
    force = np.column_stack([history[f"contacts.0.force.{axis}"] for axis in "xy"])
    turn = slice(len(place) - 64, None, 4)
    scene.lines([np.column_stack([place[2:], 0 * place[2:, 0] + 0.02])], INK, 3)
    for at, pull in zip(place[turn], force[turn], strict=True):
        scene.arrow((*at, 0.3), (*(0.4 * pull), 0.0))
    scene.body("pin", color=TEAL)
    scene.label((-16, 0, 0), "friction on the pin", ACCENT)
    return scene.save("tribometer", (-0.3, -1.0, 1.1), zoom=1.15)


def cup(folder: Path) -> Path:
    """The cup in three states, its plastic strain, and the direction of rolling."""
    scene = Scene(folder)
    results = Results(folder)
    scale = bar("plastic strain", 4)
    for place, depth in enumerate((8.0, 16.0, 26.0)):
        z = -results.history["rigid.punch.translation.z"]
        time = results.history["time"][np.searchsorted(z, depth - 1e-9)]
        (state,) = parts(results.fields(int(np.abs(np.array(results.times) - time).argmin())))
        half = state.merge(state.reflect((1, 0, 0)))
        scene.bodies["sheet"] = half.merge(half.reflect((0, 1, 0)))
        scene.bodies["sheet"].points += (68.0 * place - 5.0 * place**2, 0.0, depth)
        style = {"scalars": "plastic_strain", "cmap": "YlOrRd", "clim": (0.0, 0.6)}
        scene.body("sheet", **style, show_scalar_bar=place == 2, scalar_bar_args=scale)
    scene.arrow((-12, -42, 8), (24, 0, 0), INK)
    scene.label((-12, -42, 2), "rolled", INK)
    return scene.save("cup", (0.0, -1.0, 0.75), zoom=1.5)


PICTURES: dict[str, Callable[[Path], Path]] = {
    "ironing": ironing,
    "belt": belt,
    "thread": thread,
    "polar_plate": polar_plate,
    "ball_on_sheet": ball_on_sheet,
    "corrugated": corrugated,
    "tribometer": tribometer,
    "cup": cup,
}


if __name__ == "__main__":
    print(PICTURES[sys.argv[1]](Path(sys.argv[2])))
