"""In which order unknowns are eliminated, and which of them together: supernodes.

Nested dissection by METIS [Karypis Kumar 1998], of nodes instead of unknowns: those of a node are
coupled with the same ones. What is eliminated in turn and leaves the same ones is a supernode, and
small ones are merged [Ashcraft Grimes 1989].
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Ints
from anisocontact.solver.strategies.condensed.factor import aij

#: Unknowns of a supernode and share of its factor that may be zero, up to which it is merged from
#: smaller ones: small products take longer than a few zeros.
_MERGED: tuple[tuple[float, float], ...] = ((16, 1.0), (48, 0.8), (160, 0.25), (np.inf, 0.05))


@dataclass
class _Group:
    """Nodes that are eliminated together.

    Attributes:
        nodes: The nodes, in the order of elimination.
        left: Later nodes that they are coupled with, then.
        children: Groups of which this one takes what they leave.
        size: Unknowns of `nodes`.
        below: Unknowns of `left`.
        zeros: Entries of the factor that are zero.
    """

    nodes: list[int]
    left: set[int]
    children: list[_Group] = field(default_factory=list)
    size: int = 0
    below: int = 0
    zeros: int = 0


@dataclass(frozen=True)
class Supernode:
    """Unknowns that are eliminated together; numbers are places in the order of elimination.

    Attributes:
        first: The first one.
        count: How many there are: they follow each other.
        left: Later unknowns that they are coupled with then, increasing.
        children: Numbers of the supernodes of which this one takes what they leave.
    """

    first: int
    count: int
    left: Ints
    children: tuple[int, ...]

    @property
    def as_large_as(self) -> int:
        """Rows of a square matrix whose LU takes as many operations."""
        count, others = self.count, len(self.left)
        operations = count * (count**2 / 3 + count * others + others**2)
        return round(float(np.cbrt(1.5 * operations)))

    def places(self, unknowns: Ints) -> Ints:
        """Places of unknowns among its own and `left`."""
        behind = self.count + np.searchsorted(self.left, unknowns)
        return np.where(unknowns < self.first + self.count, unknowns - self.first, behind)


@dataclass(frozen=True)
class Elimination:
    """An order of elimination.

    Attributes:
        order: Unknowns in this order, those of the border last and increasing, (n,).
        supernodes: Children before their parents; the last one is the border.
    """

    order: Ints
    supernodes: Sequence[Supernode]


def elimination_of(matrix: scipy.sparse.csr_array, border: Ints) -> Elimination:
    """Choose an order for a matrix with symmetric pattern.

    Args:
        matrix: The matrix, columns in order, (n, n).
        border: Unknowns that are not eliminated, increasing.

    Raises:
        PETSc.Error: This PETSc has no METIS.
    """
    stays = np.zeros(matrix.shape[0], dtype=np.bool_)
    stays[border] = True
    starts = _alike(matrix, stays)
    graph = matrix[starts][:, starts].tocsr()
    sizes = np.diff(starts, append=matrix.shape[0])
    inside, outside = np.flatnonzero(~stays[starts]), np.flatnonzero(stays[starts])
    order = np.concatenate([inside[_dissected(graph[inside][:, inside].tocsr())], outside])
    graph = graph[order][:, order].tocsr()
    top = _merged(_groups(graph, len(inside)), sizes[order])
    found = list(_children_first(top))
    nodes = np.concatenate([*(group.nodes for group in found), np.arange(len(inside), len(order))])
    place = np.empty(len(nodes), dtype=np.int64)
    place[nodes] = np.arange(len(nodes))
    order, number = order[nodes], {id(group): i for i, group in enumerate(found)}
    begin = np.concatenate([[0], np.cumsum(sizes[order])])
    made = []
    for group in found:
        first, left = place[group.nodes[0]], np.sort(place[list(group.left)])
        children = tuple(number[id(child)] for child in group.children)
        own = _each(begin[left], sizes[order[left]])
        made.append(Supernode(int(begin[first]), group.size, own, children))
    roots = tuple(number[id(group)] for group in top)
    last = Supernode(int(begin[len(inside)]), len(border), np.zeros(0, dtype=np.int64), roots)
    return Elimination(_each(starts[order], sizes[order]), [*made, last])


def _alike(matrix: scipy.sparse.csr_array, stays: Flags) -> Ints:
    """First one of each run of unknowns that are coupled with the same ones."""
    key = np.random.default_rng(1).integers(0, 2**62, matrix.shape[0], dtype=np.uint64)
    sums = np.add.reduceat(np.append(key[matrix.indices], key[:1]), matrix.indptr[:-1])
    other = (np.diff(sums) != 0) | (stays[1:] != stays[:-1])
    return np.flatnonzero(np.append(True, other))


def _dissected(graph: scipy.sparse.csr_array) -> Ints:
    """Nodes in an order of nested dissection."""
    given = aij(graph)
    rows, columns = given.getOrdering("metisnd")
    order = np.array(rows.getIndices(), dtype=np.int64)
    for used in (rows, columns, given):
        used.destroy()
    return order


def _groups(graph: scipy.sparse.csr_array, inside: int) -> list[_Group]:
    """Groups of nodes that leave the same ones, children first: the first `inside` nodes go."""
    later_ones = scipy.sparse.triu(graph, 1, format="csr")
    starts, columns = later_ones.indptr.tolist(), later_ones.indices.tolist()
    left: list[set[int]] = []
    children: list[list[int]] = [[] for _ in range(inside)]
    group_of: list[_Group] = []
    groups = []
    for j in range(inside):
        later = set(columns[starts[j] : starts[j + 1]])
        below = children[j]
        if len(below) == 1 and later <= left[below[0]]:
            group = group_of[below[0]]
            group.nodes.append(j)
            now = group.left
            now.remove(j)
        else:
            now = later.union(*(left[child] for child in below))
            now.discard(j)
            group = _Group([j], now, [group_of[child] for child in below])
            groups.append(group)
        left.append(now)
        group_of.append(group)
        parent = j + 1 if j + 1 in now else min(now, default=inside)
        if parent < inside:
            children[parent].append(j)
    return groups


def _merged(groups: Sequence[_Group], sizes: Ints) -> list[_Group]:
    """Merge groups with those above them; the ones that remain at the top."""
    size = sizes.tolist()
    top: dict[int, _Group] = {}
    for group in groups:  # children first
        group.size = sum(map(size.__getitem__, group.nodes))
        group.below = sum(map(size.__getitem__, group.left))
        top[id(group)] = group
        children = group.children
        group.children = []
        for child in sorted(children, key=lambda one: -one.size):
            del top[id(child)]
            if not _merge(group, child):
                group.children.append(child)
    return list(top.values())


def _merge(group: _Group, child: _Group) -> bool:
    """Let a group take in one below it, if few zeros come into the factor; whether it does."""
    size = group.size + child.size
    entries = _entries(size, group.below)
    apart = _entries(group.size, group.below) + _entries(child.size, child.below)
    zeros = entries - apart + group.zeros + child.zeros
    share = next(share for most, share in _MERGED if size <= most)
    if zeros > share * entries:
        return False
    group.nodes = child.nodes + group.nodes
    group.children += child.children
    group.size, group.zeros = size, zeros
    return True


def _entries(size: int, below: int) -> int:
    """Entries of the factor of a group."""
    return size * (size + 1) // 2 + size * below


def _children_first(top: Iterable[_Group]) -> Iterator[_Group]:
    """All groups, those below first."""
    waiting = [(group, False) for group in top]
    while waiting:
        group, done = waiting.pop()
        if done:
            yield group
        else:
            waiting.append((group, True))
            waiting += [(child, False) for child in group.children]


def _each(first: Ints, sizes: Ints) -> Ints:
    """Numbers from each first one on, as many as its size."""
    ends = np.cumsum(sizes)
    return np.repeat(first - ends + sizes, sizes) + np.arange(ends[-1] if len(ends) else 0)
