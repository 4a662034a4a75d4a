"""What pictures of the deformed bodies show; as a program VTK's pictures of a grid.

A program of its own that imports what it draws with and nothing else.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.figure_style import GREY

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


def surfaces(grid: Solid, scale: float, shown: Shown) -> tuple[Solid, Solid]:
    """Surface of the bodies as triangles: deformed, with the `value` that is shown, and not."""
    values = shown.value(grid.values(shown.array))
    grid = grid.with_values("value", values)
    before = grid.skin()
    cut = shown.cut and not in_plane(before)
    skin = _opened(grid, values).skin() if cut else before
    return skin.moved("displacement", scale), before


def _opened(grid: Solid, values: Floats) -> Solid:
    """Bodies without what is in front of the largest value, along y."""
    behind = grid.behind(grid.points[int(np.nanargmax(abs(values)))])
    return grid if behind.empty else behind


def in_plane(before: Solid) -> bool:
    """Whether the bodies are meshed in the plane z = 0, which is then seen from the front."""
    return bool(before.bounds[4] == before.bounds[5])


def caption(scale: float) -> str:
    """Heading of the picture: how much the displacement is magnified."""
    times = "true to scale" if scale == 1.0 else f"displacement times {scale:g}"
    return f"{times}; grey: before"


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

    scene = Scene(1200, 800)
    _get_ready(scene)
    asked = sys.stdin.read()
    if not asked:
        return
    source, pictures = json.loads(asked)
    grid = read_solid(Path(source))
    for name, picture, unit, length, colours in pictures:
        scene.clear()
        _add(scene, grid, SHOWN[name], unit, length, bytes.fromhex(colours))
        scene.write(picture)


def _get_ready(scene: Scene) -> None:
    """Draw a cell, for which VTK compiles what pictures need."""
    from anisocontact.results.solids import one_cell

    shown = SHOWN["deformed"]
    grid = one_cell().with_values(shown.array, np.eye(8, 3))
    _add(scene, grid, shown, "", "", bytes(range(256)) * 4)
    scene.render()


def _add(scene: Scene, grid: Solid, shown: Shown, unit: str, length: str, colours: bytes) -> None:
    """Add what is shown on a grid to a scene."""
    scale = magnification(grid)
    skin, before = surfaces(grid, scale, shown)
    bar = scene.add_coloured(
        skin.data,
        "value",
        np.frombuffer(colours, dtype=np.uint8).reshape(-1, 4),
        shown.limits(skin.values("value")),
        ambient=0.6 if shown.cut else 0.25,
    )
    red, green, blue = (int(GREY[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    grey = (red, green, blue)
    if not shown.cut:  # colours that are read as numbers stay what they are
        scene.add_plain(before.data, grey, opacity=0.12)
    scene.add_outline(before.data, grey, width=2.0)
    low, high, labels = round_box(skin, before)
    scene.add_axes(low, high, labels, length)
    scene.add_bar(bar, shown.label.format(unit))
    scene.add_heading(caption(scale))
    if in_plane(before):
        scene.look(low, high, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), ROOM)
    else:
        scene.look(low, high, (-0.55, -1.0, 0.6), (0.0, 0.0, 1.0), ROOM)


if __name__ == "__main__":
    _main()
