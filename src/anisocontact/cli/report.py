"""`anisocontact report`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from anisocontact.base.errors import InputError
from anisocontact.base.figure_style import leave_out_descriptions
from anisocontact.cli.main import DONE
from anisocontact.cli.output import say


def command(arguments: argparse.Namespace) -> int:
    """Make the report of a folder anew from what is in it."""
    folder = Path(arguments.folder)
    leave_out_descriptions()
    from anisocontact.results.report import write_report

    if (folder / "trace.csv").is_file():
        raise InputError(f"'{folder}' is a folder of `trace`, whose report is not made anew")
    try:
        failed = write_report(folder)
    except InputError:
        raise
    except (ValueError, LookupError, TypeError) as error:
        text = f"'{folder}' holds no results of this version: {type(error).__name__}: {error}"
        raise InputError(text) from None
    except OSError as error:
        raise InputError(f"'{folder}' cannot be written: {error.strerror or error}") from None
    for line in failed:
        say(f"warning: {line}", sys.stderr)
    say(f"report    {folder / 'report.html'}")
    return DONE
