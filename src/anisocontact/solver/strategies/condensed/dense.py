"""Newton corrections of the contact unknowns: a kept dense factor and Krylov iterations.

All of this is in single precision but the residual of a correction: products and solutions are
bound by the memory that they read.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.contact.quadrature import Couplings
from anisocontact.solver.strategies.condensed.wear import Wear
from anisocontact.solver.terms.persistent import Arrays

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Block = tuple[slice, Floats]

#: Krylov iterations after which the factor is renewed, if it costs no more.
PATIENCE = 24
#: Unknowns over solutions that cost as much as a factorisation: 2/3 n^3 operations at 70 Gflop/s
#: for n^2 entries read at 4.4 G/s, OpenBLAS on one core, and a quarter more for GMRES.
_SIZE_PER_SOLUTION = 30.0
#: See `Wear`: between increments much changes at once.
_LAST, _MARGIN = 1, 1.0
#: Residual that Krylov iterations in single precision reach before they begin anew.
_SINGLE = 1e-4
#: Most of such beginnings with one factor.
_ROUNDS = 4
#: Names of the tangent of the kept factor: entries, columns and starts of the rows; its wear.
_KEPT, _SPENT = ("tangent", "tangent_columns", "tangent_starts"), "tangent_spent"


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
        self._places = Places(number if spread is None else np.arange(len(number)))
        self._contact = scipy.sparse.csr_array((count, count))
        self.summed = self._contact.astype(np.float32)

    def take(self, couplings: Sequence[Couplings]) -> None:
        """Replace the tangent of the contacts."""
        size = self.count if self._spread is None else self._spread.shape[0]
        contact = self._places.total(couplings, size)
        if self._spread is not None:
            contact = (self._spread.T @ contact @ self._spread).tocsr()
        self._contact = contact
        parts = ((contact.data / self.scale).astype(np.float32), contact.indices, contact.indptr)
        self.summed = scipy.sparse.csr_array(parts, shape=contact.shape)

    def times(self, x: Floats) -> Floats:
        """The product with a vector, (c,)."""
        return np.asarray(self._contact @ x + blocks_times(self._blocks, x))

    def factor(self, contact: scipy.sparse.csr_array) -> Callable[[Singles], Singles]:
        """LU of `S` over `scale` plus a matrix, as a function that solves with it.

        Args:
            contact: `summed`, of now or earlier.

        Raises:
            ZeroDivisionError: The matrix is singular.
        """
        n = self.count
        matrix = np.zeros((n, n), dtype=np.float32, order="F")
        for place, block in self._blocks:
            np.divide(block, self.scale, out=matrix[place, place], casting="same_kind")
        entries = contact.tocoo()
        matrix[entries.row, entries.col] += entries.data
        lu, pivots, info = scipy.linalg.lapack.sgetrf(matrix, overwrite_a=1)
        if info != 0:
            raise ZeroDivisionError("the tangent is singular")

        def solve(b: Singles) -> Singles:
            return np.asarray(scipy.linalg.lapack.sgetrs(lu, pivots, b)[0])

        return solve


class Places:
    """Where couplings of nodes go in a matrix of the contact unknowns.

    They are found once for couplings of the same nodes, which most iterations have.

    Args:
        number: Row and column of each unknown of the nodes, -1 for those without, (n,).
    """

    def __init__(self, number: Ints) -> None:
        # one more node stands for "no node"
        self._number = np.append(number, [-1] * 3).reshape(-1, 3)
        self._keys: Ints = np.full(1, -1)

    def total(self, couplings: Sequence[Couplings], size: int) -> scipy.sparse.csr_array:
        """The sum of all couplings, (size, size)."""
        nodes = len(self._number)
        keys, blocks = [np.zeros(0, np.int64)], [np.zeros((0, 9))]
        for rows, columns, values in couplings:
            row, column = (side.astype(np.int64) % nodes for side in (rows, columns))
            keys.append((row[:, :, None] * nodes + column[:, None, :]).ravel())
            blocks.append(_pairs(values, rows.shape[1], columns.shape[1]))
        key = np.concatenate(keys)
        if not np.array_equal(key, self._keys):
            self._locate(key, size)
        if not len(key):
            return scipy.sparse.csr_array((size, size))
        sums = self._sum @ np.concatenate(blocks)
        parts = (sums.ravel()[self._entry.data], self._entry.indices, self._entry.indptr)
        return scipy.sparse.csr_array(parts, shape=(size, size))

    def _locate(self, key: Ints, size: int) -> None:
        """Sort pairs of nodes, each of them a number."""
        self._keys = key
        order = np.argsort(key, kind="stable")
        first = np.flatnonzero(np.diff(key[order], prepend=-1))
        starts = np.append(first, len(key))
        self._sum = scipy.sparse.csr_array(
            (np.ones(len(key)), order, starts), shape=(len(first), len(key))
        )
        pairs = np.divmod(key[order][first], len(self._number))
        row, column = (self._number[node] for node in pairs)
        shape = (len(first), 3, 3)
        rows, columns = (
            np.broadcast_to(row[:, :, None], shape),
            np.broadcast_to(column[:, None, :], shape),
        )
        there = (rows >= 0) & (columns >= 0)
        entry = np.arange(there.size).reshape(shape)[there]
        self._entry = scipy.sparse.csr_array((entry, (rows[there], columns[there])), (size, size))


def _pairs(values: Floats, r: int, c: int) -> Floats:
    """Blocks of `Couplings` of r by c nodes as those of their pairs, (p r c, 9)."""
    if values.ndim == 3:
        values = values.reshape(-1, r, 3, c, 3).swapaxes(2, 3)
    return values.reshape(-1, 9)


class KeptFactor:
    """Solves with a changing tangent; the factor of an earlier one is the preconditioner.

    Args:
        tangent: The tangent.

    Attributes:
        factors: Number of factorisations so far.
        iterations: Number of Krylov iterations so far.
    """

    def __init__(self, tangent: ContactTangent) -> None:
        self._tangent = tangent
        self._solve: Callable[[Singles], Singles] | None = None
        self._made_of: scipy.sparse.csr_array | None = None
        self._factor_cost = tangent.count / _SIZE_PER_SOLUTION
        self._patience = max(PATIENCE, int(self._factor_cost))
        self._wear = Wear(_LAST, _MARGIN)
        self.factors = 0
        self.iterations = 0

    def solve(self, b: Floats, rtol: float) -> Floats | None:
        """Correction for a right-hand side; None where the tangent is singular.

        Args:
            b: Right-hand side, (c,).
            rtol: Norm of the residual over that of `b` at which to stop.
        """
        known = np.zeros_like(b)
        if self._solve is not None and not self._wear.worn:
            known, left = self._improved(known, b, rtol)
            if left <= rtol:
                return known
        try:
            self._make(self._tangent.summed)
        except ZeroDivisionError:
            return None
        known, left = self._improved(known, b, rtol)
        # what single precision cannot do better is still a direction for the line search
        return known if left < 0.5 else None

    def persistent(self) -> Arrays:
        """The tangent of the contacts that the kept factor was made of, none without one."""
        made = self._made_of
        if made is None:
            return {}
        parts = (made.data, made.indices, made.indptr)
        return dict(zip(_KEPT, parts, strict=True)) | {_SPENT: self._wear.persistent()}

    def restore(self, kept: Arrays) -> None:
        """Make the factor of `persistent` again."""
        if _KEPT[0] in kept:
            n = self._tangent.count
            parts = tuple(kept[name] for name in _KEPT)
            self._make(scipy.sparse.csr_array(parts, shape=(n, n)))
            self._wear.restore(kept[_SPENT])

    def _make(self, contact: scipy.sparse.csr_array) -> None:
        self._solve = None  # gives the memory back
        self._solve = self._tangent.factor(contact)
        self._made_of = contact
        self._wear.begin(self._factor_cost)
        self.factors += 1

    def _improved(self, x: Floats, b: Floats, rtol: float) -> tuple[Floats, float]:
        """Krylov iterations from `x` on; the norm of the residual over that of `b` comes with it.

        In single precision, begun anew with the residual in double precision. With the kept factor
        of M the tangent is `A = M + D`, D what contacts have changed since, so that
        `A M^-1 v = v + D M^-1 v`: the product with the dense S is not needed.
        """
        solve, made_of = self._solve, self._made_of
        assert solve is not None and made_of is not None
        change = self._tangent.summed - made_of
        change.eliminate_zeros()

        def step(v: Singles) -> tuple[Singles, Singles]:
            direction = solve(v)
            return direction, v + change @ direction

        norm, most = float(np.linalg.norm(b)) or 1.0, self._patience
        rest, left = b - self._tangent.times(x) if x.any() else b, 1.0
        for _ in range(_ROUNDS):
            size = float(np.linalg.norm(rest)) or 1.0
            goal = max(rtol * norm / size, _SINGLE)
            unit = (rest / size).astype(np.float32)
            y, _, used = gmres(step, unit, 0.9 * goal, most)
            self.iterations += used
            better = x + y.astype(np.float64) * (size / self._tangent.scale)
            rest = b - self._tangent.times(better)
            now = float(np.linalg.norm(rest))
            most -= used
            if not now < size:
                break
            x, left = better, now / norm
            if left <= rtol or most <= 0:
                break
        self._wear.add(self._patience - most, left)
        return x, left


def gmres[T: (np.float32, np.float64)](
    step: Callable[[npt.NDArray[T]], tuple[npt.NDArray[T], npt.NDArray[T]]],
    b: npt.NDArray[T],
    rtol: float,
    most: int,
) -> tuple[npt.NDArray[T], float, int]:
    """Generalised minimal residuals, preconditioned from the right, without restart.

    Args:
        step: Approximate solution with the matrix, and the product of the matrix with it.
        b: Right-hand side, (n,); its precision is that of the vectors.
        rtol: Norm of the residual over that of `b` at which to stop.
        most: Most iterations.

    Returns:
        Solution, norm of its residual over that of `b`, number of iterations.

    Example:
        >>> gmres(lambda v: (v, 2.0 * v), np.array([4.0]), 1e-12, 5)
        (array([2.]), 0.0, 1)
    """
    norm = float(np.linalg.norm(b))
    if norm == 0.0:
        return np.zeros_like(b), 0.0, 0
    # SciPy's library alone: threads of NumPy's would wait for each other with those of SciPy's
    (product,) = scipy.linalg.get_blas_funcs(("gemv",), (b,))
    basis = np.empty((len(b), most + 1), dtype=b.dtype, order="F")
    directions = np.empty((len(b), most), dtype=b.dtype, order="F")
    basis[:, 0] = b / norm
    reduced = _Reduced(norm, most)
    left, used = 1.0, 0
    while used < most:
        directions[:, used], w = step(basis[:, used])
        used += 1
        column = np.zeros(used + 1)
        for _ in range(2):  # twice is enough for orthogonality to rounding
            shares = product(1.0, basis[:, :used], w, trans=1)
            column[:used] += shares
            w = product(-1.0, basis[:, :used], shares, beta=1.0, y=w)
        length = float(np.linalg.norm(w))
        column[used] = length
        left = reduced.add(column) / norm
        if left <= rtol or length == 0.0 or not np.isfinite(left):
            break
        basis[:, used] = w / length
    y = reduced.solution().astype(b.dtype)
    return product(1.0, directions[:, :used], y), left, used


class _Reduced:
    """Small problem of least squares in GMRES, made triangular by rotations as columns come.

    Source: Saad, Iterative methods for sparse linear systems, 6.5.3.

    Args:
        norm: Norm of the right-hand side.
        most: Most columns.
    """

    def __init__(self, norm: float, most: int) -> None:
        self._triangle = np.zeros((most, most))
        self._right = [norm]
        self._turns: list[tuple[float, float]] = []

    def add(self, column: Floats) -> float:
        """Take the next column of the Hessenberg matrix; the norm of the residual with it."""
        values = column.tolist()
        for i, (c, s) in enumerate(self._turns):
            upper, lower = values[i : i + 2]
            values[i : i + 2] = c * upper + s * lower, c * lower - s * upper
        upper, lower = values[-2:]
        size = math.hypot(upper, lower)
        c, s = (upper / size, lower / size) if size != 0.0 else (0.0, 1.0)
        self._turns.append((c, s))
        last = len(self._turns)
        self._triangle[:last, last - 1] = [*values[:-2], size]
        self._right[-1:] = [c * self._right[-1], -s * self._right[-1]]
        return abs(self._right[-1])

    def solution(self) -> Floats:
        """The coefficients that make the residual smallest."""
        count = len(self._turns)
        return np.linalg.lstsq(self._triangle[:count, :count], self._right[:-1])[0]
