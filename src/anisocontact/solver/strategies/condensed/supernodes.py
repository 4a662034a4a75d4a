"""Which columns of a sparse symmetric matrix are eliminated together, and in which order."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from anisocontact.base.array_types import Ints

#: Nodes of a subtree up to which all of it is eliminated together.
_TOGETHER = 24
#: Nodes up to which supernodes are merged with the one above, and share of zeros stored beyond.
_SMALL, _ZEROS = 16, 0.1


@dataclass
class Supernodes:
    """Nodes that are eliminated together.

    Attributes:
        order: Nodes in the order in which they are eliminated, (interior,).
        begin: Where each begins in that order, and where the last one ends.
        above: The one that takes what each leaves; their number for the border.
        rows: Places in that order of the rows below each, increasing; nodes of the border stay.
    """

    order: Ints
    begin: list[int]
    above: list[int]
    rows: list[Ints]


def supernodes(graph: scipy.sparse.csr_array, interior: int) -> Supernodes:
    """Supernodes of a matrix whose nodes are in a good order, those of the border last.

    Args:
        graph: Which nodes are coupled, symmetric, (n, n).
        interior: Nodes that are eliminated.
    """
    parent = _elimination_tree(graph, interior)
    sizes = [1] * interior
    for node, top in enumerate(parent):  # numbers grow towards the border
        if top < interior:
            sizes[top] += sizes[node]
    group, order = _grouped(parent, sizes), _postorder(parent)
    starts = [p for p, node in enumerate(order) if p == 0 or group[node] != group[order[p - 1]]]
    begin = [*starts, interior]
    number = {group[order[p]]: k for k, p in enumerate(starts)}
    tops = [parent[order[end - 1]] for end in begin[1:]]
    above = [number[group[top]] if top < interior else len(starts) for top in tops]
    made = Supernodes(np.array(order, dtype=np.int64), begin, above, [])
    made.rows = _rows(graph, made)
    return _merged(made)


def _elimination_tree(graph: scipy.sparse.csr_array, interior: int) -> list[int]:
    """The node above each of the interior [Liu 1990]; the border is one, `interior`."""
    lower = scipy.sparse.tril(graph, -1, format="csr")
    starts, columns = lower.indptr.tolist(), lower.indices.tolist()
    parent, ancestor = [interior] * interior, [-1] * interior
    for node in range(graph.shape[0]):
        top = min(node, interior)
        for first in columns[starts[node] : starts[node + 1]]:
            one = first
            while one < top:
                ahead, ancestor[one] = ancestor[one], top
                if ahead < 0:
                    parent[one] = top
                    break
                one = ahead
    return parent


def _grouped(parent: list[int], sizes: list[int]) -> list[int]:
    """A number for nodes of the same small subtree, or of the same chain above those."""
    root = len(parent)
    group = list(range(root))
    for node in reversed(range(root)):
        top = parent[node]
        if top < root and sizes[top] <= _TOGETHER:
            group[node] = group[top]
    for node, top in enumerate(parent):
        if top < root and sizes[node] > _TOGETHER and sizes[top] == sizes[node] + 1:
            group[top] = group[node]
    return group


def _postorder(parent: list[int]) -> list[int]:
    """Nodes, each behind all below it."""
    root = len(parent)
    children: list[list[int]] = [[] for _ in range(root + 1)]
    for node, top in enumerate(parent):
        children[top].append(node)
    order, stack = [], [root]
    while stack:
        node = stack.pop()
        order.append(node)
        stack += children[node]
    return order[:0:-1]


def _rows(graph: scipy.sparse.csr_array, nodes: Supernodes) -> list[Ints]:
    """Rows below supernodes: those of the matrix, and those that what is below them leaves."""
    count = graph.shape[0]
    at = np.append(nodes.order, np.arange(len(nodes.order), count))
    ordered = graph[at][:, at].tocsr()
    left: list[list[Ints]] = [[] for _ in range(len(nodes.above) + 1)]
    rows: list[Ints] = []
    mark = np.zeros(count, dtype=np.bool_)
    for number, ((a, b), top) in enumerate(zip(pairwise(nodes.begin), nodes.above, strict=True)):
        for some in (ordered.indices[ordered.indptr[a] : ordered.indptr[b]], *left[number]):
            mark[some] = True
        mark[:b] = False
        found = np.flatnonzero(mark)
        mark[found] = False
        rows.append(found)
        left[top].append(found)
    return rows


def _merged(nodes: Supernodes) -> Supernodes:
    """Supernodes merged with the one above where that stores few zeros [Ashcraft Grimes 1989]."""
    count, rows, above = len(nodes.above), nodes.rows, list(nodes.above)
    parts = [[(a, b)] for a, b in pairwise(nodes.begin)]
    width, zeros = [b - a for a, b in pairwise(nodes.begin)], [0.0] * count
    children: list[list[int]] = [[] for _ in range(count + 1)]
    for one in range(count):
        kept: list[int] = []
        for below in children[one]:
            both, length = width[below] + width[one], len(rows[one])
            missing = width[below] * (width[one] + length - len(rows[below]))
            stored = zeros[below] + zeros[one] + missing
            if both > _SMALL and stored > _ZEROS * both * (0.5 * both + length):
                kept.append(below)
                continue
            zeros[one], width[one] = stored, both
            parts[one] = parts[below] + parts[one]
            kept += children[below]
        for below in kept:
            above[below] = one
        children[one] = kept
        children[above[one]].append(one)
    walk, stack = [], list(children[count])
    while stack:
        walk.append(stack.pop())
        stack += children[walk[-1]]
    return _taken(nodes, walk[::-1], parts, above)


def _taken(
    nodes: Supernodes, walk: list[int], parts: list[list[tuple[int, int]]], above: list[int]
) -> Supernodes:
    """Those of `walk`, in that order, made of parts of the old order."""
    picked = [np.concatenate([np.arange(a, b) for a, b in parts[one]]) for one in walk]
    places, interior = np.concatenate(picked), len(nodes.order)
    last = max((int(rows[-1]) for rows in nodes.rows if len(rows)), default=0)
    rank = np.arange(max(last + 1, interior))
    rank[places] = np.arange(interior)
    number = {one: k for k, one in enumerate(walk)} | {len(nodes.above): len(walk)}
    return Supernodes(
        nodes.order[places],
        np.cumsum([0, *map(len, picked)]).tolist(),
        [number[above[one]] for one in walk],
        [np.sort(rank[nodes.rows[one]]) for one in walk],
    )
