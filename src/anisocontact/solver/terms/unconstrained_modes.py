"""Rigid motions that neither a form of the user's nor its conditions keep from happening."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import MPI, Mat
from anisocontact.mesh.connected_components import component_of_nodes
from anisocontact.mesh.node_unknowns import NodeUnknowns
from anisocontact.solver.terms.free_modes import named

#: Force of a rigid motion over that of moving single nodes, root mean square, that is rounding.
NOTHING = 1e-10


@dataclass(frozen=True)
class MeshPart:
    """A part of a mesh that is connected.

    Attributes:
        nodes: Local nodes, with ghosts, (n,).
        middle: Mean of its nodes, (3,), length.
        modes: Rigid motions of the nodes this rank owns, others at rest, (6, nodes, 3).
    """

    nodes: Ints
    middle: Floats
    modes: Floats


def parts(space: Any) -> list[MeshPart]:
    """The connected parts of the mesh of a displacement; collective.

    Args:
        space: Vector space of the displacement.
    """
    comm, index_map = space.mesh.comm, space.dofmap.index_map
    owned = index_map.size_local
    x = np.asarray(space.tabulate_dof_coordinates())
    label = component_of_nodes(space)
    found = []
    for one in range(comm.allreduce(int(label.max(initial=-1)), MPI.MAX) + 1):
        nodes = np.flatnonzero(label == one)
        here = nodes[nodes < owned]
        total = comm.allreduce(np.append(x[here].sum(axis=0), len(here)))
        middle = total[:3] / total[3]
        arms = x[here] - middle
        size = np.sqrt(comm.allreduce(float((arms**2).sum())) / total[3])
        modes = np.zeros((6, owned, 3))
        for i, e in enumerate(np.eye(3)):
            modes[i, here] = e
            modes[3 + i, here] = np.cross(e, arms / size)
        found.append(MeshPart(nodes, middle, modes))
    return found


def unconstrained_modes(
    part: MeshPart, stiffness: Mat, scale: float, fixed: Ints, unknowns: NodeUnknowns
) -> str:
    """Motions of a part that meet no stiffness and no condition, in words; empty if there is none.

    Args:
        part: The part.
        stiffness: Tangent of the form alone, without conditions.
        scale: Force for a unit of length of a single node, force/length.
        fixed: Unknowns with conditions, local numbers.
        unknowns: Where the displacement of nodes is among the unknowns.
    """
    x, force = stiffness.createVecs()
    comm, marked = unknowns.comm, np.zeros(unknowns.owned)
    marked[fixed[fixed < unknowns.owned]] = 1.0
    held = unknowns.own_nodal(marked, missing=1.0) > 0.0
    rows = []
    for mode in part.modes:
        x.array[:] = unknowns.own(mode)
        stiffness.mult(x, force)
        row = unknowns.own_nodal(force.array_r) / scale
        rows.append(np.where(held, mode, row).reshape(-1))
    x.destroy()
    force.destroy()
    sums = comm.allreduce(np.array(rows) @ np.array(rows).T)
    count = comm.allreduce(part.modes[0].size)
    values, vectors = np.linalg.eigh(sums)
    loose = vectors.T[values <= NOTHING**2 * count]
    return named(loose) if len(loose) else ""
