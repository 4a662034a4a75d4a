"""Contact of a deck as tables of a case file: pairs, general contact, friction, rigid surfaces."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.case.deck_tools import Tools
from anisocontact.mesh.deck import Card, real
from anisocontact.mesh.deck_supports import key_of, written

if TYPE_CHECKING:
    from anisocontact.base.array_types import Ints
    from anisocontact.mesh.arrays import MeshArrays

#: Options of `*FRICTION` with which its numbers are no coefficients of all slips.
OTHER_FRICTION = {
    "USER": "see contact.python",
    "EXPONENTIALDECAY": "a coefficient that falls with speed is a law in contact.python",
    "ROUGH": "no slip at all: see [[tie]], or a large coefficient",
}
#: Options that leave the coefficient what it is -> what is not taken over.
PARTLY = {"TAUMAX": "its limit of stress", "DEPENDENCIES": "other values of its fields"}
#: Name of the group of all facets of a body in general contact.
SKIN = "skin"
#: Gap between the boxes of bodies that may meet, over the size of the smaller one.
NEAR = 0.1
#: Most pairs that general contact is written out for.
MOST = 12
#: Cosine of the angle from the first axis of space at which it is the normal of a surface.
ALONG = 1.0 - 1.5e-6


class DeckContacts:
    """What a deck says of contact.

    Args:
        mesh: Its mesh.
        named: Name of a set or surface -> groups "body.name".
        tools: Its analytical surfaces.
        leave: Told a card that is left out, and why.
    """

    def __init__(
        self,
        mesh: MeshArrays,
        named: Callable[[str], list[str]],
        tools: Tools,
        leave: Callable[[Card, str], None],
    ) -> None:
        self._mesh, self._named, self._tools, self._leave = mesh, named, tools, leave
        self._interaction = ""
        self._interactions: set[str] = set()
        self._friction: dict[str, list[float]] = {}
        self._penalty: dict[str, float] = {}
        self._pairs: list[Card] = []
        self._general: list[Card] = []
        self._assigned: dict[frozenset[str], str] = {}

    def take(self, step: int, card: Card) -> bool:
        """Take a card over; whether it is one of contact.

        Raises:
            InputError: It cannot be taken over.
        """
        known = card.name in _READERS and (not step or card.name in _IN_FIRST_STEP)
        if known and step > 1:
            raise InputError("contact is the same in all steps here")
        if known:
            _READERS[card.name](self, card)
        return known

    def lines(self, rigid: Iterable[str]) -> Iterator[str]:
        """Tables of groups, surfaces and contacts.

        Args:
            rigid: Skins of bodies that follow reference points.
        """
        found = [pair for card in self._pairs for pair in self._of_pairs(card)]
        found += [pair for card in self._general for pair in self._of_inclusions(card)]
        skins = [*rigid, *(one for slave, master, *_ in found for one in (slave, master))]
        for skin in dict.fromkeys(one for one in skins if one.endswith(f".{SKIN}")):
            if skin not in self._mesh.facets:
                yield from table_lines(f"[group.{key_of(skin)}]", {"by": "all"})
        for name, table in self._tools.tables().items():
            yield from table_lines(f"[surface.{key_of(name)}]", table)
        for slave, master, name, more in found:
            yield from self._contact(slave, master, name, more)

    def sides(self, card: Card, slave: str, master: str) -> tuple[str, str] | None:
        """Slave and master of a pair; None where one of them is not on one body."""
        found = []
        for name in (slave, master):
            groups = [group for group in self._named(name) if group in self._mesh.facets]
            if name == master and not groups and self._tools.known(name):
                try:
                    groups = [self._tools.use(name)]
                except InputError as error:
                    self._leave(card, f": {name.lower()}: {error}")
                    return None
            if len(groups) != 1:
                said = f"on {' and '.join(groups)}" if groups else "no facet group"
                self._leave(card, f": {name.lower()} is {said}")
                return None
            found += groups
        return found[0], found[1]

    def read_interaction(self, card: Card) -> None:
        """Take `*SURFACE INTERACTION`; what follows is of it."""
        self._interaction = card.option("NAME").upper()
        self._interactions.add(self._interaction)

    def read_friction(self, card: Card) -> None:
        """Take `*FRICTION`: a coefficient, or two along the axes of the slave.

        Raises:
            InputError: It is friction of another kind.
        """
        if not self._interaction:
            raise InputError("it belongs to no *SURFACE INTERACTION")
        for option, instead in OTHER_FRICTION.items():
            if option in card.options:
                raise InputError(f"{option} is not taken over; {instead}")
        rows = list(card.rows())
        numbers = [real(entry or "0") for entry in rows[0]]
        count = 2 if "ANISOTROPIC" in card.options else 1
        if len(numbers) < count:
            raise InputError(f"{len(numbers)} numbers, {count} are needed")
        self._friction[self._interaction] = numbers[:count]
        missing = [what for option, what in PARTLY.items() if option in card.options]
        missing += ["other values"] * (len(rows) > 1)
        if missing:
            self._leave(card, f": its coefficient is taken over, not {' and '.join(missing)}")

    def read_behaviour(self, card: Card) -> None:
        """Take `*SURFACE BEHAVIOR`: contact is exact here, a line says what was given.

        Raises:
            InputError: Faces may not come apart.
        """
        kind = card.options.get("PRESSURE-OVERCLOSURE", "").upper()
        if kind == "TIED" or "NOSEPARATION" in card.options:
            raise InputError("its faces do not come apart, as [[tie]] has it; contact does here")
        if kind == "LINEAR":
            self._penalty[self._interaction] = float(card.numbers()[0])
        elif kind in ("EXPONENTIAL", "TABULAR"):
            text = f"PRESSURE-OVERCLOSURE={kind}: contact is exact here, nothing overlaps; a "
            raise InputError(text + "compliant layer is a normal penalty")

    def read_pair(self, card: Card) -> None:
        """Take `*CONTACT PAIR`.

        Raises:
            InputError: Its faces may not come apart.
        """
        if "TIED" in card.options:
            raise InputError("TIED: its faces do not come apart; see [[tie]]")
        self._pairs.append(card)

    def read_general(self, card: Card) -> None:
        """Take `*CONTACT`, which what follows belongs to."""

    def read_inclusions(self, card: Card) -> None:
        """Take `*CONTACT INCLUSIONS`."""
        self._general.append(card)

    def read_assignment(self, card: Card) -> None:
        """Take `*CONTACT PROPERTY ASSIGNMENT`."""
        for first, second, name, *_ in card.rows():
            self._assigned[frozenset(one.upper() for one in (first, second))] = name.upper()

    def _of_pairs(self, card: Card) -> Iterator[tuple[str, str, str, dict[str, object]]]:
        name = card.options.get("INTERACTION", "").upper()
        if name and name not in self._interactions:
            what = f"there is no *SURFACE INTERACTION {name.lower()}"
            self._leave(card, f": {what}, its contact is without friction")
        for slave, *others in card.fields():
            if not others:
                self._leave(card, ": a surface with itself; see self_contact")
            elif sides := self.sides(card, slave, others[0]):
                yield *sides, name, self._adjusted(card)

    def _adjusted(self, card: Card) -> dict[str, object]:
        """What `ADJUST` asks for: gaps up to its number are closed, overlaps are taken away."""
        if "ADJUST" not in card.options:
            return {}
        given: dict[str, object] = {"adjust": True}
        try:
            gap = real(card.options["ADJUST"])
        except ValueError:
            self._leave(card, ": ADJUST of a set takes overlaps away; gaps stay, see adjust_gap")
            return given
        return given | ({"adjust_gap": gap} if gap > 0.0 else {})

    def _of_inclusions(self, card: Card) -> Iterator[tuple[str, str, str, dict[str, object]]]:
        """Pairs of general contact: those that are named, or all bodies that are near."""
        for entries in card.rows():
            slave, *others = (entry for entry in entries if entry)
            if not others:
                self._leave(card, f": {slave.lower()} with itself or all others; see self_contact")
            elif sides := self.sides(card, slave, others[0]):
                key = frozenset((slave.upper(), others[0].upper()))
                yield *sides, self._assigned.get(key, self._assigned.get(frozenset([""]), "")), {}
        if "ALLEXTERIOR" not in card.options:
            return
        near = [pair for pair in combinations(self._mesh.bodies, 2) if self._near(*pair)]
        if not near or len(near) > MOST:
            self._leave(card, f": {len(near)} pairs of bodies are near each other; see [[contact]]")
            return
        for pair in near:
            finer, other = sorted(pair, key=self._cell_size)
            name = self._assigned.get(frozenset([""]), "")
            yield f"{finer}.{SKIN}", f"{other}.{SKIN}", name, {}
        said = ", ".join(" and ".join(pair) for pair in near)
        self._leave(card, f": ALL EXTERIOR is one pair of skins for {said}; none with itself")

    def _near(self, first: str, second: str) -> bool:
        """Whether the boxes of two bodies are close to each other."""
        boxes = [(x.min(axis=0), x.max(axis=0)) for x in map(self._points, (first, second))]
        sizes = [float(np.linalg.norm(high - low)) for low, high in boxes]
        gap = np.maximum(boxes[1][0] - boxes[0][1], boxes[0][0] - boxes[1][1]).max()
        return bool(gap <= NEAR * min(sizes))

    def _points(self, body: str) -> np.ndarray:
        found: np.ndarray = self._mesh.points[np.unique(self._cells(body))]
        return found

    def _cells(self, body: str) -> Ints:
        return self._mesh.cells[self._mesh.bodies[body]]

    def _cell_size(self, body: str) -> float:
        """Mean size of its cells."""
        return float(np.ptp(self._mesh.points[self._cells(body)], axis=1).mean())

    def _contact(
        self, slave: str, master: str, name: str, more: dict[str, object]
    ) -> Iterator[str]:
        values = self._friction.get(name, [0.0])
        friction: dict[str, object] = {"coefficients": values[0]}
        if len(set(values)) > 1:
            axes: dict[str, object] = {"kind": "constant", "vector": self._first_axis(slave)}
            on = {} if self._tools.known(master) else {"directions_on": "slave"}
            friction = {"coefficients": values, "directions": axes, **on}
        yield from table_lines(
            "[[contact]]", {"slave": slave, "master": master} | more | {"friction": friction}
        )
        if name in self._penalty:
            stiff = f"normal = {{ penalty = {self._penalty[name]:g} }}"
            yield f'# nothing overlaps; as in the deck: method = "penalty", {stiff}'

    def _first_axis(self, slave: str) -> list[float]:
        """First axis of friction: x on the surface, or z where x is its normal."""
        if slave in self._mesh.facets:
            corners = self._mesh.points[self._mesh.facets[slave]]
            if corners.shape[1] > 2:
                across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
                along = np.abs(across[:, 0]) / np.linalg.norm(across, axis=1)
                if np.all(along > ALONG):
                    return [0.0, 0.0, 1.0]
        return [1.0, 0.0, 0.0]


def table_lines(head: str, values: dict[str, object]) -> Iterator[str]:
    """Lines of a table of a case file."""
    yield ""
    yield head
    for key, value in values.items():
        yield f"{key} = {written(value)}"


#: Keyword -> what takes it.
_READERS: dict[str, Callable[[DeckContacts, Card], None]] = {
    "SURFACEINTERACTION": DeckContacts.read_interaction,
    "FRICTION": DeckContacts.read_friction,
    "SURFACEBEHAVIOR": DeckContacts.read_behaviour,
    "SURFACEBEHAVIOUR": DeckContacts.read_behaviour,
    "CONTACTPAIR": DeckContacts.read_pair,
    "CONTACT": DeckContacts.read_general,
    "CONTACTINCLUSIONS": DeckContacts.read_inclusions,
    "CONTACTPROPERTYASSIGNMENT": DeckContacts.read_assignment,
}
#: Those that may stand in the first step.
_IN_FIRST_STEP = ("CONTACTPAIR", "CONTACT", "CONTACTINCLUSIONS", "CONTACTPROPERTYASSIGNMENT")
