"""The deformed bodies in space, with the outline they had before.

Drawn by VTK in a process of its own, because a machine without graphics can end a process that
asks for them; where that fails, matplotlib draws the same.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from anisocontact.base.figure_style import new_figure, save
from anisocontact.base.whole_files import draft_of
from anisocontact.results.deformed import (
    LABEL,
    caption,
    in_plane,
    magnification,
    round_box,
    surfaces,
)

__all__ = ["Drawing"]

#: Seconds that VTK may take.
PATIENCE = 120.0
_RENDERER = "anisocontact.results.deformed"


class Drawing:
    """A picture of the deformed bodies that VTK draws while other things are done.

    Args:
        source: File with the bodies and their `displacement`.
        picture: PNG to write.
        length: Unit of lengths.
    """

    def __init__(self, source: Path, picture: Path, length: str = "length") -> None:
        self._source, self._picture, self._length = source, picture, length
        self._draft = draft_of(picture)
        self._process = _start_vtk(source, self._draft, length)

    def __enter__(self) -> Drawing:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None and self._process.poll() is None:
            self._process.kill()
            self._process.wait()
        self._draft.unlink(missing_ok=True)

    def finish(self) -> None:
        """Wait for the picture; where VTK fails, matplotlib draws it."""
        if _ended(self._process) and self._draft.is_file():
            self._draft.replace(self._picture)
            return
        import pyvista

        self._picture.unlink(missing_ok=True)
        _by_matplotlib(pyvista.read(self._source), self._picture, self._length)


def _start_vtk(source: Path, picture: Path, length: str) -> subprocess.Popen[bytes] | None:
    environment = dict(os.environ)
    if sys.platform == "linux" and not environment.get("DISPLAY"):
        environment.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    command = [sys.executable, "-m", _RENDERER, str(source), str(picture), length]
    silent = subprocess.DEVNULL
    try:
        return subprocess.Popen(command, env=environment, stdout=silent, stderr=silent)
    except OSError:
        return None


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


def _by_matplotlib(grid: Any, picture: Path, length: str) -> None:
    from mpl_toolkits.mplot3d.art3d import (  # type: ignore[import-untyped]
        Poly3DCollection,
    )

    scale = magnification(grid)
    skin, before = surfaces(grid, scale)
    figure = new_figure(9.0, 6.0)
    axes: Any = figure.add_subplot(projection="3d", computed_zorder=False)
    outline = Poly3DCollection(before.points[before.regular_faces], facecolor=(0, 0, 0, 0.04))
    faces = Poly3DCollection(skin.points[skin.regular_faces], cmap="viridis")
    faces.set_array(skin.point_data["size"][skin.regular_faces].mean(axis=1))
    axes.add_collection3d(outline)
    axes.add_collection3d(faces)
    low, high, _ = round_box(skin, before)
    flat = in_plane(before)
    high[2] = max(high[2], low[2] + 1e-3 * float((high - low).max()))
    for axis, start, end in zip("xyz", low, high, strict=True):
        axes.set(**{f"{axis}lim": (start, end), f"{axis}label": f"{axis} [{length}]"})
    axes.set_box_aspect(high - low)
    axes.view_init(*((90.0, -90.0) if flat else (25.0, -60.0)))
    figure.colorbar(faces, ax=axes, label=LABEL.format(length), shrink=0.6)
    axes.set_title(caption(scale))
    save(figure, picture)
