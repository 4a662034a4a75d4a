"""Analytical surfaces of rigid bodies in a deck: `*SURFACE` of TYPE=SEGMENTS, CYLINDER, REVOLUTION.

A profile of lines and arcs in a plane, turned about the second axis of the plane or drawn out
across it. As the manual of Abaqus has it, what touches is on the left of the profile as it goes;
the generator of a cylinder is against the third axis.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.mesh.deck import Card, real

#: Kinds of them.
ANALYTIC = ("SEGMENTS", "CYLINDER", "REVOLUTION")
#: Sine of the angle of a corner that counts as smooth.
SMOOTH = 1e-3


@dataclass(frozen=True)
class Piece:
    """A line or an arc of a profile.

    Attributes:
        start: Where it begins, (2,), length.
        end: Where it ends, (2,), length.
        angle: Angle by which it turns to the left, radian; 0 of a line.
    """

    start: Floats
    end: Floats
    angle: float = 0.0

    def tangent(self, at_end: bool) -> Floats:
        """Direction in which it goes at its start or end."""
        chord = (self.end - self.start) / np.linalg.norm(self.end - self.start)
        turn = 0.5 * self.angle * (1.0 if at_end else -1.0)
        cos, sin = np.cos(turn), np.sin(turn)
        turned = [cos * chord[0] - sin * chord[1], sin * chord[0] + cos * chord[1]]
        return np.array(turned, dtype=np.float64)

    def centre(self) -> Floats:
        """Centre of an arc."""
        chord = self.end - self.start
        left = np.array([-chord[1], chord[0]])
        found: Floats = 0.5 * (self.start + self.end) + 0.5 * left / np.tan(0.5 * self.angle)
        return found


@dataclass(frozen=True)
class Profile:
    """A profile and where its plane is.

    Attributes:
        kind: SEGMENTS, CYLINDER or REVOLUTION.
        pieces: Its lines and arcs.
        frame: The origin of the plane and the ends of its three unit vectors, (4, 3), length.
        fillet: Radius that rounds its corners, length; 0 for none.
    """

    kind: str
    pieces: tuple[Piece, ...]
    frame: Floats
    fillet: float = 0.0

    def placed(self, places: Callable[[Floats], Floats]) -> Profile:
        """The profile where an instance of its part is."""
        return replace(self, frame=places(self.frame))

    def point(self, place: Floats) -> Floats:
        """A place of the plane in space."""
        found: Floats = self.frame[0] + place @ (self.frame[1:3] - self.frame[0])
        return found

    def rounded(self) -> list[Piece]:
        """Its pieces, corners between lines rounded.

        Raises:
            InputError: A corner beside an arc would have to be rounded, or is too short for it.
        """
        pieces = list(self.pieces)
        if self.fillet <= 0.0:
            return pieces
        found = [pieces[0]]
        for after in pieces[1:]:
            before = found.pop()
            found += _with_fillet(before, after, self.fillet)
        return found

    def corners(self) -> Iterator[Floats]:
        """Inner points at which it is not smooth, with the corners that the fillet rounds."""
        for before, after in zip(self.pieces, self.pieces[1:], strict=False):
            if abs(_cross(before.tangent(True), after.tangent(False))) > SMOOTH:
                yield before.end


def _cross(a: Floats, b: Floats) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _with_fillet(before: Piece, after: Piece, radius: float) -> list[Piece]:
    """Two pieces with what rounds the corner between them."""
    a, b = before.tangent(True), after.tangent(False)
    angle = float(np.arctan2(_cross(a, b), a @ b))
    if abs(np.sin(angle)) <= SMOOTH:
        return [before, after]
    if before.angle or after.angle:
        raise InputError("FILLET RADIUS beside an arc is not read; write the arc of the fillet out")
    cut = radius * abs(np.tan(0.5 * angle))
    corner = before.end
    lengths = (np.linalg.norm(corner - before.start), np.linalg.norm(after.end - corner))
    if cut > (1.0 + SMOOTH) * min(lengths):
        raise InputError(f"FILLET RADIUS={radius:g} is longer than a line that it rounds")
    first, last = corner - cut * a, corner + cut * b
    pieces = [replace(before, end=first), Piece(first, last, angle), replace(after, start=last)]
    return [one for one in pieces if np.linalg.norm(one.end - one.start) > SMOOTH * cut]


def profile_of(card: Card) -> Profile:
    """The profile that a card describes.

    Raises:
        InputError: It has no START, or pieces that are neither lines nor arcs.
    """
    kind = card.options["TYPE"].upper()
    rows = list(card.rows())
    heads = [k for k, row in enumerate(rows) if row and row[0].upper() == "START"]
    if len(heads) != 1:
        raise InputError("a line START is needed")
    placed = [real(v or "0") for row in rows[: heads[0]] for v in row]
    here, pieces = np.array([real(v) for v in rows[heads[0]][1:3]]), []
    for word, *given in rows[heads[0] + 1 :]:
        numbers = np.array([real(v or "0") for v in given])
        if word.upper() not in ("LINE", "CIRCL"):
            raise InputError(f"{word} is not read; LINE and CIRCL are")
        end, angle = numbers[:2], 0.0
        if word.upper() == "CIRCL":
            a, b = here - numbers[2:4], end - numbers[2:4]
            angle = float(np.arctan2(_cross(a, b), a @ b))
        pieces.append(Piece(here, end, angle))
        here = end
    if not pieces:
        raise InputError("a profile needs a LINE or CIRCL")
    return Profile(
        kind, tuple(pieces), _frame(kind, placed), real(card.options.get("FILLETRADIUS") or "0")
    )


def _frame(kind: str, given: list[float]) -> Floats:
    """Origin and ends of the unit vectors of the plane of a profile."""
    axes = np.eye(3)
    origin = np.zeros(3)
    if kind == "CYLINDER" and len(given) >= 9:
        origin, first, generator = np.array(given[:9]).reshape(3, 3)
        x = (first - origin) / np.linalg.norm(first - origin)
        z = origin - generator
        y = np.cross(z, x) / np.linalg.norm(np.cross(z, x))
        axes = np.array([x, y, np.cross(x, y)])
    elif kind == "REVOLUTION" and len(given) >= 6:
        origin, end = np.array(given[:6]).reshape(2, 3)
        y = (end - origin) / np.linalg.norm(end - origin)
        x = np.cross(y, np.eye(3)[np.abs(y).argmin()])
        x /= np.linalg.norm(x)
        axes = np.array([x, y, np.cross(x, y)])
    return np.vstack([origin, origin + axes])
