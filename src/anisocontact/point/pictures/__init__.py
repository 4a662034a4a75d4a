"""Pictures of a history: the path on the surface, the force plane, and everything over time.

Each function returns a `matplotlib.figure.Figure`; `save` writes all of them.
"""

from __future__ import annotations

from pathlib import Path

from anisocontact.base.figure_style import plain
from anisocontact.base.figure_style import save as write
from anisocontact.point.balance import PointInterface
from anisocontact.point.history import History
from anisocontact.point.pictures.compare import compare
from anisocontact.point.pictures.forces import force_plane
from anisocontact.point.pictures.path import path_on_surface
from anisocontact.point.pictures.time import over_time

__all__ = ["compare", "force_plane", "over_time", "path_on_surface", "save"]


def save(
    history: History,
    interface: PointInterface,
    folder: str | Path,
    title: str = "",
    compared: dict[str, History] | None = None,
    label: str = "as given",
) -> list[Path]:
    """Write `path.png`, `forces.png` and `time.png`, and `compare.png` for several runs.

    Args:
        history: What was driven.
        interface: Through what.
        folder: Where; made if it is not there.
        title: Heading.
        compared: Further runs by label.
        label: Label of this one.

    Returns:
        The files.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    title = plain(title)
    figures = {
        "path": path_on_surface(history, interface, title=title),
        "forces": force_plane(history, interface, title=title),
        "time": over_time(history, title=title),
    }
    if compared:
        runs = {plain(name): run for name, run in {label: history, **compared}.items()}
        figures["compare"] = compare(runs, interface, title=title)
    files = [target / f"{name}.png" for name in figures]
    for file, figure in zip(files, figures.values(), strict=True):
        write(figure, file)
    return files
