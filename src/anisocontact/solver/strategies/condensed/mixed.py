"""Corrections of displacements and pressures together, where an old factor preconditions them.

With pressures eliminated in cells a tangent is `J = A + B^T C^-1 B`, where C goes to zero as bodies
become incompressible: what an old one lacks, `C^-1 (B - B_0)`, goes to infinity however little B
has changed. In the mixed form, where pressures are unknowns of their own, it lacks `B - B_0` alone
[Benzi Golub Liesen 2005, section 10].
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from anisocontact.base.array_types import Floats, Sparse
from anisocontact.bulk.pressures import OF_BOTH, VolumeRows
from anisocontact.solver.strategies.condensed.krylov import gmres
from anisocontact.solver.system.problem import Problem


class MixedForm:
    """GMRES with unknowns u and s: `J u + B^T s = b`, `s = 0`.

    By s pressures are off what displacements say, `C^-1 B u`. The preconditioner is the mixed form
    of an old tangent `J_0 = A_0 + B_0^T C^-1 B_0`; eliminating its pressures leaves `J_0`, so that
    a factor of that is all it takes: for a right-hand side (f, g)

        u = J_0^-1 (f - B_0^T g),  s = C^-1 (B_0 - B) u + g.

    Pressures are counted with the forces that they make, see `OF_BOTH`.

    Args:
        problem: The problem, on one process.
        then: B_0, of the tangent that the factor is of.
        now: B and C^-1 of the last tangent.
    """

    def __init__(self, problem: Problem, then: Sparse, now: VolumeRows) -> None:
        self._now, self._changed = now, then - now.slope
        self._columns = now.slope.shape[1]
        self._forces, self._forces_then = (_forces(problem, slope) for slope in (now.slope, then))
        self._sizes = now.sizes

    def solve(
        self,
        solution: Callable[[Floats], Floats],
        product: Callable[[Floats], Floats],
        b: Floats,
        rtol: float,
        most: int,
        trial: int | None,
    ) -> tuple[Floats, float, int]:
        """As `gmres`.

        Args:
            solution: With the old tangent.
            product: With the tangent of now.
            b: Right-hand side, (n,).
            rtol: Norm of the residual over that of `b` at which to stop.
            most: Most iterations.
            trial: As of `gmres`.
        """
        n = len(b)
        right = np.concatenate([b, np.zeros(len(self._sizes))])

        def step(v: Floats) -> tuple[Floats, Floats]:
            off = v[n:] / self._sizes
            u = solution(v[:n] - self._forces_then @ off)
            s = self._now.pressures(self._changed @ u[: self._columns]) + off
            above, below = product(u) + self._forces @ s, self._sizes * s
            return np.concatenate([u, below]), np.concatenate([above, below])

        found, left, used = gmres(step, right, rtol / OF_BOTH, most, trial)
        return found[:n], left * OF_BOTH, used


def _forces(problem: Problem, slope: Sparse) -> Sparse:
    """B^T as the equations have it, empty where unknowns are prescribed, (n, pressures)."""
    free = np.ones(problem.unknowns)
    free[problem.constrained()] = 0.0
    count, n = slope.shape
    gathering = problem.constraints.gathering()
    if gathering is not None:
        slope = (slope @ gathering[:n, :n].T).tocsr()
    values = slope.data * free[slope.indices]
    # as columns: SciPy takes longer to make rows of them than the products take
    whole = scipy.sparse.csr_array((values, slope.indices, slope.indptr), (count, len(free)))
    return whole.T
