"""Facets of a mesh as a master that slave nodes meet through dual mortar weights."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, override

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Codes, Flags, Floats, Locals
from anisocontact.contact.along_normals import OPPOSED
from anisocontact.contact.beyond_border import accepted_opposite, beyond, refer_to_accepted
from anisocontact.contact.contact_planes import (
    ContactPlanes,
    Opposite,
    across,
    averaged_normal,
    held_directions,
)
from anisocontact.contact.crack_front import CrackFront
from anisocontact.contact.facet_answer import found_on_all
from anisocontact.contact.facet_mesh import outward_normals
from anisocontact.contact.facet_pairs import facing_pairs, largest_radius
from anisocontact.contact.history import Snapshot
from anisocontact.contact.master import Resting
from anisocontact.contact.meshed_master import MeshedMaster
from anisocontact.contact.mortar_answer import MortarAnswer, MortarLinear, MortarState
from anisocontact.contact.mortar_reach import mortar_reachable
from anisocontact.contact.mortar_weights import MortarWeights, mortar_weights
from anisocontact.contact.opposite_names import names_of, numbers_of
from anisocontact.contact.plane_batch import plane_batch
from anisocontact.contact.prescribed_nodes import PrescribedNodes
from anisocontact.contact.reachable import NodePairs
from anisocontact.contact.self_contact import SelfContactSides
from anisocontact.contact.side_of_master import SideOfMaster
from anisocontact.contact.sides import Sides
from anisocontact.contact.slave_nodes import SlaveNodes
from anisocontact.contact.tangent_places import met_along
from anisocontact.interface import ContactLaw, State
from anisocontact.interface.contact_law import FacetBatch, FacetLaw
from anisocontact.interface.failed_point import OnFacets, one_point
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces.facets import FACET_STATUS

#: Gap up to which a node may be in contact, as a share of the size of the facets: rounding.
NEAR = 1e-6
#: Share of its weight that has to be covered for a node to carry traction.
COVERED = 1e-8
#: Of `Opposite` what a checkpoint has.
OPPOSITE = tuple(f.name for f in fields(Opposite) if f.name != "nodes")


class MortarMaster(MeshedMaster):
    """Facets of the master below slave nodes, where both are now, see `Master`.

    Laws are evaluated in contact planes at the slave nodes, `ContactPlanes`; forces act with the
    mortar weights.

    Args:
        sides: Slave nodes and facets.
        points: The slave nodes.
        law: Laws of the interface.
        group: Facet group of the master.
        size: Length of its facets.
        self_contact: Whether the master is the slave.
    """

    def __init__(
        self,
        sides: Sides,
        points: SlaveNodes,
        law: ContactLaw,
        *,
        group: str,
        size: float,
        self_contact: bool = False,
    ) -> None:
        self._points = points
        self._self_contact: SelfContactSides | None = None
        normals: Floats | None = None
        if self_contact:
            normals = outward_normals(sides.searched, sides.reference)
            self._self_contact = SelfContactSides(points, sides.gathered, normals)
        width = sides.master.nodes.shape[1]
        self._then = Opposite.none(len(points.facet), width)
        # slave nodes that count slip from a trial, and what was opposite at the accepted increment
        self._replaced: tuple[Flags, Opposite] | None = None
        super().__init__(sides, law, group=group, size=size)
        self._prescribed = PrescribedNodes(self._gathered)
        self._front = CrackFront(sides, points, normals)
        self._at = self._placed()

    def _placed(self, weights: MortarWeights | None = None) -> MortarState:
        """The slave nodes, their weights and planes where the nodes are.

        Args:
            weights: As they are there, if that is known.
        """
        sides, points, now = self.sides, self._points, self._nodes.now
        x, tangents = points.positions(now), points.at(now).tangents[:, 0]
        normal = averaged_normal(tangents)
        held = held_directions(self._prescribed.resting, points.nodes[:, 0], self._below, normal)
        opposite = met_along(sides, x, across(held, normal), self._hint, self._then)
        if weights is None:
            more = np.concatenate([opposite.named(), self._then.named()], axis=1)
            # the same on all processes, so that a facet counts on any number of them
            radius = max(self._comm.allgather(largest_radius(sides.slave, now)))
            farther = self._self_contact is None  # walls behind the next one are not met
            pairs = facing_pairs(sides, sides.searched, now, radius, points.across, farther=farther)
            if self._self_contact is not None:
                pairs = self._self_contact.oriented(pairs, self.numbers)
            area = points.current_area
            weights = mortar_weights(
                sides, points.around, now, more, pairs, current_area=area, hand_over=True
            )
        opposite = replace(opposite, masters=weights.masters, shares=weights.shares)
        both = opposite, self._then
        planes = ContactPlanes.at(now, x, tangents, both, held)
        return MortarState(
            self._gathered, points.quadrature, weights, planes, both, now, sides.reference
        )

    @property
    def _below(self) -> Locals:
        """Nodes of the facets closest to the slave nodes, (n, j), -1 for none."""
        facet, nodes = self._hint.facet, self.sides.master.nodes
        if not len(nodes):
            return np.full((len(facet), 1), -1, dtype=np.int32)
        found = self._gathered.local_names(nodes[np.maximum(facet, 0)])
        return np.where(facet[:, None] >= 0, found, np.int32(-1))

    @property
    def _located(self) -> Flags:
        """Slave nodes with a master opposite, which for the front of a crack is itself."""
        at = self._at
        covered = at.weights.area > COVERED * self._points.quadrature.areas
        opposed = at.planes.now.cosine > OPPOSED
        found = np.asarray(covered & opposed & (at.opposite[0].facet >= 0))
        found[self._front.opposite_themselves(at.weights)] = False
        return found

    @override
    def initial_state(self) -> State:
        state = np.zeros(len(self._points.facet), dtype=self._dtype)
        located = self._located
        state["facet"] = np.where(located, np.arange(len(state)), -1)
        state["xi"][located] = self._at.planes.xi[located]
        state["origin"] = state["xi"]
        state["gap"][located] = self._at.planes.gap[located]
        self._accept(state)
        return state

    def _accept(self, state: State) -> None:
        """Let what is opposite now be that of the accepted increment, and a state refer to it."""
        self._then = accepted_opposite(self._at, self._hint, state)
        if self._self_contact is not None:
            self._self_contact.commit()
        refer_to_accepted(state, state["facet"] >= 0)
        self._accepted = (self._gathered.local(self._nodes.now), self._hint)
        self._at = self._placed(self._at.weights)

    @override
    def place(self, u: Floats, *histories: State) -> bool:
        anew = self._may_leave_gathered(u)
        if anew:
            hints = {id(hint): hint for hint in (self._hint, self._accepted[1])}.values()
            for hint in hints:
                hint.facet[:] = self._gathered.globally(hint.facet)
            known, before = self._replaced or (None, None)
            thens = [one for one in (self._then, before) if one is not None]
            named = [names_of(one, self._gathered) for one in thens]
            thens = self._number_anew(u, named, [hint.facet for hint in hints])
            self._then = thens[0]
            if known is not None:
                self._replaced = known, thens[1]
        self._nodes = self._displaced(u)
        self._hint = self.sides.project(self._nodes.now, self._hint)
        self._at = self._placed()
        return anew

    def _number_anew(
        self, u: Floats, thens: Sequence[Opposite], hints: Sequence[Locals]
    ) -> list[Opposite]:
        """Have the facets of the master that are near and those that are named; collective.

        Args:
            u: Displacements of the local nodes, (nodes, 3), length.
            thens: As of `names_of`.
            hints: Facets of the whole group, -1 for none; those of this process are written.

        Returns:
            What was opposite, with the numbers of this process.
        """
        gathered = self._gathered
        named = [(then.masters, then.around) for then in thens]
        owners = [gathered.facets_of_names(one) for both in named for one in both]
        self._have(u, *hints, *(then.facet for then in thens), *owners)
        for facets in hints:
            facets[:] = gathered.renumbered(facets)
        self._prescribed.spread()
        return [numbers_of(then, gathered) for then in thens]

    @override
    def answer(
        self,
        state: State,
        dt: float,
        *,
        tangent: bool = True,
        derivative: bool = False,
        separate: bool = False,
    ) -> Any:
        return self._answer(self._derivative if derivative else self._law, state, dt, tangent)

    def _answer(self, law: FacetLaw, state: State, dt: float, tangent: bool) -> MortarAnswer:
        batch = self._batch(state, tangent)
        found = found_on_all(self._comm, law, state, dt, batch, "tractions")
        failed = self._hint.status == FACET_STATUS.index("failed")
        return MortarAnswer.of(self._at, found, failed, tangent)

    def _batch(self, state: State, tangent: bool = True) -> FacetBatch:
        """Slave nodes and planes as the core takes them."""
        located = self._located
        touches = self._at.planes.gap - state["offset"] <= NEAR * self._points.size
        near = located & (touches | (state["multiplier"] > 0.0))
        return plane_batch(self._at, located, near, tangent, self.sides.threads)

    @override
    def take_resting(self, resting: Sequence[Resting], state: State) -> None:
        self._prescribed.take_resting(resting)
        self._at = self._placed(self._at.weights)
        then = self._at.planes.upright(state["xi"], self._points.size)
        if then is not None:
            state["xi"], carried = then
            self._then = replace(self._then, carried=carried)
            self._at = self._placed(self._at.weights)

    @override
    def take_fixed(self, fixed: Floats) -> None:
        super().take_fixed(fixed)
        self._prescribed.take_fixed(fixed)

    @override
    def immovable(self, normal: Floats) -> bool | Flags:
        weights = self._at.weights
        held = self._prescribed.immovable(weights.masters, weights.shares, normal)
        return self._rests or self._located & held

    @property
    @override
    def held(self) -> Floats:
        return self._at.planes.held

    @override
    def failed_point(self, i: int, state: State, dt: float, **of_point: Any) -> OnFacets:
        batch, own = one_point(self._batch(state), i, state)
        return OnFacets(
            **of_point,
            position=self._at.planes.slave[i],
            dt=dt,
            state=own,
            law=self._given,
            batch=batch,
        )

    @override
    def linear(self, answer: Any) -> Any:
        return MortarLinear(lambda: self._nodes.moved, lambda: self._at.planes, answer)

    @override
    def here(self, state: State, dt: float) -> State:
        there = state.copy()
        located = self._located
        there["facet"] = np.where(located, np.arange(len(state)), -1)
        there["xi"] = np.where(located[:, None], self._at.planes.xi, 0.0)
        return there

    @override
    def at(self, state: State) -> tuple[Floats, Floats]:
        return self._at.planes.points(state["facet"], state["xi"])

    @override
    def feet(self) -> Locals:
        named = self._gathered.coupled(self._at.weights.masters)
        return np.unique(named[named >= 0])

    @override
    def opposite(self) -> tuple[Locals, Locals, Floats]:
        named, weights = self._gathered.local_names, self._at.weights
        points = self._at.quadrature
        shares = weights.shares / points.basis[:, 0, :1]
        return named(points.nodes[:, 0]), named(weights.masters), shares

    @override
    def side_of_master(
        self, u: Floats, before: Snapshot, state: State, now: Snapshot
    ) -> SideOfMaster:
        found, hit = super().side_of_master(u, before, state, now), self._hint
        if self._self_contact is not None:
            return found
        # facets that face the same way do not overlap: a body that has turned over is not touched
        there = (hit.status == FACET_STATUS.index("on")) & (hit.gap <= 0.0) & ~found.located
        return found.with_behind(there, hit.normal, self._points.quadrature.areas)

    @override
    def below(self, state: State) -> Locals:
        named = self._gathered.coupled(self._then.named()[self.located(state)])
        return np.unique(named[named >= 0])

    @override
    def probe(self, laws: tuple[NormalLaw, Adhesion, Friction], state: State) -> Codes:
        law = ContactLaw(*laws).on_facets()
        failure = self._answer(law, state, 1.0, False).snapshot.response.failure
        return np.asarray(failure, dtype=np.int8)

    @override
    def reachable(self, way: Floats, margin: float, hops: int) -> list[NodePairs]:
        return mortar_reachable(self.sides, self._points, self._nodes.now, way, margin)

    @override
    def slid(self, state: State) -> Floats:
        way = self._at.planes.slid(state["xi"])
        way[~(self._located & (state["facet"] >= 0))] = 0.0
        return way

    @override
    def begin(self, state: State) -> State:
        if self._replaced is not None:
            self._then, self._replaced = self._then.with_rows(*self._replaced), None
            self._at = self._placed()
        begun, opposed = state.copy(), self._then.shares.any(axis=1)  # or beyond the border
        refer_to_accepted(begun, opposed | (state["facet"] >= 0))
        return begun

    @override
    def anchor(self, start: State) -> None:
        fresh = (start["facet"] >= 0) & (start["facet"] < len(start))
        if not self._comm.allreduce(int(fresh.any())):
            return
        here = self._at.opposite[0].with_axes(self._at.planes.now)
        if self._replaced is None:
            self._replaced = (np.zeros(len(start), dtype=bool), self._then)
        known, before = self._replaced
        self._replaced = (known | fresh, before)
        self._then = self._then.with_rows(fresh, here).in_order()
        start["facet"][fresh] += len(start)
        self._at = self._placed(self._at.weights)

    @override
    def commit(self, before: Snapshot, state: State, now: Snapshot | None) -> Floats:
        if now is None:
            return np.zeros((0, 3))
        self._replaced = None
        self._accept(now.response.state)
        lost = (state["pressure"] > 0.0) & (now.response.state["facet"] < 0)
        gone = lost & beyond(self._hint) & (self._at.weights.area <= 0.0)
        return np.concatenate(self._comm.allgather(now.points[gone]))

    @override
    def roll_back(self, tried: bool) -> None:
        if tried:
            self._return()
            if self._self_contact is not None:
                self._self_contact.roll_back()
            self._at = self._placed()

    @override
    def persistent(self, kept: dict[str, npt.NDArray[Any]]) -> dict[str, npt.NDArray[Any]]:
        then = names_of(self._then, self._gathered)
        kept |= self._kept_hint()
        kept["state"]["facet"] = np.minimum(kept["state"]["facet"], 0)
        # as wide as on the process that has most
        widths = self._comm.allgather((then.masters.shape[1], then.around.shape[1]))
        then = then.as_wide(*(int(most) for most in np.max(widths, axis=0)))
        kept |= {f"opposite.{name}": getattr(then, name).copy() for name in OPPOSITE}
        if self._self_contact is not None:
            kept["sides"] = self._self_contact.persistent()
        return kept | {"reference": self._points.quadrature.reference.copy()}

    @override
    def restore(
        self, kept: Mapping[str, npt.NDArray[Any]], u: Floats
    ) -> Mapping[str, npt.NDArray[Any]]:
        kept = {name: values.copy() for name, values in kept.items()}
        self._hint = self._hint_of(kept)
        then = replace(self._then, **{name: kept[f"opposite.{name}"] for name in OPPOSITE})
        self._then = self._number_anew(u, [then], [self._hint.facet])[0]
        if self._self_contact is not None:
            self._self_contact.restore(kept["sides"])
        refer_to_accepted(kept["state"], kept["state"]["facet"] >= 0)
        there = self._displaced(u)
        self._go_to(there.now)
        self._nodes = there
        self._accepted = (self._gathered.local(self._nodes.now), self._hint)
        self._at = self._placed()
        return kept
