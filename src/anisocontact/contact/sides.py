"""Both sides of a contact of facets: slave points and the surface that they meet."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from anisocontact.base.array_types import Codes, Flags, Floats, Ints, Locals
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import facet_keys, facet_sides
from anisocontact.contact.beyond_cuts import BeyondCuts
from anisocontact.contact.facet_mesh import (
    FacetMesh,
    FacetRule,
    facet_areas,
    facet_mesh,
    facet_rule,
    isoparametric,
)
from anisocontact.contact.facet_pairs import FARTHER, largest_radius, near_facets
from anisocontact.contact.history import Snapshot
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.contact.master_surface import MasterSurface
from anisocontact.contact.near_facets import NearFacets
from anisocontact.contact.options import ContactOptions
from anisocontact.contact.remote_nodes import NONE
from anisocontact.contact.side_of_master import Seen
from anisocontact.contact.slave_nodes import SlaveNodes
from anisocontact.contact.surface_gradient import SurfaceGradient
from anisocontact.contact.sweep import Sweep
from anisocontact.interface import State
from anisocontact.mesh import Model
from anisocontact.surfaces import (
    FACET_STATUS,
    TOPOLOGIES,
    FacetProjections,
    FacetSets,
    FacetSurface,
    default_threads,
)


@dataclass(frozen=True)
class Sides:
    """Slave points and master surface of one pass.

    Attributes:
        slave: Facets of the slave on this rank, of which slave nodes need others as well.
        rule: Quadrature on them.
        points: Its points.
        gathered: The master as this rank has it.
        surface: The same where it is now.
        reach: Distance within which the master is searched, length.
        apart: Numbers in the whole group of facets near to each facet of the slave, of which it
            cannot meet some; None where it can meet all.
        near: Those of them that this rank has; of all facets around slave nodes.
        kinds: Code of the topology of each facet of the master, (m,).
        at: Where the local nodes were when facets were gathered, (nodes, 3), length.
        threads: Threads of the kernel.
        comm: Communicator of the mesh.
    """

    slave: FacetMesh
    rule: FacetRule
    points: IntegrationPoints
    gathered: MasterSurface
    surface: FacetSurface
    reach: float
    apart: NearFacets | None
    near: NearFacets | None
    kinds: Codes
    at: Floats
    threads: int
    comm: Any

    @property
    def searched(self) -> FacetMesh:
        """Facets of the slave from which the master is searched, with those around slave nodes."""
        return self.points.searched(self.slave)

    @cached_property
    def excluded(self) -> FacetSets | None:
        """Facets that each point does not look at; None where it looks at all."""
        if self.near is None:
            return None
        return self.points.unseen(self.near)

    @cached_property
    def surface_gradient(self) -> SurfaceGradient:
        """Gradients on the master, continuous across the edges of its facets."""
        return SurfaceGradient.of(self.master, self.reference)

    @property
    def reference(self) -> Floats:
        """Positions of the nodes in the reference configuration, (nodes, 3), length."""
        return self.gathered.reference

    @property
    def master(self) -> FacetMesh:
        """Facets of the master that this rank has: all of them on one process."""
        return self.gathered.facets

    def project(
        self, now: Floats, hint: FacetProjections | None = None, named: Locals | None = None
    ) -> FacetProjections:
        """Closest points of the master to the slave points.

        Args:
            now: Positions of the nodes, (nodes, 3), length; the surface goes there.
            hint: Where to start from.
            named: As of `FacetSurface.project`.
        """
        self.surface.update(now)
        x = self.points.positions(now)
        return self.surface.project(x, hint, self.reach, self.excluded, named=named)

    def look(self, x: Floats, which: Ints | None = None) -> Seen:
        """The master where it is now from points.

        Args:
            x: Points, (n, 3), length.
            which: Their numbers, where they are slave points: what these cannot meet is not seen.
        """
        if self.excluded is None or which is None:
            hit = self.surface.project(x)
        else:
            hit = self.surface.project(x, None, self.reach, self.excluded.take(which))
        return Seen(located(hit), np.nan_to_num(hit.gap), np.nan_to_num(hit.normal))

    def lost(self, before: State, now: Snapshot) -> Floats:
        """Points that were pressed on a facet and now lie beyond the border, (n, 3)."""
        pressed = (before["facet"] >= 0) & (before["pressure"] > 0.0)
        which = np.flatnonzero(pressed & (now.response.state["facet"] < 0))
        x = now.points[which]
        excluded = None if self.excluded is None else self.excluded.take(which)
        # What this rank has ends somewhere: beyond that nothing is said.
        far = 2.0 * self.reach if self.gathered.distributed else np.inf
        hit = self.surface.project(x, max_distance=far, exclude=excluded)
        return np.asarray(x[hit.status == FACET_STATUS.index("off")])

    def tangents(self, state: State) -> Floats:
        """Tangents of the master of now, (n, 2, 3), length; any where a point has no facet."""
        return self.place(state)[1]

    def place(self, state: State) -> tuple[Floats, Floats]:
        """Places of the master of now, (n, 3), and `tangents` there, length."""
        places, tangents = np.zeros((len(state), 3)), np.tile(np.eye(3)[:2], (len(state), 1, 1))
        there = np.flatnonzero(state["facet"] >= 0)
        jet = self.surface.jet(state["facet"][there], state["xi"][there])
        places[there], tangents[there] = jet.position, jet.d1
        return places, tangents

    def stiffness(self, diagonal: Floats) -> float:
        """Traction per displacement of a node of both, one behind the other, stress/length.

        Args:
            diagonal: As of `stiffnesses`.
        """
        return float(1.0 / sum(1.0 / k for k in self.stiffnesses(diagonal)))

    def stiffnesses(self, diagonal: Floats) -> list[float]:
        """Traction per displacement of a node of slave and master, stress/length.

        Args:
            diagonal: Diagonal of the stiffness of the bodies, of the nodes this rank owns,
                (nodes, 3), force/length; zero where all of a body is rigid.
        """
        found = []
        for side in (self.slave, self.gathered.own):
            nodes = self.gathered.owned(self.gathered.local_names(side.nodes))
            area = facet_areas(side, self.reference).sum()
            local = np.array([diagonal[nodes].mean(axis=1).sum(), area])
            total, area = self.comm.allreduce(local)
            found.append(float(total / area) if total > 0.0 else np.inf)
        return found

    def may_leave_gathered(self, now: Floats) -> bool:
        """Whether points may reach facets that this rank has not gathered; the same on all ranks.

        Facets are gathered by the reach farther than they are met. A slave facet that moves comes
        nearer, its middle with it, and it may grow by twice the way.

        Args:
            now: Positions of the local nodes, (nodes, 3), length.
        """
        with np.errstate(over="ignore"):
            moved = np.linalg.norm(now - self.at, axis=1)
        most = [moved[m.nodes].max(initial=0.0) for m in (self.slave, self.gathered.own)]
        slave, master = np.max(self.comm.allgather(most), axis=0).tolist()
        # where the way is not finite, nothing is found anyway
        return bool(self.reach < 3.0 * slave + master < np.inf)

    def seen_within(self, now: Floats, far: float) -> tuple[FacetSurface, Locals]:
        """The master up to a distance from the slave, which this rank may not have; collective.

        Args:
            now: Positions of the local nodes, (nodes, 3), length.
            far: The distance, length.

        Returns:
            Its surface there, and the nodes of its facets as `Couplings` name them.
        """
        wider = copy(self.gathered)
        _collect(wider, self.slave, self.points, now, far, NONE)
        return _surface(wider, now), wider.coupled(wider.facets.nodes)

    def gather(self, now: Floats, more: Ints) -> Sides:
        """Both sides with the facets of the master that are near now; collective.

        Args:
            now: Positions of the local nodes, (nodes, 3), length.
            more: Facets to have as well, numbers in the whole group.
        """
        _collect(self.gathered, self.slave, self.points, now, (1.0 + FARTHER) * self.reach, more)
        near = None if self.apart is None else self.apart.by(partial(_there, self.gathered))
        return replace(
            self,
            surface=_surface(self.gathered, now),
            near=near,
            kinds=_kinds(self.gathered.facets),
            at=now.copy(),
        )


def _collect(
    gathered: MasterSurface,
    slave: FacetMesh,
    points: IntegrationPoints,
    now: Floats,
    far: float,
    more: Ints,
) -> None:
    """Gather what is near a slave, and more; all is there on one process."""
    if not gathered.distributed:
        return
    radii = [largest_radius(mesh, now) for mesh in (slave, gathered.own)]
    own, other = np.max(gathered.comm.allgather(radii), axis=0).tolist()
    # and the facets around those that points can meet, see `surface_gradient`
    margin = far + own + max(0.0, 2.0 * other - 0.5 * far)
    x = points.everywhere(now)[np.unique(points.nodes)]
    low = x.min(axis=0, initial=np.inf) - margin
    high = x.max(axis=0, initial=-np.inf) + margin
    gathered.gather(np.union1d(gathered.within(low, high, now), more))


def _surface(gathered: MasterSurface, now: Floats) -> FacetSurface:
    """Facets that a rank has, at positions of the local nodes, (nodes, 3), length."""
    facets = gathered.facets
    x = gathered.everywhere(now)
    return FacetSurface(x, facets.nodes, facets.topology, facets.flip)


def _kinds(facets: FacetMesh) -> Codes:
    return np.full(len(facets.nodes), list(TOPOLOGIES).index(facets.topology), dtype=np.int8)


def _there(gathered: MasterSurface, sets: FacetSets) -> FacetSets:
    """Sets of facets of the whole group as sets of those that a rank has."""
    facets = gathered.renumbered(sets.facets)
    there = facets >= 0
    count = np.concatenate([[0], np.cumsum(there)])
    return FacetSets(count[sets.offsets].astype(np.int64), facets[there])


def make_sides(
    model: Model,
    groups: Sequence[str],
    options: ContactOptions,
    nodes: SlaveNodes | None = None,
    beyond: BeyondCuts | None = None,
) -> Sides:
    """Both sides in the reference configuration.

    Args:
        model: Mesh with both groups.
        groups: Facet groups of slave and master.
        options: Of the contact.
        nodes: Slave nodes, where the law is not evaluated at points of the facets.
        beyond: What goes on beyond cut faces.
    """
    slave, master = (model.facets(group) for group in groups)
    comm, sweep, current = model.mesh.comm, Sweep.of(model), options.current_area is not False
    beside = NONE if nodes is None else nodes.far.numbers
    gathered = MasterSurface(model.space, master, sweep, beside, beyond)
    reference = gathered.start
    own = facet_mesh(model.space, slave, sweep)
    degree = options.chosen_degree(model)
    rule = facet_rule(own.topology, degree, None if sweep is None else sweep.share)
    points = nodes or IntegrationPoints(
        isoparametric(own, rule, reference), own.flip, current_area=current, comm=comm
    )
    reach = options.reach if options.reach is not None else 2.0 * points.size
    far = max(FARTHER * reach, options.apart or 0.0) + reach
    _collect(gathered, own, points, reference, far, NONE)
    surface = _surface(gathered, reference)
    near = None
    if options.apart is not None:
        keys = facet_keys(model.mesh, np.sort(slave)) if nodes is None else nodes.keys
        near = _near(gathered, keys, points.searched(own), surface, options.apart)
    return Sides(
        slave=own,
        rule=rule,
        points=points,
        gathered=gathered,
        surface=surface,
        reach=reach,
        apart=near and near.by(lambda s: FacetSets(s.offsets, gathered.globally(s.facets))),
        near=near,
        kinds=_kinds(gathered.facets),
        at=reference,
        threads=default_threads(),
        comm=comm,
    )


def _near(
    gathered: MasterSurface, keys: Ints, met: FacetMesh, surface: FacetSurface, apart: float
) -> NearFacets:
    """Facets that slave facets, known by their keys, are not to meet, see `Contact`."""
    numbers = gathered.number(keys)
    return near_facets(met, numbers, surface, gathered.facets, gathered.reference, apart)


def located(hit: FacetProjections) -> Flags:
    """Whether each point has a facet below it, (n,)."""
    return np.asarray(hit.status == FACET_STATUS.index("on"))


def initial_state(hit: FacetProjections, dtype: np.dtype[np.void]) -> State:
    """Free of force; a point near the master knows its facet, coordinates and gap.

    Args:
        hit: Projections of the points.
        dtype: Type of the state of a point.

    Returns:
        The states, (n,).
    """
    near = located(hit)
    state = np.zeros(len(hit.facet), dtype=dtype)
    state["facet"] = np.where(near, hit.facet, -1)
    state["xi"][near] = hit.xi[near]
    state["origin"] = state["xi"]
    state["gap"][near] = hit.gap[near]
    return state


def check_sides(model: Model, slave: str, master: str, apart: float | None) -> None:
    """Refuse groups that cannot be slave and master.

    Raises:
        InputError: No such facet group, one without facets or with facets inside the body, or
            groups that overlap; `apart` is not positive.
    """
    for name, field in ((slave, "slave"), (master, "master")):
        model.boundary(name, field)
    both = np.intersect1d(model.facets(slave), model.facets(master))
    shared = model.mesh.comm.allreduce(len(facet_sides(model.mesh, both)[0]))
    if apart is not None and not apart > 0.0:
        raise InputError(f"{apart!r} given, must be > 0", "apart")
    if shared and apart is None:
        raise InputError(
            f"{slave!r} and {master!r} share {shared} facets, they must not overlap", "master"
        )
