"""A program that gets ready to write a report and waits for the folder, see `report_beside`."""

from __future__ import annotations

import gc
import json
import os
import sys
from pathlib import Path

__all__: list[str] = []


def _main() -> None:
    gc.disable()  # there is nothing to be collected in what is imported
    from anisocontact.base.figure_style import leave_out_descriptions

    leave_out_descriptions()
    from anisocontact.results.report import shape, write_report

    vtk = shape.start_vtk()
    try:
        _get_ready()
        gc.freeze()
        gc.enable()
        if folder := sys.stdin.buffer.read():
            failed = write_report(Path(os.fsdecode(folder)), vtk=vtk, forks=sys.platform == "linux")
            print(json.dumps(failed))
    finally:
        shape.end(vtk)


def _get_ready() -> None:
    """Draw axes, for which Matplotlib imports what pictures need."""
    from anisocontact.base.figure_style import new_figure, png

    figure = new_figure(1.0, 1.0)
    figure.subplots()
    png(figure)


if __name__ == "__main__":
    _main()
    sys.stdout.flush()
    os._exit(0)  # all is written, and taking apart what was imported takes a while
