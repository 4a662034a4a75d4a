"""The tangent of the contact unknowns: dense blocks of the bodies and what contacts add."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats, Ints, Sparse
from anisocontact.contact.quadrature import Couplings
from anisocontact.solver.strategies.condensed.assembly_map import AssemblyMap, OppositeNodes
from anisocontact.solver.strategies.condensed.front import Front, Reals, follow

DenseBlock = tuple[slice, Floats]

#: Share of the diagonal of the bodies that counts as a change of a row by contacts.
CLEARLY = 0.1


def blocks_times(blocks: Sequence[DenseBlock], x: Floats) -> Floats:
    """Product of symmetric blocks on the diagonal with a vector; what no block covers is zero."""
    out = np.zeros(len(x))
    for place, block in blocks:
        # half of the memory is read that a product with a general matrix reads
        out[place] = scipy.linalg.blas.dsymv(1.0, block, x[place], lower=1)
    return out


class ContactTangent:
    """`S` plus the tangent of the contacts, never summed up but to be factorised.

    Args:
        blocks: Blocks of S on the diagonal.
        number: Contact unknown of each unknown of the system, -1 for all others, (n,).
        count: Number of contact unknowns; those behind the blocks have no part in S.
        spread: Where constraints make unknowns of the system follow from contact unknowns: the
            former from the latter, (n, c), and `number` does not count.

    Attributes:
        kind: Precision of all that factors and corrections are made of: single, until `double`.
        scale: Largest stiffness: forces are over it in single precision, for any units.
        summed: The tangent of the contacts over `scale`, in w, (c, c).
        basis: B, unknowns from w: what slave nodes at the middle of an edge do less what those at
            its ends do has an unknown of its own, as its gap has; None where w is u, (c, c).
        shares: How slave nodes follow the place opposite, see `Front`, (c, c).
        stiff: Diagonal of S over `scale`, (c,).
    """

    def __init__(
        self,
        blocks: Sequence[DenseBlock],
        number: Ints,
        count: int,
        spread: scipy.sparse.csr_array | None = None,
    ) -> None:
        self.count, self._spread = count, spread
        self.kind: type[np.float32] | type[np.float64] = np.float32
        self.scale = max((float(np.abs(np.diagonal(b)).max()) for _, b in blocks), default=1.0)
        self._blocks = blocks
        self._scaled: list[tuple[slice, Reals]] = []
        self._places = AssemblyMap(number if spread is None else np.arange(len(number)))
        self._contact = scipy.sparse.csr_array((count, count))
        self._known: tuple[Floats, Floats] | None = None
        self._beside: Sequence[OppositeNodes] = ()
        self._slaves = np.zeros(count, dtype=np.bool_)
        self.basis: Sparse | None = None
        self.shares = self.summed = self._contact.astype(self.kind)
        self.stiff = np.zeros(count)
        for place, block in blocks:
            self.stiff[place] = np.diagonal(block) / self.scale

    def take(
        self,
        couplings: Sequence[Couplings],
        opposite: Sequence[OppositeNodes] = (),
        beside: Sequence[OppositeNodes] = (),
    ) -> None:
        """Replace the tangent of the contacts.

        Args:
            couplings: The tangent.
            opposite: What slave nodes are held against, see `Contacts.opposite`.
            beside: Slave nodes whose gaps are theirs less those of others, see `Contacts.beside`.
        """
        size = self.count if self._spread is None else self._spread.shape[0]
        contact = self._places.total(couplings, size)
        if self._spread is not None:
            contact = (self._spread.T @ contact @ self._spread).tocsr()
            opposite = beside = ()
        self._contact, self._beside, self._known = contact, beside, None
        self._sum_up()
        self.shares, self._slaves = self._places.shares(opposite, self.count)

    def double(self) -> None:
        """Have all of it in double precision from now on."""
        self.kind, self._scaled = np.float64, []
        self._sum_up()

    def forget(self) -> None:
        """Give back the memory of what is made again when it is asked for."""
        self._scaled = []

    def _sum_up(self) -> None:
        contact = self._contact
        parts = ((contact.data / self.scale).astype(self.kind), contact.indices, contact.indptr)
        self.summed = scipy.sparse.csr_array(parts, shape=contact.shape)
        follows = self._places.following(self._beside, self.count).astype(self.kind)
        self.basis = None
        if follows.nnz:
            one = scipy.sparse.eye_array(self.count, dtype=self.kind)
            self.basis = (one + follows).tocsr()
            self.summed = (self.basis.T @ self.summed @ self.basis).tocsr()

    def times(self, x: Floats) -> Floats:
        """The product with a vector, (c,); of a correction it is asked for twice."""
        if self._known is None or not np.array_equal(self._known[0], x):
            self._known = x.copy(), self._contact @ x + blocks_times(self._blocks, x)
        return self._known[1].copy()

    def bodies_times(self, x: Reals) -> Reals:
        """The product of S over `scale`, in w, with a vector that is zero on most blocks, (c,)."""
        if not self._scaled:
            self._scaled = [(place, self._over_scale(block)) for place, block in self._blocks]
        x = x if self.basis is None else self.basis @ x
        out = np.zeros_like(x)
        (product,) = scipy.linalg.get_blas_funcs(("symv",), (x,))
        for place, block in self._scaled:
            if x[place].any():
                out[place] = product(1.0, block, x[place], lower=1)
        return out if self.basis is None else np.asarray(self.basis.T @ out)

    def front(self, whole: bool = False) -> Front:
        """S with all unknowns eliminated that contacts of now do not hold.

        Args:
            whole: Whether nothing is to be eliminated.

        Raises:
            ZeroDivisionError: What is to be eliminated is singular.
        """
        if whole or not self.shares.nnz:
            none = scipy.sparse.csr_array((self.count, self.count), dtype=self.kind)
            return self.front_of(none, np.ones(self.count, dtype=np.bool_))
        turned = (scipy.sparse.eye_array(self.count, dtype=self.kind) + self.shares).tocsr()
        stays = self._slaves | self._clearly(turned.T @ self.summed @ turned)
        return self.front_of(self.shares, stays | (self.stiff == 0.0))

    def front_of(self, shares: Sparse, stays: Flags) -> Front:
        """The same with what is known of it, see `Front`."""
        self.forget()
        return Front(self._bodies, shares, stays)

    def _bodies(self) -> Reals:
        """S over `scale`, in w, (c, c)."""
        matrix: Reals = np.zeros((self.count, self.count), dtype=self.kind, order="F")
        for place, block in self._blocks:
            np.divide(block, self.scale, out=matrix[place, place], casting="same_kind")
        if self.basis is not None:
            follow(matrix, self.basis - scipy.sparse.eye_array(self.count, dtype=self.kind))
        return matrix

    def _over_scale(self, block: Floats) -> Reals:
        """A block of S over `scale`."""
        out: Reals = np.empty_like(block, dtype=self.kind)
        return np.divide(block, self.scale, out=out, casting="same_kind")

    def _clearly(self, change: Sparse) -> Flags:
        """Rows in which a change, over `scale`, is more than a share of the bodies' stiffness."""
        return np.asarray(abs(change).max(axis=1).toarray().ravel() > CLEARLY * self.stiff)
