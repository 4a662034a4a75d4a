"""Bodies of blocks: cells of their lattices, nodes of neighbours joined."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from anisocontact.base.array_types import Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI, cell_nodes, facet_nodes
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays
from anisocontact.mesh.lattice import Block, Lattice, Side, Weld
from anisocontact.mesh.split import share_of

_UNIT = np.array(list(product((0, 1), repeat=3)))[:, ::-1]
SELF: Any = MPI.COMM_SELF
#: More cells than fit in the memory of any one machine.
MOST_CELLS = 10**8


def mesh_blocks(
    name: str, blocks: Sequence[Block], cell: str, degree: int, order: int, comm: Any = SELF
) -> MeshArrays:
    """One body of blocks; nodes at the same place become one.

    Args:
        name: Name of the body, prefix of its facet groups.
        blocks: The blocks; cells of neighbours meet node by node.
        cell: "hexahedron", or "tetrahedron" (six to each hexahedron).
        degree: Degree of the geometry, 1 or 2: curved cells have their middle nodes on the map.
        order: Order of the displacement.
        comm: Processes that share the body: each makes its own nodes and cells.
    """
    lattices = [Lattice(block, degree) for block in blocks]
    nodes = np.cumsum([0] + [lattice.count for lattice in lattices])
    hexahedra = np.cumsum([0] + [block.count for block in blocks])
    weld = Weld(lattices)
    own_nodes, own = share_of(comm, int(nodes[-1])), share_of(comm, int(hexahedra[-1]))
    points, cells = [np.zeros((0, 3))], [np.zeros((0, len(cell_nodes(cell, degree))), np.int64)]
    facets: dict[str, Ints] = {}
    for lattice, start, first in zip(lattices, nodes[:-1], hexahedra[:-1], strict=True):
        here = lattice.part(own_nodes, start, lattice.count)
        kept = here[~np.isin(start + here, weld.removed)]
        points.append(lattice.points(kept))
        local = lattice.hexahedra(lattice.part(own, first, lattice.block.count))
        made = _cells(local + start, weld.number, cell, degree)
        cells.append(weld.number(made))
        for side, group in lattice.block.sides.items():
            found = weld.number(_side(made - start, lattice, side, cell, degree) + start)
            known = facets.get(f"{name}.{group}", found[:0])
            facets[f"{name}.{group}"] = np.concatenate([known, found])
    joined = np.concatenate(cells)
    bodies = {name: np.arange(len(joined))}
    return MeshArrays(
        cell, degree, np.concatenate(points), joined, bodies, facets, order=order, comm=comm
    )


def _cells(local: Ints, number: Callable[[Ints], Ints], cell: str, degree: int) -> Ints:
    """Cells in DOLFINx order from hexahedra as of `Lattice`."""
    if cell == "hexahedron":
        return local[:, _place(cell_nodes(cell, degree), degree)]
    corners = local[:, _place(degree * _UNIT, degree)]
    split = _splits()[_split_kind(number(corners))]
    # The nodes of a tetrahedron lie at whole places of the lattice: middles of corners.
    weights = cell_nodes(cell, degree)
    barycentric = np.column_stack([degree - weights.sum(axis=1), weights])
    nodes = np.einsum("na,ctax->ctnx", barycentric, _UNIT[split])
    rows = np.arange(len(local))[:, None, None]
    return np.asarray(local[rows, _place(nodes, degree)].reshape(-1, len(weights)))


def _place(lattice: Ints, degree: int) -> Ints:
    """Number of a node in a hexahedron as of `Lattice`, from whole places along the axes."""
    return np.asarray(lattice @ np.array([(degree + 1) ** 2, degree + 1, 1]))


def _split_kind(corners: Ints) -> Ints:
    """Row of `_splits`: lowest corner, and which diagonal each opposite face has."""
    lowest = np.argmin(corners, axis=1)
    faces = CELL_FACETS["hexahedron"]
    where = np.argmin(corners[:, faces], axis=2)
    straight = np.isin(where, (0, 3)).astype(np.int64)
    opposite = np.array([[f for f in range(6) if v not in faces[f]] for v in range(8)])
    bits = np.take_along_axis(straight, opposite[lowest], axis=1)
    return np.asarray(8 * lowest + bits @ np.array([1, 2, 4]), dtype=np.int64)


@cache
def _splits() -> Ints:
    """Corners of six tetrahedra for every `_split_kind`, (64, 6, 4).

    Each face is cut from its lowest corner, so that neighbours cut it alike; the three faces
    without the lowest corner of the cell are joined to that corner.
    """
    faces = CELL_FACETS["hexahedron"]
    out = []
    for lowest in range(8):
        opposite = [face for face in faces if lowest not in face]
        for bits in range(8):
            cut = []
            for i, (a, b, c, d) in enumerate(opposite):
                halves = [(a, b, d), (a, c, d)] if bits >> i & 1 else [(a, b, c), (b, c, d)]
                cut += [_right_handed([lowest, *half]) for half in halves]
            out.append(cut)
    return np.array(out)


def _right_handed(corners: list[int]) -> list[int]:
    edges = _UNIT[corners[1:]] - _UNIT[corners[0]]
    return corners if np.linalg.det(edges) > 0.0 else [*corners[:2], corners[3], corners[2]]


def _side(cells: Ints, lattice: Lattice, side: Side, cell: str, degree: int) -> Ints:
    """Nodes of the facets on a side of the cube, vertices first, (facets, nodes)."""
    facets = cells[:, facet_nodes(cell, degree)]
    facets = facets.reshape(-1, facets.shape[-1])
    return np.asarray(facets[np.all(lattice.on(facets, side), axis=1)])


def check_count(blocks: Sequence[Block]) -> None:
    """Refuse more cells than fit in the memory of any one machine: a slip of the keyboard.

    Raises:
        InputError: Says how many there would be.
    """
    count = sum(block.count for block in blocks)
    if count > MOST_CELLS:
        raise InputError(f"{count:.1e} cells given, at most {MOST_CELLS:.0e} allowed", "cells")
