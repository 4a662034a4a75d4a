"""Analytical surfaces of a deck as surfaces of a case file.

Profiles that are turned about an axis become revolutions, a line that is drawn out a plane, an arc
a cylinder, and smooth profiles of several pieces a NURBS patch.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.mesh.deck_profiles import Piece, Profile
from anisocontact.mesh.inp import plain

#: Length of a patch across its profile, over the size of the mesh.
ACROSS = 4.0
#: Largest angle of an arc that is one piece of a patch, radian.
LARGEST = 0.5 * math.pi
#: Share of a radius by which two arcs count as one.
SAME = 1e-6


class Tools:
    """The analytical surfaces of a deck.

    Args:
        profiles: Name in capitals -> profile.
        points: Nodes of the mesh, (nodes, 3), length.
        axisymmetric: Whether the mesh is that of a body of revolution.
    """

    def __init__(self, profiles: dict[str, Profile], points: Floats, axisymmetric: bool) -> None:
        self._profiles = profiles
        self._points, self._axisymmetric = points, axisymmetric
        self._tables: dict[str, dict[str, object]] = {}

    def known(self, name: str) -> bool:
        """Whether a name is that of an analytical surface."""
        return name.upper() in self._profiles or name in self._tables

    def use(self, name: str) -> str:
        """The key of a surface, which the case has from now on.

        Raises:
            InputError: There is no such surface here.
        """
        key = plain(name)
        if key not in self._tables:
            self._tables[key] = self._table(self._profiles[name.upper()])
        return key

    def tables(self) -> dict[str, dict[str, object]]:
        """Tables of the surfaces that are used."""
        return self._tables

    def _table(self, profile: Profile) -> dict[str, object]:
        if profile.kind == "REVOLUTION" or self._axisymmetric:
            return _revolution(profile)
        pieces = profile.rounded()
        if len(pieces) == 1 and not pieces[0].angle:
            x, y = pieces[0].tangent(False)
            normal = profile.point(np.array([-y, x])) - profile.frame[0]
            point = profile.point(pieces[0].start)
            return {"shape": "plane", "point": _list(point), "normal": _list(normal)}
        if all(piece.angle for piece in pieces) and _one_circle(pieces):
            centre = profile.point(pieces[0].centre())
            radius = float(np.linalg.norm(pieces[0].start - pieces[0].centre()))
            found = {"shape": "cylinder", "point": _list(centre), "radius": radius}
            found["axis"] = _list(profile.frame[3] - profile.frame[0])
            return found | ({"inside": True} if pieces[0].angle > 0.0 else {})
        return self._patch(profile, pieces)

    def _patch(self, profile: Profile, pieces: Sequence[Piece]) -> dict[str, object]:
        """A profile of several pieces, drawn out."""
        if not profile.fillet and any(True for _ in profile.corners()):
            (x, y), *_ = profile.corners()
            raise InputError(f"its corner at {x:g}, {y:g} is sharp; give it a FILLET RADIUS")
        control, weights, knots = _quadratic(pieces)
        span = np.ptp(self._points, axis=0).max()
        middle = 0.5 * (self._points.min(axis=0) + self._points.max(axis=0))
        along = profile.frame[3] - profile.frame[0]
        here = float((middle - profile.frame[0]) @ along)
        ends = [here + sign * 0.5 * ACROSS * span for sign in (1.0, -1.0)]
        points = [profile.point(place) + end * along for place in control for end in ends]
        return {
            "shape": "nurbs",
            "degrees": [2, 1],
            "knots_1": knots,
            "knots_2": [0.0, 0.0, 1.0, 1.0],
            "points": [v for point in points for v in _list(point)],
            "weights": [w for w in weights for _ in ends],
        }


def _list(values: Floats) -> list[float]:
    """Numbers without signs of zero and the last digits of turns."""
    return [round(float(v), 12) + 0.0 for v in values]


def _one_circle(pieces: Sequence[Piece]) -> bool:
    centre, radius = pieces[0].centre(), np.linalg.norm(pieces[0].start - pieces[0].centre())
    return all(
        np.linalg.norm(piece.centre() - centre) <= SAME * radius
        and abs(np.linalg.norm(piece.start - centre) - radius) <= SAME * radius
        for piece in pieces
    )


def _revolution(profile: Profile) -> dict[str, object]:
    pieces = profile.rounded()
    places = np.array([pieces[0].start, *(piece.end for piece in pieces)])
    places[np.abs(places[:, 0]) <= SAME * np.abs(places).max(), 0] = 0.0
    if np.any(places[:, 0] < 0.0):
        raise InputError("its profile crosses the axis; r >= 0 is needed")
    found: dict[str, object] = {
        "shape": "revolution",
        "point": _list(profile.frame[0]),
        "axis": _list(profile.frame[2] - profile.frame[0]),
        "profile": [_list(place) for place in places],
    }
    if any(piece.angle for piece in pieces):
        found["arcs_deg"] = [round(math.degrees(piece.angle), 10) for piece in pieces]
    return found | {"inside": True}


def _quadratic(pieces: Sequence[Piece]) -> tuple[list[Floats], list[float], list[float]]:
    """Control points, weights and knots of a profile as quadratic pieces, knots by its length."""
    control, weights, breaks = [pieces[0].start], [1.0], [0.0]
    for piece in pieces:
        count = max(1, math.ceil(abs(piece.angle) / LARGEST - SAME))
        for part in _parts(piece, count):
            half = 0.5 * part.angle
            chord = part.end - part.start
            left = np.array([-chord[1], chord[0]])
            control += [0.5 * (part.start + part.end) - 0.5 * left * math.tan(half), part.end]
            weights += [math.cos(half), 1.0]
            length = float(np.linalg.norm(chord))
            breaks.append(breaks[-1] + (length * half / math.sin(half) if half else length))
    inner = [knot for knot in breaks[1:-1] for _ in range(2)]
    return control, weights, [0.0] * 3 + inner + [breaks[-1]] * 3


def _parts(piece: Piece, count: int) -> list[Piece]:
    """An arc in equal parts."""
    if count == 1:
        return [piece]
    centre, start = piece.centre(), piece.start - piece.centre()
    places = [piece.start]
    for k in range(1, count):
        cos, sin = math.cos(piece.angle * k / count), math.sin(piece.angle * k / count)
        turned = [cos * start[0] - sin * start[1], sin * start[0] + cos * start[1]]
        places.append(centre + np.array(turned))
    places.append(piece.end)
    return [Piece(first, last, piece.angle / count) for first, last in pairwise(places)]
