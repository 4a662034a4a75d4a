"""Both sides of a contact of facets: slave points and the surface that they meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact._fenicsx import facet_keys, facet_sides
from anisocontact.contact.facet_mesh import (
    FacetMesh,
    FacetRule,
    SlavePoints,
    facet_mesh,
    facet_rule,
    group_area,
    near_facets,
)
from anisocontact.contact.master_surface import MasterSurface
from anisocontact.errors import InputError
from anisocontact.facets import FACET_STATUS, TOPOLOGIES, FacetProjections, FacetSets, FacetSurface
from anisocontact.interface import STATE, State
from anisocontact.mesh import Model
from anisocontact.surfaces import default_threads

Mask = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Sides:
    """Slave points and master surface of one pass.

    Attributes:
        slave: Facets of the slave on this rank.
        rule: Quadrature on them.
        points: Its points.
        gathered: The master on every rank.
        own_master: Facets of the master on this rank.
        surface: The master where it is now.
        reach: Distance within which the master is searched, length.
        near: Facets that each facet of the slave cannot meet; None where it can meet all.
        excluded: The same for each point.
        kinds: Code of the topology of each facet of the master, (m,).
        threads: Threads of the kernel.
        comm: Communicator of the mesh.
    """

    slave: FacetMesh
    rule: FacetRule
    points: SlavePoints
    gathered: MasterSurface
    own_master: FacetMesh
    surface: FacetSurface
    reach: float
    near: FacetSets | None
    excluded: FacetSets | None
    kinds: npt.NDArray[np.int8]
    threads: int
    comm: Any

    @property
    def reference(self) -> Floats:
        """Positions of the nodes in the reference configuration, (nodes, 3), length."""
        return self.gathered.reference

    @property
    def master(self) -> FacetMesh:
        """All facets of the master."""
        return self.gathered.facets

    def project(self, now: Floats, hint: FacetProjections | None = None) -> FacetProjections:
        """Closest points of the master to the slave points.

        Args:
            now: Positions of the nodes, (nodes, 3), length; the surface goes there.
            hint: Where to start from.
        """
        self.surface.update(now)
        return self.surface.project(self.points.positions(now), hint, self.reach, self.excluded)

    def beyond_the_border(self, which: npt.NDArray[np.int64], x: Floats) -> Floats:
        """Of positions of some slave points, (m, 3), those beyond the border, (n, 3)."""
        excluded = None if self.excluded is None else self.excluded.take(which)
        hit = self.surface.project(x, exclude=excluded)
        return np.asarray(x[hit.status == FACET_STATUS.index("off")])

    def tangents(self, state: State) -> Floats:
        """Tangents of the master of now, (n, 2, 3), length; any where a point has no facet."""
        tangents = np.tile(np.eye(3)[:2], (len(state), 1, 1))
        there = np.flatnonzero(state["facet"] >= 0)
        tangents[there] = self.surface.jet(state["facet"][there], state["xi"][there]).d1
        return tangents

    def stiffness(self, diagonal: Floats) -> float:
        """Traction per displacement of a node of both, one behind the other, stress/length.

        Args:
            diagonal: Diagonal of the stiffness of the bodies, of the nodes this rank owns,
                (nodes, 3), force/length.
        """
        found = []
        for side in (self.slave, self.own_master):
            nodes = np.unique(side.nodes)
            owned = diagonal[nodes[nodes < len(diagonal)]]
            local = np.array([owned.mean(axis=1).sum(), group_area(side, self.reference)])
            total, area = self.comm.allreduce(local)
            found.append(total / area)
        return float(1.0 / sum(1.0 / k for k in found))


def make_sides(
    model: Model,
    groups: Sequence[str],
    degree: int,
    reach: float | None,
    apart: float | None,
    current_area: bool,
    weight: float,
) -> Sides:
    """Both sides in the reference configuration.

    Args:
        model: Mesh with both groups.
        groups: Facet groups of slave and master.
        degree: Degree of the quadrature.
        reach: See `FacetContact`.
        apart: See `FacetContact`.
        current_area: See `FacetContact`.
        weight: See `FacetContact`.
    """
    slave, master = (model.facets(group) for group in groups)
    comm = model.mesh.comm
    gathered = MasterSurface(model.space, master)
    reference, facets = gathered.reference, gathered.facets
    own = facet_mesh(model.space, slave)
    rule = facet_rule(own.topology, degree)
    points = SlavePoints(own, rule, reference, current_area, weight, comm)
    surface = FacetSurface(reference, facets.nodes, facets.topology, facets.flip)
    kind = list(TOPOLOGIES).index(facets.topology)
    near = excluded = None
    if apart is not None:
        numbers = gathered.number(facet_keys(model.mesh, np.sort(slave)))
        near = near_facets(own, numbers, surface, reference, apart)
        excluded = near.take(points.facet)
    return Sides(
        slave=own,
        rule=rule,
        points=points,
        gathered=gathered,
        own_master=facet_mesh(model.space, master),
        surface=surface,
        reach=reach if reach is not None else 2.0 * points.size,
        near=near,
        excluded=excluded,
        kinds=np.full(len(facets.nodes), kind, dtype=np.int8),
        threads=default_threads(),
        comm=comm,
    )


def located(hit: FacetProjections) -> Mask:
    """Whether each point has a facet below it, (n,)."""
    return np.asarray(hit.status == FACET_STATUS.index("on"))


def initial_state(hit: FacetProjections) -> State:
    """Free of force; a point near the master knows its facet, coordinates and gap."""
    near = located(hit)
    state = np.zeros(len(hit.facet), dtype=STATE)
    state["facet"] = np.where(near, hit.facet, -1)
    state["xi"][near] = hit.xi[near]
    state["origin"] = state["xi"]
    state["gap"][near] = hit.gap[near]
    return state


def check_sides(model: Model, slave: str, master: str, apart: float | None) -> None:
    """Refuse groups that cannot be slave and master.

    Raises:
        InputError: No such facet group, one without facets, or groups that overlap; `apart` is not
            positive.
    """
    for name, field in ((slave, "slave"), (master, "master")):
        model.facets(name, field)
        if model.count_facets(name) == 0:
            raise InputError(f"facet group {name!r} has no facets", field)
    both = np.intersect1d(model.facets(slave), model.facets(master))
    shared = model.mesh.comm.allreduce(len(facet_sides(model.mesh, both)[0]))
    if apart is not None and not apart > 0.0:
        raise InputError(f"{apart!r} given, must be > 0", "apart")
    if shared and apart is None:
        raise InputError(
            f"{slave!r} and {master!r} share {shared} facets, they must not overlap", "master"
        )
