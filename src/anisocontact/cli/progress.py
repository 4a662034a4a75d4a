"""What a run shows: a bar on a terminal, a line for each increment in a pipe."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TextIO, cast

from anisocontact.base.errors import printable
from anisocontact.case.run import Listener, accepted_line, points_text, ran_off_lines
from anisocontact.cli.output import Output, say
from anisocontact.solver import Accepted, Cut, Progress, Step

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

#: What is said after a first Ctrl-C.
STOPPING = "stopping after this increment; a second Ctrl-C stops at once"


@contextmanager
def progress_on(stream: Output, steps: Sequence[Step]) -> Iterator[Listener]:
    """A listener that shows the run on a stream."""
    if not stream.isatty():
        yield Lines(stream)
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.fields[state]}", markup=False),
    )
    # names of the user are shown as they are, brackets and all
    console = Console(file=cast(TextIO, stream), markup=False, emoji=False, highlight=False)
    with Bar(*columns, console=console) as bar:
        yield Terminal(bar, steps, stream)


class Lines:
    """A line for each increment.

    Args:
        stream: Where they go.
    """

    def __init__(self, stream: Output) -> None:
        self._stream = stream

    def iteration(self, progress: Progress) -> None:
        """Nothing: `run.log` has the iterations."""

    def accepted(self, accepted: Accepted, numbers: dict[str, Any]) -> None:
        """Print the increment."""
        for text in (accepted_line(accepted, numbers), *ran_off_lines(accepted)):
            say(text, self._stream)

    def cut(self, cut: Cut) -> None:
        """Print the cut."""
        say(str(cut), self._stream)

    def warning(self, text: str) -> None:
        """Print it."""
        say(f"warning: {text}", self._stream)

    def stopping(self) -> None:
        """Print it."""
        say(STOPPING, self._stream)

    def lost(self) -> str:
        """Why nobody reads this."""
        return self._stream.why


class Terminal:
    """One bar for the whole run, with the iteration that is going on; a line for each step.

    Args:
        bar: Where it is drawn.
        steps: The steps.
        stream: Where the bar goes.
    """

    def __init__(self, bar: Bar, steps: Sequence[Step], stream: Output) -> None:
        self._bar = bar
        self._stream = stream
        self._increments = {step.name: step.increments for step in steps}
        self._task = bar.add_task("start", total=sum(self._increments.values()), state="")

    def iteration(self, progress: Progress) -> None:
        """Show iteration, residual and contact points."""
        counts = "; ".join(points_text(points) for points in progress.contacts.values())
        self._bar.update(
            self._task,
            description=printable(
                f"{progress.step} {progress.increment}/{self._increments[progress.step]}"
            ),
            state=f"iteration {progress.iteration:2}  residual {progress.residual:.0e}  {counts}",
        )

    def accepted(self, accepted: Accepted, numbers: dict[str, Any]) -> None:
        """Move the bar on; say how a step ended."""
        if accepted.done < 1.0:
            return
        self._bar.update(self._task, advance=1)
        if accepted.increment == self._increments[accepted.step]:
            self._say(accepted_line(accepted, numbers))

    def cut(self, cut: Cut) -> None:
        """Show the cut beside the bar."""
        self._bar.update(self._task, state=f"cut to {cut.next_size:.3g} of the increment")

    def warning(self, text: str) -> None:
        """Print it above the bar."""
        self._say(f"warning: {text}")

    def stopping(self) -> None:
        """Print it above the bar."""
        self._say(STOPPING)

    def lost(self) -> str:
        """Why nobody sees this."""
        return self._stream.why

    def _say(self, line: str) -> None:
        self._bar.console.print(printable(line), soft_wrap=True)
