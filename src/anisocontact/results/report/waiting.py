"""A program that gets ready to write a report and waits for the folder, see `report_beside`."""

from __future__ import annotations

import gc
import json
import os
import sys
from pathlib import Path

from anisocontact.base.figure_style import new_figure, png
from anisocontact.results.report import shape, write_report

__all__: list[str] = []


def _main() -> None:
    vtk = shape.start_vtk()
    try:
        _get_ready()
        if folder := sys.stdin.buffer.read():
            failed = write_report(Path(os.fsdecode(folder)), vtk=vtk, forks=sys.platform == "linux")
            print(json.dumps(failed))
    finally:
        shape.end(vtk)


def _get_ready() -> None:
    """Draw a figure, for which Matplotlib imports what pictures need."""
    figure = new_figure(1.0, 1.0)
    axes = figure.subplots()
    figure.colorbar(axes.tripcolor([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 2.0]), ax=axes)
    png(figure)
    gc.freeze()  # there is nothing to be collected in what was imported


if __name__ == "__main__":
    _main()
