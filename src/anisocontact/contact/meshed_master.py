"""Facets of a mesh as a master, whatever is put on them: what passes over facets share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, override

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.contact.beyond_border import beyond
from anisocontact.contact.history import Snapshot
from anisocontact.contact.master import Master
from anisocontact.contact.point_tangent import Nodes
from anisocontact.contact.side_of_master import Seen, SideOfMaster, carried
from anisocontact.contact.sides import Sides
from anisocontact.interface import ContactLaw, State
from anisocontact.surfaces.facets import FacetProjections, FacetSurface

#: Trace of the projection on held directions above which these are all: it is their number.
ALL = 2.5
#: Way along the master, over that towards it and the size of the facets, of which nothing is said.
SLIGHT = 0.02


class MeshedMaster(Master):
    """Both sides where they are now, the laws, and the closest points of the master.

    Args:
        sides: Slave points and facets.
        law: Laws of the interface.
        group: Facet group of the master.
        size: Length of its facets.

    Attributes:
        sides: As given, with the facets that this rank has now.
    """

    # projections start from the last ones, and could come back to another facet
    retraceable = False

    def __init__(self, sides: Sides, law: ContactLaw, *, group: str, size: float) -> None:
        self.groups, self.size, self.reach = (group,), size, sides.reach
        self.sides, self._dtype = sides, law.dtype
        self._gathered, self._comm = sides.gathered, sides.comm
        self._nodes = Nodes(sides.reference, np.zeros_like(sides.reference))
        self._hint: FacetProjections = sides.project(sides.reference)
        self._accepted = (self._gathered.local(sides.reference), self._hint)
        self._rests = False
        self.take(law, law)

    def connected_to_slave(self) -> bool:
        """Whether a connected part of the mesh has facets of both sides; collective."""
        return self._gathered.connected_to(self.sides.slave)

    @property
    def positions(self) -> Floats:
        """Where the nodes of both sides are now, as slave points and facets number them, length."""
        return self._nodes.now

    @property
    def facets(self) -> Locals:
        """Nodes of the facets that this rank has, (m, k)."""
        return self._gathered.local_names(self.sides.master.nodes)

    @property
    def named_facets(self) -> Locals:
        """The same, with nodes as `Couplings` name them."""
        return self._gathered.coupled(self.sides.master.nodes)

    @property
    def named_slaves(self) -> Locals:
        """Nodes of the facets of the slave points, named in the same way, (n, k)."""
        return self._gathered.coupled(self.sides.points.nodes)

    def seen_within(self, u: Floats, far: float) -> tuple[FacetSurface, Locals]:
        """The surface up to a distance from the slave points; collective.

        Args:
            u: Displacements of the local nodes, (nodes, 3), length.
            far: The distance, length; on one process all is there.

        Returns:
            The surface where the nodes are, and the nodes of its facets as `Couplings` name them.
        """
        if not self._gathered.distributed:
            return self.sides.surface, self.named_facets
        return self.sides.seen_within(self._gathered.local(self.sides.reference) + u, far)

    @override
    def local_names(self, nodes: Locals) -> Locals:
        return self._gathered.local_names(nodes)

    @property
    def numbers(self) -> Ints:
        """Their numbers in the whole group."""
        return self._gathered.numbers

    @override
    def take(self, laws: ContactLaw, derivative: ContactLaw) -> None:
        self._given, self._law = laws, laws.on_facets()
        self._derivative = self._law if derivative is laws else derivative.on_facets()

    @override
    def located(self, state: State) -> Flags:
        return np.asarray(state["facet"] >= 0)

    @override
    def beyond(self, state: State) -> Flags:
        return ~self.located(state) & beyond(self._accepted[1])

    @override
    def from_afar(self, start: State) -> Flags:
        """Points that the master is below now, and that were farther away than it is searched."""
        before, now = self._gathered.everywhere(self._accepted[0]), self._nodes.now
        hit, points = self._hint, self.sides.points
        came = self.located(self.here(start, 0.0)) & ~self.located(start) & (hit.facet >= 0)
        rows = np.flatnonzero(came)
        carried_by = (now - before)[self.sides.master.nodes[hit.facet[rows]]].mean(axis=1)
        way = (points.positions(now) - points.positions(before))[rows] - carried_by
        normal = points.outward_of(points.at(now))[rows]
        towards = np.einsum("ni,ni->n", way, normal)
        aside = np.linalg.norm(way - towards[:, None] * normal, axis=1)
        came[rows] = aside > SLIGHT * (np.abs(towards) + points.size)
        return came

    @override
    def stiffness(self, diagonal: Floats) -> float:
        return self.sides.stiffness(diagonal)

    @override
    def yields(self, diagonal: Floats) -> float:
        slave, master = self.sides.stiffnesses(diagonal)
        return slave * self.sides.points.size / (master * self.size)

    @override
    def couplable(self) -> Locals:
        named = self._gathered.local_names
        return np.union1d(named(self.sides.slave.nodes), named(self._gathered.own.nodes))

    @override
    def take_fixed(self, fixed: Floats) -> None:
        held = np.trace(fixed, axis1=1, axis2=2) > ALL
        here = bool(held[self._gathered.local_names(self._gathered.own.nodes)].all())
        self._rests = all(self._comm.allgather(here))

    @override
    def immovable(self, normal: Floats) -> bool | Flags:
        return self._rests

    @override
    def look(self, x: Floats) -> Seen:
        return self.sides.look(x)

    @override
    def side_of_master(
        self, u: Floats, before: Snapshot, state: State, now: Snapshot
    ) -> SideOfMaster:
        sides = self.sides
        there = sides.reference + self._gathered.everywhere(self._gathered.moved(u))
        then = self._gathered.everywhere(self._accepted[0])
        nodes = np.unique(sides.master.nodes)
        return SideOfMaster(
            before=carried(before.points, then[nodes], there[nodes]),
            now=now.points,
            outward=sides.points.outward_of(sides.points.at(there)),
            touched=before.response.status != 0,
            closed=now.response.status != 0,
            located=self.located(now.response.state),
            had=self.located(state),
            normal=now.response.normal,
            areas=now.areas,
            size=sides.points.size,
            reach=self.reach,
            look=sides.look,
            comm=self._comm,
            idle=np.zeros(len(now.points), dtype=bool),
        )

    def _may_leave_gathered(self, u: Floats) -> bool:
        """Whether points may reach facets of other processes; displacements of local nodes."""
        gathered = self._gathered
        return gathered.distributed and self.sides.may_leave_gathered(
            gathered.local(self.sides.reference) + u
        )

    def _have(self, u: Floats, *facets: Locals) -> None:
        """Have the facets of the master that are near, and others; collective.

        Args:
            u: Displacements of the local nodes, (nodes, 3), length.
            *facets: Numbers in the whole group, -1 for none.
        """
        if self._gathered.distributed:
            numbers = np.unique(np.concatenate([one.reshape(-1) for one in facets]))
            now = self._gathered.local(self.sides.reference) + u
            self.sides = self.sides.gather(now, numbers[numbers >= 0].astype(np.int64))

    def _kept_hint(self) -> dict[str, npt.NDArray[Any]]:
        """Closest points of the accepted state for a checkpoint, facets numbered in the group."""
        hint = self._accepted[1]
        kept = {f"projection.{f.name}": getattr(hint, f.name).copy() for f in fields(hint)}
        return kept | {"projection.facet": self._gathered.globally(hint.facet)}

    @staticmethod
    def _hint_of(kept: Mapping[str, npt.NDArray[Any]]) -> FacetProjections:
        """What `_kept_hint` gave, facets still numbered in the group."""
        names = [f.name for f in fields(FacetProjections)]
        return FacetProjections(*(kept[f"projection.{name}"] for name in names))

    def _displaced(self, u: Floats) -> Nodes:
        """Nodes of both sides at displacements of the local nodes, (nodes, 3), length."""
        moved = np.array(self._gathered.everywhere(self._gathered.moved(u)))
        return Nodes(self.sides.reference + moved, moved)

    def _go_to(self, now: Floats) -> None:
        """Bring the surface to positions of the nodes, (nodes, 3), length."""
        self._nodes = Nodes(now, now - self.sides.reference)
        self.sides.surface.update(now)

    def _return(self) -> None:
        """Go back to the accepted state."""
        place, self._hint = self._accepted
        self._go_to(self._gathered.everywhere(place))
