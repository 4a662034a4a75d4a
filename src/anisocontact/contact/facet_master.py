"""Facets of a mesh as a master: large sliding, both sides deforming."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, override

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Codes, Flags, Floats, Ints, Locals
from anisocontact.contact.beyond_border import BeyondBorder
from anisocontact.contact.facet_answer import ByPoints, FacetAnswer, FacetEvaluation
from anisocontact.contact.held_points import HeldPoints, on_held_facets, projected_facets
from anisocontact.contact.history import Snapshot
from anisocontact.contact.meshed_master import MeshedMaster
from anisocontact.contact.point_tangent import Nodes, PointTangent
from anisocontact.contact.reachable import NodePairs, reachable, slid
from anisocontact.contact.sides import Sides, initial_state, located
from anisocontact.interface import ContactLaw, State
from anisocontact.interface.failed_point import OnFacets, one_point
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces.facets import FacetProjections


class FacetMaster(MeshedMaster):
    """The closest facets below the slave points of one pass, where both are now, see `Master`.

    Args:
        sides: Slave points and facets.
        law: Laws of the interface.
        group: Facet group of the master.
        size: Length of its facets.
    """

    def __init__(self, sides: Sides, law: ContactLaw, *, group: str, size: float) -> None:
        super().__init__(sides, law, group=group, size=size)
        self._held = HeldPoints(len(sides.points.facet))
        self._beyond = BeyondBorder.of(sides, self._nodes.now, self._hint)

    @override
    def initial_state(self) -> State:
        return initial_state(self._hint, self._dtype)

    @override
    def place(self, u: Floats, *histories: State) -> bool:
        u = self._gathered.moved(u)
        anew = self._gather(u, histories)
        moved = np.array(self._gathered.everywhere(u))
        self._nodes = Nodes(self.sides.reference + moved, moved)
        self._hint = self._project(self._hint)
        return anew

    def _gather(self, u: Floats, histories: tuple[State, ...]) -> bool:
        """Have all facets of the master that the points can reach; whether there are others."""
        anew = self._may_leave_gathered(u)
        if anew:
            # some of them can be one and the same
            states = {id(state): state for state in histories}.values()
            hints = {id(h): h for h in (self._hint, self._accepted[1], *self._held.hints)}.values()
            named = [*(state["facet"] for state in states), *(hint.facet for hint in hints)]
            named.append(self._beyond.facet)
            for facets in named:
                facets[:] = self._gathered.globally(facets)
            self._number_anew(u, named)
        return anew

    def _number_anew(self, u: Floats, named: Sequence[Locals]) -> None:
        """Have the facets that are near and those that are named; collective.

        Args:
            u: Displacements of the local nodes, (nodes, 3), length.
            named: Arrays of facets of the whole group, -1 for none; those of this process are
                written.
        """
        self._have(u, *named)
        for facets in named:
            facets[:] = self._gathered.renumbered(facets)

    def _project(self, before: FacetProjections) -> FacetProjections:
        held = self._held.points
        hit = self._closest(before)
        if held.any():
            hit = on_held_facets(self.sides, self._nodes.now, hit, before.facet, held)
        return hit

    def _closest(self, before: FacetProjections) -> FacetProjections:
        """Closest points, on the facets of the accepted state where several share them.

        The couple of friction acts on the facet that is named, and what is remembered goes on from
        its tangents: named by the way of the iterations it would bring two of them to two answers.
        """
        return self.sides.project(self._nodes.now, before, self._accepted[1].facet)

    @override
    def answer(
        self,
        state: State,
        dt: float,
        *,
        tangent: bool = True,
        derivative: bool = False,
        separate: bool = False,
    ) -> FacetAnswer[Any]:
        asked = FacetEvaluation(self.sides, self._hint, self._nodes.now, separate)
        return asked.answer(self._derivative if derivative else self._law, state, dt, tangent)

    @override
    def failed_point(self, i: int, state: State, dt: float, **of_point: Any) -> OnFacets:
        asked = FacetEvaluation(self.sides, self._hint, self._nodes.now, True)
        batch, own = one_point(asked.batch(state), i, state)
        return OnFacets(
            **of_point,
            position=self.sides.points.positions(self._nodes.now)[i],
            dt=dt,
            state=own,
            law=self._given,
            batch=batch,
        )

    @override
    def linear(self, answer: FacetAnswer[ByPoints]) -> PointTangent:
        return PointTangent(self.sides.points, lambda: self._nodes, answer)

    @override
    def here(self, state: State, dt: float) -> State:
        there = state.copy()
        there["facet"] = np.where(located(self._hint), self._hint.facet, -1)
        there["xi"] = np.nan_to_num(self._hint.xi)
        return there

    @override
    def at(self, state: State) -> tuple[Floats, Floats]:
        return self.sides.place(state)

    @override
    def feet(self) -> Locals:
        return np.unique(self.named_facets[self._hint.facet[located(self._hint)]])

    @override
    def below(self, state: State) -> Locals:
        return np.unique(self.named_facets[state["facet"][self.located(state)]])

    @override
    def probe(self, laws: tuple[NormalLaw, Adhesion, Friction], state: State) -> Codes:
        asked = FacetEvaluation(self.sides, self._hint, self._nodes.now, False)
        law = ContactLaw(*laws).on_facets()
        return asked.answer(law, state, 1.0, False).snapshot.response.failure

    @override
    def reachable(self, way: Floats, margin: float, hops: int) -> list[NodePairs]:
        return reachable(self.sides, self._nodes.now, way, margin, hops)

    @override
    def slid(self, state: State) -> Floats:
        return slid(self.sides, state, self._hint)

    @override
    def projected_facets(self, count: int) -> Ints:
        return projected_facets(self._hint, self._gathered.globally(self._hint.facet))

    @override
    def hold(self, points: Flags) -> None:
        self._held.points |= points

    @override
    def strayed(self, count: int) -> Floats:
        held = self._held.points
        wrong = np.zeros(len(held))
        if held.any():
            closest = self._closest(self._hint)
            both = held & located(closest) & located(self._hint)
            wrong[both] = np.abs(closest.gap - self._hint.gap)[both]
        return wrong

    @override
    def let_go(self) -> bool:
        any_let_go = self._held.points.any() and self._held.let_go(
            self._hint, self._closest(self._hint)
        )
        return self._anywhere(bool(any_let_go))

    @override
    def hold_again(self) -> bool:
        before = self._held.again()
        if before is not None:
            self._hint = before
        return self._anywhere(before is not None)

    def _anywhere(self, here: bool) -> bool:
        return bool(self._comm.allreduce(int(here)))

    @override
    def begin(self, state: State) -> State:
        self._held = HeldPoints(len(state))
        return self._beyond.begin(state)

    @override
    def commit(self, before: Snapshot, state: State, now: Snapshot | None) -> Floats:
        left = np.zeros((0, 3))
        if now is not None:
            left = np.concatenate(self._comm.allgather(self.sides.lost(state, now)))
        self._accept()
        return left

    def _accept(self) -> None:
        """Let trials start from where the points are."""
        self._accepted = (self._gathered.local(self._nodes.now), self._hint)
        self._beyond = BeyondBorder.of(self.sides, self._nodes.now, self._hint)

    @override
    def roll_back(self, tried: bool) -> None:
        if tried:
            self._return()

    @override
    def persistent(self, kept: dict[str, npt.NDArray[Any]]) -> dict[str, npt.NDArray[Any]]:
        kept["state"]["facet"] = self._gathered.globally(kept["state"]["facet"])
        return (
            kept
            | self._kept_hint()
            | {"reference": self.sides.points.positions(self.sides.reference)}
        )

    @override
    def restore(
        self, kept: Mapping[str, npt.NDArray[Any]], u: Floats
    ) -> Mapping[str, npt.NDArray[Any]]:
        kept = {name: values.copy() for name, values in kept.items()}
        self._hint = self._hint_of(kept)
        u = self._gathered.moved(u)
        self._number_anew(u, (kept["state"]["facet"], self._hint.facet))
        self._go_to(self.sides.reference + self._gathered.everywhere(u))
        self._accept()
        return kept
