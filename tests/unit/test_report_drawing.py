"""How pictures of a report are drawn: once each, in a process beside that imports little."""

from __future__ import annotations

import os
import select
import subprocess
import sys

import numpy as np
from matplotlib.artist import Artist
from matplotlib.image import imread

from anisocontact.base.figure_style import new_figure, save
from anisocontact.results.report.shared_work import attempts


def test_a_picture_is_drawn_once(tmp_path):
    """`savefig` of Matplotlib draws twice; the pixels are the same."""
    figure, twice, drawn = new_figure(3.0, 2.0), tmp_path / "twice.png", []
    left, right = figure.subplots(1, 2)
    left.plot([0.0, 1.0], [1.0, 3.0], label="line")
    right.set(title="title", xlabel="x [length]")
    figure.legend(loc="outside lower center")
    figure.savefig(twice)
    figure.add_artist(_Counting(drawn))
    save(figure, tmp_path / "once.png")
    assert drawn == [figure]
    assert np.array_equal(imread(tmp_path / "once.png"), imread(twice))


class _Counting(Artist):
    """Nothing to be seen; counts how often it is drawn."""

    def __init__(self, drawn):
        super().__init__()
        self.drawn = drawn

    def draw(self, renderer):
        self.drawn.append(self.figure)


def test_what_draws_is_imported_without_descriptions():
    """Matplotlib's texts on what can be set take a third of its import; `set` does without them."""
    code = (
        "from anisocontact.results import report_worker; report_worker._main(); "
        "from matplotlib.artist import Artist; from matplotlib.lines import Line2D; "
        "from matplotlib.patches import Patch; line = Line2D([], []); line.set(lw=3.0); "
        "print(line.get_linewidth(), [one.set is Artist.set for one in (Line2D, Patch)])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split(maxsplit=1) == ["3.0", "[True, True]\n"]


def test_work_is_shared_with_a_copy():
    """Each piece is done once and told in its place, by whoever is free; all here if a copy dies.

    The first piece waits for what the second one does, which one process alone would do after it.
    """
    ours, theirs = os.pipe()
    here = os.getpid()

    def waits():
        ready, _, _ = select.select([ours], [], [], 20.0)
        return os.read(ours, 1).decode() if ready else "alone"

    def frees():
        os.write(theirs, b"x")
        return "frees"

    assert attempts([waits, frees, lambda: "last"], forks=True) == ["x", "frees", "last"]
    os.close(ours)
    os.close(theirs)
    assert attempts([lambda: str(os.getpid() == here)] * 3, forks=False) == ["True"] * 3

    def dying():
        if os.getpid() != here:
            os._exit(1)
        return "here"

    assert attempts([dying] * 3, forks=True) == ["here"] * 3
