"""Forces of a deck on its nodes that mean something else here, or nothing.

Faces of 20-node hexahedra have eight nodes there and nine here. An even pressure is a force of
-1/12 of the sum on each corner and 1/3 on each middle node of an edge of eight, of 1/36 and 1/9 of
nine, where the middle of the face has 4/9 [Zienkiewicz Taylor Zhu 2013, section 6.7]. The shares of
eight nodes on a face of nine dent it: they are summed, and the sum is spread over the face.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.mesh.deck_contents import KNOWN, Deck
from anisocontact.mesh.tetrahedra import EDGES, FACES

#: Share of the largest force by which those of an even traction may differ: numbers are printed.
EVEN = 1e-3
#: Cells whose faces have eight nodes.
_OF_TWENTY = ("hexahedron", 20)
#: Their faces as rows of the nodes of the cell: corners in order, then the middle nodes of edges.
_SIDES = tuple(
    (
        *side,
        *(
            8 + next(k for k, edge in enumerate(EDGES["hexahedron"]) if set(edge) == {a, b})
            for a, b in zip(side, (*side[1:], side[0]), strict=True)
        ),
    )
    for side in FACES["hexahedron"]
)
#: Places and weights of Gauss on (-1, 1), exact for what a flat face needs.
_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
_MIDDLES = np.array([(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)])


@dataclass(frozen=True)
class StepForces:
    """What a step of a deck gives groups of nodes.

    Attributes:
        name: Its name.
        forces: Group -> component -> force, or its end and its amplitude.
        supports: Group -> component -> displacement.
        released: Whether supports of earlier steps are not there any more.
        renewed: Whether their forces are not.
    """

    name: str
    forces: dict[str, Any]
    supports: Mapping[str, Mapping[str, object]]
    released: bool
    renewed: bool


@dataclass(frozen=True)
class NodalForces:
    """Forces on sets and single nodes of a deck.

    Attributes:
        deck: The deck.
        members: Group "body.name" -> numbers of its nodes, of all groups of forces and supports.
        facets: Groups that are facets.
        named: Name of a set -> groups "body.name".
    """

    deck: Deck
    members: Mapping[str, set[int]]
    facets: frozenset[str]
    named: Callable[[str], list[str]]

    def tidy(self, steps: list[StepForces]) -> Iterator[str]:
        """Take out of steps what supports take up, and spread the rest over faces.

        Args:
            steps: The steps, whose forces are changed.

        Yields:
            Lines on what is left out.
        """
        supports: dict[str, dict[str, object]] = {}
        for step in steps:
            if step.released:
                supports.clear()
            for group, given in step.supports.items():
                supports[group] = {**supports.get(group, {}), **given}
            yield from self._taken_up(step, supports)
        yield from self._beside_earlier(steps)
        sides = self._sides({n for s in steps for group in s.forces for n in self.members[group]})
        for component in "xyz" if sides else "":
            yield from self._on_faces(component, steps, sides)
        for step in steps:
            for group in [group for group, given in step.forces.items() if not given]:
                del step.forces[group]

    def _taken_up(
        self, step: StepForces, supports: Mapping[str, Mapping[str, object]]
    ) -> Iterator[str]:
        """Take out forces all of whose nodes are led in their direction."""
        led: dict[str, set[int]] = defaultdict(set)
        for group, given in supports.items():
            for component in given:
                led[component] |= self.members[group]
        for group, given in step.forces.items():
            idle = [c for c, v in given.items() if v != 0.0 and self.members[group] <= led[c]]
            if idle:
                step.forces[group] = {c: v for c, v in given.items() if c not in idle}
                yield (
                    f"force of {step.name} on {group} along {' and '.join(idle)}: supports lead "
                    "all of its nodes there"
                )

    def _beside_earlier(self, steps: list[StepForces]) -> Iterator[str]:
        """Lines on nodes whose forces of an earlier step, by another group, decks replace."""
        earlier: set[tuple[str, str]] = set()
        for step in steps:
            if step.renewed:
                earlier.clear()
            here = {(group, c) for group, given in step.forces.items() for c in given}
            for (new, c), (old, before) in product(sorted(here - earlier), sorted(earlier)):
                if c == before and not self.members[new].isdisjoint(self.members[old]):
                    yield (
                        f"that the force of {step.name} on {new} along {c} replaces what nodes had "
                        f"by {old} in an earlier step: both are there now"
                    )
            earlier |= here

    def _on_faces(
        self, component: str, steps: list[StepForces], sides: list[tuple[int, ...]]
    ) -> Iterator[str]:
        """Put forces along one direction on faces of eight nodes, where they are even on them."""
        given = [(s, v) for s in steps if (v := self._by_nodes(s, component, sides))]
        loaded = {node for _, values in given for group in values for node in self.members[group]}
        covered = [side for side in sides if loaded.issuperset(side)]
        if not covered:
            return
        alike = len({frozenset(values) for _, values in given}) == 1
        found = [self._even(values, covered) if alike else None for _, values in given]
        if None in found:
            yield (
                f"shares of forces along {component} on faces of eight nodes ({len(covered)} "
                "loaded): they are no even traction, and faces have nine nodes here; the forces "
                "are written by their groups, better give a pressure, a traction or the force of "
                "the face"
            )
            return
        for (step, values), face in zip(given, found, strict=True):
            for group in values:
                del step.forces[group][component]
            if face is not None:
                step.forces.setdefault(face[0], {})[component] = face[1]

    def _by_nodes(
        self, step: StepForces, component: str, sides: list[tuple[int, ...]]
    ) -> dict[str, Any]:
        """What a step gives groups along a direction that are no whole faces of eight nodes."""
        return {
            group: given[component]
            for group, given in step.forces.items()
            if component in given
            and not (group in self.facets and any(self.members[group].issuperset(s) for s in sides))
        }

    def _sides(self, loaded: set[int]) -> list[tuple[int, ...]]:
        """Faces of eight nodes whose nodes are among some."""
        if len(loaded) < len(_SIDES[0]):
            return []
        cells = [nodes for kind, nodes in self.deck.elements.values() if KNOWN[kind] == _OF_TWENTY]
        sides = (tuple(nodes[k] for k in side) for nodes in cells for side in _SIDES)
        return [side for side in sides if loaded.issuperset(side)]

    def _even(
        self, values: Mapping[str, Any], covered: list[tuple[int, ...]]
    ) -> tuple[str, Any] | None:
        """The facet group over which forces are spread evenly, and their sum; None otherwise."""
        amplitudes = {v["amplitude"] if isinstance(v, dict) else "" for v in values.values()}
        force: dict[int, float] = defaultdict(float)
        for group, value in values.items():
            number = float(value["value"] if isinstance(value, dict) else value)
            for node in self.members[group]:
                force[node] += number / len(self.members[group])
        face = self._group_of(set(force))
        if face is None or len(amplitudes) > 1:
            return None
        shares: dict[int, float] = defaultdict(float)
        for side in covered:
            places = np.array([self.deck.nodes[node] for node in side])
            for node, share in zip(side, _shares(places).tolist(), strict=True):
                shares[node] += share
        given = np.array([force[node] for node in force])
        total = float(given.sum())
        even = np.array([shares[node] for node in force]) * total / sum(shares.values())
        if np.abs(given - even).max() > EVEN * np.abs(given).max():
            return None
        (amplitude,) = amplitudes
        return face, {"amplitude": amplitude, "value": total} if amplitude else total

    def _group_of(self, nodes: set[int]) -> str | None:
        """The facet group of the node set that holds just these nodes."""
        for name, members in self.deck.node_sets.items():
            found = [group for group in self.named(name) if group in self.facets]
            if len(found) == 1 and set(members) == nodes:
                return found[0]
        return None


def _shares(places: Floats) -> Floats:
    """Integrals of the shape functions over a face of eight nodes, corners first, (8,)."""
    found = np.zeros(8)
    for x, a in zip(_PLACES, _WEIGHTS, strict=True):
        for y, b in zip(_PLACES, _WEIGHTS, strict=True):
            values, slopes = _shape(np.array([x, y]))
            found += a * b * float(np.linalg.norm(np.cross(*(slopes.T @ places)))) * values
    return found


def _shape(at: Floats) -> tuple[Floats, Floats]:
    """Serendipity functions of eight nodes, (8,), and their derivatives, (8, 2)."""
    factors = 1.0 + _CORNERS * at
    rest = (_CORNERS * at).sum(axis=1) - 1.0
    corners = 0.25 * factors.prod(axis=1) * rest
    of_corners = (
        0.25 * _CORNERS * (factors[:, ::-1] * rest[:, None] + factors.prod(axis=1)[:, None])
    )
    across = _MIDDLES[:, 0] == 0.0  # along the first coordinate such a function is a bubble
    bubble = 1.0 - np.where(across, at[0], at[1]) ** 2
    line = 1.0 + np.where(across, _MIDDLES[:, 1] * at[1], _MIDDLES[:, 0] * at[0])
    of_bubble = -np.where(across, at[0], at[1]) * line
    of_line = 0.5 * bubble * np.where(across, _MIDDLES[:, 1], _MIDDLES[:, 0])
    of_middles = np.where(
        across[:, None],
        np.column_stack([of_bubble, of_line]),
        np.column_stack([of_line, of_bubble]),
    )
    return np.concatenate([corners, 0.5 * bubble * line]), np.vstack([of_corners, of_middles])
