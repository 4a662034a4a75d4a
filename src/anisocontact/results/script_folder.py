"""The results folder of a run that a script solves, as runs of case files have it."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from anisocontact.base.errors import one_line, tell_script
from anisocontact.base.typed import typed
from anisocontact.results.files import WriteError, check_folder
from anisocontact.results.lock import locked
from anisocontact.results.output_options import Labels, OutputOptions
from anisocontact.results.writer import Writer
from anisocontact.solver import Accepted, Solver, StoppedError


@typed
def recorded(
    solver: Solver,
    folder: Path,
    *,
    title: str = "",
    every: int = 1,
    quantities: Sequence[str] = (),
    pictures: bool = True,
    vtkhdf: bool = False,
    overwrite: bool = False,
) -> Iterator[Accepted]:
    """Solve increment by increment, as `Solver.run`, and write all of it into a folder.

    The folder has files for ParaView, the table `history.csv`, `summary.json`, `run.log` and, at
    the end, the report; `Results` reads it. Checkpoints are those of case files alone. What the
    user should look at is in it and a `RunWarning`.

    Args:
        solver: The solver, with its problem and steps.
        folder: Where; made if it is not there.
        title: Heading of the report.
        every: Fields are written every so many increments, and at the end of each step.
        quantities: Names of the arrays to write for ParaView; all if not given.
        pictures: Whether the report is drawn at the end.
        vtkhdf: Whether all states are also written as one file of each sort at the end.
        overwrite: Whether an earlier run in the folder is replaced.

    Returns:
        Every accepted increment or sub-increment; the problem holds its state until the next. A
        run that the script leaves before its end is "stopped".

    Raises:
        InputError: The folder holds an earlier run or something else, or cannot be made.
        StoppedError: An increment did not converge, as of `Solver.run`.
        WriteError: A file cannot be written.

    Example:
        >>> import tempfile
        >>> from anisocontact.bulk import make_material
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> from anisocontact.results import Results
        >>> from anisocontact.solver import Problem, Step
        >>> model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 4), (1, 1, 1))})
        >>> problem = Problem(model, {"bar": make_material("linear-elastic", E=200.0, nu=0.0)})
        >>> held = {"bar.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
        >>> pull = Step("pull", 2, held, traction={"bar.top": {"z": 5.0}})
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     solver = Solver(problem, [pull])
        ...     done = [one.increment for one in recorded(solver, folder, pictures=False)]
        ...     done, Results(folder).times.tolist()
        ([1, 2], [0.0, 0.5, 1.0])
    """
    place = Path(folder)
    check_folder(place, overwrite)
    options = OutputOptions(every=every, quantities=quantities, pictures=pictures, vtkhdf=vtkhdf)
    return _run(solver, place, options, Labels(title))


def _run(
    solver: Solver, folder: Path, options: OutputOptions, labels: Labels
) -> Generator[Accepted]:
    comm = solver.problem.comm
    with locked(folder, comm) as unlocked:
        writer = Writer(folder, solver.problem, solver.steps, options, labels)
        writer.strategy(solver.choice.name, solver.choice.reason)

        def warn(text: str) -> None:
            writer.log(f"warning: {text}")
            tell_script(text)

        if unlocked:
            warn(unlocked)
        try:
            for accepted in solver.run(None, writer.cut, writer.log, warn):
                writer.accept(accepted)
                yield accepted
        except StoppedError as stop:
            writer.log_stop(str(stop), stop.culprits, stop.failed)
            with suppress(WriteError):  # why the run stopped is what is raised
                writer.close("stopped", str(stop), solver.doubtful)
            raise
        except BaseException as error:
            left = isinstance(error, GeneratorExit)
            said = "left by the script" if left else one_line(f"{type(error).__name__}: {error}")
            if left and comm.size == 1:
                with suppress(WriteError):
                    writer.close("stopped", said, solver.doubtful)
            else:  # others may wait elsewhere
                writer.abandon(said)
            raise
        if unwritten := writer.close("done", "", solver.doubtful):
            tell_script(unwritten)
