"""The report of a run, drawn by a process that gets ready while the run goes on.

What draws takes longer to be imported than a small run takes.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

#: Writes the report of a results folder; what could not be drawn and why, a line each.
Reporter = Callable[[Path], list[str]]
_PROGRAM = "anisocontact.results.report_worker"


def report_here(folder: Path) -> list[str]:
    """Write a report by this process."""
    # Matplotlib takes half a second to be imported, and only pictures need it
    from anisocontact.results.report import write_report

    return write_report(folder)


@contextmanager
def report_beside(wanted: bool = True) -> Iterator[Reporter]:
    """Start a process that can write a report; it ends with the block.

    Args:
        wanted: Whether a process is started; this one writes otherwise, and where that fails.

    Yields:
        Writes a report.
    """
    process = _started() if wanted else None

    def write(folder: Path) -> list[str]:
        found = _asked(process, folder)
        return report_here(folder) if found is None else found

    try:
        yield write
    finally:
        if process is not None:
            _end(process)


def _started() -> subprocess.Popen[bytes] | None:
    """The process, in a group of its own: it is ended with what it starts, and by nothing else."""
    pipe, silent = subprocess.PIPE, subprocess.DEVNULL
    # pictures have no large matrices, and threads that wait for some take what the run needs
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-m", _PROGRAM]
    try:
        return subprocess.Popen(
            command,
            stdin=pipe,
            stdout=pipe,
            stderr=silent,
            env=environment,
            start_new_session=True,
        )
    except OSError:
        return None


def _asked(process: subprocess.Popen[bytes] | None, folder: Path) -> list[str] | None:
    """What a process could not draw; None where it has not written a report."""
    if process is None:
        return None
    try:
        told, _ = process.communicate(os.fsencode(folder.absolute()))
        found: list[str] = json.loads(told)
    except (OSError, ValueError):
        return None
    return found


def _end(process: subprocess.Popen[bytes]) -> None:
    if process.poll() is None:
        with suppress(OSError):
            os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
