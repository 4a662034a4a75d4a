"""`anisocontact run`."""

from __future__ import annotations

import argparse
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from anisocontact.case import load
from anisocontact.case.restart import checkpoint_of
from anisocontact.cli.main import DONE, STOPPED
from anisocontact.cli.output import Output, say
from anisocontact.results import report_process
from anisocontact.results.files import check_folder, results_folder
from anisocontact.results.lock import locked

if TYPE_CHECKING:
    from anisocontact.case.read import CaseFile
    from anisocontact.case.run import RunOutcome
    from anisocontact.results.checkpoint import Stored
    from anisocontact.results.report_process import Reporter


def command(arguments: argparse.Namespace) -> int:
    """Solve a case; 0 if it is done, 3 if it stopped before its end."""
    file = load(arguments.case)
    folder = results_folder(arguments.output, file.name)
    if not arguments.restart:
        check_folder(folder, arguments.overwrite)

    from anisocontact.base.fenicsx import MPI

    with locked(folder, MPI.COMM_WORLD) as warning:
        if warning:
            say(f"warning: {warning}", sys.stderr)
        checkpoint = None
        if arguments.restart:
            checkpoint = checkpoint_of(folder, file)
        else:  # once more: another run may just have ended
            check_folder(folder, arguments.overwrite)
        drawn = file.case.output.pictures and MPI.COMM_WORLD.rank == 0
        with report_process.report_beside(drawn) as reporter:
            return _run(arguments, file, folder, checkpoint, reporter)


def _run(
    arguments: argparse.Namespace,
    file: CaseFile,
    folder: Path,
    checkpoint: Stored | None,
    reporter: Reporter,
) -> int:
    """Solve a case into a folder that is ours alone."""
    from anisocontact.case.build import build
    from anisocontact.case.run import run
    from anisocontact.cli.check import contents
    from anisocontact.cli.progress import progress_on

    built = build(file)
    for line in contents(built):
        say(line)
    if arguments.restart:
        say(_beginning(checkpoint))
    shown = Output.of(sys.stdout)
    with progress_on(shown, built.steps) as listener:
        outcome = run(built, folder, listener, checkpoint, reporter)
    for warning in outcome.warnings:
        say(f"warning: {warning}", sys.stderr)
    if outcome.status == "done":
        say(f"done      {folder}")
        return DONE
    if not shown.gone:
        _explain(outcome, arguments, folder)
    return STOPPED


def _explain(outcome: RunOutcome, arguments: argparse.Namespace, folder: Path) -> None:
    """Say why a run stopped, and how it goes on."""
    kept = f"; what converged is in {folder}" if folder.is_dir() else ""
    say(f"error: stopped: {outcome.message}{kept}", sys.stderr)
    if outcome.goes_on:
        words = ["anisocontact", "run", str(arguments.case), "-o", str(folder), "--restart"]
        say(f"to go on: {shlex.join(words)}", sys.stderr)


def _beginning(checkpoint: Stored | None) -> str:
    if checkpoint is None:
        return "restart   from the beginning: no increment was accepted before"
    summary = checkpoint.facts["writer"]["summary"]
    return f"restart   after {summary['steps']} accepted increments, time {summary['time']:.6g}"
