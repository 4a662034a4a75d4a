"""Matrix of bodies that touch: the pattern of the bulk and couplings of nodes and rigid bodies."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.contact.quadrature import Couplings
from anisocontact.contact.reachable import NodePairs
from anisocontact.contact.remote_nodes import globally
from anisocontact.mesh.node_unknowns import NodeUnknowns
from anisocontact.mesh.split import Route, Split

#: Couplings over those that are needed or foreseen, at which the others lose their places.
MOST_LEFT = 2.0


class CoupledTangent:
    """Matrix with room for the bulk and for blocks that couple nodes of different bodies.

    The bulk is assembled straight into it, between `make_room` and `add`.

    Unknowns beyond those of the mesh come after them, on the last rank, and are counted in threes
    as nodes too. Couplings name a node by its local number, or by the number of local nodes plus
    its number in the whole mesh, which those beyond the mesh continue.

    The pattern has places for the couplings that are foreseen. It grows only where a slave point
    meets a facet that it was not expected on, and then with what is foreseen from there; the
    symbolic factorisation is reused in between. What is not foreseen any more keeps its place until
    it makes most of the pattern.

    Args:
        stiffness: Matrix of the bulk; its pattern stays.
        unknowns: Where the displacement of nodes is among those of the bulk.
        extra: Number of nodes beyond those of the mesh.
    """

    def __init__(self, stiffness: Mat, unknowns: NodeUnknowns, extra: int = 0) -> None:
        self._stiffness, self._unknowns = stiffness, unknowns
        self._lg = stiffness.getLGMap()
        self._comm = comm = unknowns.comm
        self._space = space = unknowns.nodes
        (own, total), _ = stiffness.getSizes()
        added = 3 * extra
        self._size = (own + added * (comm.rank == comm.size - 1), total + added)
        index_map = space.dofmap.index_map
        local = index_map.size_local + index_map.num_ghosts
        #: What couplings call the first node beyond those of the mesh.
        self.first_extra = int(local + index_map.size_global)
        self._numbers = self.first_extra + extra
        self._first, _ = stiffness.getOwnershipRange()
        self._keys: Ints = np.empty(0, dtype=np.int64)
        self._given = self._keys
        self._sum = scipy.sparse.csr_array((0, 0), dtype=np.float64)
        self._blocks: Floats = np.empty((0, 9))

    @property
    def pattern(self) -> Ints:
        """Couplings that have a place, pairs of nodes as one number each.

        The order of elimination depends on them, and with it the last bits of a solution.
        """
        return self._keys.copy()

    @pattern.setter
    def pattern(self, keys: Ints) -> None:
        self._keys = keys.copy()
        self._given = np.full(1, -1, dtype=np.int64)

    def placed(self) -> tuple[Ints, Ints, Floats]:
        """Couplings that have a place: nodes of rows and columns of the whole system, and blocks.

        Blocks are those of the last `make_room`, (k, 9); of a matrix just made there are none.
        """
        row, column = self._places()
        blocks = self._blocks if len(self._blocks) == len(row) else np.zeros((len(row), 9))
        return row, column, blocks

    def new_matrix(self, foreseen: Sequence[NodePairs] = ()) -> Mat:
        """Matrix for `make_room` and `add`.

        Args:
            foreseen: Nodes that will be coupled, without which the pattern is that of the bulk and
                of couplings that were there before.
        """
        if foreseen:
            self._keys = np.union1d(self._keys, self._named(foreseen))
            self._given = np.full(1, -1, dtype=np.int64)
        matrix = PETSc.Mat().create(self._comm)
        matrix.setSizes((self._size, self._size), bsize=self._unknowns.block)
        matrix.setType(PETSc.Mat.Type.AIJ)
        matrix.setLGMap(*self._lg)
        self._preallocate(matrix)
        return matrix

    def make_room(
        self, out: Mat, couplings: Sequence[Couplings], foresee: Callable[[], Sequence[NodePairs]]
    ) -> bool:
        """Let the pattern of a matrix of `new_matrix` grow where these couplings need it.

        Args:
            out: The matrix.
            couplings: The couplings.
            foresee: Asked where it grows which nodes will be coupled from now on.

        Returns:
            Whether it has grown; its entries are gone then. On several processes PETSc does not
            notice, so that what was factorised with the old pattern has to be thrown away.
        """
        keys, blocks = _pairs(couplings, self._numbers)
        changed = not np.array_equal(keys, self._given)
        grown = False
        if self._comm.allreduce(changed):
            grown = self._locate(keys, out, foresee)
        self._blocks = self._sum @ blocks
        return grown

    def add(self, out: Mat) -> None:
        """Add the couplings of `make_room` to the bulk in the matrix, and assemble it."""
        row, column = self._places()
        blocks = self._blocks.reshape(-1, 3, 3)
        self._unknowns.add_blocks(out, row[:, None], column[:, None], blocks)
        out.assemble()

    def _locate(self, keys: Ints, out: Mat, foresee: Callable[[], Sequence[NodePairs]]) -> bool:
        """Places of the blocks of `keys`; whether the pattern grows by some that are new."""
        there = np.flatnonzero(keys >= 0)
        unknown = np.unique(keys[there][~_found(self._keys, keys[there])])
        grown = bool(self._comm.allreduce(unknown.size) > 0)
        if grown:
            foreseen = self._named(foresee())
            needed = np.union1d(foreseen, keys[there])
            whole = np.union1d(self._keys, needed)
            left = len(foreseen) > 0 and len(whole) > MOST_LEFT * len(needed)
            self._keys = needed if left else whole
            self._preallocate(out)
        places = np.searchsorted(self._keys, keys[there])
        entries = (np.ones(len(there)), (places, there))
        self._sum = scipy.sparse.csr_array(entries, shape=(len(self._keys), len(keys)))
        self._given = keys
        return grown

    def _preallocate(self, matrix: Mat) -> None:
        pairs, block = self._of_bulk() + self._of_couplings(), self._unknowns.block
        full = np.ones((pairs.nnz, block, block), dtype=bool)
        sides = (side.astype(PETSc.IntType) for side in (pairs.indices, pairs.indptr))
        whole = scipy.sparse.bsr_array((full, *sides), shape=self._size).tocsr()
        matrix.setPreallocationCSR((whole.indptr, whole.indices))
        matrix.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        matrix.assemble()

    def _of_bulk(self) -> scipy.sparse.csr_array:
        """Pattern of the bulk in the rows of this rank, columns of the whole system, in blocks."""
        own, total = (size // self._unknowns.block for size in self._size)
        step = self._unknowns.block
        (unknowns, _), _ = self._stiffness.getSizes()
        first = PETSc.IS().createStride(unknowns // step, self._first, step, self._comm)
        part = self._stiffness.createSubMatrix(first, first)
        starts, columns, _ = part.getValuesCSR()
        part.destroy()
        starts = np.append(starts, [starts[-1]] * (own + 1 - len(starts)))
        there = np.ones(len(columns), dtype=bool)
        return scipy.sparse.csr_array((there, columns, starts), shape=(own, total))

    def _of_couplings(self) -> scipy.sparse.csr_array:
        """The same of the couplings that any rank has; collective."""
        own, total = (size // self._unknowns.block for size in self._size)
        rows, columns = self._unknowns.blocks(*self._places())
        owners = Split(self._comm, own)
        route = Route(self._comm, owners.owner(rows))
        rows, columns = route.there(rows) - owners.first, route.there(columns)
        there = np.ones(len(rows), dtype=bool)
        return scipy.sparse.csr_array((there, (rows, columns)), shape=(own, total))

    def _named(self, pairs: Sequence[NodePairs]) -> Ints:
        """Each pair of nodes once, as one number."""
        found = [_keys(rows, columns, self._numbers) for rows, columns in pairs]
        named = np.unique(np.concatenate([self._keys[:0], *found]))
        return named[named >= 0]

    def _places(self) -> tuple[Ints, Ints]:
        """Nodes of the rows and of the columns of the couplings, numbers in the whole system."""
        row, column = np.divmod(self._keys, self._numbers)
        return globally(row, self._space), globally(column, self._space)


def _found(known: Ints, keys: Ints) -> Flags:
    """Whether each key is among those that are known, which are sorted."""
    if not len(known):
        return np.zeros(len(keys), dtype=bool)
    places = np.minimum(np.searchsorted(known, keys), len(known) - 1)
    return np.asarray(known[places] == keys)


def _keys(rows: Locals, columns: Locals, nodes: int) -> Ints:
    """Pairs of nodes as one number each, -1 for none: of rows (p, r) and columns (p, c)."""
    pair = rows[:, :, None].astype(np.int64) * nodes + columns[:, None, :]
    missing = (rows[:, :, None] < 0) | (columns[:, None, :] < 0)
    return np.where(missing, -1, pair).reshape(-1)


def _pairs(couplings: Sequence[Couplings], nodes: int) -> tuple[Ints, Floats]:
    """Pairs of nodes as one number each, -1 for none, and their 3 x 3 blocks as rows of nine."""
    keys, blocks = [np.empty(0, dtype=np.int64)], [np.empty((0, 9))]
    for rows, columns, values in couplings:
        keys.append(_keys(rows, columns, nodes))
        by_pair = values
        if values.ndim == 3:  # whole rows
            shape = (len(rows), rows.shape[1], 3, columns.shape[1], 3)
            by_pair = values.reshape(shape).swapaxes(2, 3)
        blocks.append(by_pair.reshape(-1, 9))
    return np.concatenate(keys), np.concatenate(blocks)
