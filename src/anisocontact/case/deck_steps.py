"""Static steps of a deck as tables of a case file: supports, loads, times."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.case.deck_forces import NodalForces, StepForces
from anisocontact.case.deck_materials import Temperatures
from anisocontact.case.deck_procedures import STATIC
from anisocontact.case.deck_weights import Weights
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.deck import Card, real
from anisocontact.mesh.deck_contents import Deck, pressed_face, pressures
from anisocontact.mesh.deck_supports import (
    DeckSupport,
    Unread,
    check_options,
    supports_of,
    with_amplitude,
)
from anisocontact.mesh.inp import bodies_of

#: Most increments that are taken over of a step.
MOST = 1000

#: Group, or component of gravity -> what it is given, a number or components.
type _Given = dict[str, Any]
#: Key of a step, group or component, what it is given; or why an entry is not taken over.
type _Load = tuple[str, str, Any] | InputError


@dataclass
class _Step:
    """A step of a deck.

    Attributes:
        name: Its name.
        duration: Its time.
        increments: Number of increments.
        keys: Key of a step of a case file -> group -> what is given.
        new: Keywords of which it takes back what earlier steps had.
    """

    name: str
    duration: float = 1.0
    increments: int = 1
    keys: dict[str, _Given] = field(default_factory=dict)
    new: set[str] = field(default_factory=set)


class Steps:
    """The steps of a deck.

    Args:
        deck: The deck.
        mesh: Its mesh.
        named: Name of a set or surface -> groups "body.name".
        temperatures: Makes what knows the temperatures of bodies; asked once, with the first.

    Attributes:
        finite: Whether a step asks for finite strain.
        nodes: Name of a node that is held by its number -> its place.
        constant: Amplitude that is a number -> the number.
    """

    def __init__(
        self,
        deck: Deck,
        mesh: MeshArrays,
        named: Callable[[str], list[str]],
        temperatures: Callable[[], Temperatures],
    ) -> None:
        self._deck, self._mesh, self._named = deck, mesh, named
        self._temperatures = cache(temperatures)
        self._steps: list[_Step] = []
        self._weights = Weights(deck, list(mesh.bodies))
        self._turned: set[int] = set()
        #: Group of a force or a support -> numbers of its nodes.
        self._members: dict[str, set[int]] = {}
        self.finite = False
        self.nodes: dict[str, list[float]] = {}
        self.constant: dict[str, float] = {}

    def take(self, step: int, card: Card) -> bool:
        """Take a card over; whether it is one of a step.

        Raises:
            InputError: It cannot be taken over.
        """
        if card.name == "TRANSFORM":
            self._turned.update(self._deck.nodes_of(card.option("NSET")))
        if card.name == "STEP":
            title = card.options.get("NAME") or (card.data[0] if card.data else "")
            names = [one.name for one in self._steps]
            name = title.replace('"', "'").lower()
            self._steps.append(_Step(name if name and name not in names else f"step {step}"))
            self.finite = self.finite or card.options.get("NLGEOM", "NO").upper() in ("", "YES")
            return True
        if card.name in STATIC and step:
            times = [real(v or "0") for v in next(card.rows(), [])]
            # what is left out or zero is the default: a step of 1, in one increment
            whole = (times[1] if len(times) > 1 else 0.0) or 1.0
            first = (times[0] if times else 0.0) or whole
            here = self._steps[-1]
            here.duration = whole
            here.increments = max(1, min(MOST, math.ceil(whole / first - 1e-9)))
            return True
        if step and card.options.get("OP", "MOD").upper() == "NEW":
            self._steps[-1].new |= _RENEWED.get(card.name, set())
        if card.name not in _LOADS or not step:
            return False
        if card.name != "TEMPERATURE":  # which has options of its own
            check_options(card)
        amplitude = card.options.get("AMPLITUDE", "").lower()
        problems: dict[str, None] = {}
        for load in _LOADS[card.name](self, card):
            try:
                if isinstance(load, InputError):
                    raise load
                self._add(*load, amplitude)
            except InputError as error:
                problems[str(error)] = None
        if problems:
            raise InputError("; ".join(problems))
        return True

    def _add(self, key: str, group: str, given: Any, amplitude: str) -> None:
        """Give a group of the last step something, beside what that has given it before."""
        groups = self._steps[-1].keys.setdefault(key, {})
        single = not isinstance(given, dict)
        components = {"": given} if single else given
        now = {name: self.with_amplitude(value, amplitude) for name, value in components.items()}
        known = groups.get(group, {})
        before = {"": known} if single and group in groups else known
        if key in _SUMMED:
            now = _added(before, now, f"{_SUMMED[key]} {group}")
        groups[group] = now[""] if single else {**before, **now}

    def finish(self) -> list[str]:
        """Take the supports over; lines on what is not."""
        left = []
        deck = self._deck
        for one in supports_of(deck.cards, deck.nodes_of, lambda n: self._named(deck.name_of(n))):
            if isinstance(one, Unread):
                left.append(f"step {one.step}: {one.text}")
            elif self._steps:
                left += self._support(one)
        left += self._tidy_forces()
        left += self._pressed_again()
        left += [
            f"gravity of step {self._steps[step - 1].name!r} {text}"
            for step, text in self._weights.partly()
        ]
        self._renew()
        return left

    def _tidy_forces(self) -> list[str]:
        """Bring forces on nodes to what they mean here; lines on what is left out."""
        nodal = NodalForces(self._deck, self._members, frozenset(self._mesh.facets), self._named)
        given = [
            StepForces(
                f"step {step.name!r}",
                step.keys.setdefault("force", {}),
                step.keys.get("displacement", {}),
                "displacement" in step.new,
                "force" in step.new,
            )
            for step in self._steps
        ]
        left = list(nodal.tidy(given))
        for step in self._steps:
            if not step.keys["force"]:
                del step.keys["force"]
        return left

    def _pressed_again(self) -> Iterator[str]:
        """Lines on faces whose pressure of an earlier step, by another group, decks replace."""
        earlier: dict[str, set[tuple[int, ...]]] = {}
        for step in self._steps:
            if "pressure" in step.new:
                earlier.clear()
            here = {
                group: set(map(tuple, np.sort(self._mesh.facets[group], axis=1).tolist()))
                for group in step.keys.get("pressure", {})
            }
            for (new, faces), (old, before) in product(here.items(), earlier.items()):
                if new not in earlier and not faces.isdisjoint(before):
                    yield (
                        f"that the pressure of step {step.name!r} on {new} replaces what faces had "
                        f"by {old} in an earlier step: both are there now"
                    )
            earlier |= here

    def tables(self) -> Iterator[dict[str, object]]:
        """Tables of the steps."""
        for step in self._steps:
            table: dict[str, object] = {"name": step.name, "increments": step.increments}
            if step.duration != 1.0:
                table["duration"] = step.duration
            yield table | step.keys

    def _support(self, one: DeckSupport) -> Iterator[str]:
        keys = self._steps[max(one.step - 1, 0)].keys.setdefault(one.kind, {})
        groups = one.groups or self._node(int(one.entry))
        if not groups:
            yield f"support of node {one.entry}: it is on no body"
        for group in groups:
            self._members[group] = set(self._deck.nodes_of(one.entry))
            given = {
                name: self.with_amplitude(value, one.amplitude) for name, value in one.given.items()
            }
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

    def with_amplitude(self, value: object, amplitude: str) -> object:
        """A value that follows an amplitude, if there is one.

        Args:
            value: The value.
            amplitude: Name of the amplitude in small letters; empty for none.
        """
        if amplitude in self.constant and isinstance(value, float):
            return self.constant[amplitude] * value
        return with_amplitude(value, amplitude)

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

    def _loaded(self, entry: str) -> str:
        """Where a force on each node of a set, or on one by its number, is put.

        Raises:
            InputError: It is on no body, or on several.
        """
        groups = self._node(int(entry)) if entry.isdigit() else tuple(self._named(entry))
        if len(groups) != 1:
            where = f"on {' and '.join(groups)}" if groups else "on no body"
            raise InputError(f"{entry.lower()} is {where}, a force is on one")
        return groups[0]

    def cloads(self, card: Card) -> Iterator[_Load]:
        """Forces of `*CLOAD` on a node, or summed over a set, which spreads them over itself."""
        yield from _each(card, self._cload)

    def _cload(self, entry: str, direction: str, value: str = "0", *_: str) -> Iterator[_Load]:
        if int(direction) > 3:
            text = f"a moment on {entry.lower()}; faces on a reference point take them"
            raise InputError(text)
        nodes = np.unique(self._deck.nodes_of(entry))
        if not self._turned.isdisjoint(nodes.tolist()):
            raise InputError(f"{entry.lower()} has a *TRANSFORM; forces along x, y, z are read")
        total, group = real(value) * len(nodes), self._loaded(entry)
        self._members[group] = set(nodes.tolist())
        yield "force", group, {"xyz"[int(direction) - 1]: total}

    def temperatures(self, card: Card) -> Iterator[_Load]:
        """Temperatures of bodies of `*TEMPERATURE`."""
        for found in self._temperatures().prescribed(card):
            yield found if isinstance(found, InputError) else ("temperature", *found)

    def dloads(self, card: Card) -> Iterator[_Load]:
        """Pressures and gravity of `*DLOAD`."""
        for name, (values, _) in pressures(card).items():
            try:
                yield from [("pressure", self._facets(name), real(value)) for value in values]
            except InputError as error:
                yield error
        yield from _each(card, self._dload)

    def _dload(self, entry: str, label: str, *numbers: str) -> Iterator[_Load]:
        if label.upper() == "GRAV":
            size, *direction = (real(v or "0") for v in (*numbers, "0", "0", "0")[:4])
            vector = np.array(direction) / (np.linalg.norm(direction) or 1.0)
            yield from self._weights.add(len(self._steps), entry, size * vector)
        elif not pressed_face(label):
            raise InputError(f"{label} on {entry.lower()}; P1, P2 ... and GRAV are read")

    def dsloads(self, card: Card) -> Iterator[_Load]:
        """Pressures and tractions of `*DSLOAD`."""
        yield from _each(card, self._dsload)

    def _dsload(self, name: str, label: str, value: str = "0", *along: str) -> Iterator[_Load]:
        if label.upper() == "P":
            yield "pressure", self._facets(name), real(value)
        elif label.upper() == "TRVEC" and len(along) >= 3 and not self.finite:
            direction = np.array([real(v or "0") for v in along[:3]])
            traction = real(value) * direction / np.linalg.norm(direction)
            yield "traction", self._facets(name), dict(zip("xyz", traction.tolist(), strict=True))
        else:
            turns = " turns with the surface under NLGEOM" if label.upper() == "TRVEC" else ""
            raise InputError(f"{label} on {name.lower()}{turns}; P is read, see traction")

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


def _each(card: Card, read: Callable[..., Iterator[_Load]]) -> Iterator[_Load]:
    """What the entries of a card give, one by one: one that is not read leaves the others."""
    for entries in card.rows():
        try:
            yield from read(*entries)
        except InputError as error:
            yield error
        except (ValueError, IndexError, TypeError):
            yield InputError(f"{', '.join(entries)}: data of another kind")


def _added(before: _Given, now: _Given, what: str) -> _Given:
    """Loads with those that the same step gives a group before: CalculiX adds them.

    Raises:
        InputError: They follow different amplitudes.
    """
    total = dict(now)
    for name in before.keys() & now.keys():
        (one, first), (other, second) = (_ramp(given[name]) for given in (before, now))
        if first != second:
            along = f" along {name}" * bool(name)
            raise InputError(f"two {what}{along} in one step, with different amplitudes")
        total[name] = with_amplitude(one + other, first)
    return total


def _ramp(force: Any) -> tuple[float, str]:
    """The end of a force, and its amplitude; empty for none."""
    if isinstance(force, dict):
        return float(force["value"]), str(force["amplitude"])
    return float(force), ""


def _gone(key: str, before: Any, now: Any) -> Any:
    """What a group is given now where it is not to keep what it had."""
    if not isinstance(before, dict) or "amplitude" in before:
        return 0.0 if now == {} else now
    gone = "free" if key in ("displacement", "cylindrical") else 0.0
    still = {"axis", "point"}
    return {name: v if name in still else gone for name, v in before.items()} | now


_LOADS: dict[str, Callable[[Steps, Card], Iterator[_Load]]] = {
    "CLOAD": Steps.cloads,
    "DLOAD": Steps.dloads,
    "DSLOAD": Steps.dsloads,
    "TEMPERATURE": Steps.temperatures,
}
#: Keys of a step whose values add up where it gives them twice, as they are told.
_SUMMED = {
    "force": "forces on",
    "pressure": "pressures on",
    "traction": "tractions on",
    "gravity": "accelerations along",
}
#: Keys of a step that a keyword with OP=NEW begins anew.
_RENEWED = {
    "BOUNDARY": {"displacement", "cylindrical"},
    "CLOAD": {"force"},
    "DLOAD": {"pressure", "gravity"},
    "DSLOAD": {"pressure", "traction"},
}
