"""Newton corrections of the contact unknowns: a kept dense factor and Krylov iterations.

All of this is in single precision but the residual of a correction: products and solutions are
bound by the memory that they read. Where that is not enough a factor in double precision is made.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.solver.strategies.condensed.dense import ContactTangent
from anisocontact.solver.strategies.condensed.front import Front, Sparse
from anisocontact.solver.strategies.condensed.krylov import gmres
from anisocontact.solver.strategies.condensed.wear import Wear
from anisocontact.solver.terms.persistent import Arrays

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Step = Callable[[Singles], tuple[Singles, Singles]]

#: Krylov iterations after which the factor is renewed, if it costs no more.
PATIENCE = 24
#: Operations of a dense factorisation in the time in which a solution reads an entry of a factor:
#: 70 Gflop/s and 4.4 G entries/s, OpenBLAS on one core in single precision, and a quarter more
#: for GMRES.
_OPERATIONS_PER_ENTRY = 20.0
#: See `Wear`: between increments much changes at once.
_LAST, _MARGIN = 1, 1.0
#: Residual that Krylov iterations in single precision reach before they begin anew.
_SINGLE = 1e-4
#: Most of such beginnings with one factor.
_ROUNDS = 4
#: Residual over its right-hand side that another factor does not make smaller, and the largest
#: that is still a direction for the line search.
_PRECISE, _USEFUL = 1e-10, 0.5
#: Residual over the one asked for, and over its right-hand side, up to which double precision gains
#: no iteration of Newton's method: a correction leaves a thousandth of the forces out of balance.
_ENOUGH, _ROUGH = 100.0, 0.1
#: Change of a row over the stiffness of the bodies that is a constraint.
CONSTRAINT = 10.0
#: Names of sparse matrices that are kept: of the factor and of the front; and of their wear.
_FACTOR, _FRONT = "tangent", "tangent_shares"
_STAYS, _SPENT, _FRONT_SPENT = "tangent_stays", "tangent_spent", "tangent_shares_spent"


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
        self._front: Front | None = None
        self._solve: Callable[[Singles], Singles] | None = None
        self._made_of = self._none()
        # the last of `_held`, and what it is of
        self._last: tuple[Front, Sparse, Sparse] | None = None
        self._wear, self._front_wear = Wear(_LAST, _MARGIN), Wear(_LAST, _MARGIN)
        self.factors = 0
        self.iterations = 0

    def solve(self, b: Floats, rtol: float) -> Floats | None:
        """Correction for a right-hand side; None where the tangent is singular.

        Args:
            b: Right-hand side, (c,).
            rtol: Norm of the residual over that of `b` at which to stop.
        """
        best, least = np.zeros_like(b), 1.0
        if self._serves():
            best, least = self._improved(best, b, rtol)
        for make in (self._factorised, self._eliminated, self._whole):
            if least <= rtol:
                break
            try:
                made = make(least)
            except ZeroDivisionError:
                continue
            if made:
                begun = self.iterations
                best, least = self._improved(best, b, rtol)
                self._front_wear.add(self.iterations - begun, least)
        if least > max(min(_ENOUGH * rtol, _ROUGH), _PRECISE):
            best, least = self._in_double(b, best, least)
        # what cannot be done better is still a direction for the line search
        return best if least < _USEFUL else None

    def persistent(self) -> Arrays:
        """What the kept factor was made of, nothing without one."""
        front = self._front
        if self._solve is None or front is None:
            return {}
        spent = {_SPENT: self._wear.persistent(), _FRONT_SPENT: self._front_wear.persistent()}
        matrices = {_FACTOR: self._made_of, _FRONT: front.shares}
        return spent | {
            _STAYS: front.stays,
            **{
                f"{name}_{part}": getattr(matrix, part)
                for name, matrix in matrices.items()
                for part in ("data", "indices", "indptr")
            },
        }

    def restore(self, kept: Arrays) -> None:
        """Make the factor of `persistent` again."""
        if _STAYS not in kept:
            return
        n = self._tangent.count
        made_of, shares = (
            scipy.sparse.csr_array(
                tuple(kept[f"{name}_{part}"] for part in ("data", "indices", "indptr")), (n, n)
            )
            for name in (_FACTOR, _FRONT)
        )
        self._front = self._tangent.front_of(shares, kept[_STAYS])
        self._made_of = made_of
        self._solve = self._front.factor(made_of)
        self.factors += 1
        self._wear.restore(kept[_SPENT])
        self._front_wear.restore(kept[_FRONT_SPENT])

    def _none(self) -> Sparse:
        n = self._tangent.count
        return scipy.sparse.csr_array((n, n), dtype=np.float32)

    def _serves(self) -> bool:
        """Whether the factor that there is may do for the tangent of now."""
        if self._front is None or self._solve is None or self._wear.worn:
            return False
        # where a constraint comes or goes a Krylov method takes an iteration for it
        changed = self._tangent.clearly(self._held(self._front) - self._made_of, CONSTRAINT)
        return int(np.count_nonzero(changed)) <= self._patience(self._front)

    def _factorised(self, _: float) -> bool:
        """Make the factor of the contacts of now, unless what they leave is due."""
        if self._front is None or (self._front_wear.worn and self._moved(self._front)):
            return False
        self._factorise(self._front)
        return True

    def _eliminated(self, least: float) -> bool:
        """Eliminate what contacts of now leave, and make the factor."""
        front = self._front
        if front is not None and (least <= _PRECISE or not self._moved(front)):
            return False
        self._front = self._solve = self._last = front = None  # gives the memory back
        self._begin(self._tangent.front())
        return True

    def _moved(self, front: Front) -> bool:
        """Whether slave nodes have moved on since."""
        then, now = front.shares, self._tangent.shares
        return then.nnz != now.nnz or bool((then != now).nnz)

    def _whole(self, least: float) -> bool:
        """Make a factor with nothing eliminated."""
        if least < _USEFUL or (self._front is not None and self._front.stays.all()):
            return False
        self._front = self._solve = self._last = None  # gives the memory back
        self._begin(self._tangent.front(whole=True))
        return True

    def _begin(self, front: Front) -> None:
        self._front, self._solve = front, None
        self._front_wear.begin(self._solutions(front.operations))
        self._factorise(front)

    def _factorise(self, front: Front) -> None:
        self._solve = None  # gives the memory back
        self._made_of = self._held(front)
        self._solve = front.factor(self._made_of)
        self._wear.begin(self._solutions(front.factor_operations))
        self.factors += 1

    def _held(self, front: Front) -> Sparse:
        """What contacts of now do where slave nodes move against what is opposite, (c, c)."""
        contact, last = self._tangent.summed, self._last
        if last is None or last[0] is not front or last[1] is not contact:
            last = self._last = front, contact, front.held(contact, self._tangent.shares)
        return last[2]

    def _solutions(self, operations: float) -> float:
        """How many solutions with the whole cost as much as operations."""
        return operations / (_OPERATIONS_PER_ENTRY * max(self._tangent.count, 1) ** 2)

    def _patience(self, front: Front) -> int:
        return max(PATIENCE, int(self._solutions(front.factor_operations)))

    def _improved(self, x: Floats, b: Floats, rtol: float) -> tuple[Floats, float]:
        """Krylov iterations from `x` on; the norm of the residual over that of `b` comes with it.

        In single precision, begun anew with the residual in double precision.
        """
        assert self._front is not None
        step, patience = self._step(self._front), self._patience(self._front)
        norm, most = float(np.linalg.norm(b)) or 1.0, patience
        rest = b - self._tangent.times(x) if x.any() else b
        left = float(np.linalg.norm(rest)) / norm
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
        self._wear.add(patience - most, left)
        return x, left

    def _in_double(self, b: Floats, x: Floats, least: float) -> tuple[Floats, float]:
        """A solution with a factor in double precision, or `x` where that is as good.

        Where next to nothing of a slave node is covered, what is opposite may follow it many times
        over; with multipliers what single precision leaves of that is more than the bodies hold.
        """
        lu, pivots, info = scipy.linalg.lapack.dgetrf(self._tangent.whole(), overwrite_a=1)
        self.factors += 1
        if info != 0:
            return x, least
        found = np.asarray(scipy.linalg.lapack.dgetrs(lu, pivots, b)[0])
        rest = b - self._tangent.times(found)
        left = float(np.linalg.norm(rest) / (np.linalg.norm(b) or 1.0))
        return (found, left) if left < least else (x, least)

    def _step(self, front: Front) -> Step:
        """Approximate solution with the tangent, and the product of the tangent with it.

        With the factor of M = T^-T (S' + K) T^-1, S' = T^T S T, of an earlier P and K, and with E
        the change of P since, a solution is `x = (1 + E) M^-1 (1 + E)^T v`, and
        `A x = (1 + E)^T v - T^-T K T^-1 M^-1 (1 + E)^T v + C x + S E M^-1 (1 + E)^T v`: of products
        with S there is at most that with E.
        """
        solve, made_of, tangent = self._solve, self._made_of, self._tangent
        assert solve is not None
        if not front.shares.nnz:
            change = tangent.summed - made_of
            change.eliminate_zeros()

            def plain(v: Singles) -> tuple[Singles, Singles]:
                direction = solve(v)
                return direction, v + change @ direction

            return plain
        shares, contact = front.shares, tangent.summed
        drift = (front.shares_with(tangent.shares) - shares).tocsr()
        back, drift_back = shares.T.tocsr(), drift.T.tocsr()

        def step(v: Singles) -> tuple[Singles, Singles]:
            turned = v + drift_back @ v
            own = solve(turned + back @ turned)
            held, more = made_of @ own, drift @ own
            x = own + shares @ own + more
            product = turned - held + back @ held + contact @ x + tangent.bodies_times(more)
            return x, product

        return step
