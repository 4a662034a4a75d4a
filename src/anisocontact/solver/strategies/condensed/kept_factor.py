"""Newton corrections of the contact unknowns: a kept dense factor and Krylov iterations.

All of this is in single precision but the residual of a correction: products and solutions are
bound by the memory that they read. Where that is not enough all of it is in double precision.
"""

from __future__ import annotations

import numpy as np
import scipy

from anisocontact.base.array_types import Floats, Sparse
from anisocontact.solver.strategies.condensed.dense import ContactTangent
from anisocontact.solver.strategies.condensed.factor_renewal import FactorRenewal
from anisocontact.solver.strategies.condensed.front import Front, Reals
from anisocontact.solver.strategies.condensed.krylov import gmres
from anisocontact.solver.strategies.condensed.steps import (
    KrylovStep,
    step_against_masters,
    step_of_changes,
)
from anisocontact.solver.strategies.condensed.updated import COLUMN, UpdatedFactor
from anisocontact.solver.terms.persistent import Arrays

#: Krylov iterations after which the factor is renewed, if it costs no more.
PATIENCE = 24
#: Operations of a dense factorisation in the time in which a solution reads an entry of a factor:
#: 70 Gflop/s and 4.4 G entries/s, OpenBLAS on one core in single precision, and a quarter more
#: for GMRES.
_OPERATIONS_PER_ENTRY = 20.0
#: See `FactorRenewal`: between increments much changes at once.
_LAST, _MARGIN = 1, 1.0
#: Iterations for a decimal with a factor that is new: between corrections something changes.
_FRESH = 2.0
#: Residual that Krylov iterations reach before they begin anew, by precision.
_PRECISIONS = {np.float32: 1e-4, np.float64: 1e-12}
#: Most of such beginnings with one factor.
_ROUNDS = 4
#: Residual over its right-hand side that another factor does not make smaller, and the largest
#: that is still a direction for the line search.
_PRECISE, _USEFUL = 1e-10, 0.5
#: Residual over the one asked for, and over its right-hand side, up to which double precision gains
#: no iteration of Newton's method: a correction leaves a thousandth of the forces out of balance.
_ENOUGH, _ROUGH = 100.0, 0.1
#: Residual of a solution with a factor that is new over that which Krylov iterations saw, where
#: stiff contacts couple unknowns: what changes is no more told from rounding.
_ROUNDED = 30.0
#: A residual in the basis of a tangent over that of its unknowns, at least.
_OF_BASIS = 0.5
#: Most columns of an `UpdatedFactor`, over all unknowns.
_COLUMNS = 0.2
#: Change of a row over the stiffness of the bodies that is a constraint.
CONSTRAINT = 10.0
#: Names of sparse matrices that are kept, of the factor and the front; and of what they have cost.
_FACTOR, _FRONT = "tangent", "tangent_shares"
#: The same of the bases, see `ContactTangent`, that both were made in.
_BASES = ("tangent_shares_basis", "tangent_basis")
_STAYS, _SPENT, _FRONT_SPENT = "tangent_stays", "tangent_spent", "tangent_shares_spent"
#: The same of flags.
_FLAGS = "tangent_flags"


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
        self._factor: UpdatedFactor | None = None
        self._rounded = False
        # bases in which front and factor were made
        self._bases: list[Sparse | None] = [None, None]
        # the last of `_held`, and what it is of
        self._last: tuple[Front, Sparse, Sparse] | None = None
        self._renewal, self._front_renewal = (
            FactorRenewal(_LAST, _MARGIN, _FRESH),
            FactorRenewal(_LAST, _MARGIN),
        )
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
        for make in (self._factorised, self._eliminated, self._whole, self._doubled):
            if least <= rtol:
                break
            try:
                made = make(least, rtol)
            except ZeroDivisionError:
                continue
            if made:
                begun = self.iterations
                best, least = self._improved(best, b, rtol)
                self._front_renewal.add(self.iterations - begun, least)
        # what cannot be done better is still a direction for the line search
        return best if least < _USEFUL else None

    def persistent(self) -> Arrays:
        """What the kept factor was made of, nothing without one."""
        front, factor = self._front, self._factor
        if factor is None or front is None:
            return {}
        spent = {_SPENT: self._renewal.persistent(), _FRONT_SPENT: self._front_renewal.persistent()}
        bases = {n: one for n, one in zip(_BASES, self._bases, strict=True) if one is not None}
        matrices = {_FACTOR: factor.first, _FRONT: front.shares, **bases}
        flags = np.array([self._rounded, self._tangent.kind is np.float64])
        return spent | {
            _STAYS: front.stays,
            _FLAGS: flags,
            **{f"{_FACTOR}_{name}": one for name, one in factor.persistent().items()},
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
        count = self._tangent.count
        self._rounded, double = map(bool, kept[_FLAGS])
        if double:
            self._tangent.double()
        # the tangent has none of a contact yet: its basis is that of the next one it takes
        bases = [_matrix(kept, name, count) if f"{name}_data" in kept else None for name in _BASES]
        self._tangent.basis = bases[0]
        self._front = self._tangent.front_of(_matrix(kept, _FRONT, count), kept[_STAYS])
        self._tangent.basis = bases[1]
        self._factor = self._made(self._front, _matrix(kept, _FACTOR, int(kept[_STAYS].sum())))
        self._bases = bases
        begin = len(_FACTOR) + 1
        self._factor.restore(
            {name[begin:]: one for name, one in kept.items() if name.startswith(f"{_FACTOR}_")}
        )
        self.factors += 1
        self._renewal.restore(kept[_SPENT])
        self._front_renewal.restore(kept[_FRONT_SPENT])

    def forget(self) -> None:
        """Give back the memory; nothing can be solved any more without a new factor."""
        self._front = self._factor = self._last = None
        self._tangent.forget()

    def _serves(self) -> bool:
        """Whether the factor that there is may do for the tangent of now."""
        front, factor = self._front, self._factor
        if front is None or factor is None or self._renewal.due or self._to_double:
            return False
        held = front.own(self._held(front))
        if self._solutions(front, front.factor_operations) < PATIENCE:
            # a factor costs next to nothing; a constraint that comes or goes takes an iteration
            stiff = CONSTRAINT * self._tangent.stiff[front.unknowns]
            changed = abs(held - factor.first).max(axis=1).toarray().ravel() > stiff
            return int(np.count_nonzero(changed)) <= PATIENCE
        found = factor.take(held, int(_COLUMNS * len(front.unknowns)))
        if found is None:
            return False
        self._renewal.spend(COLUMN * found)
        return True

    @property
    def _to_double(self) -> bool:
        """Whether rounding has been in the way of what changes."""
        return self._rounded and self._tangent.kind is np.float32

    def _factorised(self, *_: float) -> bool:
        """Make the factor of the contacts of now, unless what they leave is due."""
        front = self._front
        if front is None or self._to_double:
            return False
        if self._front_renewal.due and self._moved(front):
            return False
        self._factorise(front)
        return True

    def _eliminated(self, least: float, _: float) -> bool:
        """Eliminate what contacts of now leave, and make the factor."""
        front = self._front
        if self._to_double:
            self._tangent.double()
        elif front is not None and (least <= _PRECISE or not self._moved(front)):
            return False
        self._front = self._factor = self._last = front = None  # gives the memory back
        self._begin(self._tangent.front())
        return True

    def _moved(self, front: Front) -> bool:
        """Whether slave nodes have moved on since."""
        then, now = front.shares, self._tangent.shares
        return then.nnz != now.nnz or bool((then != now).nnz)

    def _whole(self, least: float, _: float) -> bool:
        """Make a factor with nothing eliminated."""
        if least < _USEFUL or (self._front is not None and self._front.stays.all()):
            return False
        self._front = self._factor = self._last = None  # gives the memory back
        self._begin(self._tangent.front(whole=True))
        return True

    def _doubled(self, least: float, rtol: float) -> bool:
        """Go on in double precision where single precision is not enough.

        Where next to nothing of a slave node is covered, what is opposite may follow it many times
        over; with multipliers what single precision leaves of that is more than the bodies hold.
        """
        enough = least <= max(min(_ENOUGH * rtol, _ROUGH), _PRECISE)
        if enough or self._tangent.kind is np.float64:
            return False
        self._tangent.double()
        self._front = self._factor = self._last = None  # gives the memory back
        self._begin(self._tangent.front())
        return True

    def _begin(self, front: Front) -> None:
        self._front, self._factor = front, None
        self._bases[0] = self._tangent.basis
        self._front_renewal.begin(self._solutions(front, front.operations))
        self._factorise(front)

    def _factorise(self, front: Front) -> None:
        self._factor = None  # gives the memory back
        self._factor = self._made(front, front.own(self._held(front)))
        self._bases[1] = self._tangent.basis
        self._renewal.begin(self._solutions(front, front.factor_operations))
        self.factors += 1

    def _made(self, front: Front, held: Sparse) -> UpdatedFactor:
        return UpdatedFactor(front.own_factor(held), held, self._tangent.stiff[front.unknowns])

    def _held(self, front: Front) -> Sparse:
        """What contacts of now do where slave nodes move against what is opposite, (c, c)."""
        contact, last = self._tangent.summed, self._last
        if last is None or last[0] is not front or last[1] is not contact:
            last = self._last = front, contact, front.held(contact, self._tangent.shares)
        return last[2]

    def _solutions(self, front: Front, operations: float) -> float:
        """How many solutions cost as much as operations."""
        size = self._tangent.count if front.shares.nnz else len(front.unknowns)
        return operations / (_OPERATIONS_PER_ENTRY * max(size, 1) ** 2)

    def _improved(self, x: Floats, b: Floats, rtol: float) -> tuple[Floats, float]:
        """Krylov iterations from `x` on; the norm of the residual over that of `b` comes with it.

        They begin anew with the residual in double precision.
        """
        front, factor, kind = self._front, self._factor, self._tangent.kind
        assert front is not None
        assert factor is not None
        make = step_against_masters if front.shares.nnz else step_of_changes
        step = make(front, factor, self._tangent)
        patience = max(PATIENCE, int(self._solutions(front, front.factor_operations)))
        norm, most = float(np.linalg.norm(b)) or 1.0, patience
        rest = b - self._tangent.times(x) if x.any() else b
        left = float(np.linalg.norm(rest)) / norm
        for _ in range(_ROUNDS):
            size = float(np.linalg.norm(rest)) or 1.0
            goal = max(rtol * norm / size, _PRECISIONS[kind])
            y, seen, used = self._krylov(step, (rest / size).astype(kind), 0.9 * goal, most)
            self.iterations += used
            better = x + y.astype(np.float64) * (size / self._tangent.scale)
            rest = b - self._tangent.times(better)
            now = float(np.linalg.norm(rest))
            most -= used
            if used == 1 and now > _ROUNDED * max(seen, goal) * size:
                self._rounded = True
            if not now < size:
                break
            x, left = better, now / norm
            if left <= rtol or most <= 0:
                break
        self._renewal.add(patience - most, left)
        return x, left

    def _krylov(
        self, step: KrylovStep, b: Reals, goal: float, most: int
    ) -> tuple[Reals, float, int]:
        """As `gmres` of a right-hand side of norm one, in the basis of the tangent."""
        basis = self._tangent.basis
        if basis is None:
            return gmres(step, b, goal, most)
        given = basis.T @ b
        size = float(np.linalg.norm(given)) or 1.0
        own, left, used = gmres(step, given, _OF_BASIS * goal / size, most)
        return basis @ own, left * size, used


def _matrix(kept: Arrays, name: str, count: int) -> Sparse:
    """A sparse matrix that was kept, (count, count)."""
    parts = tuple(kept[f"{name}_{part}"] for part in ("data", "indices", "indptr"))
    return scipy.sparse.csr_array(parts, (count, count))
