"""Gaps between facets that are to be tied, closed in the mesh: nodes move, nothing is strained."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import basix, geometry
from anisocontact.base.typed import typed
from anisocontact.contact.penalty import facet_size
from anisocontact.contact.tied_surfaces import WholeGroups
from anisocontact.mesh import Model
from anisocontact.surfaces.facets import FacetSurface

#: Gap that is closed over the size of the facets of the master, if none is given.
TOLERANCE = 0.1
#: Share of its volume that a cell has to keep everywhere.
KEPT = 0.1
#: Codes of `FacetProjections`: a point above a facet, and one whose foot is not at the border.
_ON, _INTERIOR = 0, 0


@typed
def close_gaps(
    model: Model, slave: str, master: str, tolerance: float | None = None
) -> tuple[int, float]:
    """Move the slave nodes of a tie onto the facets of its master; collective.

    It comes first: contacts, materials and problems are made of the mesh as it is then.

    Args:
        model: The mesh, which is changed.
        slave: Facet group whose nodes are moved, "body.group".
        master: Facet group that they are moved to.
        tolerance: Nodes farther off stay where they are, length; a tenth of the size of the facets
            of the master if not given.

    Returns:
        How many nodes were moved, and how far at most, length.

    Raises:
        InputError: A cell would be squeezed flat.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> lower = BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))
        >>> upper = BoxSpec((0, 0, 1.01), (1, 1, 1), (3, 3, 3))
        >>> model = build_box({"lower": lower, "upper": upper})
        >>> moved, most = close_gaps(model, "upper.bottom", "lower.top")
        >>> moved, round(most, 12)
        (16, 0.01)
    """
    reach = TOLERANCE * facet_size(model, master) if tolerance is None else tolerance
    groups = WholeGroups(model, {slave, master})
    x = groups.x if groups.sweep is None else groups.sweep.positions(groups.x)
    other = groups.groups[master].facets
    surface = FacetSurface(x, other.nodes, other.topology, other.flip)
    nodes = np.unique(groups.groups[slave].facets.nodes % len(groups.x))
    foot = surface.project(groups.x[nodes], max_distance=reach)
    near = (foot.status == _ON) & (foot.feature == _INTERIOR)
    moved, way = nodes[near], foot.position[near] - groups.x[nodes[near]]
    _move(model, groups, moved, way, f"tie of {slave!r} to {master!r}")
    far = np.linalg.norm(way, axis=1)
    return int((far > 0.0).sum()), float(far.max(initial=0.0))


def _move(model: Model, groups: WholeGroups, nodes: Ints, way: Floats, what: str) -> None:
    """Move nodes of the mesh, given by their places in the groups."""
    ways = np.zeros((len(groups.x) + 1, 3))
    ways[nodes] = way
    index_map = model.space.dofmap.index_map
    local = np.arange(index_map.size_local + index_map.num_ghosts, dtype=np.int32)
    place = groups.placed(index_map.local_to_global(local))
    _, of_cells, x = geometry(model.mesh)
    same = model.space.dofmap.list[:, : of_cells.shape[1]]
    before, moved = _volumes(model), x.copy()
    # every cell says the same of a node that it shares with others
    moved[of_cells.ravel()] = x[of_cells.ravel()] + ways[place[same.ravel()]]
    x[:] = moved
    share = float((_volumes(model) / before).min(initial=np.inf))
    if min(model.mesh.comm.allgather(share)) < KEPT:
        text = f"closing its gaps leaves a cell {share:.2g} of its volume; tolerance is too large"
        raise InputError(text, what)


def _volumes(model: Model) -> Floats:
    """Volume over that of the reference cell at points inside of every cell, (cells, points)."""
    element, cells, x = geometry(model.mesh)
    points, _ = basix.make_quadrature(element.cell_type, 2 * element.degree)
    slopes = element.tabulate(1, points)[1:, :, :, 0]
    dim = len(slopes)
    jacobian = np.einsum("dqk,ckx->cqxd", slopes, x[cells][:, :, :dim], optimize=True)
    return np.asarray(np.linalg.det(jacobian))
