"""Connected components of a mesh: parts of it that share no nodes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.base.arrays import connected
from anisocontact.base.fenicsx import fem
from anisocontact.mesh.described import SAME
from anisocontact.mesh.model import Model
from anisocontact.mesh.overlapping_cells import overlapping_cells


def component_of_nodes(space: Any) -> Ints:
    """Number of the connected part of the mesh each local node is in, the same on all ranks.

    Args:
        space: Vector space of the displacement.
    """
    comm, index_map = space.mesh.comm, space.dofmap.index_map
    cells = np.asarray(space.dofmap.list)
    count = index_map.size_local + index_map.num_ghosts
    here = connected(count, cells)
    first = np.append(0, np.cumsum(comm.allgather(int(here.max(initial=-1)) + 1)))
    own = here + first[comm.rank]
    # a ghost and the node it is a copy of are one
    of_ghosts = (np.asarray(index_map.ghosts, dtype=np.int64), own[index_map.size_local :])
    low, high = index_map.local_range
    links = [np.zeros((0, 2), dtype=np.int64)]
    for nodes, labels in comm.allgather(of_ghosts):
        mine = (nodes >= low) & (nodes < high)
        links.append(np.column_stack([own[nodes[mine] - low], labels[mine]]))
    together = np.concatenate(comm.allgather(np.concatenate(links)))
    return np.asarray(connected(int(first[-1]), together)[own])


def unjoined_bodies(model: Model, apart: Sequence[Locals] = ()) -> list[str]:
    """Bodies of pieces that lie on or in each other and share no nodes; collective.

    A mesh of parts that were not merged looks like one body, and nothing passes between them. One
    that has parts twice is twice as stiff there.

    Args:
        model: The bodies.
        apart: Local nodes that are meant to lie on others, as those in contact.

    Returns:
        A line for each such body, two where its pieces do both.
    """
    space, comm = model.space, model.mesh.comm
    label, owned = component_of_nodes(space), space.dofmap.index_map.size_local
    x = np.asarray(space.tabulate_dof_coordinates())
    meant = np.zeros(len(x), dtype=np.bool_)
    meant[np.concatenate([np.zeros(0, dtype=np.int32), *apart])] = True
    said = []
    for name in model.body_names():
        nodes = fem.locate_dofs_topological(space, model.idealisation.dim, model.cells(name))
        own = nodes[(nodes < owned) & ~meant[nodes]]
        numbers = np.unique(np.concatenate(comm.allgather(np.unique(label[nodes]))))
        if len(numbers) == 1:
            continue
        if twice := overlapping_cells(model, name):
            said.append(twice)
        count = _on_others(*(np.concatenate(comm.allgather(part[own])) for part in (x, label)))
        if count:
            said.append(
                f"body {name!r} has {len(numbers)} pieces that share no node, and {count} nodes "
                "of one lie on nodes of another: nothing passes between them; merge the nodes in "
                "the mesh, or give the pieces bodies of their own with a tie or a contact"
            )
    return said


def _on_others(places: Floats, pieces: Ints) -> int:
    """Nodes that lie on a node of another piece before them."""
    from scipy.spatial import cKDTree

    near = SAME * np.ptp(places, axis=0).max(initial=0.0)
    pairs = cKDTree(places).query_pairs(near, output_type="ndarray")
    return len(np.unique(pairs.max(axis=1)[pieces[pairs[:, 0]] != pieces[pairs[:, 1]]]))
