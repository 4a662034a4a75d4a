"""The deformed bodies in space, with the outline they had before.

Drawn by VTK in a process of its own, because a machine without graphics can end a process that
asks for them; where that fails, matplotlib draws the same.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from anisocontact.base.figure_style import new_figure, save
from anisocontact.base.whole_files import draft_of
from anisocontact.results.deformed import (
    FRONT,
    SHOWN,
    Shown,
    caption,
    colours_of,
    in_plane,
    magnification,
    round_box,
    surfaces,
)
from anisocontact.results.section_plane import SectionPlane

if TYPE_CHECKING:
    from anisocontact.results.solids import Solid

#: Seconds that VTK may take for all of them.
PATIENCE = 120.0
_RENDERER = "anisocontact.results.deformed"


class Drawings:
    """Pictures of the deformed bodies that VTK draws while other things are done.

    Args:
        source: File with the bodies and their `displacement`.
        folder: Where the pictures go.
        names: Which of `SHOWN`.
        units: Unit by dimension; the dimension itself if there is none.
        process: What `start_vtk` gave; started now if not given.
    """

    def __init__(
        self,
        source: Path,
        folder: Path,
        names: Sequence[str],
        units: Mapping[str, str],
        process: subprocess.Popen[bytes] | None = None,
    ) -> None:
        self._source, self._length = source, units.get("length", "length")
        self._pictures = {name: folder / f"{name}.png" for name in names}
        self._units = {
            name: units.get(SHOWN[name].dimension, SHOWN[name].dimension) for name in names
        }
        self._drafts = {name: draft_of(picture) for name, picture in self._pictures.items()}
        wanted = [
            [name, str(draft), self._units[name], self._length, colours_of(SHOWN[name].colours)]
            for name, draft in self._drafts.items()
        ]
        self._process = process or start_vtk()
        _ask(self._process, [str(source), wanted])
        self._whole: bool | None = None

    def __enter__(self) -> Drawings:
        return self

    def __exit__(self, *_: object) -> None:
        end(self._process)
        for draft in self._drafts.values():
            draft.unlink(missing_ok=True)

    def finish(self, name: str) -> None:
        """Wait for a picture; where VTK fails, matplotlib draws it."""
        if self._whole is None:
            self._whole = _ended(self._process)
        draft, picture = self._drafts[name], self._pictures[name]
        if self._whole and draft.is_file():
            draft.replace(picture)
            return
        from anisocontact.results.solids import read_solid

        picture.unlink(missing_ok=True)
        grid = read_solid(self._source)
        _by_matplotlib(grid, SHOWN[name], picture, self._units[name], self._length)


def start_vtk() -> subprocess.Popen[bytes] | None:
    """Start what draws; it gets ready and waits for `Drawings`."""
    environment = dict(os.environ)
    if sys.platform == "linux" and not environment.get("DISPLAY"):
        environment.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    command, silent = [sys.executable, "-m", _RENDERER], subprocess.DEVNULL
    try:
        return subprocess.Popen(
            command, env=environment, stdin=subprocess.PIPE, stdout=silent, stderr=silent
        )
    except OSError:
        return None


def end(process: subprocess.Popen[bytes] | None) -> None:
    """End what `start_vtk` gave, if it has not ended."""
    if process is not None and process.poll() is None:
        process.kill()
        process.wait()


def _ask(process: subprocess.Popen[bytes] | None, wanted: Any) -> None:
    """Ask for pictures; a process that has ended is met where its pictures are missed."""
    if process is not None and process.stdin is not None:
        with suppress(OSError), process.stdin as asked:
            asked.write(json.dumps(wanted).encode())


def _ended(process: subprocess.Popen[bytes] | None) -> bool:
    """Wait for a process; whether it ended well."""
    if process is None:
        return False
    try:
        return process.wait(PATIENCE) == 0
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return False


def _by_matplotlib(grid: Solid, shown: Shown, picture: Path, unit: str, length: str) -> None:
    from mpl_toolkits.mplot3d.art3d import (  # type: ignore[import-untyped]
        Poly3DCollection,
    )

    scale = magnification(grid)
    drawn = surfaces(grid, scale, shown)
    skin, before = drawn.skin, drawn.before
    values = skin.values("value")
    figure = new_figure(9.0, 6.0)
    axes: Any = figure.add_subplot(projection="3d", computed_zorder=False)
    outline = Poly3DCollection(before.points[before.triangles()], facecolor=(0, 0, 0, 0.04))
    faces = Poly3DCollection(skin.points[skin.triangles()], cmap=shown.colours)
    faces.set_array(values[skin.triangles()].mean(axis=1))
    faces.set_clim(*shown.limits(values))
    axes.add_collection3d(outline)
    axes.add_collection3d(faces)
    low, high, _ = round_box(skin, before)
    flat = in_plane(before)
    high[2] = max(high[2], low[2] + 1e-3 * float((high - low).max()))
    for axis, start, end in zip("xyz", low, high, strict=True):
        axes.set(**{f"{axis}lim": (start, end), f"{axis}label": f"{axis} [{length}]"})
    axes.set_box_aspect(high - low)
    axes.view_init(*((90.0, -90.0) if flat else _angles(drawn.cut)))
    figure.colorbar(faces, ax=axes, label=shown.label.format(unit), shrink=0.6)
    axes.set_title(caption(scale, drawn.cut))
    save(figure, picture)


def _angles(cut: SectionPlane | None) -> tuple[float, float]:
    """Elevation and azimuth of who looks at the bodies, degrees."""
    x, y, _ = FRONT if cut is None else cut.towards_viewer
    return 25.0, math.degrees(math.atan2(y, x))
