"""Arguments and exit codes; what a command needs is imported when it runs."""

from __future__ import annotations

import argparse
import atexit
import gc
import sys
import traceback
from collections.abc import Callable, Sequence
from importlib import import_module

from anisocontact import __version__
from anisocontact.base.blas_threads import set_blas_threads
from anisocontact.base.errors import InputError, RunError, one_line
from anisocontact.base.import_hooks import when_used
from anisocontact.base.machine import lack
from anisocontact.base.processes import started_together
from anisocontact.base.signals import ended_by_signals, held_back
from anisocontact.cli.output import outputs, say

DONE, INTERNAL, BAD_INPUT, STOPPED = 0, 1, 2, 3
#: Packages of NumPy that few commands use: SciPy imports all there are.
_OF_NUMPY = ("f2py", "testing", "polynomial")

_EPILOG = """\
exit codes: 0 done, 2 bad input (nothing is written), 3 stopped before the end (by a signal, or
because something does not converge or the machine lacks something; what converged is kept),
1 an error of the program itself
"""


type Commands = argparse._SubParsersAction[argparse.ArgumentParser]


def build_parser() -> argparse.ArgumentParser:
    """The parser of the command; the reference page is made from it.

    Example:
        >>> build_parser().parse_args(["check", "case.toml"]).case
        'case.toml'
    """
    parser = argparse.ArgumentParser(
        prog="anisocontact",
        description="Frictional contact of surfaces that have a direction.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"anisocontact {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)

    for add in (_add_cases, _add_points, _add_lists):
        add(commands)
    return parser


def _add_cases(commands: Commands) -> None:
    """What is done with cases, their meshes and their results."""
    run = _command(commands, "run", "solve a case and write its results")
    _case_argument(run)
    _output_arguments(run).add_argument(
        "--restart",
        action="store_true",
        help="go on with a run that was stopped or killed, from its last accepted increment",
    )

    check = _command(
        commands,
        "check",
        "read a case and its mesh, run the Python files it names, and say what it contains; "
        "or read a mesh file, and say what is in it",
    )
    check.add_argument(
        "case", type=_name, metavar="CASE.toml", help="the case file, or a mesh file"
    )
    check.add_argument(
        "--no-python",
        action="store_true",
        help="check all but the laws in Python, whose files are not run: for cases of others",
    )

    _add_convert(commands)

    report = _command(commands, "report", "draw the pictures and the report of a results folder")
    report.add_argument("folder", type=_name, metavar="DIR", help="results folder of `run`")


def _add_convert(commands: Commands) -> None:
    """What is made of meshes, decks and results for other codes."""
    convert = _command(
        commands,
        "convert",
        "write a mesh in another format, with bodies and facet groups, or a case file of a deck",
    )
    convert.add_argument(
        "source",
        type=_name,
        metavar="IN",
        help="a mesh file, a case file for its mesh, a results folder, or a deck .inp",
    )
    convert.add_argument(
        "target",
        type=_name,
        metavar="OUT",
        help="file to write: .msh of gmsh, .vtu or .vtk; .vtkhdf of a results folder; .toml of a "
        "deck, which is a case file",
    )


def _add_points(commands: Commands) -> None:
    """What is done with points alone."""
    trace = _command(commands, "trace", "move a point over a surface and write what it meets")
    _case_argument(trace)
    _output_arguments(trace)

    replay = _command(
        commands,
        "replay",
        "evaluate alone a point at which a law failed: state, trial, traction, tangent; "
        "runs the Python file of a law of your own",
    )
    replay.add_argument(
        "file", type=_name, metavar="FILE.json", help="failed_point.json of a results folder"
    )


def _add_lists(commands: Commands) -> None:
    """What says what there is."""
    schema = _command(commands, "schema", "print the JSON Schema of the case file")
    schema.add_argument("--trace", action="store_true", help="of the case file of `trace`")

    info = _command(
        commands, "info", "print versions and the surfaces, laws, rules and materials there are"
    )
    info.add_argument("--json", action="store_true", help="print it as JSON")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command.

    Args:
        argv: Arguments without the name of the program; those of the process if left out.

    Returns:
        The exit code: 0 done, 1 internal error, 2 bad input, 3 stopped before the end.

    Example:
        >>> main(["--version"])
        anisocontact ...
        0
    """
    try:
        arguments = build_parser().parse_args(argv)
    except SystemExit as end:  # argparse has said what is wrong, or printed the help
        return end.code if isinstance(end.code, int) else BAD_INPUT
    set_blas_threads()
    with ended_by_signals(), held_back() as answer_signals:
        together = started_together()
        if together is None:
            return _run(arguments, answer_signals)
        together.quiet()
        return together.finish(_run(arguments, answer_signals))


def command() -> int:
    """The command in a process of its own: garbage is looked for seldom, and not at the end.

    What is imported stays, and looking through it takes as long as a small case. A process that
    calls `main` again and again needs its garbage collected: meshes that nobody has any more hold
    communicators, of which MPI has some 2000.

    Returns:
        The exit code.
    """
    gc.set_threshold(100_000)
    atexit.register(gc.freeze)
    return main()


def _run(arguments: argparse.Namespace, loaded: Callable[[], None]) -> int:
    """Run a command; its exit code.

    Args:
        arguments: Those of the command.
        loaded: Called where its modules are there.
    """
    with outputs() as (out, _):
        code = _ended(arguments, loaded)
        out.flush()
        # a reader that has gone has a right to; what has stopped because of it has said so
        if code == DONE and out.failure is not None and not out.gone:
            say(f"error: {out.why}", sys.stderr)
            return STOPPED
        return code


def _ended(arguments: argparse.Namespace, loaded: Callable[[], None]) -> int:
    """Run a command and say what is wrong; its exit code."""
    try:
        for name in _OF_NUMPY:
            when_used(f"numpy.{name}")
        command = import_module(f"anisocontact.cli.{arguments.command}")
        loaded()
        code: int = command.command(arguments)
        return code
    except (Exception, KeyboardInterrupt, SystemExit) as error:
        if arguments.debug:
            for line in "".join(traceback.format_exception(error)).splitlines():
                say(line, sys.stderr)
        return _error_line(error)


def _error_line(error: BaseException) -> int:
    """Say in a line what is wrong; the exit code."""
    if isinstance(error, InputError):
        for one in getattr(error, "errors", [error]):
            say(f"error: {one}", sys.stderr)
        return BAD_INPUT
    if isinstance(error, KeyboardInterrupt):
        say("error: interrupted", sys.stderr)
        return STOPPED
    lacking = lack(error)
    if lacking is not None:
        say(f"error: {lacking}", sys.stderr)
        return STOPPED
    text = error if isinstance(error, RunError) else f"{type(error).__name__}: {error}"
    say(f"error: internal: {one_line(text)}", sys.stderr)
    return INTERNAL


def _command(commands: Commands, name: str, text: str) -> argparse.ArgumentParser:
    description = f"{text[0].upper()}{text[1:]}."
    made = commands.add_parser(name, help=text, description=description, allow_abbrev=False)
    made.add_argument(
        "--debug",
        action="store_true",
        help="before the line that says what is wrong, print the traceback of the error",
    )
    return made


def _output_arguments(parser: argparse.ArgumentParser) -> argparse._MutuallyExclusiveGroup:
    """Where results go; returns the group of what may be done about an earlier run there."""
    parser.add_argument(
        "-o",
        "--output",
        metavar="DIR",
        help="results folder; results/<name of the case> if left out",
    )
    earlier = parser.add_mutually_exclusive_group()
    earlier.add_argument(
        "--overwrite", action="store_true", help="replace the results of an earlier run"
    )
    return earlier


def _case_argument(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("case", type=_name, metavar="CASE.toml", help="the case file")


def _name(given: str) -> str:
    """The name of a file or folder; an empty one is that of a variable that was never set."""
    if not given.strip():
        raise argparse.ArgumentTypeError(f"{given!r} given, the name of a file or folder needed")
    return given
