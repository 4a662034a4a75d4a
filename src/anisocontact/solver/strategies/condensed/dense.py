"""The tangent of the contact unknowns: dense blocks of the bodies and what contacts add."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.contact.quadrature import Couplings
from anisocontact.solver.strategies.condensed.front import Front, Sparse
from anisocontact.solver.strategies.condensed.places import Opposite, Places

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Singles = npt.NDArray[np.float32]
Block = tuple[slice, Floats]

#: Share of the diagonal of the bodies that counts as a change of a row by contacts.
CLEARLY = 0.1


def blocks_times(blocks: Sequence[Block], x: Floats) -> Floats:
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
        scale: Largest stiffness: forces are over it in single precision, for any units.
        summed: The tangent of the contacts over `scale` in single precision, (c, c).
        shares: How slave nodes follow the place opposite, see `Front`, (c, c).
    """

    def __init__(
        self,
        blocks: Sequence[Block],
        number: Ints,
        count: int,
        spread: scipy.sparse.csr_array | None = None,
    ) -> None:
        self.count, self._spread = count, spread
        self.scale = max((float(np.abs(np.diagonal(b)).max()) for _, b in blocks), default=1.0)
        self._blocks = blocks
        self._singles: list[tuple[slice, Singles]] = []
        self._places = Places(number if spread is None else np.arange(len(number)))
        self._contact = scipy.sparse.csr_array((count, count))
        self._slaves = np.zeros(count, dtype=np.bool_)
        self.shares = self.summed = self._contact.astype(np.float32)
        self._stiff = np.zeros(count)
        for place, block in blocks:
            self._stiff[place] = np.diagonal(block) / self.scale

    def take(self, couplings: Sequence[Couplings], opposite: Sequence[Opposite] = ()) -> None:
        """Replace the tangent of the contacts.

        Args:
            couplings: The tangent.
            opposite: What slave nodes are held against, see `Contacts.opposite`.
        """
        size = self.count if self._spread is None else self._spread.shape[0]
        contact = self._places.total(couplings, size)
        if self._spread is not None:
            contact = (self._spread.T @ contact @ self._spread).tocsr()
            opposite = ()
        self._contact = contact
        parts = ((contact.data / self.scale).astype(np.float32), contact.indices, contact.indptr)
        self.summed = scipy.sparse.csr_array(parts, shape=contact.shape)
        self.shares, self._slaves = self._places.shares(opposite, self.count)

    def times(self, x: Floats) -> Floats:
        """The product with a vector, (c,)."""
        return np.asarray(self._contact @ x + blocks_times(self._blocks, x))

    def whole(self) -> Floats:
        """All of it, (c, c)."""
        matrix: Floats = self._contact.toarray(order="F")
        for place, block in self._blocks:
            matrix[place, place] += block
        return matrix

    def bodies_times(self, x: Singles) -> Singles:
        """The product of S over `scale` with a vector that is zero on most blocks, (c,)."""
        if not self._singles:
            self._singles = [(place, self._single(block)) for place, block in self._blocks]
        out = np.zeros_like(x)
        for place, block in self._singles:
            if x[place].any():
                out[place] = scipy.linalg.blas.ssymv(1.0, block, x[place], lower=1)
        return out

    def front(self, whole: bool = False) -> Front:
        """S with all unknowns eliminated that contacts of now do not hold.

        Args:
            whole: Whether nothing is to be eliminated.

        Raises:
            ZeroDivisionError: What is to be eliminated is singular.
        """
        if whole or not self._slaves.any():
            none = scipy.sparse.csr_array((self.count, self.count), dtype=np.float32)
            return self.front_of(none, np.ones(self.count, dtype=np.bool_))
        turned = (scipy.sparse.eye_array(self.count, dtype=np.float32) + self.shares).tocsr()
        stays = self._slaves | self.clearly(turned.T @ self.summed @ turned)
        return self.front_of(self.shares, stays | (self._stiff == 0.0))

    def front_of(self, shares: Sparse, stays: Flags) -> Front:
        """The same with what is known of it, see `Front`."""
        self._singles = []  # gives the memory back
        return Front(self._bodies, shares, stays)

    def _bodies(self) -> Singles:
        """S over `scale`, (c, c)."""
        matrix = np.zeros((self.count, self.count), dtype=np.float32, order="F")
        for place, block in self._blocks:
            np.divide(block, self.scale, out=matrix[place, place], casting="same_kind")
        return matrix

    def _single(self, block: Floats) -> Singles:
        """A block of S over `scale`."""
        out: Singles = np.empty_like(block, dtype=np.float32)
        return np.divide(block, self.scale, out=out, casting="same_kind")

    def clearly(self, change: Sparse, share: float = CLEARLY) -> Flags:
        """Rows in which a change, over `scale`, is more than a share of the bodies' stiffness."""
        return np.asarray(abs(change).max(axis=1).toarray().ravel() > share * self._stiff)
