"""Faces of a deck that follow reference points: `*RIGID BODY`, `*COUPLING` with `*KINEMATIC`.

They become rigid bodies with `faces`: what `*BOUNDARY` gives their points is a motion, what
`*CLOAD` gives is a load, and components that nothing holds are free.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from anisocontact.base.errors import InputError
from anisocontact.case.deck_contact import SKIN
from anisocontact.case.deck_tools import Tools
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.deck import Card, real
from anisocontact.mesh.deck_contents import Deck
from anisocontact.mesh.deck_supports import check_options
from anisocontact.mesh.inp import bodies_of

#: Components of a motion and of a load by the number of their direction, from 1 on.
MOTION = ("x", "y", "z", "rx_deg", "ry_deg", "rz_deg")
LOAD = ("x", "y", "z", "rx", "ry", "rz")
_MOVED = dict(zip(LOAD, MOTION, strict=True))
#: Names of supports in the place of directions.
NAMED = {"ENCASTRE": (1, 6), "PINNED": (1, 3)}
#: Options that name what follows: a surface, or nodes that hold faces.
FACES = ("ANALYTICALSURFACE", "SURFACE", "ELSET", "NSET", "TIENSET", "PINNSET")


@dataclass(frozen=True)
class _Prescribed:
    """A component of a point that a step gives.

    Attributes:
        step: Number of the step, 0 in front of the first.
        key: "motion" or "load".
        body: Name of the rigid body.
        component: Name of the component.
        value: What it is given.
        amplitude: Name of its amplitude in small letters; empty for none.
    """

    step: int
    key: str
    body: str
    component: str
    value: float
    amplitude: str


class ReferencePoints:
    """The reference points of a deck.

    Args:
        deck: The deck.
        mesh: Its mesh.
        named: Name of a set or surface -> groups "body.name".
        tools: Its analytical surfaces.
        components: Directions that a point can go along or turn about, from 1 on.
        leave: Told a card that is left out, and why.

    Attributes:
        tables: Tables of the rigid bodies by name.
        rigid: Bodies that are rigid as a whole.
    """

    def __init__(
        self,
        deck: Deck,
        mesh: MeshArrays,
        named: Callable[[str], list[str]],
        tools: Tools,
        components: Sequence[int],
        leave: Callable[[Card, str], None],
    ) -> None:
        self._deck, self._mesh, self._named = deck, mesh, named
        self._tools, self._components, self._leave = tools, components, leave
        self._points: dict[int, tuple[str, int]] = {}
        self._prescribed: list[_Prescribed] = []
        self._new: set[tuple[int, str]] = set()
        self._open: Card | None = None
        self.tables: dict[str, dict[str, object]] = {}
        self.rigid: list[str] = []

    @property
    def skins(self) -> list[str]:
        """All facets of the bodies that are rigid as a whole, as groups."""
        return [f"{body}.{SKIN}" for body in self.rigid]

    def take(self, card: Card) -> bool:
        """Take a card over; whether it is one of a coupling.

        Raises:
            InputError: It cannot be taken over.
        """
        if card.name == "RIGIDBODY":
            self._add(card)
        elif card.name == "COUPLING":
            self._open = card
        elif card.name in ("KINEMATIC", "DISTRIBUTING") and self._open is not None:
            coupling, self._open = self._open, None
            if card.name == "DISTRIBUTING":
                raise InputError("its face may deform, one of a rigid body does not; see force")
            tied = {k for first, last in map(_range, card.fields()) for k in range(first, last + 1)}
            needed = 3 if 3 in self._components else 2  # of nodes, in space and in the plane
            if tied and not tied.issuperset(range(1, needed + 1)):
                text = f"single components are coupled, all of 1 to {needed} are taken over"
                raise InputError(text)
            self._add(coupling)
        else:
            return False
        return True

    def without(self, cards: Sequence[tuple[int, Card]]) -> list[tuple[int, Card]]:
        """Cards without what they give to reference points, which is kept or left out."""
        kept = []
        for step, card in cards:
            key = {"BOUNDARY": "motion", "CLOAD": "load"}.get(card.name)
            if key is None or not self._points:
                kept.append((step, card))
                continue
            lines = []
            for line in card.data:
                entries = next(replace(card, data=(line,)).rows())
                nodes = self._deck.nodes_of(entries[0]) if entries else []
                if nodes and self._points.keys() >= set(nodes):
                    self._try_line(step, key, card, nodes, entries)
                else:
                    lines.append(line)
            if card.options.get("OP", "").upper() == "NEW":
                self._new.add((step, key))
            if lines or not card.data or (step, key) in self._new:
                kept.append((step, replace(card, data=tuple(lines))))
        return kept

    def step(
        self, number: int, with_amplitude: Callable[[object, str], object]
    ) -> dict[str, object]:
        """Motions and loads of a step.

        Args:
            number: Its number, from 1 on.
            with_amplitude: Gives a value its amplitude.
        """
        motion = {name: self._given(number, "motion", name, with_amplitude) for name in self.tables}
        load = {
            name: {  # what is taken off a component that is held now needs no words
                component: value
                for component, value in self._given(number, "load", name, with_amplitude).items()
                if value != 0.0 or motion[name].get(_MOVED[component], "free") == "free"
            }
            for name in self.tables
        }
        both = {"motion": motion, "load": load}
        found = {key: {n: own for n, own in bodies.items() if own} for key, bodies in both.items()}
        return {key: bodies for key, bodies in found.items() if bodies}

    def _given(
        self, number: int, key: str, body: str, with_amplitude: Callable[[object, str], object]
    ) -> dict[str, object]:
        own = [one for one in self._prescribed if (one.key, one.body) == (key, body)]
        now: dict[str, object] = {}
        if key == "motion" and number == 1:
            now = {MOTION[k - 1]: "free" for k in self._components}
        elif (number, key) in self._new:
            before = [one.component for one in own if one.step < number]
            now = dict.fromkeys(before, "free" if key == "motion" else 0.0)
        for one in own:
            if one.step == number or (number == 1 and one.step == 0):
                now[one.component] = with_amplitude(one.value, one.amplitude)
        return now

    def _add(self, card: Card) -> None:
        node = self._point(card.option("REFNODE"))
        option = next((name for name in FACES if card.options.get(name)), "")
        if not option:
            raise InputError("a surface, elements, or a node set that holds faces is taken over")
        wanted = card.options[option]
        name = (card.options.get("CONSTRAINTNAME") or wanted).lower().replace(".", "_")
        self.tables[name] = {
            **self._carried(option, wanted),
            "reference": self._deck.nodes[node],
        }
        self._points[node] = (name, 0)
        if card.options.get("ROTNODE"):
            self._points[self._point(card.options["ROTNODE"])] = (name, 3)

    def _carried(self, option: str, wanted: str) -> dict[str, object]:
        """What a reference point carries: surfaces, faces, or bodies as a whole."""
        if option == "ANALYTICALSURFACE":
            if not self._tools.known(wanted):
                raise InputError(f"there is no analytical surface {wanted.lower()}")
            return {"surfaces": [self._tools.use(wanted)]}
        if option == "ELSET":
            members, of_element = set(self._deck.members_of(wanted)), bodies_of(self._deck)
            whole: dict[str, bool] = {}
            for number in self._deck.elements:
                body = of_element.get(number, "")
                whole[body] = whole.get(body, True) and number in members
            bodies = [body for body in self._mesh.bodies if whole.get(body)]
            if not bodies:
                raise InputError(
                    f"{wanted.lower()} is no whole body of solids; see rigid bodies for tools"
                )
            self.rigid += bodies
            return {"faces": [f"{body}.{SKIN}" for body in bodies]}
        faces = [group for group in self._named(wanted) if group in self._mesh.facets]
        if not faces:
            raise InputError(f"{wanted.lower()} holds no faces")
        return {"faces": faces}

    def _point(self, entry: str) -> int:
        nodes = self._deck.nodes_of(entry)
        if len(set(nodes)) != 1 or nodes[0] not in self._deck.nodes:
            raise InputError(f"the reference point {entry.lower()} is {len(set(nodes))} nodes")
        return nodes[0]

    def _try_line(
        self, step: int, key: str, card: Card, nodes: Sequence[int], entries: Sequence[str]
    ) -> None:
        try:
            self._take_line(step, key, card, nodes, entries)
        except InputError as error:
            self._leave(card, f": {error}")
        except (ValueError, IndexError):
            self._leave(card, f": {entries[0].lower()} has data of another kind")

    def _take_line(
        self, step: int, key: str, card: Card, nodes: Sequence[int], entries: Sequence[str]
    ) -> None:
        if "FIXED" in card.options and step > 1:
            raise InputError(f"FIXED holds {entries[0].lower()} where it is; give its motion")
        check_options(card)
        amplitude = card.options.get("AMPLITUDE", "").lower()
        first, last = _range(entries[1:]) if key == "motion" else (int(entries[1]),) * 2
        value = real((*entries[3:], "0")[0] if key == "motion" else entries[2])
        for body, more in (self._points[node] for node in nodes):
            for k in range(first + more, last + more + 1):
                if k in self._components:
                    turned = key == "motion" and k > 3
                    number = math.degrees(value) if turned else value
                    name = (MOTION if key == "motion" else LOAD)[k - 1]
                    self._prescribed.append(_Prescribed(step, key, body, name, number, amplitude))


def _range(entries: Sequence[str]) -> tuple[int, int]:
    """First and last direction of a line; of one without an end the first alone."""
    if not entries:
        return 1, 6
    if entries[0].upper() in NAMED:
        return NAMED[entries[0].upper()]
    if not all(entry.isdigit() for entry in entries[:2] if entry):
        raise InputError(f"{entries[0]} of a reference point is not read; give its directions")
    return int(entries[0]), int((*entries[1:2], "")[0] or entries[0])


def of_ideal(kinds: Iterable[str]) -> tuple[int, ...]:
    """Directions of a reference point under an idealisation, by what a deck calls its elements."""
    names = {kind[:3] for kind in kinds}
    if names <= {"CAX"}:
        return (2,)
    return (1, 2, 6) if names <= {"CPE", "CPS"} else (1, 2, 3, 4, 5, 6)
