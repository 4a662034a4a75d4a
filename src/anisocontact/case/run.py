"""Running a case: solve, write, and always end in one of done or stopped."""

from __future__ import annotations

import signal
import threading
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any, Protocol

from anisocontact.case.build import Built
from anisocontact.case.law_file import fingerprints
from anisocontact.errors import InputError
from anisocontact.results.checkpoint import NAME, Stored, distribute
from anisocontact.results.files import WriteError
from anisocontact.results.writer import Writer
from anisocontact.solver import Accepted, Cut, Progress, StoppedError

__all__ = ["Listener", "Outcome", "RunError", "run"]


class Listener(Protocol):
    """Who wants to know how a run goes on."""

    def iteration(self, progress: Progress) -> None:
        """A Newton iteration has been made."""

    def accepted(self, accepted: Accepted, numbers: dict[str, Any]) -> None:
        """An increment has converged; `numbers` is the summary so far."""

    def cut(self, cut: Cut) -> None:
        """An increment has failed and is tried again in smaller parts."""

    def warning(self, text: str) -> None:
        """Something has happened that the user should look at."""

    def stopping(self) -> None:
        """The run has been asked to stop and will, after the increment."""


@dataclass(frozen=True)
class Outcome:
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


class RunError(RuntimeError):
    """A run ended in an error of the program; the results folder has what converged."""


def run(
    built: Built, folder: str | Path, listener: Listener, checkpoint: Stored | None = None
) -> Outcome:
    """Solve the steps of a case and write its results.

    A first Ctrl-C, or the signal TERM, ends the run after the current increment, a second one at
    once. After every accepted increment the folder has a checkpoint.

    Args:
        built: The case with its problem.
        folder: Results folder; an earlier run in it is replaced, or goes on.
        listener: Is told of iterations and increments.
        checkpoint: Where to go on; from the beginning if not given.

    Returns:
        Done, or stopped and why; what converged is in the folder.

    Raises:
        InputError: The checkpoint does not fit the mesh or the contacts.
        RunError: Something unforeseen happened; `run.log` has the details.
    """
    text = built.file.path.read_text(encoding="utf-8")
    laws = fingerprints(built.file.case.contact, built.file.resolve)
    facts = {"case": text, "laws": laws}
    together = built.problem.together
    if checkpoint is not None:
        solver = built.solver
        solver.restore(distribute(checkpoint, built.problem.model, solver.persistent()))
    try:
        writer = _writer(built, folder, text, checkpoint)
    except WriteError as error:
        return Outcome("stopped", str(error), Path(folder), goes_on=checkpoint is not None)
    writer.strategy(built.solver.choice.name, built.solver.choice.reason)
    try:
        status, message = _solve(built, writer, listener, facts)
    except KeyboardInterrupt:
        status, message = "stopped", "interrupted"
        if together.met() is None:
            writer.abandon(message)
            raise
    except Exception as error:
        text = " ".join(f"{type(error).__name__}: {error}".split())
        if together.met() is None:
            writer.abandon(f"internal error: {text}", traceback.format_exc())
        else:
            writer.log(traceback.format_exc())
            writer.close("stopped", f"internal error: {text}")
        raise RunError(f"{text}; details in {writer.folder / 'run.log'}") from error
    writer.close(status, message)
    warnings = tuple(writer.summary["warnings"])
    return Outcome(status, message, writer.folder, warnings, (writer.folder / NAME).is_file())


def _writer(built: Built, folder: str | Path, text: str, checkpoint: Stored | None) -> Writer:
    case = built.file.case
    return Writer(
        folder,
        built.problem,
        built.steps,
        masters=[contact.master for contact in case.contact],
        title=case.title or built.file.name,
        every=case.output.every,
        pictures=case.output.pictures,
        case=text,
        resumed=checkpoint.facts["writer"] if checkpoint else None,
    )


def _solve(
    built: Built, writer: Writer, listener: Listener, facts: dict[str, Any]
) -> tuple[str, str]:
    told = threading.Event()

    def on_iteration(progress: Progress) -> None:
        writer.log(_iteration_line(progress))
        listener.iteration(progress)
        if interrupted.is_set() and not told.is_set():
            told.set()
            listener.stopping()

    def on_cut(cut: Cut) -> None:
        writer.cut(cut)
        listener.cut(cut)

    def on_warning(text: str) -> None:
        writer.log(f"warning: {text}")
        listener.warning(text)

    def keep() -> None:
        place = built.solver.place
        begun = {"begun": place.step + place.begun}
        writer.keep(built.solver.persistent(), facts | begun)

    comm = built.problem.comm
    try:
        with _interrupt() as interrupted:
            keep()
            for accepted in built.solver.run(on_iteration, on_cut, writer.log, on_warning):
                writer.accept(accepted)
                keep()
                listener.accepted(accepted, writer.summary)
                writer.log(accepted_line(accepted, writer.summary))
                for said in ran_off_lines(accepted):
                    writer.log(said)
                if comm.allreduce(interrupted.is_set()):
                    where = f"step {accepted.step!r}, increment {accepted.increment}"
                    return "stopped", f"interrupted after {where}"
    except StoppedError as stop:
        writer.log(f"stopped: {stop}")
        writer.log_culprits(stop.culprits)
        return "stopped", str(stop)
    except InputError as error:  # a mistake that shows only where a step begins
        writer.log(f"stopped: {error}")
        return "stopped", str(error)
    except WriteError as error:
        return "stopped", str(error)
    return "done", ""


def _iteration_line(progress: Progress) -> str:
    counts = "; ".join(points_text(points) for points in progress.contacts.values())
    return f"  iteration {progress.iteration}  residual {progress.residual:.2e}  {counts}"


def accepted_line(accepted: Accepted, numbers: dict[str, Any]) -> str:
    """One line for an accepted increment."""
    contacts = "; ".join(
        f"{points_text(contact['points'])}  force {_force_text(contact['force'])}"
        for contact in numbers["contacts"]
    )
    part = "" if accepted.done == 1.0 else f" ({accepted.done:.4g} of it)"
    return (
        f"{accepted.step} {accepted.increment}{part}  {accepted.iterations} iterations  "
        f"residual {accepted.residuals[-1]:.1e}  {contacts}"
    )


def ran_off_lines(accepted: Accepted) -> list[str]:
    """A line for each contact with points that left the end of the master in an increment."""
    lines = []
    for name, points in accepted.ran_off.items():
        first = ", ".join(f"{v:.4g}" for v in points[0])
        count = f"{len(points)} point{'s' * (len(points) > 1)}"
        lines.append(f"  {name}: {count} ran off the end of the master, the first at ({first})")
    return lines


def points_text(points: dict[str, int]) -> str:
    """Numbers of open, sticking and slipping points."""
    return " ".join(f"{name} {count}" for name, count in points.items())


def _force_text(force: list[float]) -> str:
    # What is nothing but round-off of the largest component is shown as zero.
    least = 1e-9 * max(map(abs, force))
    return f"({', '.join(f'{v if abs(v) > least else 0.0:.4g}' for v in force)})"


@contextmanager
def _interrupt() -> Iterator[threading.Event]:
    """An event that the first Ctrl-C or TERM sets; the second one interrupts at once."""
    asked = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield asked  # only the main thread may handle signals
        return

    def handle(number: int, frame: FrameType | None) -> None:
        if asked.is_set():
            signal.default_int_handler(number, frame)
        asked.set()

    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(number, handle) for number in signals]
    try:
        yield asked
    finally:
        for number, handler in zip(signals, before, strict=True):
            signal.signal(number, handler)
