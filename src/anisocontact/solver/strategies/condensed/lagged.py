"""Newton corrections by GMRES, with the interior of an old tangent and the contacts of now."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Mat, Vec
from anisocontact.solver.strategies.condensed.border import PARTS
from anisocontact.solver.strategies.condensed.factor_renewal import FactorRenewal
from anisocontact.solver.strategies.condensed.krylov import gmres
from anisocontact.solver.strategies.condensed.lagged_preconditioner import (
    BorderedPreconditioner,
    LaggedPreconditioner,
)
from anisocontact.solver.strategies.condensed.mixed import MixedForm
from anisocontact.solver.strategies.condensed.substructures import Substructures
from anisocontact.solver.strategies.krylov_backoff import KrylovBackoff
from anisocontact.solver.strategies.notes import without_repeats
from anisocontact.solver.strategies.whole import WholeLU
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.term import SingularError

#: What is kept of changes of volume when the factor was made.
_SLOPE = "lagged.slope"
#: Most Krylov iterations of a correction before a new factor is made, if that costs no more.
_PATIENCE = 20
#: Share of them after which an old factor that leads nowhere is given up.
_TRIAL = 0.5
#: See `FactorRenewal`: the cost of a correction alone depends on how many points change.
_LAST, _MARGIN = 10, 1.25


class LaggedFactor:
    """Solves with the tangent J of now by GMRES, preconditioned from the right.

    The preconditioner is an earlier tangent, factorised once, whose border has the contacts of now,
    see `LaggedPreconditioner`. All that changes at once is in it, and what it lacks is the change
    of the bodies since. Where volume is kept apart it is the mixed form that is preconditioned, see
    `MixedForm`.

    `FactorRenewal` says when a new factor pays. All unknowns are factorised for a correction alone
    where a new factor in double precision does not lead to it either, and in the place of new
    factors that cost more, see `KrylovBackoff`.

    Args:
        problem: The problem.
        note: Called with a line for every factorisation.
        kept: What `persistent` gave of a run that goes on; nothing for one that begins.

    Attributes:
        krylov: Krylov iterations of every correction so far.
    """

    def __init__(
        self, problem: Problem, note: Callable[[str], None], kept: Arrays | None = None
    ) -> None:
        self._problem, self._note = problem, without_repeats(note)
        self._several = problem.comm.size > 1
        self._factor: LaggedPreconditioner = (
            Substructures(problem) if self._several else BorderedPreconditioner(problem)
        )
        self._slope = scipy.sparse.csr_array((0, 0))
        self._single, self._due, self._made = True, True, False
        self._renewal, self._backoff = FactorRenewal(_LAST, _MARGIN), KrylovBackoff()
        #: Costs in solutions: of this correction so far, and of the last one with a new factor.
        self._spent = self._with_new = 0.0
        self._interiors, self._whole = 0, WholeLU()
        self.krylov: list[int] = []
        if kept and "lagged.flags" in kept:
            self._restore(kept)

    def persistent(self) -> Arrays:
        """What the corrections of a run that goes on depend on: the matrices behind the factor.

        The factor is not written but made again, from the same numbers in the same order.
        """
        own = self._factor.persistent() if self._made else {}
        if not own:
            return {}
        return own | {
            "lagged.spent": self._renewal.persistent(),
            "lagged.flags": np.array([self._single, self._due]),
            "lagged.trust": self._backoff.persistent(),
            "lagged.with_new": np.array(self._with_new),
            **{f"{_SLOPE}.{part}": getattr(self._slope, part) for part in PARTS},
        }

    def _restore(self, kept: Arrays) -> None:
        slope = tuple(kept[f"{_SLOPE}.{part}"] for part in PARTS)
        columns = self._problem.bulk.stiffness.getSize()[1]
        self._slope = scipy.sparse.csr_array(slope, (len(slope[-1]) - 1, columns))
        self._single, self._due = map(bool, kept["lagged.flags"])
        self._renewal.restore(kept["lagged.spent"])
        self._backoff.restore(kept["lagged.trust"])
        self._with_new = float(kept["lagged.with_new"])
        self._factor.restore(kept, self._single)
        self._made = True

    def outgrow(self) -> None:
        """Take it that contacts couple other nodes than before; those may be in the border."""
        self._due = self._factor.outgrown() or self._due
        if self._several:  # PETSc would go on with the symbolic factorisation of the old pattern
            self._whole.close()

    def solve(self, tangent: Mat, b: Floats, rtol: float) -> Floats | None:
        """Correction for a right-hand side; None where the tangent is singular.

        Args:
            tangent: J.
            b: Right-hand side of the unknowns this process owns, (n,).
            rtol: Norm of the residual over that of `b` at which to stop.
        """
        self.krylov.append(0)
        self._spent = 0.0
        untried = self._backoff.skips()
        if untried and self._with_new > self._whole_cost:
            self._due = True
            return self._whole.solve(tangent, b)
        if not untried:
            self._whole.close()
        found = self._with_kept(tangent, b, rtol, untried)
        if not untried:
            self._backoff.add(self._spent, self._whole_cost)
        return self._whole.solve(tangent, b) if found is None else found

    def _with_kept(self, tangent: Mat, b: Floats, rtol: float, anew: bool) -> Floats | None:
        """A correction with a factor that is kept, or that is from now on; None where none leads.

        Args:
            tangent: J.
            b: Right-hand side, (n,).
            rtol: Norm of the residual over that of `b` at which to stop.
            anew: Whether the one that there is is not tried.
        """
        fresh = (anew or self._due) and self._renewed(tangent)
        found, left = self._corrected(tangent, b, rtol, fresh)
        if not left <= rtol and not fresh and self._renewed(tangent):
            found, left = self._corrected(tangent, b, rtol, True)
        if not left <= rtol and self._single and self._doubled(tangent):
            found, left = self._corrected(tangent, b, rtol, True)
        # the border, in single precision, cannot tell stiff contacts from the bodies
        return found if left <= rtol else None

    def inverse(self) -> Callable[[Vec, Vec], None] | None:
        """Solutions with what the last correction came from, as it is; None where there is none."""
        if self._whole.inverse is not None:
            return self._whole.inverse
        if not self._made:
            return None

        def solution(b: Vec, x: Vec) -> None:
            x.array[:] = self._factor.solution(np.array(b.array_r))

        return solution

    def close(self) -> None:
        """Give back the memory."""
        self._whole.close()
        self._factor.close()
        self._made = False

    @property
    def factors(self) -> int:
        """Factorisations so far."""
        return self._interiors + self._whole.made

    @property
    def _whole_cost(self) -> float:
        """What a factorisation of all unknowns costs, in solutions: none where there is no other.

        Operations are about those for the interior, and take half of the time in single precision.
        """
        if not self._made:
            return 0.0
        return (2.0 if self._single else 1.0) * self._factor.solutions_per_factor + 1.0

    def _corrected(self, tangent: Mat, b: Floats, rtol: float, fresh: bool) -> tuple[Floats, float]:
        """What Krylov iterations find, and the norm of its residual over that of `b`."""
        factor = self._factor
        if not self._made:
            return b, np.inf
        try:
            spent = factor.renew()
        except SingularError:
            return b, np.inf
        given, out = tangent.createVecs()

        def product(v: Floats) -> Floats:
            given.array[:] = v
            tangent.mult(given, out)
            return np.asarray(out.array_r)

        most = max(_PATIENCE, int(factor.solutions_per_factor))
        # of a new factor all that it can do is wanted: those in double precision are dearer
        trial = None if fresh else int(_TRIAL * most)
        volume = self._problem.bulk.volume
        if volume is None:

            def step(v: Floats) -> tuple[Floats, Floats]:
                found = factor.solution(v)
                return found, product(found)

            total = self._problem.layout.total if self._several else None
            found, left, used = gmres(step, b, rtol, most, trial, total)
        else:
            mixed = MixedForm(self._problem, self._slope, volume.rows())
            found, left, used = mixed.solve(factor.solution, product, b, rtol, most, trial)
        self.krylov[-1] += used
        self._count(spent + used, left, fresh)
        return found, left

    def _count(self, cost: float, left: float, fresh: bool) -> None:
        """Compare what this correction has cost with the average since the last factor."""
        if not np.isfinite(left):
            return
        self._spent += cost
        if fresh:
            per_factor = self._factor.solutions_per_factor
            self._renewal.begin(per_factor)
            self._spent += per_factor
            self._with_new = per_factor + cost
        self._renewal.add(cost, left)
        self._due = self._renewal.due

    def _renewed(self, tangent: Mat) -> bool:
        """Make a factor of this tangent; the old one stays where there is none."""
        try:
            self._factor.take(tangent, self._single)
        except SingularError:
            return False
        volume = self._problem.bulk.volume
        if volume is not None:
            self._slope = volume.rows().slope
        self._made, self._due = True, False
        self._interiors += 1
        self._note(
            f"condensing {tangent.getSize()[0]} unknowns on {self._factor.border} that contact "
            f"can couple, in {'single' if self._single else 'double'} precision (MUMPS)"
        )
        return True

    def _doubled(self, tangent: Mat) -> bool:
        """Make a factor in double precision, from now on."""
        self._single = False
        return self._renewed(tangent)
