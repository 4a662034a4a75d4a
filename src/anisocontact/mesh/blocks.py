"""Blocks of cells: a lattice in a unit cube and the map that takes it into space."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import product

import numpy as np
import scipy.sparse
from scipy.spatial import cKDTree

from anisocontact._fenicsx import cell_nodes, facet_nodes
from anisocontact.errors import InputError
from anisocontact.mesh.arrays import CELL_FACETS, Floats, MeshArrays, Nodes

#: A side of the unit cube: axis and end (0: low, 1: high).
type Side = tuple[int, int]

#: Distance of nodes of neighbouring blocks that are one, over the extent of the body.
SAME_NODE = 1e-9
_UNIT = np.array(list(product((0, 1), repeat=3)))[:, ::-1]


@dataclass(frozen=True)
class Block:
    """Cells between planes of a unit cube, and where the cube lies in space.

    Attributes:
        planes: Positions of the planes along each axis, from 0 to 1, one more than cells.
        place: Takes points of the cube, (n, 3), to points in space, (n, 3), length; right-handed.
        sides: Sides of the cube that are facet groups, by name of the group.
    """

    planes: tuple[Floats, Floats, Floats]
    place: Callable[[Floats], Floats]
    sides: Mapping[Side, str] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Number of hexahedra."""
        return math.prod(len(p) - 1 for p in self.planes)


def even(cells: int) -> Floats:
    """Planes of cells of one size, from 0 to 1."""
    return np.linspace(0.0, 1.0, cells + 1)


def graded(cells: int, ratio: float) -> Floats:
    """Planes of cells that grow geometrically, from 0 to 1.

    Args:
        cells: Number of cells.
        ratio: Size of the last over that of the first.

    Returns:
        Positions of the planes, (cells + 1,).

    Example:
        >>> graded(2, 3.0).tolist()
        [0.0, 0.25, 1.0]
    """
    if cells == 1 or ratio == 1.0:
        return even(cells)
    sizes = ratio ** (np.arange(cells) / (cells - 1))
    ends = np.concatenate([[0.0], np.cumsum(sizes)])
    return np.asarray(ends / ends[-1])


def mesh_blocks(
    name: str, blocks: Sequence[Block], cell: str, degree: int, order: int
) -> MeshArrays:
    """One body of blocks; nodes at the same place become one.

    Args:
        name: Name of the body, prefix of its facet groups.
        blocks: The blocks; cells of neighbours meet node by node.
        cell: "hexahedron", or "tetrahedron" (six to each hexahedron).
        degree: Degree of the geometry, 1 or 2: curved cells have their middle nodes on the map.
        order: Order of the displacement.

    Returns:
        The mesh.
    """
    lattices = [_lattice(block, degree) for block in blocks]
    first = np.cumsum([0] + [len(points) for points, _, _ in lattices])
    points = np.concatenate([points for points, _, _ in lattices])
    number, points = _welded(points)
    cells: list[Nodes] = []
    facets: dict[str, Nodes] = {}
    for block, start, (_, places, local) in zip(blocks, first[:-1], lattices, strict=True):
        own = _cells(local + start, number, cell, degree)
        cells.append(number[own])
        for side, group in block.sides.items():
            on_side = _side(own - start, places, side, cell, degree)
            found = number[on_side + start]
            known = facets.get(f"{name}.{group}", found[:0])
            facets[f"{name}.{group}"] = np.concatenate([known, found])
    joined = np.concatenate(cells)
    return MeshArrays(
        cell, degree, points, joined, {name: np.arange(len(joined))}, facets, order=order
    )


def _lattice(block: Block, degree: int) -> tuple[Floats, Floats, Nodes]:
    """Points of the nodes, their places in the cube, and the node numbers of each hexahedron.

    A hexahedron has (degree + 1)^3 nodes, numbered with the last axis fastest.
    """
    planes = [_with_middles(p) if degree == 2 else p for p in block.planes]
    places = np.stack(np.meshgrid(*planes, indexing="ij"), axis=-1).reshape(-1, 3)
    shape = tuple(len(p) for p in planes)
    corner = [degree * np.arange(len(p) - 1) for p in block.planes]
    corners = np.stack(np.meshgrid(*corner, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    inside = np.array(list(product(range(degree + 1), repeat=3)))
    strides = np.array([shape[1] * shape[2], shape[2], 1])
    return block.place(places), places, ((corners + inside) @ strides).astype(np.int64)


def _with_middles(planes: Floats) -> Floats:
    out = np.empty(2 * len(planes) - 1)
    out[::2], out[1::2] = planes, 0.5 * (planes[1:] + planes[:-1])
    return out


def _welded(points: Floats) -> tuple[Nodes, Floats]:
    """Number of each point once points at one place are one, and what is left of the points."""
    tolerance = SAME_NODE * float(np.ptp(points, axis=0).max())
    pairs = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    links = scipy.sparse.coo_array(
        (np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2
    )
    _, labels = scipy.sparse.csgraph.connected_components(links, directed=False)
    _, firsts, number = np.unique(labels, return_index=True, return_inverse=True)
    # Numbers in the order in which the points come.
    rank = np.argsort(np.argsort(firsts))
    return rank[number].astype(np.int64), points[np.sort(firsts)]


def _cells(local: Nodes, number: Nodes, cell: str, degree: int) -> Nodes:
    """Cells in DOLFINx order from hexahedra as of `_lattice`."""
    if cell == "hexahedron":
        return local[:, _place(cell_nodes(cell, degree), degree)]
    corners = local[:, _place(degree * _UNIT, degree)]
    split = _splits()[_split_kind(number[corners])]
    # The nodes of a tetrahedron lie at whole places of the lattice: middles of corners.
    weights = cell_nodes(cell, degree)
    barycentric = np.column_stack([degree - weights.sum(axis=1), weights])
    nodes = np.einsum("na,ctax->ctnx", barycentric, _UNIT[split])
    rows = np.arange(len(local))[:, None, None]
    return np.asarray(local[rows, _place(nodes, degree)].reshape(-1, len(weights)))


def _place(lattice: Nodes, degree: int) -> Nodes:
    """Number of a node in a hexahedron as of `_lattice`, from whole places along the axes."""
    return np.asarray(lattice @ np.array([(degree + 1) ** 2, degree + 1, 1]))


def _split_kind(corners: Nodes) -> Nodes:
    """Row of `_splits`: lowest corner, and which diagonal each opposite face has."""
    lowest = np.argmin(corners, axis=1)
    faces = CELL_FACETS["hexahedron"]
    where = np.argmin(corners[:, faces], axis=2)
    straight = np.isin(where, (0, 3)).astype(np.int64)
    opposite = np.array([[f for f in range(6) if v not in faces[f]] for v in range(8)])
    bits = np.take_along_axis(straight, opposite[lowest], axis=1)
    return np.asarray(8 * lowest + bits @ np.array([1, 2, 4]), dtype=np.int64)


@cache
def _splits() -> Nodes:
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


def _side(cells: Nodes, places: Floats, side: Side, cell: str, degree: int) -> Nodes:
    """Nodes of the facets on a side of the cube, vertices first, (facets, nodes)."""
    axis, end = side
    facets = cells[:, facet_nodes(cell, degree)]
    facets = facets.reshape(-1, facets.shape[-1])
    return np.asarray(facets[np.all(places[facets, axis] == end, axis=1)])


def check_count(blocks: Sequence[Block], most: int = 10**8) -> None:
    """Refuse more cells than fit in the memory of any one machine: a slip of the keyboard.

    Raises:
        InputError: Says how many there would be.
    """
    count = sum(block.count for block in blocks)
    if count > most:
        raise InputError(f"{count:.1e} cells given, at most {most:.0e} allowed", "cells")
