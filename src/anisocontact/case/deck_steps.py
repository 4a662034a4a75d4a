"""Steps of a deck as tables of a case file: supports, loads, times."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.deck import Card, real
from anisocontact.mesh.deck_contents import Deck, pressed_face, pressed_name
from anisocontact.mesh.deck_supports import Support, Unread, led, supports_of
from anisocontact.mesh.inp import bodies_of

__all__ = ["Steps"]

#: Most increments that are taken over of a step.
MOST = 1000

#: Group, or component of gravity -> what it is given, a number or components.
type _Given = dict[str, Any]


@dataclass
class _Step:
    """A step of a deck.

    Attributes:
        name: Its name.
        duration: Its time; None where it is no static step.
        increments: Number of increments.
        keys: Key of a step of a case file -> group -> what is given.
        new: Keywords of which it takes back what earlier steps had.
    """

    name: str
    duration: float | None = None
    increments: int = 1
    keys: dict[str, _Given] = field(default_factory=dict)
    new: set[str] = field(default_factory=set)


class Steps:
    """The steps of a deck.

    Args:
        deck: The deck.
        mesh: Its mesh.
        named: Name of a set or surface -> groups "body.name".

    Attributes:
        finite: Whether a step asks for finite strain.
        nodes: Name of a node that is held by its number -> its place.
    """

    def __init__(self, deck: Deck, mesh: MeshArrays, named: Callable[[str], list[str]]) -> None:
        self._deck, self._mesh, self._named = deck, mesh, named
        self._steps: list[_Step] = []
        self.finite = False
        self.nodes: dict[str, list[float]] = {}

    def take(self, step: int, card: Card) -> bool:
        """Take a card over; whether it is one of a step.

        Raises:
            InputError: It cannot be taken over.
        """
        if card.name == "STEP":
            title = card.options.get("NAME") or (card.data[0] if card.data else "")
            names = [one.name for one in self._steps]
            name = title.replace('"', "'").lower()
            self._steps.append(_Step(name if name and name not in names else f"step {step}"))
            self.finite = self.finite or card.options.get("NLGEOM", "NO").upper() in ("", "YES")
            return True
        if card.name == "STATIC" and step:
            times = [real(v) for v in next(card.fields(), [])]
            first, whole = (*times, *(1.0, 1.0)[len(times) :])[:2]
            here = self._steps[-1]
            here.duration = whole
            here.increments = max(1, min(MOST, math.ceil(whole / first - 1e-9)))
            return True
        if step and card.options.get("OP", "MOD").upper() == "NEW":
            self._steps[-1].new |= _RENEWED.get(card.name, set())
        if card.name not in _LOADS or not step:
            return False
        amplitude = card.options.get("AMPLITUDE", "").lower()
        for row in card.fields():
            key, group, given = _LOADS[card.name](self, row)
            groups = self._steps[-1].keys.setdefault(key, {})
            if isinstance(given, dict):
                components = {name: led(value, amplitude) for name, value in given.items()}
                groups[group] = {**groups.get(group, {}), **components}
            else:
                groups[group] = led(given, amplitude)
        return True

    def finish(self) -> list[str]:
        """Take the supports over; lines on what is not."""
        left = []
        for one in supports_of(self._deck.cards, self._deck.nodes_of, self._named):
            if isinstance(one, Unread):
                left.append(f"step {one.step}: {one.text}")
            elif self._steps:
                left += self._support(one)
        for step in self._steps:
            if step.duration is None:
                left.append(f"step {step.name!r} is not *STATIC: taken as one")
        self._renew()
        return left

    def tables(self) -> Iterator[dict[str, object]]:
        """Tables of the steps."""
        for step in self._steps:
            table: dict[str, object] = {"name": step.name, "increments": step.increments}
            if step.duration not in (None, 1.0):
                table["duration"] = step.duration
            yield table | step.keys

    def _support(self, one: Support) -> Iterator[str]:
        keys = self._steps[max(one.step - 1, 0)].keys.setdefault(one.kind, {})
        groups = one.groups or self._node(int(one.entry))
        if not groups:
            yield f"support of node {one.entry}: it is on no body"
        for group in groups:
            given = {name: led(value, one.amplitude) for name, value in one.given.items()}
            keys[group] = {**keys.get(group, {}), **given}

    def _node(self, number: int) -> tuple[str, ...]:
        """Name of a node by the body that it is on."""
        of_element = bodies_of(self._deck)
        for element, (_, nodes) in self._deck.elements.items():
            if number in nodes:
                body = of_element.get(element) or next(iter(self._mesh.bodies))
                name = f"{body}.node{number}"
                self.nodes[name] = self._deck.nodes[number]
                return (name,)
        return ()

    def _facets(self, name: str) -> str:
        """The facet group of a set or surface.

        Raises:
            InputError: There is none, or it is on several bodies.
        """
        groups = [group for group in self._named(name) if group in self._mesh.facets]
        if len(groups) != 1:
            found = " and ".join(groups) or "no facets"
            raise InputError(f"{name.lower()} has {found}, one facet group is needed")
        return groups[0]

    def _cload(self, row: list[str]) -> tuple[str, str, Any]:
        entry, direction, value = row[0], int(row[1]), real(row[2])
        if direction > 3:
            raise InputError(f"a moment on {entry.lower()}; faces on a reference point take them")
        if entry.isdigit():
            raise InputError(f"a force on node {entry} alone; a group of facets takes one")
        total = value * len(np.unique(self._deck.nodes_of(entry)))
        return "force", self._facets(entry), {"xyz"[direction - 1]: total}

    def _dload(self, row: list[str]) -> tuple[str, str, Any]:
        entry, label, *numbers = row
        if label.upper() == "GRAV":
            size, *direction = (real(v) for v in numbers[:4])
            along = [float(v) for v in np.multiply(size, direction)]
            return self._gravity(dict(zip("xyz", along, strict=False)))
        if not pressed_face(label) or entry.isdigit():
            raise InputError(f"{label} on {entry.lower()}; P1, P2 ... on a set of elements is read")
        return "pressure", self._facets(pressed_name(entry, label)), real(numbers[0])

    def _gravity(self, along: dict[str, float]) -> tuple[str, str, Any]:
        (name, value), *others = [(k, v) for k, v in along.items() if v] or [("z", 0.0)]
        here = self._steps[-1].keys.setdefault("gravity", {})
        here |= dict(others)
        return "gravity", name, value

    def _dsload(self, row: list[str]) -> tuple[str, str, Any]:
        name, label, value, *_ = row
        if label.upper() != "P":
            raise InputError(f"{label} on {name.lower()}; P is read, see traction")
        return "pressure", self._facets(name), real(value)

    def _renew(self) -> None:
        """Release and take away what a step with OP=NEW does not name."""
        before: dict[str, _Given] = {}
        for step in self._steps:
            for key in step.new & set(before):
                here = step.keys.setdefault(key, {})
                for group, given in before.pop(key).items():
                    here[group] = _gone(key, given, here.get(group, {}))
            for key, groups in step.keys.items():
                for group, given in groups.items():
                    known = before.setdefault(key, {}).get(group, {})
                    now = given if isinstance(given, dict) and "amplitude" not in given else None
                    before[key][group] = given if now is None else {**known, **now}


def _gone(key: str, before: Any, now: Any) -> Any:
    """What a group is given now where it is not to keep what it had."""
    if not isinstance(before, dict) or "amplitude" in before:
        return 0.0 if now == {} else now
    gone = "free" if key in ("displacement", "cylindrical") else 0.0
    still = {"axis", "point"}
    return {name: v if name in still else gone for name, v in before.items()} | now


_LOADS: dict[str, Callable[[Steps, list[str]], tuple[str, str, Any]]] = {
    "CLOAD": Steps._cload,
    "DLOAD": Steps._dload,
    "DSLOAD": Steps._dsload,
}
#: Keys of a step that a keyword with OP=NEW begins anew.
_RENEWED = {
    "BOUNDARY": {"displacement", "cylindrical"},
    "CLOAD": {"force"},
    "DLOAD": {"pressure", "gravity"},
    "DSLOAD": {"pressure"},
}
