"""Newton's method on the whole system with PETSc SNES."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import PETSc, Vec
from anisocontact.base.petsc_calls import check_memory, forget_failure, not_finite
from anisocontact.contact import NotHeldError
from anisocontact.solver.strategies.database import Database, OptionValue
from anisocontact.solver.strategies.newton_iteration import NewtonIteration
from anisocontact.solver.strategies.settled_contact import SettledContact
from anisocontact.solver.strategies.stability import unstable
from anisocontact.solver.strategies.system import System
from anisocontact.solver.system.culprit import Culprit, LostError
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.term import SingularError

DEFAULTS: dict[str, OptionValue] = {
    "snes_type": "newtonls",
    # Steps are halved until the residual falls [Armijo 1966]: as many iterations as full steps
    # where those converge. Behind a jump, as where points get onto the next facet, the parabola of
    # quadratic backtracking says nothing, and takes a tenth.
    "snes_linesearch_type": "bt",
    "snes_linesearch_order": 1,
    # where a dozen halvings gain nothing no equilibrium was ever found later on
    "snes_linesearch_minlambda": 2.0**-12,
    "ksp_type": "preonly",
    "pc_type": "lu",
    "pc_factor_mat_solver_type": "mumps",
    "mat_mumps_icntl_33": 1,  # the determinant, of which the sign says whether a state is stable
}
#: Methods of PETSc that do not fit, and why.
_UNFIT = {
    PETSc.SNES.Type.KSPONLY: "never asks whether forces are in balance",
    PETSc.SNES.Type.FAS: "needs coarser problems, and there are none",
}
#: Residual over the forces at work at which an increment is accepted.
TOLERANCE = 1e-8
#: Corrections at most, unless options say how many.
MOST_ITERATIONS = 100


@dataclass(frozen=True)
class NewtonResult:
    """Outcome of an increment.

    Attributes:
        iterations: Number of corrections, those for all multipliers.
        residuals: Residual over the forces at work, of the start and after each correction with
            the last multipliers.
        reason: Empty if it converged, else why it did not.
        culprits: Places that ended it, where they are known.
        far: How far bodies went where what is left may be rounding as they went farther than all
            is long, length; else 0.
        unstable: Whether the last tangent that was factorised has a negative eigenvalue, as far as
            `unstable` finds one: the state found is not stable.
    """

    iterations: int
    residuals: list[float]
    reason: str
    culprits: tuple[Culprit, ...] = ()
    far: float = 0.0
    unstable: bool = False


class Newton:
    """SNES with the exact tangent and convergence relative to the forces at work.

    An iterate is accepted when what is prescribed is reached (`prescribed_reached`) and the norm of
    the residual is below `snes_rtol` times `ForceBalance.force_scale`, or below what floating point
    can resolve, in any units; of a mixed problem that is asked of each field. Every PETSc option
    works with the prefix, for example `-anisocontact_snes_linesearch_type basic`.

    Args:
        problem: The system.
        prefix: Prefix of the PETSc options.
        options: PETSc options without prefix; those already in the PETSc database come first.
        on_iteration: Called with the number of the iteration and the residual.

    Raises:
        InputError: `snes_type` is one that takes any state for a solution, or needs others.

    Example:
        A block that is held below and pushed from above; its equations are linear.

        >>> from anisocontact.bulk import make_material
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> from anisocontact.solver import Problem, Step
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        >>> problem = Problem(model, {"block": make_material("linear-elastic", E=100.0, nu=0.3)})
        >>> held = {"block.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
        >>> problem.begin(Step("push", 1, held, traction={"block.top": {"z": -1.0}}))
        >>> problem.set_load_factor(1.0, 1.0)
        >>> newton = Newton(problem, "example_", {}, lambda number, residual: None)
        >>> newton.solve(problem.accepted()).iterations
        1
        >>> newton.close()
    """

    def __init__(
        self,
        problem: System,
        prefix: str,
        options: Mapping[str, OptionValue],
        on_iteration: Callable[[int, float], None],
    ) -> None:
        self._problem = problem
        self.snes = PETSc.SNES().create(problem.comm)
        # what SNES calls must not keep it alive
        settled = SettledContact(problem, weakref.proxy(self.snes))
        self._iteration = NewtonIteration(problem, on_iteration, settled)
        self.snes.setOptionsPrefix(prefix)
        self.snes.setFunction(self._iteration.function, problem.new_vector())
        self.snes.setJacobian(self._iteration.jacobian, problem.new_tangent())
        self.snes.setTolerances(rtol=TOLERANCE, atol=0.0, stol=0.0, max_it=MOST_ITERATIONS)
        # Some options, such as those of MUMPS, are read when they are first needed, in `solve`.
        self._database = Database(prefix, DEFAULTS | dict(options))
        with self._database:
            self.snes.setFromOptions()
            given = PETSc.Options(prefix).hasName("snes_max_it")
            self.snes.getKSP().setFromOptions()
            self.snes.getKSP().getPC().setFromOptions()
        if why := _UNFIT.get(self.snes.getType()):
            text = f"{self.snes.getType()!r} given, which {why}"
            raise InputError(text, field="options.snes_type")
        self.snes.setConvergenceTest(self._iteration.converged)
        self.snes.setLineSearchPreCheck(self._iteration.damp)
        self._line_search = self.snes.getLineSearch().getType()
        if given:
            self._iteration.patience = self.snes.getTolerances()[3]

    def persistent(self) -> Arrays:
        """Nothing is kept from one solution to the next."""
        return {}

    def close(self) -> None:
        """Give back PETSc's objects at once, also those of several processes."""
        self.snes.destroy()

    @property
    def residual(self) -> Floats:
        """Residual of the unknowns this rank owns at the last iterate."""
        return np.array(self.snes.getFunction()[0].array_r)

    def solve(
        self, x: Vec, full_steps: bool = False, damping: Callable[[], float] | None = None
    ) -> NewtonResult:
        """Correct `x` until it is in equilibrium or no more can be done.

        Args:
            x: Start, overwritten by the last iterate, length.
            full_steps: Whether to go without line search: it holds back where a law jumps, as the
                explicit rule does between stick and slip.
            damping: Asked before every correction what share of it is to be taken, 0 to 1.

        Returns:
            What came of it.
        """
        usual = self._line_search == PETSc.SNESLineSearch.Type.BT
        with self._problem.corrected(usual and not full_steps) as full:
            self._iteration.damp_by(damping, full)
            return self._solve(x, full or full_steps)

    def _solve(self, x: Vec, full_steps: bool) -> NewtonResult:
        """Equilibria, with better multipliers or softer penalties, until there is the last one."""
        spent = 0
        last = x.copy()
        while True:
            contacts = self._problem.contact_term
            self._iteration.mixes = self._mixed and not full_steps
            self._search_along(full_steps or contacts.simultaneous or self._iteration.mixes)
            result = self._equilibrium(x)
            spent += result.iterations
            try:
                again = self._problem.soften() if result.reason else self._problem.improve(x)
            except NotHeldError as error:
                result, again = replace(result, reason=str(error)), False
            except LostError as error:
                result = replace(result, reason=str(error), culprits=(error.culprit,))
                again = False
            if not again:
                found = not result.reason and spent > 0
                return replace(result, iterations=spent, unstable=found and self._unstable())
            if result.reason:
                last.copy(x)
            else:
                x.copy(last)

    @property
    def _mixed(self) -> bool:
        """Whether penalties press bodies whose pressures follow corrections."""
        followed = self._problem.followed
        follows = followed is not None and followed.active
        return follows and self._problem.contact_term.by_penalties

    def _unstable(self) -> bool:
        """Whether the last tangent has a negative eigenvalue, as far as found; collective."""
        return unstable(self.snes.getKSP(), self._problem.comm)

    def _search_along(self, full_steps: bool) -> None:
        """Take full steps, or the line search of the options."""
        search = self.snes.getLineSearch()
        kind = PETSc.SNESLineSearch.Type.BASIC if full_steps else self._line_search
        # trust regions have none, and PETSc reads what is no type as a text
        if self._line_search is None or search.getType() == kind:
            return
        search.setType(kind)
        if not full_steps:
            with self._database:  # a new type has none of the options of the one before
                search.setFromOptions()

    def _equilibrium(self, x: Vec) -> NewtonResult:
        """Newton's method with the multipliers as they are."""
        self._iteration.begin()
        # PETSc leaves the iterate locked where a callback raises: that is not to be the caller's.
        iterate = x.copy()
        try:
            with self._database:
                self.snes.solve(None, iterate)
        except PETSc.Error as error:
            if isinstance(error.__cause__, SingularError):
                known = self._iteration.residuals
                return NewtonResult(len(known) - 1, known, str(error.__cause__))
            # What a callback raises (an interrupt too) comes wrapped by PETSc.
            raise error.__cause__ or error from None
        iterate.copy(x)
        reason = self.snes.getConvergedReason()
        text = "" if reason > 0 else self._explain(reason)
        if reason == PETSc.SNES.ConvergedReason.DIVERGED_LINEAR_SOLVE:
            ksp = self.snes.getKSP()
            check_memory(ksp.getPC())
            if not_finite(ksp.getPC()):
                text = "the tangent matrix has values that are not finite"
            forget_failure(ksp)
        balance = self._problem.balance
        lost = bool(text) and balance.in_rounding(self.snes.getFunctionNorm())
        known = self._iteration.residuals
        far = balance.far if lost else 0.0
        return NewtonResult(self.snes.getIterationNumber(), known, text, far=far)

    def _explain(self, reason: int) -> str:
        reasons = PETSc.SNES.ConvergedReason
        residuals = self._iteration.residuals
        last = residuals[-1] if residuals else np.nan
        known = {
            reasons.DIVERGED_MAX_IT: "no convergence in {n} Newton iterations, residual {r:.1e}",
            reasons.DIVERGED_FUNCTION_NANORINF: "the residual is not a number",
            reasons.DIVERGED_FUNCTION_DOMAIN: "the residual is not a number",
            reasons.DIVERGED_LINEAR_SOLVE: "the tangent matrix could not be factorised "
            "(a body without support?)",
            reasons.DIVERGED_LINE_SEARCH: "the line search got stuck, residual {r:.1e}",
            reasons.DIVERGED_LOCAL_MIN: "corrections of the multipliers gain nothing, "
            "residual {r:.1e}",
            reasons.DIVERGED_DTOL: "the Newton iteration diverged, residual {r:.1e}",
        }
        text = known.get(reason, f"SNES stopped with reason {reason}")
        text = text.format(n=self.snes.getIterationNumber(), r=last)
        norm = self.snes.getFunctionNorm()
        return ", ".join(filter(None, [text, self._problem.balance.explained(norm)]))
