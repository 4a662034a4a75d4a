"""Steps in increments: start, Newton, accept, cut or stop."""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence

from anisocontact.base.blas_threads import with_one_thread
from anisocontact.base.errors import InputError, tell_script
from anisocontact.base.fenicsx import Vec, release_unreferenced
from anisocontact.base.limits import Limits
from anisocontact.base.strategies import AUTO
from anisocontact.base.typed import typed
from anisocontact.base.uncopied import Uncopied
from anisocontact.contact import warn_of
from anisocontact.contact.multiplier_schemes import SLENDER
from anisocontact.solver.stepping.attempts import Attempts, Outcome
from anisocontact.solver.stepping.bending import bend, told_if_unstable
from anisocontact.solver.stepping.border_watch import without_slip
from anisocontact.solver.stepping.convergence_diagnostics import NAMED, folded_by_deformation
from anisocontact.solver.stepping.cut_faces import CutFaceWatch
from anisocontact.solver.stepping.energy_watch import EnergyWatch
from anisocontact.solver.stepping.events import EventWatch, check_events
from anisocontact.solver.stepping.failures import Failures
from anisocontact.solver.stepping.increment_warnings import IncrementWarnings
from anisocontact.solver.stepping.moved_across import AcrossWatch
from anisocontact.solver.stepping.overload import (
    AT_LIMIT,
    least_halved,
    past_holding,
    too_much_load,
)
from anisocontact.solver.stepping.predictor import Predictor
from anisocontact.solver.stepping.prescribed_turns import prescribed_turns
from anisocontact.solver.stepping.report import Accepted, Cut, Progress, StoppedError
from anisocontact.solver.stepping.rolling_watch import RollingWatch
from anisocontact.solver.stepping.run_position import RunPosition, fraction
from anisocontact.solver.stepping.same_problem import as_array, check_run, described_run, size_of
from anisocontact.solver.stepping.status_watch import StatusWatch
from anisocontact.solver.stepping.symmetry_watch import SymmetryWatch
from anisocontact.solver.stepping.turn_watch import PRESCRIBED, TurnWatch, half_turns
from anisocontact.solver.stepping.turned_faces import TurnedFaceWatch
from anisocontact.solver.strategies.choice import choose
from anisocontact.solver.strategies.database import Database, OptionValue
from anisocontact.solver.strategies.strategy import IncrementSolver, Task
from anisocontact.solver.system.interior import PENDING
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.persistent import Arrays, Persistent, under
from anisocontact.solver.terms.step import Step


@typed
class Solver(Uncopied, changing="place doubtful"):
    """Runs the steps of a problem.

    An increment that does not converge is cut into sub-increments, which grow again where they
    converge; the end of every increment that a step asks for is met exactly.

    Args:
        problem: The problem, in any accepted state.
        steps: What to do, in order.
        options_prefix: Prefix of the PETSc options of the Newton solver.
        options: PETSc options without prefix, such as {"snes_rtol": 1e-10}.
        limits: Bounds of the increments.
        strategy: How the equations are solved, one of `strategies.STRATEGIES`.

    Attributes:
        choice: The strategy and why it was taken.
        place: How far the run has come.
        doubtful: What is hardly meant in the steps and, after an increment, in the options.
        cautions: What the steps ask for that is at the limit of a model, a line each.

    Raises:
        InputError: There is no step, one names an unknown facet group, shared nodes get two values,
            the strategy cannot solve the problem, or supports turn a body at small strain by more
            than five degrees.

    Example:
        >>> from anisocontact.bulk import make_material
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 4), (1, 1, 1))})
        >>> steel = {"bar": make_material("linear-elastic", E=200.0, nu=0.0)}
        >>> held = {"bar.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
        >>> pull = Step("pull", 1, held, traction={"bar.top": {"z": 5.0}})
        >>> for accepted in Solver(Problem(model, steel), [pull]).run():
        ...     print(accepted.increment, accepted.reactions["bar.bottom"].round(6)[2])
        1 -5.0
    """

    def __init__(
        self,
        problem: Problem,
        steps: Sequence[Step],
        options_prefix: str = "anisocontact_",
        options: Mapping[str, OptionValue] | None = None,
        limits: Limits | None = None,
        strategy: str = AUTO,
    ) -> None:
        warn_of(problem.contacts)
        self.problem = problem
        self.steps = tuple(steps)
        if not self.steps:
            raise InputError("no step given, one or more needed", field="steps")
        self.limits = limits or Limits()
        self.doubtful = problem.check(self.steps)
        check_events(problem, self.steps)
        turns = prescribed_turns(problem.model, problem.materials, self.steps)
        self.cautions = [*self.doubtful, *turns]
        self.place = RunPosition.beginning(0, 0.0, self.limits)
        self._task = Task(problem, self.steps, options_prefix, dict(options or {}))
        self.choice = choose(strategy, self._task)
        self._options = Database(options_prefix, self._task.options)
        self._newton: IncrementSolver | None = None
        self._begun: int | None = None
        self._solves = False
        self._kept: Arrays = {}
        self._waiting: Arrays = {}
        self._on_iteration: Callable[[Progress], None] | None = None
        self._on_cut: Callable[[Cut], None] | None = None
        self._watch = StatusWatch(problem.contacts)
        self._energy = EnergyWatch(problem)
        self._cut_faces, self._rolling = CutFaceWatch(problem), RollingWatch(problem)
        self._faces = TurnedFaceWatch(problem)
        self._symmetry, self._across = SymmetryWatch(problem), AcrossWatch(problem)
        self._turns = TurnWatch()
        self._predictor = Predictor(problem)
        self._failures = Failures(problem, self.doubtful)
        self._made_of = described_run(problem, self.steps)

    @typed
    def run(
        self,
        on_iteration: Callable[[Progress], None] | None = None,
        on_cut: Callable[[Cut], None] | None = None,
        on_note: Callable[[str], None] | None = None,
        on_warning: Callable[[str], None] | None = None,
    ) -> Iterator[Accepted]:
        """Solve increment by increment, from where the run has come.

        Once all steps are done there is nothing left to solve, and a warning says so.

        Args:
            on_iteration: Called at the start of each attempt and after each Newton iteration.
            on_cut: Called when an increment failed and is cut.
            on_note: Called with what is worth a line in a log.
            on_warning: Called with what the user should look at, as soon as it happens; goes to
                `on_note` if not given, and is a `RunWarning` if that is not given either.

        Yields:
            Every accepted increment or sub-increment; the problem holds its state until the next.

        Raises:
            StoppedError: An increment did not converge; the problem holds the last accepted one.
            InputError: Another solver has begun a step of the problem meanwhile, or this one was
                restored or has begun another run, which alone goes on.
        """
        self._end_last()
        self._on_iteration, self._on_cut = on_iteration, on_cut
        note = on_note or (lambda _: None)
        noted = tell_script if on_note is None else lambda text: note(f"warning: {text}")
        warn = on_warning or noted
        for text in self.doubtful:
            warn(text)
        if self.place.step == len(self.steps):
            warn("all steps are done: nothing is left to solve")
        self._energy.begin()
        self._predictor.begin()
        if not (self.choice.strategy.reduces and self._kept):
            self.problem.reduction.recover()
            self.problem.reduce_by(None)  # a run that was left open may have had it reduced
        with self._options.blamed(self.problem.together):
            yield from with_one_thread(self._all(note, warn))

    def persistent(self) -> Persistent:
        """State of the problem and of the run as last accepted, of this rank."""
        kept = self.problem.persistent()
        kept.common["problem"] = as_array(self._made_of)
        kept.common["energy_watch"] = self._energy.persistent()
        kept.common.update(self._turns.persistent())
        kept.common.update(self.place.persistent())
        before = self.place.before
        if before is not None:
            kept.nodal["before"], kept.common["before"] = self.problem.layout.split(before)
        self._predictor.persistent(kept)
        kept.strategy.update(self._kept if self._newton is None else self._newton.persistent())
        return kept

    @typed
    def restore(self, kept: Persistent) -> None:
        """Go on from what `persistent` gave; a `run` that begins now continues there.

        Args:
            kept: The state, of a problem that was made of the same, with the same steps so far.

        Raises:
            InputError: It is that of another problem: names what differs.
        """
        place = RunPosition.restored(kept.common, self.limits)
        size, begun = size_of(self.problem.model.positions), place.steps_begun
        check_run(kept, self._made_of, self.problem.persistent(), begun, size)
        self._end_last()
        self._turns.restore(kept.common)
        self.problem.restore(kept, self.steps[:begun], place.stopped)
        self._begun = self.problem.begun
        self._energy.restore(kept.common["energy_watch"])
        self._waiting = {n: v for n, v in kept.common.items() if n == "event"}
        self._kept = kept.strategy and kept.strategy | under(PENDING, kept.nodal)
        # without its interior it is no state to extrapolate from
        goes_on = bool(self._kept) and self.choice.strategy.reduces
        states = goes_on or not self.problem.reduction.pending()
        self._predictor.restore(kept, states)
        if "before" in kept.nodal and states:
            place.before = self.problem.layout.joined(kept.nodal["before"], kept.common["before"])
        self.place = place

    def _all(self, note: Callable[[str], None], warn: Callable[[str], None]) -> Generator[Accepted]:
        """Step by step, with a solver that is closed however it ends."""
        comm, strategy = self.problem.comm, self.choice.strategy
        with self._options:
            self._newton = newton = strategy.solver(self._task, self._report, note, self._kept)
        attempts = Attempts(self.problem, newton, self._watch, self._turns)
        warnings = IncrementWarnings()
        try:
            while self.place.step < len(self.steps):
                step = self.steps[self.place.step]
                for accepted in self._step(attempts, step):
                    unread = [*self._options.unread(comm)]
                    self.doubtful += unread
                    for text in (*unread, *warnings.of(accepted)):
                        warn(text)
                    yield accepted
                    self._check_last(newton)
                if (end := self.place.ended_at) is not None:
                    self.problem.end_at(end)
                self.place = self.place.after(step)
        except (Exception, KeyboardInterrupt):
            self.problem.together.met()
            raise
        finally:
            if self._newton is not newton:
                pass  # closed by what has ended this run
            elif self.problem.together.apart or sys.is_finalizing():
                self._newton = None  # others do not come along, or the libraries are gone
            else:
                self._end_last()

    def _step(self, attempts: Attempts, step: Step) -> Iterator[Accepted]:
        """Sub-increment by sub-increment to the end of the step, or to its event."""
        place, control, newton = self.place, self.place.control, self._newton
        largest, events = self._begin(step)
        attempts.events = events
        while control.increment <= step.increments:
            self._check_alone()
            self._check_last(newton)
            last = self.problem.accepted()
            if self._slides_before_end(step, events):
                continue
            outcome = self._part(attempts, step, last)
            place.spent += outcome.result.iterations
            if outcome.result.reason:
                self._predictor.refuse(outcome.ahead, control.part)
                if not events.objects:
                    self._cut(step, outcome)
                continue
            increment, done, part = control.increment, control.end, control.part
            events.accept(done == 1.0)
            self._predictor.accept(part)
            accepted = self._accepted(step, increment, done, outcome, events)
            control.advance(outcome.iterations, outcome.relaxed, outcome.way)
            if events.happened:
                place.stopped[place.step] = fraction(step, increment, done)
                control.increment = step.increments + 1
            control.bound(min(self._turns.allowed(part), largest))
            loads = not (self.problem.stabilisation.landed or self._energy.pushed_apart)
            place.before = last if loads else None
            place.spent = 0
            place.lost = None if done == 1.0 else place.lost
            yield accepted

    def _begin(self, step: Step) -> tuple[float, EventWatch]:
        """Take over the loads of a step, unless they are in a run that goes on.

        Returns:
            Largest sub-increment by how far the step turns rigid bodies, share of an increment; and
            what looks for its event.
        """
        place, control = self.place, self.place.control
        self._check_alone()
        if begins := not place.begun:
            self.problem.begin(step)
            self._begun = self.problem.begun
            self._turns.begin()
            self._predictor.forget()
            place.begun = True
        if bend(self.problem) and begins:
            control.way = SLENDER
        prescribed = self.problem.rigid.prescribed_turn(step) / step.increments
        largest = PRESCRIBED / max(prescribed, PRESCRIBED)
        if ambiguous := half_turns(prescribed, self.limits.smallest):
            raise StoppedError(step.name, control.increment, ambiguous)
        control.bound(largest)
        place.events = events = EventWatch(self.problem, step, self.limits.smallest)
        events.restore(self._waiting)
        self._waiting = {}
        return largest, events

    def _check_alone(self) -> None:
        """Refuse to go on where another solver has moved the problem away meanwhile."""
        if self._begun not in (None, self.problem.begun):
            text = "another solver has begun a step of it since: one at a time, each to its end"
            raise InputError(text, field="problem")

    def _end_last(self) -> None:
        """End the run that goes on, if there is one; the problem is brought up to date."""
        if self._solves:
            text = "it solves an increment: restore it, or begin another run, between increments"
            raise InputError(text, field="solver")
        if self._newton is not None:
            newton, self._newton, self._kept = self._newton, None, {}
            newton.close()

    def _check_last(self, newton: IncrementSolver | None) -> None:
        """Refuse to go on with a run that a restored state or another run has ended."""
        if self._newton is not newton:
            text = "it was restored, or has begun another run, since this run: begin a new one"
            raise InputError(text, field="solver")

    def _slides_before_end(self, step: Step, events: EventWatch) -> bool:
        """Whether friction cannot hold the loads where a step that ends with sliding goes next."""
        control = self.place.control
        control.goal = events.goal(control.done)
        events.begin(control.part, control.end)
        slides, end = events.slides(), fraction(step, control.increment, control.end)
        now = self.place.reached(step)
        found = too_much_load(self.problem, end, now, AT_LIMIT, slides) if slides else []
        if any(one.told or one.further for one in found):
            return events.overload()
        # pressures may move until then, and so may the limit: it is come closer to first
        if far := bool(found) and control.part > max(least_halved(found), self.limits.smallest):
            control.bound(0.5 * control.part)
        return far

    def _part(self, attempts: Attempts, step: Step, last: Vec) -> Outcome:
        """Solve the next sub-increment from the state that is predicted for its end."""
        control = self.place.control
        dt = step.duration / step.increments
        end = fraction(step, control.increment, control.end)
        part = dt if control.part == 1.0 else control.part * dt
        self.problem.set_load_factor(end, part)
        first, ratio = self._predictor.state(last, self.place.before, control)
        self._turns.permitted = control.cuttable
        release_unreferenced(self.problem.comm)
        # where friction cannot hold the loads no smaller sub-increment leads to their end
        overloads = past_holding(self.problem, end, self.place.reached(step), control.cuts)
        self._solves = True
        try:
            with self._options:
                return attempts.solve(first, last, ratio, control, overloads)
        finally:
            self._solves = False

    def _cut(self, step: Step, outcome: Outcome) -> None:
        """Make the next sub-increment smaller, or give up."""
        control, result = self.place.control, outcome.result
        tried, cuts = control.part, control.cuts
        if result.culprits:
            self.place.lost = outcome
        final = outcome.final or self._failures.hopeless(step, self.place, cuts, result)
        if final or not control.cut():
            last = f"{cuts} cuts, the last sub-increment was {tried:.2g}" if cuts else ""
            raise self._failures.stopped(step, self.place, outcome, last)
        more = self._failures.hint(step, self.place, cuts)
        if self._on_cut is not None:
            self._on_cut(
                Cut(
                    step=step.name,
                    increment=control.increment,
                    time=self.place.time_at(step, control.increment, control.done),
                    size=tried,
                    next_size=control.part,
                    reason="; ".join(text for text in (result.reason, more) if text),
                    iterations=result.iterations,
                    count=len(outcome.culprits),
                    culprits=outcome.culprits[:NAMED],
                )
            )

    def _report(self, iteration: int, residual: float) -> None:
        self._watch.note(residual)
        # with viscous regularisation bodies go far in an attempt
        if not self.problem.stabilisation.regularisation.active:
            self._watch.hold()
        if self._on_iteration is not None:
            counts = {c.name: c.counts() for c in self.problem.contacts}
            where = self.steps[self.place.step].name, self.place.control.increment
            self._on_iteration(Progress(*where, iteration, residual, counts))

    def _accepted(
        self, step: Step, increment: int, done: float, outcome: Outcome, events: EventWatch
    ) -> Accepted:
        last = increment == step.increments and done == 1.0
        contacts, energies = self.problem.contacts, self._energy.accepted()
        ran_off = {c.name: c.ran_off for c in contacts if len(c.ran_off)}
        return Accepted(
            step=step.name,
            step_index=self.place.step,
            increment=increment,
            done=done,
            time=self.place.time_at(step, increment, done),
            iterations=self.place.spent,
            residuals=outcome.result.residuals,
            contacts={c.name: c.counts() for c in contacts},
            resultants={c.name: c.resultant() for c in contacts},
            reactions=self.problem.reactions(),
            energies=energies,
            ran_off=ran_off,
            undetermined={c.name: n for c in contacts if (n := c.undetermined())},
            turned=self.problem.rotations.accepted,
            imbalance=self._energy.after(energies, bool(ran_off)),
            behind=tuple(self.problem.sides.partly),
            past_cuts=self._cut_faces.lost(),
            relaxed=outcome.relaxed,
            slivers={c.name: n for c in contacts if outcome.relaxed and (n := c.slivers())},
            rolled=self._rolling.strides(),
            faces=self._faces.faces(),
            without_slip=without_slip(self.problem),
            crossed=self._symmetry.crossed(),
            across=self._across.moved(),
            folded=folded_by_deformation(self.problem),
            unstable=outcome.result.unstable and told_if_unstable(self.problem),
            event=events.text if events.happened else "",
            missed=events.text if last and events.waits else "",
        )
