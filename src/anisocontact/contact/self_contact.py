"""Self-contact: which facets of a surface that meets itself are slaves.

Of two facets that face each other one is the slave, so that every gap is held once, by multipliers
that the displacements can hold: the sides of a surface that folds onto itself are told apart where
it does. The graph of the pairs is coloured with two colours along its minimum spanning tree, the
closest pairs first. What faces one another facet by facet, as the faces of a slit whose meshes
match, is in as many parts, and facets that go on smoothly beside each other have one colour where
pairs leave it open, at the round end of a fold last of all. A facet keeps its colour, and with it
the nodes their history, while anything faces it. Where the tree leaves a pair of one colour, as
where three walls meet, the facet with the lower number is the slave of that pair.
"""

from __future__ import annotations

import numpy as np
import scipy

from anisocontact.base.array_types import Codes, Flags, Floats, Ints, Sparse
from anisocontact.contact.facet_pairs import FacetPairs
from anisocontact.contact.master_surface import MasterSurface
from anisocontact.contact.sharp_edges import SMOOTH, Around
from anisocontact.contact.slave_nodes import SlaveNodes

#: Colours of a facet that faces another one.
SLAVE, MASTER = 1, -1


class SelfContactSides:
    """Sides of the facets of a group that meets itself, the same on all processes; collective.

    Args:
        points: The slave nodes, with the facets around them.
        surface: The group as its own master.
        normals: Outward unit normals of the facets in the reference configuration, (m, 3).
    """

    def __init__(self, points: SlaveNodes, surface: MasterSurface, normals: Floats) -> None:
        self._around, self._comm = points.around, surface.comm
        self._numbers = surface.in_group(points.keys)
        beside = self._numbers[_smooth_neighbours(self._around, normals)]
        self._beside: Ints = np.concatenate(self._comm.allgather(beside))
        count = self._comm.allreduce(len(surface.own.nodes))
        self._side: Codes = np.zeros(count, dtype=np.int8)
        self._accepted = self._side
        self._faced: Ints = np.zeros(0, dtype=np.int64)

    def oriented(self, pairs: FacetPairs, masters: Ints) -> FacetPairs:
        """Those pairs of which the first facet is the slave; collective.

        Facets that face others for the first time take sides until `commit` or `roll_back`.

        Args:
            pairs: Pairs of facets that face each other.
            masters: Numbers in the whole group of the facets of the master here.
        """
        first, second = self._numbers[pairs.slave], masters[pairs.master]
        self._faced = np.union1d(first, second)
        if any(self._comm.allgather(bool((self._side[self._faced] == 0).any()))):
            found = self._comm.allgather((first, second, pairs.apart))
            gathered = map(np.concatenate, zip(*found, strict=True))
            self._side = with_sides(self._side, self._beside, *gathered)
        one, other = self._side[first], self._side[second]
        return pairs.take(np.where(one != other, one > other, first < second))

    def commit(self) -> None:
        """Keep the sides of facets that face another one; collective."""
        faced = np.concatenate(self._comm.allgather(self._faced))
        self._accepted = np.zeros_like(self._side)
        self._accepted[faced] = self._side[faced]
        self._side = self._accepted

    def roll_back(self) -> None:
        """Return to the sides of the accepted increment."""
        self._side = self._accepted

    def persistent(self) -> Ints:
        """Accepted sides of the facets around each node, (n, k): number and one, times side."""
        offsets, facets = self._around.offsets, self._numbers[self._around.facets]
        counts = np.diff(offsets)
        width = max(self._comm.allgather(int(counts.max(initial=0))))
        kept = np.zeros((len(counts), width), dtype=np.int64)
        kept[np.arange(width) < counts[:, None]] = (facets + 1) * self._accepted[facets]
        return kept

    def restore(self, kept: Ints) -> None:
        """Go on from what `persistent` gave; collective."""
        known = np.concatenate(self._comm.allgather(np.unique(kept[kept != 0])))
        self._accepted = np.zeros_like(self._side)
        self._accepted[np.abs(known) - 1] = np.sign(known)
        self._side = self._accepted


def _smooth_neighbours(around: Around, normals: Floats) -> Ints:
    """Pairs of facets that share a node and go on smoothly, (k, 2).

    Args:
        around: The facets around each node.
        normals: Outward unit normals of all facets, (m, 3).
    """
    shape = (len(around.offsets) - 1, len(normals))
    at = scipy.sparse.csr_array((np.ones(len(around.facets)), around.facets, around.offsets), shape)
    pairs = np.stack(scipy.sparse.triu(at.T @ at, 1).coords, axis=1).astype(np.int64)
    along = np.einsum("pi,pi->p", normals[pairs[:, 0]], normals[pairs[:, 1]])
    return np.asarray(pairs[along > SMOOTH])


def with_sides(side: Codes, beside: Ints, first: Ints, second: Ints, apart: Floats) -> Codes:
    """Sides of facets that have some, and of others that face each other.

    Two more nodes of the graph face the slaves and the masters that are known, and each other. In
    parts where none is known the side of more facets, the finer one, is the slave; of as many that
    of the lowest number.

    Args:
        side: Sides of all facets, 0 for none, (n,).
        beside: Pairs of facets of one side, where those that face each other leave it open, (k, 2).
        first: One facet of each pair, (p,).
        second: The other one.
        apart: Distance of the pairs, (p,).
    """
    n = len(side)
    known = np.flatnonzero(side)
    faced = np.union1d(first, second)
    beside = beside[np.isin(beside, faced).all(axis=1)]
    rank = np.empty(len(apart))
    rank[np.argsort(apart, kind="stable")] = np.arange(len(apart)) + 2.0
    last = len(apart) + 2.0
    rows = [known, [n], np.minimum(first, second), beside.min(axis=1)]
    columns = [n + (side[known] == MASTER), [n + 1], np.maximum(first, second), beside.max(axis=1)]
    length = [np.ones(len(known) + 1), rank, last + _ends(n, beside, first, second)]
    tree = _spanning_tree(n + 2, *map(np.concatenate, (rows, columns, length)))
    alike = tree * (tree >= last)
    opposed = tree - alike
    # a facet and its image are in one part with those at an odd and at an even distance
    twofold = scipy.sparse.block_array([[alike, opposed], [opposed, alike]])
    parts, part = scipy.sparse.csgraph.connected_components(twofold, directed=False)
    own, opposite = part[: n + 2], part[n + 2 :]
    size = np.bincount(own, np.repeat([1.0, 0.0, n + 1.0], [n, 1, 1]), minlength=parts)
    lowest = np.full(parts, n)
    np.minimum.at(lowest, own, np.arange(n + 2))
    slave = np.where(
        size[own] != size[opposite],
        size[own] > size[opposite],
        lowest[own] < lowest[opposite],
    )
    out = side.copy()
    taken = faced[side[faced] == 0]
    out[taken] = np.where(slave[taken], SLAVE, MASTER)
    return out


def _ends(n: int, beside: Ints, first: Ints, second: Ints) -> Flags:
    """Which smooth neighbours face neither one facet nor facets beside each other, (k,).

    So it is at the end of a fold, where the surface goes on from one side to the other.
    """
    facing, near = _graph(n, first, second), _graph(n, *beside.T)
    beside_those = facing[beside[:, 0]] @ (near + scipy.sparse.eye_array(n, format="csr"))
    return np.asarray(beside_those.multiply(facing[beside[:, 1]]).sum(axis=1) == 0.0)


def _graph(n: int, first: Ints, second: Ints) -> Sparse:
    """Both directions of edges between n nodes."""
    rows, columns = np.append(first, second), np.append(second, first)
    return scipy.sparse.csr_array((np.ones(len(rows)), (rows, columns)), (n, n))


def _spanning_tree(n: int, rows: Ints, columns: Ints, length: Floats) -> Sparse:
    """Minimum spanning tree of a graph of n nodes, of which edges may be given several times."""
    order = np.lexsort((length, columns, rows))
    new = np.ones(len(order), dtype=bool)
    new[1:] = np.any(np.diff(np.stack([rows, columns])[:, order], axis=1) != 0, axis=0)
    kept = order[new]
    graph = scipy.sparse.csr_array((length[kept], (rows[kept], columns[kept])), (n, n))
    return scipy.sparse.csr_array(scipy.sparse.csgraph.minimum_spanning_tree(graph))
