"""`anisocontact trace`."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from anisocontact.base.errors import InputError
from anisocontact.base.figure_style import leave_out_descriptions
from anisocontact.base.shown import shown
from anisocontact.case.trace import Trace, load_trace
from anisocontact.cli.main import DONE, STOPPED
from anisocontact.cli.output import say
from anisocontact.interface import Interface
from anisocontact.interface.jumping_forces import jumping_forces
from anisocontact.point import Group, History, Load, StoppedError, drive
from anisocontact.results.files import check_folder, results_folder
from anisocontact.results.lock import locked
from anisocontact.results.trace import write_trace


def command(arguments: argparse.Namespace) -> int:
    """Drive a point; 0 if it is done, 3 if it stopped before its end."""
    trace = load_trace(arguments.case)
    folder = results_folder(arguments.output, trace.name)
    check_folder(folder, arguments.overwrite)
    with locked(folder) as warning:
        if warning:
            say(f"warning: {warning}", sys.stderr)
        check_folder(folder, arguments.overwrite)  # another run may just have ended
        return _drive_into(folder, trace)


def _drive_into(folder: Path, trace: Trace) -> int:
    """Drive a point into a folder that is ours alone."""
    began = time.perf_counter()
    history, message = _driven(trace.interface, trace.load, trace.group)
    runs = [(f"as given: {trace.case.contact.friction.sliding_rule}", history)]
    for label, interface in trace.compared:
        run, stopped = _driven(interface, trace.load, trace.group)
        runs.append((label, run))
        message = message or (f"{label}: {stopped}" if stopped else "")
    if trace.case.output.pictures:
        leave_out_descriptions()
    summary = write_trace(
        folder,
        runs,
        trace.interface,
        title=trace.case.title,
        message=message,
        wall_time=time.perf_counter() - began,
        pictures=trace.case.output.pictures,
        case=trace.text,
    )
    for label, interface in [("contact", trace.interface), *trace.compared]:
        if jumps := jumping_forces(interface.tangential):
            say(f"warning: {label}: {jumps}", sys.stderr)
    for _, run in runs:
        if run.warning:
            say(f"warning: {run.warning}", sys.stderr)
    if message:
        say(f"error: {message}; what converged is in {folder}", sys.stderr)
        return STOPPED
    x, f = (shown(summary[key], 6) for key in ("reference", "force"))
    say(f"steps     {summary['steps']}, {summary['newton_iterations']} iterations")
    say(f"end       position {x}, force {f}")
    say(f"done      {folder}")
    return DONE


def _driven(interface: Interface, load: Load, group: Group) -> tuple[History, str]:
    """What converged, and why it stopped."""
    try:
        return drive(interface, load, group), ""
    except StoppedError as stopped:
        return stopped.history, str(stopped)
    except InputError as error:
        if not hasattr(load, error.field):
            raise
        raise InputError(error.said, f"load.{error.field}") from None
