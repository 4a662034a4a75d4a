"""Gravity of a deck, which sets of elements have there, and all bodies here."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.mesh.deck_contents import Deck
from anisocontact.mesh.inp import bodies_of


class Weights:
    """What the steps of a deck say of gravity.

    Args:
        deck: The deck.
        bodies: Names of its bodies.
    """

    def __init__(self, deck: Deck, bodies: list[str]) -> None:
        self._deck, self._bodies = deck, bodies
        #: Step -> body -> acceleration.
        self._given: dict[int, dict[str, Floats]] = {}

    def add(self, step: int, entry: str, acceleration: Floats) -> Iterator[tuple[str, str, float]]:
        """Take a `GRAV` of a step; what it gives twice to a body adds up.

        Args:
            step: Number of the step.
            entry: Set of elements; empty for all.
            acceleration: Acceleration.

        Yields:
            "gravity", component, by how much that of all bodies which have one in the step grows.

        Raises:
            InputError: Bodies differ.
        """
        given = self._given.setdefault(step, {})
        before = next(iter(given.values()), np.zeros(3))
        more = {body: given.get(body, 0.0) + acceleration for body in self._whole(entry)}
        now, *others = (given | more).values()
        if any(np.any(other != now) for other in others):
            raise InputError(f"GRAV on {entry.lower()} is not that of other bodies, one is for all")
        given |= more
        for i in np.flatnonzero((before != 0.0) | (now != 0.0)):
            yield "gravity", "xyz"[i], float(now[i] - before[i])

    def partly(self) -> Iterator[tuple[int, str]]:
        """Number of each step whose gravity is not on all bodies, and what to say of it."""
        for step, given in self._given.items():
            others = [body for body in self._bodies if body not in given]
            if others:
                text = f"is on {', '.join(given)} alone: it acts on all bodies here, "
                yield step, f"{text}density = 0 takes it off {', '.join(others)}"

    def _whole(self, entry: str) -> list[str]:
        """Bodies whose elements a set holds.

        Raises:
            InputError: It holds a part of one, or none.
        """
        of_element = bodies_of(self._deck)
        members = set(self._deck.members_of(entry)) if entry else set(self._deck.elements)
        found = {of_element[number] for number in members if number in of_element}
        cut = [b for n, b in of_element.items() if b in found and n not in members]
        if not found or cut:
            where = f"a part of {cut[0]}" if cut else "no body"
            raise InputError(f"GRAV on {entry.lower()}, which is {where}: it is on whole bodies")
        return [body for body in self._bodies if body in found]
