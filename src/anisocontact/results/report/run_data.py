"""A run as the pictures need it: history by step, fields at chosen moments."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.figure_style import plain
from anisocontact.results.read import Results
from anisocontact.results.report.frame import ContactView

#: Share of the length of a path below which a step in which bodies turn is too short on it.
HARDLY = 0.1
#: Component along x of an axis from which on it is the radial one.
RADIAL = 0.5
#: Turn, in radian, up to which a rigid body does no more than tilt.
TILT = 1e-3


@dataclass(frozen=True)
class Moment:
    """A written state.

    Args:
        title: Step and increment.
        index: Its number in the collections of fields.
        row: Its row of the history.
    """

    title: str
    index: int
    row: int


class RunData:
    """Results with what the pictures ask of them."""

    def __init__(self, folder: Path) -> None:
        self.results = Results(folder)
        self.summary: dict[str, Any] = _numbers(self.results.summary)
        self.units: dict[str, str] = self.summary.get("units", {})
        self.history = self.results.history
        self.rows = len(self.history.get("time", ()))

    @cached_property
    def steps(self) -> list[tuple[str, Ints]]:
        """Name of each step that was begun, and the rows of its accepted increments."""
        names = self.history["step"] if self.rows else np.array([], dtype=str)
        order = list(dict.fromkeys(names.tolist()))
        return [(name, np.flatnonzero(names == name)) for name in order]

    @cached_property
    def moments(self) -> list[Moment]:
        """Written states, the start left out."""
        found = []
        times = self.results.times
        for row in range(self.rows):
            same = np.flatnonzero(np.isclose(times, self.history["time"][row], rtol=1e-12))
            if same.size:
                step, increment = self.history["step"][row], self.history["increment"][row]
                found.append(Moment(f"{step}, increment {increment:.0f}", int(same[-1]), row))
        return found

    def ends(self) -> list[Moment]:
        """The last written state of each step."""
        return [m for m in (self._last_of(rows) for _, rows in self.steps) if m is not None]

    def _last_of(self, rows: Ints) -> Moment | None:
        inside = [m for m in self.moments if m.row in rows]
        return inside[-1] if inside else None

    def mixed(self, contact: int) -> list[Moment]:
        """The written state of each step in which stick and slip are most mixed."""
        chosen = []
        for _, rows in self.steps:
            inside = [m for m in self.moments if m.row in rows]
            if inside:
                chosen.append(max(inside, key=lambda m: self._mixture(contact, m.row)))
        return chosen

    def _mixture(self, contact: int, row: int) -> float:
        counts = np.array(
            [self.history[f"contacts.{contact}.points.{s}"][row] for s in ("stick", "slip")]
        )
        # The least of both, and among states that are all the same the last one.
        return float(counts.min() + 1e-9 * row)

    def vectors(self, name: str) -> Floats:
        """A vector column of the history, (rows, 3)."""
        return np.column_stack([self.history[f"{name}.{axis}"] for axis in "xyz"])

    def is_resultant(self, axis: Floats) -> bool:
        """Whether forces along an axis have a resultant: around an axis radial ones have none."""
        return not self.around_an_axis or abs(axis[0]) < RADIAL

    @property
    def around_an_axis(self) -> bool:
        """Whether the mesh is a section of a body of revolution about x = 0."""
        return bool(self.summary.get("idealisation") == "axisymmetric")

    def exact(self, contact: int, law: str) -> bool:
        """Whether multipliers make a law of a contact exact: its stiffness is no property then."""
        return law in self.summary["contacts"][contact].get("multipliers", ())

    @cache  # noqa: B019 (one object for one report)
    def view(self, index: int, contact: int) -> ContactView:
        """A contact in a written state; an outline begins where it does in the last one."""
        last = self.moments[-1].index if self.moments else index
        contour = None if index in (last, -1) else self.view(last, contact).contour
        return ContactView(self.results.slave_points(index), contact, contour)

    def path_length(self) -> tuple[str, Floats]:
        """How far what moves most has come: a group, a rigid body, its angle, or else the time.

        The time as well where a body turns in a step in which it hardly comes any farther.
        """
        rigid = self.summary.get("rigid", {})
        moves = {g: f"displacements.{g}" for g in self.summary["displacements"]}
        moves |= {body: f"rigid.{body}.translation" for body in rigid}
        turns = {body: f"rigid.{body}.turn" for body in rigid}
        for text, columns in (
            ("distance travelled by {} [length]", moves),
            ("rotation angle of {} [rad]", turns),
        ):
            paths = {name: self._path(column) for name, column in columns.items()}
            longest = max(paths, key=lambda name: paths[name][-1], default=None)
            if longest is not None and paths[longest][-1] > 0.0:
                if columns is moves and self._turns_at(paths[longest], turns.values()):
                    break
                return text.format(plain(longest)), paths[longest]
        return "time [time]", self.history["time"]

    @cached_property
    def turning(self) -> dict[str, Floats]:
        """Axis of each rigid body that turns, that of its largest turn, (3,)."""
        found = {}
        for body in self.summary.get("rigid", {}):
            turn = self.vectors(f"rigid.{body}.turn")
            size = np.linalg.norm(turn, axis=1)
            if size.max(initial=0.0) > TILT:
                found[body] = turn[np.argmax(size)] / size.max()
        return found

    def angle(self, body: str) -> Floats:
        """Angle through which a rigid body has turned up to each row, there and back, (rows,)."""
        return self._path(f"rigid.{body}.turn")

    def _turns_at(self, path: Floats, turns: Iterable[str]) -> bool:
        """Whether something turns in a step that has next to nothing of the length of a path."""
        turned = [self._path(column) for column in turns]
        for _, rows in self.steps:
            before = max(rows[0] - 1, 0)
            still = path[rows[-1]] - path[before] < HARDLY * path[-1]
            if still and any(angle[rows[-1]] > angle[before] for angle in turned):
                return True
        return False

    def _path(self, column: str) -> Floats:
        """Length of the path of a vector up to each row, (rows,)."""
        moved = np.vstack([np.zeros(3), self.vectors(column)])
        return np.cumsum(np.linalg.norm(np.diff(moved, axis=0), axis=1))


def _numbers(value: Any) -> Any:
    """Nested values with not-a-number where JSON has null."""
    if isinstance(value, dict):
        return {key: _numbers(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_numbers(one) for one in value]
    return math.nan if value is None else value
