"""The report of a run: pictures in `pictures/` and `report.html`, made from the results folder."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from anisocontact.base.errors import InputError
from anisocontact.base.figure_style import save
from anisocontact.results.deformed import SHOWN
from anisocontact.results.files import write_text
from anisocontact.results.no_energy import energies_by_name
from anisocontact.results.report import curves, maps, shape
from anisocontact.results.report.labels import labelled
from anisocontact.results.report.page import Picture, page
from anisocontact.results.report.run_data import RunData
from anisocontact.results.report.shared_work import attempts

if TYPE_CHECKING:
    import subprocess

    from matplotlib.figure import Figure

__all__ = ["page", "step_rows", "write_report"]

#: Resultant of the pressures over their sum beyond which a contact is nearly a plane.
LEVEL = 0.9
#: Of each contact: name of the picture, who draws it, heading and caption.
_OF_CONTACT: tuple[tuple[str, Callable[[RunData, int], Figure], str, str], ...] = (
    (
        "pressure",
        maps.pressure,
        "Pressure",
        "Pressure on the slave at the end of the steps, or of the last three, at the deformed "
        "position; what touches alone where that is little of the slave.",
    ),
    (
        "status",
        maps.status,
        "Status",
        "Open, sticking and slipping points. Of each step, or of the last three, the written state "
        "is shown in which stick and slip are most mixed: the smaller of the two numbers of points "
        "is largest; where points only stick, or only slip, it is the last one.",
    ),
    (
        "traction",
        maps.traction,
        "Traction in principal axes",
        "Components of the tangential traction along the two axes of friction, at the end.",
    ),
    (
        "domain",
        curves.domain,
        "Path of the resultant and adhesion domain",
        "Left: the resultant tangential force over the normal force; where the axes are the same "
        "at all points it cannot leave the friction ellipse. Right: the mean elastic slip around "
        "the centre of the adhesion domain, with the "
        "ellipse e.(BFB)e = N² for the mean pressure at the end of each step.",
    ),
    (
        "force",
        curves.force,
        "Force over displacement",
        "Resultant of the contact on the slave; the steps are shaded.",
    ),
)
#: Heading and caption of the domain where multipliers hold.
_WITHOUT_ADHESION = (
    "Path of the resultant",
    "The resultant tangential force over the normal force; where the axes are the same at all "
    "points it cannot leave the friction ellipse. Multipliers hold what sticks: there is no "
    "elastic slip and no adhesion domain.",
)
#: Heading and caption of the moments.
_MOMENT = (
    "Moment over angle",
    "Moment of contacts and faces on rigid bodies that turn, about the axis of their largest turn "
    "through their reference point; the steps are shaded.",
)
#: Of the bodies: heading and caption by the name of the picture.
_OF_BODIES = {
    "deformed": ("Deformed bodies", "Colour: size of the displacement."),
    "von_mises": (
        "Equivalent stress",
        "Von Mises; bodies are cut open through the largest value, the heading says where.",
    ),
    "principal_stress": (
        "Principal stress",
        "The one that is largest in size, tension positive; bodies are cut open through it, the "
        "heading says where.",
    ),
}


def write_report(
    folder: str | Path, *, vtk: subprocess.Popen[bytes] | None = None, forks: bool = False
) -> list[str]:
    """Draw the pictures and write the report from what is in a results folder.

    Args:
        folder: Results folder of a run that has ended.
        vtk: What `shape.start_vtk` gave; started now if not given.
        forks: Whether this process may be doubled to draw: it has neither MPI nor threads.

    Returns:
        What could not be drawn and why, a line each; the report is written all the same.
    """
    folder = Path(folder)
    run = RunData(folder)
    album = _Album(folder / "pictures")
    if run.moments:
        _draw(run, album, vtk, forks)
    write_text(folder / "report.html", page(run.summary, step_rows(run), album.pictures))
    return album.failed


@dataclass(frozen=True)
class _Wanted:
    """A picture of a report."""

    path: Path
    title: str
    caption: str
    draw: Callable[[Path], object]

    def attempt(self) -> str:
        """Draw it; why it could not be drawn: a picture is no reason to lose a run."""
        try:
            self.draw(self.path)
        except Exception as error:
            return f"picture {self.path.stem}: {type(error).__name__}: {error}"
        return ""


class _Album:
    """Pictures that could be drawn, and why others could not.

    Args:
        folder: Where they go.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.pictures: list[Picture] = []
        self.failed: list[str] = []

    def wanted(
        self, name: str, title: str, caption: str, draw: Callable[[Path], object]
    ) -> _Wanted:
        """A picture that goes there."""
        return _Wanted(self.folder / f"{name}.png", title, caption, draw)

    def take(self, wanted: Sequence[_Wanted], failed: Sequence[str]) -> None:
        """Take pictures, each with why it could not be drawn, which is empty if it was."""
        for one, why in zip(wanted, failed, strict=True):
            if why:
                self.failed.append(why)
            else:
                self.pictures.append(Picture(one.path, one.title, one.caption))


def _draw(run: RunData, album: _Album, vtk: subprocess.Popen[bytes] | None, forks: bool) -> None:
    album.folder.mkdir(exist_ok=True)
    there = _arrays(run)
    names = [name for name in _OF_BODIES if SHOWN[name].array in there]
    source = run.results.fields_file()
    with shape.Drawings(source, album.folder, names, run.units, vtk) as bodies:
        count = len(run.summary["contacts"])
        contacts = [one for number in range(count) for one in _of_contact(run, number, album)]
        contacts += _of_turning(run, album)
        drawn = attempts([one.attempt for one in contacts], forks=forks)
        # drawn meanwhile by another process, shown first
        first = [_of_bodies(run, name, album, bodies) for name in names]
        album.take(first, [one.attempt() for one in first])
    album.take(contacts, drawn)


def _of_bodies(run: RunData, name: str, album: _Album, bodies: shape.Drawings) -> _Wanted:
    title, caption = _OF_BODIES[name]
    state = f" State: {run.moments[-1].title}."
    return album.wanted(name, title, caption + state, lambda path: bodies.finish(path.stem))


def _arrays(run: RunData) -> Collection[str]:
    """Arrays at the nodes; that alone without which nothing is drawn where none can be read."""
    try:
        return run.results.grid().point_data
    except InputError:  # each picture says what is wrong
        return ("displacement",)


def _of_contact(run: RunData, number: int, album: _Album) -> list[_Wanted]:
    contacts = run.summary["contacts"]
    many, contact = len(contacts) > 1, contacts[number]
    pair = f": {contact['slave']} on {contact['master']}" if many else ""
    found = []
    for name, draw, *texts in _OF_CONTACT:
        without = name == "domain" and run.exact(number, "adhesion")
        title, caption = _WITHOUT_ADHESION if without else texts

        def drawn(path: Path, draw: Callable[[RunData, int], Figure] = draw) -> None:
            save(labelled(draw(run, number), run.units), path)

        # around a master resultants in one plane may lie outside of the friction ellipse
        if name != "domain" or _in_a_plane(run, number):
            of_pair = f"{name}-{number}" if many else name
            found.append(album.wanted(of_pair, f"{title}{pair}", caption, drawn))
    return found


def _of_turning(run: RunData, album: _Album) -> list[_Wanted]:
    """Moments, where rigid bodies turn."""

    def drawn(path: Path) -> None:
        save(labelled(curves.moment(run), run.units), path)

    return [album.wanted("moment", *_MOMENT, drawn)] if run.turning else []


def _in_a_plane(run: RunData, number: int) -> bool:
    """Whether points touch in one plane, nearly; taken so where they cannot be read."""
    try:
        return run.view(run.moments[-1].index, number).level > LEVEL
    except Exception:  # each picture says what is wrong
        return True


def step_rows(run: RunData) -> list[dict[str, Any]]:
    """Numbers of each step of a run.

    Args:
        run: What is in its folder.

    Returns:
        A row a step, by column.
    """
    rows = []
    for name, at in run.steps:
        iterations = run.history["newton_iterations"][at]
        row: dict[str, Any] = {
            "step": name,
            "increments": len(at),
            "iterations": int(iterations.sum()),
            "most in an increment": int(iterations.max()),
            "largest residual": float(run.history["residual"][at].max()),
        }
        for number, contact in enumerate(run.summary["contacts"]):
            end = {key: run.history[f"contacts.{number}.force.{key}"][at[-1]] for key in "xyz"}
            where = f"on {contact['slave']} at the end [force]"
            row |= {f"force {axis} {where}": float(v) for axis, v in end.items()}
        residual = float(run.history["energy.residual"][at[-1]])
        rows.append(row | energies_by_name({"residual of the energies [force length]": residual}))
    return rows
