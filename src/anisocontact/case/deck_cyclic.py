"""Sectors of a deck: cut faces that `*TIE, CYCLIC SYMMETRY` names, as tables of a case file."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.deck import Card

#: Difference of the angle between cut faces to that of a sector, radian, that is none.
SAME = 1e-3


class DeckSectors:
    """What a deck says of cyclic symmetry.

    Args:
        mesh: Its mesh.
        named: Name of a set or surface -> groups "body.name".
    """

    def __init__(self, mesh: MeshArrays, named: Callable[[str], list[str]]) -> None:
        self._mesh, self._named = mesh, named
        self._ties: dict[str, Card] = {}
        self._found: list[dict[str, object]] = []

    def take(self, card: Card) -> bool:
        """Take a card over; whether it is one of a sector.

        Raises:
            InputError: It cannot be taken over.
        """
        if card.name == "TIE" and "CYCLICSYMMETRY" in card.options:
            self._ties[card.options.get("NAME", "").upper()] = card
        elif card.name == "CYCLICSYMMETRYMODEL":
            self._found += self._faces(card)
        else:
            return False
        return True

    def tables(self) -> list[dict[str, object]]:
        """A table for each body that is cut."""
        return self._found

    def _faces(self, card: Card) -> Iterator[dict[str, object]]:
        numbers = card.numbers()
        if "N" not in card.options or len(numbers) < 6:
            raise InputError("sectors N and two points of the axis are needed")
        name = card.options.get("TIE", "").upper()
        tie = self._ties.get(name) or (next(iter(self._ties.values()), None) if not name else None)
        if tie is None:
            raise InputError(f"there is no *TIE, CYCLIC SYMMETRY {name.lower()}".rstrip())
        slave, master, *_ = next(tie.fields())
        point, axis = numbers[:3], numbers[3:6] - numbers[:3]
        sectors = int(card.options["N"])
        pairs = list(self._pairs(slave, master))
        if not pairs:
            raise InputError(f"{slave.lower()} and {master.lower()} are no facets of one body")
        for cut, other in pairs:
            angle = self._angle(other, cut, point, axis)
            if abs(abs(angle) - 2.0 * math.pi / sectors) > SAME:
                text = f"{cut} is {math.degrees(angle):.4g} degrees from {other}, N={sectors}"
                raise InputError(text)
            table = {"slave": cut, "master": other, "sectors": sectors}
            table |= {"axis": (math.copysign(1.0, angle) * axis + 0.0).tolist()}
            yield table | ({"point": point.tolist()} if np.any(np.cross(point, axis)) else {})

    def _pairs(self, slave: str, master: str) -> Iterator[tuple[str, str]]:
        """Facet groups of both faces on the same body."""
        on_body = {one.partition(".")[0]: one for one in self._facets(master)}
        for one in self._facets(slave):
            body = one.partition(".")[0]
            if body in on_body:
                yield one, on_body[body]

    def _facets(self, name: str) -> list[str]:
        return [group for group in self._named(name) if group in self._mesh.facets]

    def _angle(
        self,
        start: str,
        end: str,
        point: Floats,
        axis: Floats,
    ) -> float:
        """Turn about the axis from the middle of one face to that of another, radian."""
        along = axis / np.linalg.norm(axis)
        arms = []
        for group in (start, end):
            nodes = np.unique(self._mesh.facets[group])
            arm = self._mesh.points[nodes].mean(axis=0) - point
            arms.append(arm - (arm @ along) * along)
        return math.atan2(along @ np.cross(arms[0], arms[1]), arms[0] @ arms[1])
