"""Newton corrections of the contact unknowns: a kept dense factor and Krylov iterations."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt
import scipy.linalg

from anisocontact.contact.transfer import Couplings

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
Block = tuple[slice, Floats]

#: Krylov iterations after which the factor is renewed: about what a new one costs.
PATIENCE = 25
#: Krylov iterations with a factor of the same matrix: single precision needs a few.
MOST = 40


def blocks_times(blocks: Sequence[Block], x: Floats) -> Floats:
    """Product of symmetric blocks on the diagonal with a vector."""
    out = np.empty(len(x))
    for place, block in blocks:
        # half of the memory is read that a product with a general matrix reads
        out[place] = scipy.linalg.blas.dsymv(1.0, block, x[place], lower=1)
    return out


class ContactTangent:
    """`S` plus the tangent of the contacts, never summed up.

    Args:
        blocks: Blocks of S on the diagonal.
        number: Contact unknown of each unknown of the system, -1 for all others, (n,).
        count: Number of contact unknowns.
    """

    def __init__(self, blocks: Sequence[Block], number: Ints, count: int) -> None:
        self.count = count
        self._blocks = blocks
        # one more place takes what belongs to no contact unknown; it also stands for "no node"
        self._number = np.append(np.where(number < 0, count, number), [count] * 3)
        self._couplings: list[tuple[Ints, Ints, Floats]] = []

    def take(self, couplings: Sequence[Couplings]) -> None:
        """Replace the tangent of the contacts."""
        self._couplings = [
            (self._unknowns(rows), self._unknowns(columns), _whole(values))
            for rows, columns, values in couplings
        ]

    def times(self, x: Floats) -> Floats:
        """The product with a vector, (c,)."""
        out = np.zeros(self.count + 1)
        longer = np.append(x, 0.0)
        for rows, columns, values in self._couplings:
            y = np.matmul(values, longer[columns][:, :, None])[:, :, 0]
            out += np.bincount(rows.ravel(), y.ravel(), minlength=self.count + 1)
        out[:-1] += blocks_times(self._blocks, x)
        return out[:-1]

    def factor(self) -> Callable[[Floats], Floats]:
        """LU of the sum in single precision, as a function that solves with it.

        Raises:
            ZeroDivisionError: The matrix is singular.
        """
        n = self.count
        # forces are divided by the stiffness of the bodies, so that units do not overflow
        scale = max(float(np.abs(np.diagonal(block)).max()) for _, block in self._blocks)
        matrix = np.zeros((n, n), dtype=np.float32, order="F")
        for place, block in self._blocks:
            matrix[place, place] = block / scale
        flat = matrix.reshape(-1, order="F")
        for rows, columns, values in self._couplings:
            there = (rows < n)[:, :, None] & (columns < n)[:, None, :]
            at = columns[:, None, :] * n + rows[:, :, None]
            np.add.at(flat, at[there], (values[there] / scale).astype(np.float32))
        lu, pivots, info = scipy.linalg.lapack.sgetrf(matrix, overwrite_a=1)
        if info != 0:
            raise ZeroDivisionError("the tangent is singular")

        def solve(b: Floats) -> Floats:
            size = float(np.linalg.norm(b)) or 1.0
            x, _ = scipy.linalg.lapack.sgetrs(lu, pivots, (b / size).astype(np.float32))
            return np.asarray(x.astype(np.float64) * (size / scale))

        return solve

    def _unknowns(self, nodes: npt.NDArray[np.int32]) -> Ints:
        """Contact unknowns of nodes, (p, k) -> (p, 3 k); node -1 has none."""
        at = 3 * nodes[:, :, None].astype(np.int64) + np.arange(3)
        at[nodes < 0] = len(self._number) - 1
        return np.asarray(self._number[at].reshape(len(nodes), 3 * nodes.shape[1]))


def _whole(values: Floats) -> Floats:
    """Blocks of pairs of nodes, (p, r, c, 3, 3), as matrices, (p, 3 r, 3 c)."""
    if values.ndim == 3:
        return values
    p, r, c = values.shape[:3]
    return np.ascontiguousarray(values.swapaxes(2, 3)).reshape(p, 3 * r, 3 * c)


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
        self._solve: Callable[[Floats], Floats] | None = None
        self.factors = 0
        self.iterations = 0

    def solve(self, b: Floats, rtol: float) -> Floats | None:
        """Correction for a right-hand side; None where the tangent is singular.

        Args:
            b: Right-hand side, (c,).
            rtol: Norm of the residual over that of `b` at which to stop.
        """
        known, left = np.zeros_like(b), 1.0
        if self._solve is not None:
            known, left, used = gmres(self._tangent.times, self._solve, b, rtol, PATIENCE)
            self.iterations += used
            if left <= rtol:
                return known
        try:
            self._solve = self._tangent.factor()
        except ZeroDivisionError:
            return None
        self.factors += 1
        rest = b - self._tangent.times(known)
        x, more, used = gmres(self._tangent.times, self._solve, rest, rtol / left, MOST)
        self.iterations += used
        # what single precision cannot do better is still a direction for the line search
        return known + x if more * left < 0.5 else None


def gmres(
    times: Callable[[Floats], Floats],
    precondition: Callable[[Floats], Floats],
    b: Floats,
    rtol: float,
    most: int,
) -> tuple[Floats, float, int]:
    """Generalised minimal residuals, preconditioned from the right, without restart.

    Args:
        times: Product with the matrix.
        precondition: Approximate solution with the matrix.
        b: Right-hand side, (n,).
        rtol: Norm of the residual over that of `b` at which to stop.
        most: Most iterations.

    Returns:
        Solution, norm of its residual over that of `b`, number of iterations.

    Example:
        >>> gmres(lambda x: 2.0 * x, lambda x: x, np.array([4.0]), 1e-12, 5)
        (array([2.]), 0.0, 1)
    """
    norm = float(np.linalg.norm(b))
    if norm == 0.0:
        return np.zeros_like(b), 0.0, 0
    basis, directions = [b / norm], []
    hessenberg = np.zeros((most + 1, most))
    right = np.zeros(most + 1)
    right[0] = norm
    y, left = np.zeros(0), 1.0
    for j in range(most):
        directions.append(precondition(basis[j]))
        w = times(directions[j])
        for i in range(j + 1):
            hessenberg[i, j] = basis[i] @ w
            w = w - hessenberg[i, j] * basis[i]
        hessenberg[j + 1, j] = np.linalg.norm(w)
        h = hessenberg[: j + 2, : j + 1]
        y = np.linalg.lstsq(h, right[: j + 2])[0]
        left = float(np.linalg.norm(h @ y - right[: j + 2])) / norm
        if left <= rtol or hessenberg[j + 1, j] == 0.0 or not np.isfinite(left):
            break
        basis.append(w / hessenberg[j + 1, j])
    return np.stack(directions, axis=1) @ y, left, len(directions)
