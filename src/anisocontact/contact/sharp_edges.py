"""Which facets around a slave node make its averaged normal.

Where a slave goes around a sharp edge, the mean of both faces is the normal of neither, and a node
that one face presses on the master would be pushed aside as much. Of the facets around a node those
count that face the master nearest to it in the reference configuration, or else the one that faces
it most and what goes on smoothly from there. A wedge that stands on its edge has both of its faces.
Where a surface meets itself its master is what faces one of the facets from in front; a node that
nothing faces has all of them.

A facet that does not count stands across what its neighbour meets: beside a block that has sunk
into its base their projections overlap where nothing touches. It meets what faces it within 60
degrees.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.contact.beyond_cuts import BeyondCuts
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.contact.quadrature import facet_quadrature, inward
from anisocontact.mesh import Model

#: Places, (n, 3), and the normals of facets there with their place, (pairs, 3) and (pairs,), to
#: outward unit normals of the master nearest to the places, (n, 3); not a number where none is.
type Towards = Callable[[Floats, Floats, Ints], Floats]


class Around(Protocol):
    """The facets around slave nodes, see `Patches`."""

    @property
    def offsets(self) -> Ints:
        """Where the facets of each node begin, (n + 1,)."""

    @property
    def facets(self) -> Locals:
        """Facets around the nodes, one list after the other."""

    @property
    def nodes(self) -> Locals:
        """Each node first, then those around it, (n, k)."""

    @property
    def counts(self) -> Floats:
        """How each facet counts."""


#: Cosine of the angle between normals up to which facets go on smoothly, or face each other.
SMOOTH = 0.5
#: How far behind a facet what faces it may lie, over the distance: rounding of a closed slit.
BEHIND = 0.02
#: That between a facet and the mean of those around a node, below which it has an edge: 30 degrees.
SHARP = np.sqrt(0.75)


def facing_facets(owner: Ints, normals: Floats, master: Floats) -> Flags:
    """Facets that make the averaged normals of nodes, (pairs,).

    Args:
        owner: Node of each pair of a node and a facet, (pairs,).
        normals: Outward unit normals of the facets there, (pairs, 3).
        master: Those of the master nearest to the nodes, (n, 3).
    """
    opposed = -np.einsum("pi,pi->p", normals, master[owner])
    first = np.full(len(master), -1)
    # the last that is written for a node is the most opposed of its facets
    order = np.argsort(opposed, kind="stable")
    first[owner[order]] = order
    along = np.einsum("pi,pi->p", normals, normals[first[owner]])
    return np.asarray((opposed > SMOOTH) | (along > SMOOTH))


def counting(around: Around, normals: Floats, x: Floats, towards: Towards | None) -> Floats:
    """How facets count for the averaged normals of nodes, 1 or 0, (pairs,).

    Args:
        around: The facets around each node.
        normals: Outward unit normals of all facets, (m, 3).
        x: Positions of the nodes in the reference configuration, (nodes, 3), length.
        towards: Normals of the master; without it all facets count.
    """
    n, own = len(around.nodes), normals[around.facets]
    owner = np.repeat(np.arange(n), np.diff(around.offsets))
    total = np.zeros((n, 3))
    np.add.at(total, owner, own)
    size = np.linalg.norm(total, axis=1)[:, None]
    mean = total / np.where(size > 0.0, size, 1.0)  # at the tip of a closed slit nothing is left
    counts = np.ones(len(owner))
    sharp = np.zeros(n, dtype=bool)
    sharp[owner[np.einsum("pi,pi->p", own, mean[owner]) < SHARP]] = True
    if towards is None or not sharp.any():
        return counts
    at = np.flatnonzero(sharp[owner])
    nodes, place = np.unique(owner[at], return_inverse=True)
    master = towards(x[around.nodes[nodes, 0]], own[at], place)
    faced = ~np.isnan(master[place, 0])
    counts[at] = ~faced | facing_facets(place, own[at], np.nan_to_num(master))
    return counts


def beside_edges(around: Around, keys: Ints, comm: Any) -> Flags:
    """Facets that do not count at one of their nodes, on whatever process, (m,); collective.

    Args:
        around: The facets around each node that this process owns.
        keys: Numbers of all facets, (m,).
        comm: Communicator of the mesh.
    """
    own = keys[np.unique(around.facets[around.counts == 0.0])]
    return np.isin(keys, np.concatenate(comm.allgather(own)))


def towards_facets(model: Model, group: str, beyond: BeyondCuts | None = None) -> Towards:
    """Normals of the facets of a group; collective, and it has those of all processes.

    Args:
        model: Mesh with the group.
        group: Facet group "body.group".
        beyond: What goes on beyond cut faces.
    """
    places, normals = _middles(model, group)
    if beyond is not None:
        places, normals = beyond.all_around(places, normals)

    def towards(x: Floats, *_: object) -> Floats:
        from scipy.spatial import cKDTree  # slow to import, and smooth slaves do without

        return np.asarray(normals[cKDTree(places).query(x)[1]])

    return towards


def towards_itself(model: Model, group: str) -> Towards:
    """The same of a group that meets itself: of those facets that face one at the place."""
    places, normals = _middles(model, group)

    def towards(x: Floats, own: Floats, owner: Ints) -> Floats:
        found = np.full_like(x, np.nan)
        for i, place in enumerate(x):
            there, way = own[owner == i], places - place
            away = np.linalg.norm(way, axis=1)
            faces = (normals @ there.T < -SMOOTH) & (way @ there.T > -BEHIND * away[:, None])
            if faces.any():
                found[i] = normals[np.where(faces.any(axis=1), away, np.inf).argmin()]
        return found

    return towards


def _middles(model: Model, group: str) -> tuple[Floats, Floats]:
    """Middles of the facets of a group on all processes, and outward unit normals there."""
    facets, comm = model.facets(group), model.mesh.comm
    quadrature = facet_quadrature(model.space, facets, 1, model.idealisation)
    flip = inward(model.space, facets, quadrature)
    points: Any = IntegrationPoints(quadrature, flip, current_area=False, comm=comm)
    gathered = (comm.allgather(found) for found in (quadrature.reference, points.outward))
    places, normals = (np.concatenate(found) for found in gathered)
    return places, normals
