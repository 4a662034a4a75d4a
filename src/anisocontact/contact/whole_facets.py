"""Facets around nodes that a process owns, wherever these facets live."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.array_types import Ints, Locals
from anisocontact.contact.beyond_cuts import BeyondCuts, Led
from anisocontact.contact.facet_mesh import FacetMesh
from anisocontact.contact.remote_nodes import NONE, RemoteNodes, node_count
from anisocontact.mesh.split import Route, Split


@dataclass(frozen=True)
class WholeFacets:
    """All facets around the nodes of a surface that this process owns, wherever they live.

    Attributes:
        mesh: The facets; nodes that are not local have numbers after these.
        far: Those nodes.
        others: Nodes of the facets that other processes own, or that follow others on cut faces.
        keys: Numbers of `facet_keys` of the facets.
        nodes: The nodes of the surface that this process owns, ascending, but those that follow.
        beside: Numbers on the facets of `others`.
        drawn: How many of the facets, the first, are in the mesh; the others are turned there.
    """

    mesh: FacetMesh
    far: RemoteNodes
    others: RemoteNodes | Led
    keys: Ints
    nodes: Ints | Locals
    beside: Ints | Locals
    drawn: int


def around_own_nodes(
    space: Any, mesh: FacetMesh, keys: Ints, beyond: BeyondCuts | None = None
) -> WholeFacets:
    """The facets around nodes; on one process those that are given; collective.

    Args:
        space: Vector Lagrange space of the displacement.
        mesh: Facets of the surface on this process, with its local nodes.
        keys: Their numbers of `facet_keys`, whose order is that of the facets, (m,).
        beyond: What goes on beyond cut faces, on one process.
    """
    comm, index_map = space.mesh.comm, space.dofmap.index_map
    if comm.size == 1:
        return _on_one_process(space, mesh, keys, beyond)
    nodes = index_map.local_to_global(mesh.nodes.reshape(-1)).reshape(mesh.nodes.shape)
    owner = Split(comm, index_map.size_local).owner(nodes)
    facet, to = np.divmod(np.unique(np.arange(len(nodes))[:, None] * comm.size + owner), comm.size)
    route = Route(comm, to)
    keys, nodes, flip = (route.there(table[facet]) for table in (keys, nodes, mesh.flip))
    order = np.argsort(keys)
    nodes = nodes[order]
    local = index_map.global_to_local(nodes.reshape(-1)).reshape(nodes.shape)
    far = np.unique(nodes[local < 0])
    named = np.where(local < 0, node_count(space) + np.searchsorted(far, nodes), local)
    known, first = np.unique(named, return_index=True)
    own = known < index_map.size_local
    others = RemoteNodes(space, nodes.reshape(-1)[first[~own]])
    found = FacetMesh(mesh.topology, named.astype(np.int32), flip[order])
    return WholeFacets(
        found, RemoteNodes(space, far), others, keys[order], known[own], known[~own], len(order)
    )


def _on_one_process(
    space: Any, mesh: FacetMesh, keys: Ints, beyond: BeyondCuts | None
) -> WholeFacets:
    none, drawn = RemoteNodes(space, NONE), len(mesh.nodes)
    nodes = np.unique(mesh.nodes if mesh.sweep is None else mesh.sweep.edges(mesh.nodes))
    if beyond is None:
        return WholeFacets(mesh, none, none, keys, nodes, NONE, drawn)
    leading, following = beyond.followed(mesh)
    found, of = beyond.beside(mesh)
    own = np.setdiff1d(nodes, following)
    return WholeFacets(found, none, Led(leading), keys[of], own, following, drawn)
