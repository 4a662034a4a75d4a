"""A block of cells: a lattice in a unit cube and the map that takes it into space."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.arrays import connected
from anisocontact.base.errors import InputError

#: A side of the unit cube: axis and end (0: low, 1: high).
type Side = tuple[int, int]

#: Distance of nodes of neighbouring blocks that are one, over the extent of the body.
SAME_NODE = 1e-9
#: Cells along one direction that are certainly a slip of the keyboard: their planes alone would
#: take gigabytes before anybody could count the cells.
MOST_ALONG = 10**7


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
    """Planes of cells of one size, from 0 to 1.

    Raises:
        InputError: More cells than anybody can mean.
    """
    check_line(cells)
    return np.linspace(0.0, 1.0, cells + 1)


def graded(cells: int, ratio: float) -> Floats:
    """Planes of cells that grow geometrically, from 0 to 1.

    Args:
        cells: Number of cells.
        ratio: Size of the last over that of the first.

    Returns:
        Positions of the planes, (cells + 1,).

    Raises:
        InputError: More cells than anybody can mean.

    Example:
        >>> graded(2, 3.0).tolist()
        [0.0, 0.25, 1.0]
    """
    if cells == 1 or ratio == 1.0:
        return even(cells)
    check_line(cells)
    sizes = ratio ** (np.arange(cells) / (cells - 1))
    ends = np.concatenate([[0.0], np.cumsum(sizes)])
    return np.asarray(ends / ends[-1])


def focused(cells: int, focus: float, low: float = -1.0, high: float = 1.0) -> Floats:
    """Planes of cells that are fine around 0 and grow geometrically away from it.

    Args:
        cells: Number of cells.
        focus: Size of the cells at 0 over that of those farthest from it.
        low: Where they begin, -1 or 0.
        high: Where they end, 0 or 1.

    Returns:
        Positions of the planes between `low` at 0 and `high` at 1, (cells + 1,).

    Raises:
        InputError: More cells than anybody can mean, or an odd number to both sides of 0.

    Example:
        >>> focused(4, 1 / 3).tolist()
        [0.0, 0.375, 0.5, 0.625, 1.0]
    """
    if focus == 1.0:
        return even(cells)
    if low == 0.0:
        return graded(cells, 1.0 / focus)
    if high == 0.0:
        return np.asarray(1.0 - graded(cells, 1.0 / focus)[::-1])
    if cells % 2:
        text = f"{cells} cells to both sides of where focus is, an even number is needed"
        raise InputError(text, "cells")
    right = 0.5 * graded(cells // 2, 1.0 / focus)
    return np.concatenate([0.5 - right[:0:-1], 0.5 + right])


def zoned(cells: int, place: float, size: float) -> Floats:
    """Planes of cells that are fine around a place and grow geometrically away from it.

    The size of a cell is linear in its distance from the place, and there is a plane at the place:
    cells on its two sides differ there by no more than rounding their numbers asks for.

    Args:
        cells: Number of cells.
        place: Where they are fine, from 0 to 1.
        size: Size at the place over that at the farther end, in the limit of many cells.

    Returns:
        Positions of the planes, from 0 to 1, (cells + 1,).

    Raises:
        InputError: More cells than anybody can mean, or one for both sides.

    Example:
        >>> zoned(4, 0.25, 1.0).tolist()
        [0.0, 0.25, 0.5, 0.75, 1.0]
        >>> zoned(3, 0.0, 0.25).round(6).tolist()
        [0.0, 0.1958, 0.506614, 1.0]
    """
    check_line(cells)
    away = np.array([place, 1.0 - place])
    growth = (1.0 / size - 1.0) / away.max()
    # the integral of one over the size
    spans = np.log1p(growth * away) / growth if growth > 0.0 else away
    sides = np.flatnonzero(away)
    if cells < len(sides):
        raise InputError(f"{cells} given, fine cells inside need at least {len(sides)}", "cells")
    low = round(cells * spans[0] / spans.sum())
    low = min(max(low, int(away[0] > 0.0)), cells - int(away[1] > 0.0))

    def distances(span: float, count: int) -> Floats:
        steps = span * np.arange(count + 1) / max(count, 1)
        return np.asarray(np.expm1(growth * steps) / growth if growth > 0.0 else steps)

    left, right = distances(spans[0], low), distances(spans[1], cells - low)
    planes = np.concatenate([place - left[:0:-1], place + right])
    planes[0], planes[-1] = 0.0, 1.0
    return planes


def check_line(cells: int) -> None:
    """Refuse more cells along one direction than anybody can mean.

    Raises:
        InputError: Says how many there would be.
    """
    if cells > MOST_ALONG:
        text = f"{cells:.1e} cells along one direction given, at most {MOST_ALONG:.0e} allowed"
        raise InputError(text, "cells")


class Lattice:
    """Nodes of a block, numbered with the last axis fastest; any of them without the others.

    Args:
        block: The block.
        degree: Degree of the cells, 1 or 2.

    Attributes:
        block: The block.
        count: Number of nodes.
    """

    def __init__(self, block: Block, degree: int) -> None:
        self.block = block
        self._degree = degree
        self._planes = [_with_middles(p) if degree == 2 else p for p in block.planes]
        self._shape = tuple(len(p) for p in self._planes)
        self._strides = np.array([self._shape[1] * self._shape[2], self._shape[2], 1])
        self.count = math.prod(self._shape)

    def part(self, own: tuple[int, int], before: int, count: int) -> Ints:
        """Numbers in this block of what is one's own in a row of blocks.

        Args:
            own: First number of one's own and the one after the last.
            before: Numbers in the blocks before this one.
            count: Numbers in this one.
        """
        return np.arange(*np.clip(np.subtract(own, before), 0, count), dtype=np.int64)

    def points(self, nodes: Ints) -> Floats:
        """Points in space of some nodes, (n, 3), length."""
        shares = [p[self._along(axis, nodes)] for axis, p in enumerate(self._planes)]
        return self.block.place(np.stack(shares, axis=-1))

    def hexahedra(self, numbers: Ints) -> Ints:
        """Nodes of some hexahedra, (n, (degree + 1)^3), the last axis fastest."""
        cells = [len(p) - 1 for p in self.block.planes]
        corner = self._degree * np.stack(np.unravel_index(numbers, cells), axis=-1)
        inside = np.array(list(product(range(self._degree + 1), repeat=3)))
        return np.asarray((corner[:, None] + inside) @ self._strides, dtype=np.int64)

    def on(self, nodes: Ints, side: Side) -> Flags:
        """Whether nodes lie on a side of the cube."""
        axis, end = side
        return np.asarray(self._along(axis, nodes) == end * (self._shape[axis] - 1))

    def seams(self) -> Ints:
        """Nodes on the sides that are no facet groups: what meets another side is none."""
        sides = [np.zeros(0, dtype=np.int64)]
        for axis, end in set(product(range(3), (0, 1))) - set(self.block.sides):
            index = list(np.ix_(*(np.arange(n) for n in self._shape)))
            index[axis] = np.array(end * (self._shape[axis] - 1))
            sides.append(sum(i * s for i, s in zip(index, self._strides, strict=True)).reshape(-1))
        return np.unique(np.concatenate(sides))

    def _along(self, axis: int, nodes: Ints) -> Ints:
        return np.asarray(nodes // self._strides[axis] % self._shape[axis])


def _with_middles(planes: Floats) -> Floats:
    out = np.empty(2 * len(planes) - 1)
    out[::2], out[1::2] = planes, 0.5 * (planes[1:] + planes[:-1])
    return out


class Weld:
    """Nodes of several lattices, those at one place as one.

    Only sides that are no facet groups can meet.

    Args:
        lattices: The lattices; their nodes are numbered one lattice behind the other.

    Attributes:
        removed: Nodes in the place of which there is an earlier one, sorted.
    """

    def __init__(self, lattices: Sequence[Lattice]) -> None:
        starts = np.cumsum([0] + [lattice.count for lattice in lattices])
        seams = [lattice.seams() for lattice in lattices]
        points = np.concatenate([one.points(s) for one, s in zip(lattices, seams, strict=True)])
        nodes = np.concatenate([s + n for s, n in zip(seams, starts[:-1], strict=True)])
        self.removed = self._stays = np.zeros(0, dtype=np.int64)
        if not len(points):
            return
        from scipy.spatial import cKDTree  # slow to import, and a box does without

        tolerance = SAME_NODE * float(np.ptp(points, axis=0).max())
        pairs = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
        labels = connected(len(points), pairs)
        _, firsts = np.unique(labels, return_index=True)
        stays = nodes[firsts][labels]
        gone = stays != nodes
        self.removed = nodes[gone]
        self._stays = stays[gone]

    def number(self, nodes: Ints) -> Ints:
        """Numbers of nodes once those at one place are one, in the order of the nodes."""
        if not len(self.removed):
            return nodes
        place = np.minimum(np.searchsorted(self.removed, nodes), len(self.removed) - 1)
        kept = np.where(self.removed[place] == nodes, self._stays[place], nodes)
        return np.asarray(kept - np.searchsorted(self.removed, kept))
