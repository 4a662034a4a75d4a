"""One multiplicative cycle on a level: smoothing of its interior around a correction from below."""

from __future__ import annotations

from typing import Protocol

from anisocontact.base.fenicsx import Mat, PETSc, Vec


class Correction(Protocol):
    """What corrects a residual on the level below."""

    def solve(self, rest: Vec) -> Vec:
        """Correction of a level's unknowns; overwritten by the next call."""


class Residual(Protocol):
    """What is out of balance on a level."""

    def __call__(self, b: Vec, x: Vec, out: Vec) -> None:
        """Set `out` to `b - A x`."""


class Smoother:
    """Chebyshev's iteration with the diagonal on the unknowns of an interior.

    Args:
        matrix: Matrix of the interior.
        unknowns: Where its unknowns are among those of the level.
        first: Number of the first unknown of the level on this rank.
        prefix: Prefix of the options of the iteration.
    """

    def __init__(self, matrix: Mat, unknowns: PETSc.IS, first: int, prefix: str) -> None:
        self._here, self._empty = unknowns.getIndices() - first, unknowns.getSize() == 0
        self._part, self._correction = matrix.createVecs()
        self._solver = PETSc.KSP().create(matrix.getComm())
        self._solver.setOptionsPrefix(f"{prefix}smoother_")
        self._solver.setNormType(PETSc.KSP.NormType.NONE)
        self.renew(matrix)
        self._solver.setFromOptions()

    def renew(self, matrix: Mat) -> None:
        """Take another matrix of the interior."""
        self._solver.setOperators(matrix)

    def smooth(self, rest: Vec, x: Vec) -> None:
        """Add to unknowns what the interior finds for a residual."""
        if self._empty:
            return
        self._part.array[:] = rest.array_r[self._here]
        self._solver.solve(self._part, self._correction)
        x.array[self._here] += self._correction.array_r

    @property
    def of_products(self) -> bool:
        """Whether it asks a matrix for products and the diagonal alone."""
        return self._solver.getPC().getType() in (PETSc.PC.Type.JACOBI, PETSc.PC.Type.NONE)

    def destroy(self) -> None:
        """Give back PETSc's objects."""
        self._solver.destroy()


def residual(matrix: Mat) -> Residual:
    """What is out of balance with a matrix."""

    def of_matrix(b: Vec, x: Vec, out: Vec) -> None:
        matrix.mult(x, out)
        out.aypx(-1.0, b)

    return of_matrix


def cycle(
    residual: Residual, smoother: Smoother, below: Correction, b: Vec, rest: Vec, x: Vec
) -> None:
    """Smooth, correct from below, smooth again.

    Args:
        residual: Of the level.
        smoother: Smoother of its interior.
        below: What corrects the residual on the level below.
        b: Right-hand side.
        rest: Residual of `x`, overwritten.
        x: Solution so far, improved in place.
    """
    smoother.smooth(rest, x)
    residual(b, x, rest)
    x.axpy(1.0, below.solve(rest))
    residual(b, x, rest)
    smoother.smooth(rest, x)
