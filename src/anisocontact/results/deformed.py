"""What pictures of the deformed bodies show; as a program VTK's pictures of a grid.

A program of its own that imports what it draws with and nothing else.
"""

from __future__ import annotations

import gc
import json
import math
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.figure_style import GREY
from anisocontact.results.section_plane import SectionPlane, section_of

if TYPE_CHECKING:
    from anisocontact.results.scene import Scene
    from anisocontact.results.solids import Solid

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
        colours: Name of the scale of colours.
        signed: Whether zero is in its middle, where it has to differ from the white behind.
        cut: Whether bodies are cut open at the largest value, towards who looks at them.
    """

    array: str
    label: str
    dimension: str
    value: Callable[[Floats], Floats]
    colours: str = "viridis"
    signed: bool = False
    cut: bool = False

    def limits(self, values: Floats) -> tuple[float, float]:
        """Ends of the scale of colours."""
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        largest = max(abs(low), abs(high)) or 1.0
        return (-largest, largest) if self.signed else (min(low, 0.0), largest)


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
        "principal_stress",
        "principal stress [{}]",
        "stress",
        _further,
        "coolwarm",
        signed=True,
        cut=True,
    ),
}
#: Direction from the bodies to who looks at them.
FRONT = (-0.55, -1.0, 0.6)
#: Size of the bodies in the picture, over all of it: labels of axes have the rest.
ROOM = 0.86


def magnification(grid: Solid) -> float:
    """A round number >= 1 that makes the displacement visible; 1 if it is so as it is."""
    largest = float(np.linalg.norm(grid.values("displacement"), axis=1).max())
    if largest == 0.0:
        return 1.0
    wanted = VISIBLE * grid.length / largest
    if wanted < 3.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(wanted))
    return next(f * power for f in (5.0, 2.0, 1.0) if f * power <= wanted * (1.0 + 1e-12))


@dataclass(frozen=True)
class BodySurfaces:
    """Surfaces of the bodies as triangles.

    Args:
        skin: Deformed, with the `value` that is shown.
        edges: Sharp edges of the bodies as meshed and the rim of the cut, deformed.
        before: Not deformed, and whole.
        cut: Where they are cut open; None where they are not.
    """

    skin: Solid
    edges: list[Solid]
    before: Solid
    cut: SectionPlane | None


def surfaces(grid: Solid, scale: float, shown: Shown) -> BodySurfaces:
    """Surfaces of bodies whose displacement is magnified, with what is shown of them."""
    values = shown.value(grid.values(shown.array))
    grid = grid.with_values("value", values)
    before = grid.skin()
    cut = section_of(grid.points, values) if shown.cut and not in_plane(before) else None
    if cut is None:
        shapes = [before, before.edges()]
    else:
        shapes = [grid.behind(cut).skin(), before.edges().behind(cut), before.rim(cut)]
    skin, *edges = [one.moved("displacement", scale) for one in shapes]
    return BodySurfaces(skin, edges, before, cut)


def in_plane(before: Solid) -> bool:
    """Whether the bodies are meshed in the plane z = 0, which is then seen from the front."""
    return bool(before.bounds[4] == before.bounds[5])


def caption(scale: float, cut: SectionPlane | None) -> str:
    """Heading of the picture: how much the displacement is magnified, and what is left out."""
    times = "true to scale" if scale == 1.0 else f"displacement times {scale:g}"
    lines = [f"{times}; grey: before"]
    return "\n".join(lines if cut is None else [*lines, str(cut)])


def round_box(*meshes: Solid) -> tuple[Any, Any, Any]:
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


def _main() -> None:
    """Draw the pictures of a grid that are asked for: names, files, two units and colours."""
    from anisocontact.results.scene import Scene
    from anisocontact.results.solids import read_solid

    gc.disable()  # what is made here lives as long as the program
    scene = Scene()
    _get_ready(scene)
    asked = sys.stdin.read()
    if not asked:
        return
    source, pictures = json.loads(asked)
    grid = read_solid(Path(source))
    for name, picture, unit, length, colours in pictures:
        scene.begin(1200, 800)
        _add(scene, grid, SHOWN[name], unit, length, bytes.fromhex(colours))
        scene.write(picture)


def _get_ready(scene: Scene) -> None:
    """Draw a cell, for which VTK compiles what pictures need."""
    from anisocontact.results.solids import one_cell

    shown = SHOWN["deformed"]
    grid = one_cell().with_values(shown.array, np.eye(8, 3))
    scene.begin(60, 40)
    _add(scene, grid, shown, "", "", b"\xff" * 1024)
    scene.render()


def _add(scene: Scene, grid: Solid, shown: Shown, unit: str, length: str, colours: bytes) -> None:
    """Add what is shown on a grid to a scene."""
    scale = magnification(grid)
    drawn = surfaces(grid, scale, shown)
    skin, before = drawn.skin, drawn.before
    bar = scene.add_coloured(
        skin.data,
        "value",
        np.frombuffer(colours, dtype=np.uint8).reshape(-1, 4),
        shown.limits(skin.values("value")),
        shaded=not shown.cut,  # colours that are read as numbers stay what they are
    )
    red, green, blue = (int(GREY[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    grey = (red, green, blue)
    if shown.cut:
        for edges in drawn.edges:
            scene.add_lines(edges.data, width=1.0)
    else:
        scene.add_plain(before.data, grey, opacity=0.12)
    scene.add_outline(before.data, grey, width=2.0)
    low, high, labels = round_box(skin, before)
    scene.add_axes(low, high, labels, length)
    scene.add_bar(bar, shown.label.format(unit))
    scene.add_heading(caption(scale, drawn.cut))
    if in_plane(before):
        scene.look(low, high, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), ROOM)
    else:
        along = FRONT if drawn.cut is None else drawn.cut.towards_viewer
        scene.look(low, high, along, (0.0, 0.0, 1.0), ROOM)


if __name__ == "__main__":
    _main()
    os._exit(0)  # all is written, and taking apart what was imported takes a while
