"""Running a case: solve, write, and always end in one of done or stopped."""

from __future__ import annotations

import signal
import traceback
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from anisocontact.base.arrays import by_place
from anisocontact.base.errors import InputError, RunError, one_line
from anisocontact.base.machine import lack
from anisocontact.base.shown import shown
from anisocontact.base.signals import interrupt, on_signals
from anisocontact.case.build import Built
from anisocontact.case.named_files import fingerprints
from anisocontact.results.checkpoint import NAME, Stored, distribute
from anisocontact.results.files import WriteError
from anisocontact.results.output_options import Labels
from anisocontact.results.report_process import Reporter, report_here
from anisocontact.results.writer import Writer
from anisocontact.solver import Accepted, Cut, Progress, StoppedError


class Listener(Protocol):
    """Who wants to know how a run goes on."""

    def iteration(self, progress: Progress) -> None:
        """A Newton iteration has been made."""

    def accepted(self, accepted: Accepted, numbers: dict[str, Any]) -> None:
        """An increment has converged; `numbers` is the summary so far."""

    def cut(self, cut: Cut) -> None:
        """An increment has failed and is tried again in smaller sub-increments."""

    def warning(self, text: str) -> None:
        """Something has happened that the user should look at."""

    def stopping(self) -> None:
        """The run has been asked to stop and will, after the increment."""

    def lost(self) -> str:
        """Why nobody can be told any more, in a few words; empty while somebody can."""


@dataclass(frozen=True)
class RunOutcome:
    """How a run ended.

    Args:
        status: "done" or "stopped".
        message: Why it stopped; empty if it is done.
        folder: Where its results are.
        warnings: What the user should look at.
        goes_on: Whether it has a checkpoint from which it can go on.
    """

    status: str
    message: str
    folder: Path
    warnings: tuple[str, ...] = ()
    goes_on: bool = False


def run(
    built: Built,
    folder: str | Path,
    listener: Listener,
    checkpoint: Stored | None = None,
    reporter: Reporter = report_here,
) -> RunOutcome:
    """Solve the steps of a case and write its results.

    A first Ctrl-C, or the signals TERM and HUP, end the run after the current increment, as does a
    listener that has been lost; a Ctrl-C after that ends it at once. The folder has checkpoints
    by time (`checkpoint_every` of the table `[output]`), and one of the last accepted increment
    however the run ends in order.

    Args:
        built: The case with its problem.
        folder: Results folder; an earlier run in it is replaced, or goes on.
        listener: Called for every iteration and increment.
        checkpoint: Where to go on; from the beginning if not given.
        reporter: Writes the report.

    Returns:
        Done, or stopped and why; what converged is in the folder.

    Raises:
        InputError: The checkpoint does not fit the mesh or the contacts.
        RunError: Something unforeseen happened; `run.log` has the details.
    """
    text = built.file.text
    facts = {"case": text, "files": _read_once(built)}
    doubts = built.doubts()
    if checkpoint is not None:
        solver = built.solver
        solver.restore(distribute(checkpoint, built.problem.model, solver.persistent()))
    try:
        writer = _writer(built, folder, text, checkpoint, reporter)
    except WriteError as error:
        return RunOutcome("stopped", str(error), Path(folder), goes_on=checkpoint is not None)
    writer.strategy(built.solver.choice.name, built.solver.choice.reason)
    for doubt in doubts:
        writer.log(f"warning: {doubt}")
    request = _StopRequest(listener)
    with on_signals(request.by_signal):
        curable = _run_and_close(built, writer, request, facts, doubts)
    summary = writer.summary
    status, message = summary["status"], summary["message"]
    goes_on = curable and (writer.folder / NAME).is_file()
    return RunOutcome(status, message, writer.folder, tuple(summary["warnings"]), goes_on)


class _End(NamedTuple):
    """How a run ended.

    Attributes:
        status: "done" or "stopped".
        message: Why it stopped.
        curable: Whether what may change before a run goes on can help.
    """

    status: str
    message: str
    curable: bool = True


def _run_and_close(
    built: Built,
    writer: Writer,
    request: _StopRequest,
    facts: dict[str, Any],
    doubts: Sequence[str],
) -> bool:
    """Run the steps and close the results, however it ends; whether the run can go on.

    Raises:
        RunError: Something unforeseen happened.
        InputError: A mistake has shown on this process, and other processes are stuck.
        MachineError: The machine lacks something, and other processes are stuck.
        KeyboardInterrupt: The run was interrupted at once, and other processes are stuck.
    """
    together = built.problem.together
    try:
        end = _solve(built, writer, request, facts)
    except InputError as error:  # on this process alone: others would wait in the last results
        writer.abandon(str(error))
        raise
    except KeyboardInterrupt:
        end = _End("stopped", "interrupted")
        if together.met() is None:
            writer.abandon(end.message)
            raise
    except Exception as error:
        lacking = lack(error)
        text = one_line(f"{type(error).__name__}: {error}")
        end = _End("stopped", str(lacking or f"internal error: {text}"))
        if together.met() is None:
            writer.abandon(end.message, traceback.format_exc())
            raise lacking or RunError(f"{text}; {_details(writer)}") from error
        for line in traceback.format_exc().splitlines():
            writer.log(line)
        if lacking is None:
            with suppress(WriteError):  # the reason is what is told
                writer.close(end.status, end.message, [*doubts, *built.solver.doubtful])
            raise RunError(f"{text}; {_details(writer)}") from error
    with suppress(WriteError):  # the summary has it
        writer.close(end.status, end.message, [*doubts, *built.solver.doubtful])
    return end.curable


def _read_once(built: Built) -> dict[str, str]:
    """Fingerprints of the files of a case, read by the first process for all."""
    comm = built.problem.comm
    found: dict[str, str] = {}
    error = None
    if comm.rank == 0:
        try:
            found = fingerprints(built.file)
        except InputError as mistake:
            error = mistake
    found, error = comm.bcast((found, error))
    if error is not None:
        raise error
    return found


def _details(writer: Writer) -> str:
    return f"details in {writer.folder / 'run.log'}"


def _writer(
    built: Built, folder: str | Path, text: str, checkpoint: Stored | None, reporter: Reporter
) -> Writer:
    case = built.file.case
    labels = Labels(
        title=case.title or built.file.name,
        masters=[contact.master for contact in case.contact],
        units=case.units.labels(),
    )
    return Writer(
        folder,
        built.problem,
        built.steps,
        case.output.options(),
        labels,
        case=text,
        reporter=reporter,
        resumed=checkpoint.facts["writer"] if checkpoint else None,
    )


@dataclass(frozen=True)
class _Reports:
    """Tells log and listener what a run does.

    Attributes:
        writer: Writer of the results.
        request: Who listens.
    """

    writer: Writer
    request: _StopRequest

    def iteration(self, progress: Progress) -> None:
        self.writer.log(_iteration_line(progress))
        self.request.listener.iteration(progress)
        self.request.acknowledge()

    def cut(self, cut: Cut) -> None:
        self.writer.cut(cut)
        self.request.listener.cut(cut)

    def warning(self, text: str) -> None:
        self.writer.log(f"warning: {text}")
        self.request.listener.warning(text)

    def accepted(self, accepted: Accepted) -> None:
        self.request.listener.accepted(accepted, self.writer.summary)
        self.writer.log(accepted_line(accepted, self.writer.summary))
        for said in ran_off_lines(accepted):
            self.writer.log(said)


def _solve(built: Built, writer: Writer, request: _StopRequest, facts: dict[str, Any]) -> _End:
    """Run the steps, and keep the last accepted increment."""
    try:
        ended = _increments(built, writer, request, facts)
        writer.keep_last()
    except WriteError as error:
        return _End("stopped", str(error))
    return ended


def _increments(built: Built, writer: Writer, request: _StopRequest, facts: dict[str, Any]) -> _End:
    reports = _Reports(writer, request)

    def keep() -> None:
        place = built.solver.place
        begun = {"begun": place.step + place.begun}
        writer.keep(built.solver.persistent(), facts | begun)

    comm = built.problem.comm
    try:
        keep()
        if comm.allreduce(bool(request.why())):
            return _End("stopped", request.why())
        for accepted in built.solver.run(
            reports.iteration, reports.cut, writer.log, reports.warning
        ):
            writer.accept(accepted)
            keep()
            reports.accepted(accepted)
            if comm.allreduce(bool(request.why())) and not _was_last(built, accepted):
                where = f"step {accepted.step!r}, increment {accepted.increment}{_part(accepted)}"
                return _End("stopped", f"{request.why() or 'interrupted'} after {where}")
    except StoppedError as stop:
        writer.log_stop(str(stop), stop.culprits, stop.failed)
        return _End("stopped", str(stop))
    except InputError as error:  # of a law in Python, or a mistake that shows where a step begins
        if built.problem.together.met() is None:
            raise
        writer.log_stop(str(error), failed=error.failed)
        return _End("stopped", str(error), curable=not built.solver.place.begun)
    return _End("done", "")


def _was_last(built: Built, accepted: Accepted) -> bool:
    """Whether an accepted state ends the last step, or has its event: nothing is left to stop."""
    step = built.steps[-1]
    last = built.solver.place.step == len(built.steps) - 1
    at_end = accepted.increment == step.increments and accepted.done == 1.0
    return last and (at_end or bool(accepted.event))


def _iteration_line(progress: Progress) -> str:
    counts = "; ".join(points_text(points) for points in progress.contacts.values())
    return f"  iteration {progress.iteration}  residual {progress.residual:.2e}  {counts}"


def accepted_line(accepted: Accepted, numbers: dict[str, Any]) -> str:
    """One line for an accepted increment."""
    contacts = "; ".join(
        f"{points_text(contact['points'])}  force {shown(contact['force'])}"
        for contact in numbers["contacts"]
    )
    return (
        f"{accepted.step} {accepted.increment}{_part(accepted)}  {accepted.iterations} iterations  "
        f"residual {accepted.residuals[-1]:.1e}  {contacts}"
        + (f"  ends: {accepted.event}" if accepted.event else "")
    )


def _part(accepted: Accepted) -> str:
    """Up to which share of an increment a part of it has come; empty at its end."""
    return "" if accepted.done == 1.0 else f" ({accepted.done:.4g} of it)"


def ran_off_lines(accepted: Accepted) -> list[str]:
    """A line for each contact with points that left the end of the master in an increment."""
    lines = []
    for name, points in accepted.ran_off.items():
        first = shown(points[by_place(points)[0]])
        count = f"{len(points)} point{'s' * (len(points) > 1)}"
        lines.append(f"  {name}: {count} ran off the end of the master, the first at {first}")
    return lines


def points_text(points: dict[str, int]) -> str:
    """Numbers of open, sticking and slipping points."""
    return " ".join(f"{name} {count}" for name, count in points.items())


@dataclass
class _StopRequest:
    """Whether a run has been asked to stop, by a signal or because nobody listens any more.

    Args:
        listener: Called once.
    """

    listener: Listener
    _signal: int = field(default=0, init=False)
    _acknowledged: bool = field(default=False, init=False)

    def by_signal(self, number: int) -> None:
        """Take a signal; a Ctrl-C after another one interrupts at once.

        Other signals come twice without anybody meaning it: from the shell and the terminal, or
        from a launcher and the batch system.
        """
        if self._signal and number == signal.SIGINT:
            interrupt(number)
        self._signal = self._signal or number

    def why(self) -> str:
        """Why it is to stop, in a few words; empty if it is not."""
        return "interrupted" if self._signal else self.listener.lost()

    def acknowledge(self) -> None:
        """Say that a signal has been taken."""
        if self._signal and not self._acknowledged:
            self._acknowledged = True
            self.listener.stopping()
