"""Ways to solve one sub-increment of the load, one after the other until one converges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from anisocontact.base.fenicsx import Vec
from anisocontact.contact.multiplier_schemes import (
    COMPLIANT,
    GRADED,
    GRADED_SLENDER,
    IN_CYCLES,
    PENALTIES,
    SINGLY,
    SLENDER,
    SOFTER,
    USUAL,
)
from anisocontact.interface.failed_point import FailedPoint
from anisocontact.solver.stepping.acceptance import Refusal, refused
from anisocontact.solver.stepping.compliant_penalties import CompliantPenalties
from anisocontact.solver.stepping.continuation import LAYERED, Continuation
from anisocontact.solver.stepping.convergence_diagnostics import failed_point, find_culprits
from anisocontact.solver.stepping.events import EventWatch
from anisocontact.solver.stepping.failure_reasons import CONCLUSIVE, explained, more_severe
from anisocontact.solver.stepping.graded_penalties import GradedPenalties
from anisocontact.solver.stepping.increment_control import IncrementControl
from anisocontact.solver.stepping.overload import Overload
from anisocontact.solver.stepping.status_watch import StatusWatch
from anisocontact.solver.stepping.turn_watch import TurnWatch
from anisocontact.solver.strategies.newton import NewtonResult
from anisocontact.solver.strategies.strategy import IncrementSolver
from anisocontact.solver.system.culprit import Culprit
from anisocontact.solver.system.problem import Problem

#: Smallest share of a correction that is taken while the status of points alternates.
LEAST_SHARE = 1.0 / 64.0
#: Sub-increments in a row, each smaller than the one before, whose loads throw bodies farther than
#: all is long: beyond that no smaller load is held either.
FLOWN = 3
#: Kinds that shares of corrections do not help against.
NEVER_DAMPED = {"law", "inverted"}


@dataclass(frozen=True)
class Outcome:
    """What came of all attempts.

    Attributes:
        result: Of the attempt that converged, or of the last; iterations are those of all.
        culprits: Places that caused the failure of one of them.
        final: Whether no smaller sub-increment can help, see `Refusal`.
        hint: What may be behind the failure, and what to do about it.
        failed: A point at which the laws failed, on the first rank that has one.
        relaxed: Whether penalties hold where no multipliers were found.
        way: Scheme that led to the multipliers, see `multiplier_schemes`.
        refused: Whether an equilibrium was found that no model of a body holds for.
        ahead: Equilibrium at the end of the sub-increment that was refused as points turn too far,
            or as it is beyond an event; smaller sub-increments are on the way to it.
    """

    result: NewtonResult
    culprits: tuple[Culprit, ...] = ()
    final: bool = False
    hint: str = ""
    failed: FailedPoint | None = None
    relaxed: bool = False
    way: str = USUAL
    refused: bool = False
    ahead: Vec | None = None

    @property
    def conclusive(self) -> bool:
        """Whether the failure is explained by itself, whatever loads there are."""
        return self.refused or any(culprit.kind in CONCLUSIVE for culprit in self.culprits)

    @property
    def iterations(self) -> int:
        """Newton iterations that show how hard it was: searching multipliers does not."""
        return len(self.result.residuals) - 1 if self.relaxed else self.result.iterations


@dataclass(frozen=True)
class _Attempt:
    """One attempt.

    Attributes:
        start: State that it starts from.
        ratio: Size of the sub-increment over the last one if that is extrapolated, else 0.
        full_steps: Whether there is no line search.
        damped: Whether corrections are taken in shares while the status of points alternates.
        regularised: Whether viscous forces act, see `ViscousRegularisation`.
        multipliers: Way to the multipliers of augmented contacts.
        spare: Whether its failure says nothing of what holds the bodies.
        detour: What is solved before the laws as they are: `LAYERED`, see `Continuation`,
            `COMPLIANT`, `GRADED`, see `CompliantPenalties`, `GradedPenalties`, or nothing.
    """

    start: Vec
    ratio: float = 0.0
    full_steps: bool = True
    damped: bool = False
    regularised: bool = False
    multipliers: str = USUAL
    spare: bool = False
    detour: str = ""

    @property
    def way(self) -> str:
        """Scheme of the multipliers, or how penalties are come to."""
        return self.detour or self.multipliers


class Attempts:
    """Solves for given loads and commits what converges.

    The first attempt starts from the extrapolated state with a line search, the last one from the
    accepted state with full steps: a line search stops in front of a jump of the law. Both are one
    where nothing is extrapolated and pressures of cells follow corrections in full steps. Where
    adhesion is stiff one with compliant layers comes between them, where penalties are one with
    multipliers before them, see `Continuation`. Other penalties are come to by way of multipliers
    between them, see `CompliantPenalties`, and raised from soft ones where both fail, see
    `GradedPenalties`, and from then on where the first does. Where the status of points alternated,
    a further one takes a share of each correction: half as much as before where it still
    alternates, twice as much where it does not. Where that does not help either and the
    sub-increment is small, the last one regularises, see `ViscousRegularisation`. Where a
    sub-increment is tiny, both are tried whatever was in the way. Where multipliers are not
    required and a cut did not lead to them, penalties come before these last ones. Where contact
    may hold free bodies without springs, an attempt without them comes before all these.
    Multipliers that follow every correction have ways of their own, see `_following`.

    Args:
        problem: The problem.
        newton: Its solver.
        watch: Called in every iteration.
        turns: Judges how far points in contact turn.
    """

    def __init__(
        self, problem: Problem, newton: IncrementSolver, watch: StatusWatch, turns: TurnWatch
    ) -> None:
        self._turns = turns
        #: Looks for the event of the step.
        self.events: EventWatch | None = None
        self._problem = problem
        self._newton = newton
        self._watch = watch
        self._share = 1.0
        self._final = False
        self._flown = 0
        self._failed: FailedPoint | None = None
        self._ahead: Vec | None = None
        self._continuation = Continuation(problem, newton)
        self._compliant = CompliantPenalties(problem.contacts, newton)
        self._graded = GradedPenalties(problem.contacts, newton)
        self._detours = {
            LAYERED: self._continuation.solve,
            COMPLIANT: self._compliant.solve,
            GRADED: self._graded.solve,
        }

    def solve(
        self,
        first: Vec,
        last: Vec,
        ratio: float,
        control: IncrementControl,
        overloads: Sequence[Overload] = (),
    ) -> Outcome:
        """Solve and commit, or roll back.

        Args:
            first: Extrapolated state.
            last: Accepted state.
            ratio: Size of this sub-increment over that of the last one, 0 where nothing is
                extrapolated.
            control: Size of the sub-increment: in a small one, that is not likely to get smaller,
                more is tried, in a tiny one everything, whatever failed.
            overloads: Loads that friction does not hold at the end of the sub-increment: everything
                is tried, and what fails is final where nothing else can come to hold the bodies.

        Returns:
            What converged, or why nothing did, and where.
        """
        spent, self._failed, self._ahead, failed, far = 0, None, None, "", False
        overloaded, hopeless = bool(overloads), any(one.certain for one in overloads)
        found: list[Culprit] = []
        seen: set[str] = set()
        ways = self._planned(first, last, ratio, control)
        for way in ways:
            result, culprits = self._attempt(way)
            spent += result.iterations
            if not result.reason:
                self._flown = 0
                result = replace(result, iterations=spent)
                relaxed = way.multipliers == PENALTIES
                return Outcome(result, relaxed=relaxed, way=way.way)
            # nothing but a smaller sub-increment can help
            if self._turns.objects or (self.events is not None and self.events.objects):
                return Outcome(replace(result, iterations=spent), ahead=self._ahead)
            # a regularised attempt without culprits says nothing of what was in the way
            if not way.regularised or result.culprits:
                failed, found = result.reason, more_severe(found, culprits)
            far |= result.far > 0.0
            seen |= {culprit.kind for culprit in culprits}
            alternates = "chattering" in seen and not seen & NEVER_DAMPED
            if way is ways[-1] and not self._final and (alternates or control.tiny or overloaded):
                ways += self._last_resorts(way, control.small or overloaded)
        reason = explained(failed, found, self._problem.contacts)
        result = replace(result, iterations=spent, reason=reason)
        hint = self._continuation.hint()
        self._flown = self._flown + 1 if far else 0
        final, failed_at = self._final or hopeless or self._flown > FLOWN, self._failed
        return Outcome(result, tuple(found), final, hint, failed_at, refused=self._final)

    def _planned(
        self, first: Vec, last: Vec, ratio: float, control: IncrementControl
    ) -> list[_Attempt]:
        """Attempts in their order, without the last resorts; arguments as of `solve`."""
        searching, full = _Attempt(first, ratio, full_steps=False), _Attempt(last)
        ways = self._ordered(searching=searching, full=full, led=control.way)
        if not (control.may_relax and PENALTIES in self._problem.contact_term.ways):
            return ways
        relaxed = [replace(way, multipliers=PENALTIES) for way in self._apart(searching, full)]
        return [*(ways[:1] if control.relaxed else ways), *relaxed]

    def _ordered(self, *, searching: _Attempt, full: _Attempt, led: str) -> list[_Attempt]:
        """Attempts in their order, without penalties in the place of multipliers.

        Args:
            searching: From the extrapolated state with a line search.
            full: From the accepted state in full steps.
            led: What led to the last equilibrium, see `Outcome.way`.
        """
        stiff, layered = self._continuation.stiff(), replace(full, detour=LAYERED)
        freely = self._problem.stabilisation.trusts  # one without springs comes before
        if self._problem.contact_term.simultaneous:
            ways = self._to_multipliers(searching=searching, full=full, led=led)
        else:
            both = [searching, full] if stiff else self._apart(searching, full)
            if stiff and self._continuation.easy:
                return [*[layered] * (1 + freely), *both]
            ways = [*both[:1] * freely, *both]
            if not stiff:
                return self._with_detours(ways, full, led)
        if not stiff:
            return ways
        begun, later = ways[: 1 + freely], ways[1 + freely :]
        return [*begun, layered, *later]

    def _to_multipliers(self, *, searching: _Attempt, full: _Attempt, led: str) -> list[_Attempt]:
        """Ways to multipliers that follow every correction; arguments as of `_ordered`."""
        cycles = IN_CYCLES in self._problem.contact_term.ways
        schemes = [USUAL, SOFTER]
        if cycles and not self._problem.linear:
            schemes.append(SLENDER)
        if cycles:
            slender = self._problem.contact_term.slender
            schemes += [GRADED_SLENDER if slender else GRADED, SINGLY]
        if led != GRADED:  # it leads bodies that do not bend by detours: 504 corrections for 99
            schemes.sort(key=led.__ne__)
        freely = self._problem.stabilisation.trusts
        return _following(searching, full, schemes=schemes, cycles=cycles, freely=freely)

    def _with_detours(self, ways: list[_Attempt], full: _Attempt, led: str) -> list[_Attempt]:
        """Penalties by way of multipliers before the last of some ways, from soft ones after it."""
        # slender bodies, which bend, are led to penalties from soft ones or not at all
        suits = self._problem.contact_term.compact and self._compliant.contacts
        compliant = [replace(full, detour=COMPLIANT)] if suits else []
        graded = [replace(full, detour=GRADED)] if self._graded.contacts else []
        first, *later = ways
        order = [*later[:-1], *compliant, *later[-1:], *graded]
        return [first, *sorted(order, key=lambda way: way.detour != led)]

    def _apart(self, searching: _Attempt, full: _Attempt) -> list[_Attempt]:
        """Both ways; one where there is neither extrapolation nor a line search between them."""
        return [searching, full] if searching.ratio or not self._problem.in_full else [full]

    def _last_resorts(self, failed: _Attempt, may_jump: bool) -> list[_Attempt]:
        """What is left to be tried where the status of points alternates, or sizes are tiny."""
        if not failed.damped and not failed.regularised:
            return [replace(failed, damped=True, detour="")]
        if may_jump and self._problem.stabilisation.enabled and not failed.regularised:
            # on the way from one contact to another multipliers are found with smaller penalties
            follows = SOFTER in self._problem.contact_term.ways
            by = SOFTER if follows else failed.multipliers
            return [_Attempt(failed.start, regularised=True, multipliers=by)]
        return []

    def _attempt(self, way: _Attempt) -> tuple[NewtonResult, list[Culprit]]:
        problem = self._problem
        self._watch.clear()
        self._share, self._final, self._turns.objects = 1.0, False, False
        x = way.start.copy()
        try:
            result = self._correct(way, x)
            refusal = None if result.reason else self._objection(way, x)
            if not result.reason and refusal is None:
                problem.commit(x)
                return result, []
            if not way.spare:
                problem.stabilisation.distrust()
            if refusal is not None:
                self._final = refusal.final
                return replace(result, reason=refusal.reason), list(refusal.culprits)
            return result, self._culprits(result)
        except (Exception, KeyboardInterrupt):
            problem.together.met()
            raise
        finally:
            problem.stabilisation.regularisation.stop()
            if not problem.together.apart:
                self._continuation.end()
                problem.roll_back()

    def _correct(self, way: _Attempt, x: Vec) -> NewtonResult:
        """Newton's method on one of the ways; `x` is its start, and its last iterate."""
        problem = self._problem
        if way.regularised:
            problem.stabilisation.regularisation.start(problem.nodal)
        problem.contact_term.take_way(way.multipliers)
        problem.contact_term.predict(way.ratio)
        if way.detour:
            return self._detours[way.detour](x)
        damping = self._damping if way.damped else None
        return self._newton.solve(x, way.full_steps, damping)

    def _objection(self, way: _Attempt, x: Vec) -> Refusal | None:
        """Why a state in equilibrium is not accepted, if it is not."""
        refusal = refused(self._problem, x)
        if refusal is None and not way.regularised:
            # a jump turns points by as much in the smallest sub-increment
            refusal = self._turns.objection(self._problem)
            self._ahead = x if self._turns.objects else None
        if refusal is None and self.events is not None:
            refusal = self.events.objection(x)
            self._ahead = x if refusal is not None and not way.regularised else None
        return refusal

    def _culprits(self, result: NewtonResult) -> list[Culprit]:
        """Where an attempt failed that found no equilibrium."""
        known = list(result.culprits)
        known = known or find_culprits(self._problem, self._watch, self._newton.residual)
        if known and known[0].kind == "law":
            self._failed = failed_point(self._problem)
        return known

    def _damping(self) -> float:
        unsettled = self._problem.comm.allreduce(self._watch.unsettled())
        self._share = max(0.5 * self._share, LEAST_SHARE) if unsettled else 2.0 * self._share
        self._share = min(self._share, 1.0)
        return self._share


def _following(
    first: _Attempt, last: _Attempt, *, schemes: Sequence[str], cycles: bool, freely: bool
) -> list[_Attempt]:
    """Ways where multipliers follow every correction, each from the accepted history.

    Corrections as long as the balance of forces allows, see `Backtracking`, which close one point
    at a time where they gain nothing and nothing sticks, the same with smaller penalties, at finite
    strain with those of slender bodies, then, where there are cycles, such that begin with soft
    penalties, corrections that close one point at a time whatever sticks, and cycles with penalties
    that suit the bodies, then shares of corrections with smaller penalties.

    Args:
        first: From the extrapolated state.
        last: From the accepted state.
        schemes: Those of the first attempts, in the order in which they are tried.
        cycles: Whether multipliers can be found in cycles instead.
        freely: Whether the first attempt has no springs where contact may hold free bodies.
    """
    usual = replace(first, spare=cycles)
    begun = [replace(usual, multipliers=one) for one in schemes]
    again = replace(first, multipliers=IN_CYCLES) if cycles else first
    ways = [again] if freely or cycles else []
    if freely and cycles:
        ways.append(again)
    if first.start is not last.start:
        ways.append(replace(last, multipliers=again.multipliers))
    return [*begun, *ways, replace(last, multipliers=SOFTER, damped=True)]
