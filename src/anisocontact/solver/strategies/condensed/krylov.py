"""Generalised minimal residuals in the precision of the vectors."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.array_types import Floats


def gmres[T: (np.float32, np.float64)](
    step: Callable[[npt.NDArray[T]], tuple[npt.NDArray[T], npt.NDArray[T]]],
    b: npt.NDArray[T],
    rtol: float,
    most: int,
    trial: int | None = None,
    total: Callable[[npt.NDArray[T]], npt.NDArray[T]] | None = None,
) -> tuple[npt.NDArray[T], float, int]:
    """Generalised minimal residuals, preconditioned from the right, without restart.

    A product that overflows, or is not a number, ends it with what was found before.

    Args:
        step: Approximate solution with the matrix, and the product of the matrix with it.
        b: Right-hand side, (n,); its precision is that of the vectors.
        rtol: Norm of the residual over that of `b` at which to stop.
        most: Most iterations.
        trial: Iterations after which it also ends where at the rate so far the most will not do;
            it goes on if not given.
        total: Sum over all processes, where each has a part of the vectors; collective.

    Returns:
        Solution, norm of its residual over that of `b`, number of iterations.

    Example:
        >>> gmres(lambda v: (v, 2.0 * v), np.array([4.0]), 1e-12, 5)
        (array([2.]), 0.0, 1)
    """

    def size(v: npt.NDArray[T]) -> float:
        # of what is no number neither is the size
        return float(np.linalg.norm(v) if total is None else np.sqrt(total(v @ v)))

    norm = size(b)
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
        if not (np.isfinite(w).all() if total is None else math.isfinite(size(w))):
            break
        used += 1
        w, shares = _orthogonal(w, basis[:, :used], product, total)
        length = size(w)
        left = reduced.add(np.append(shares, length)) / norm
        if left <= rtol or length == 0.0:
            break
        if trial is not None and used >= trial and _too_slow(left, used, rtol, most):
            break
        basis[:, used] = w / length
    if not used:
        return np.zeros_like(b), 1.0, 0
    y = reduced.solution().astype(b.dtype)
    return product(1.0, directions[:, :used], y), left, used


def _orthogonal[T: (np.float32, np.float64)](
    w: npt.NDArray[T],
    basis: npt.NDArray[T],
    product: Callable[..., npt.NDArray[T]],
    total: Callable[[npt.NDArray[T]], npt.NDArray[T]] | None,
) -> tuple[npt.NDArray[T], Floats]:
    """A vector without its shares in an orthonormal basis, and these."""
    shares = np.zeros(basis.shape[1])
    for _ in range(2):  # twice is enough for orthogonality to rounding
        found = product(1.0, basis, w, trans=1)
        found = found if total is None else total(found)
        shares += found
        w = product(-1.0, basis, found, beta=1.0, y=w)
    return w, shares


def _too_slow(left: float, used: int, rtol: float, most: int) -> bool:
    """Whether a residual that goes on to fall as it has on average does not fall far enough."""
    return most * math.log(left) > used * math.log(rtol)


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
