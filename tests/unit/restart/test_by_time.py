"""Checkpoints by time: few of them where increments are quick, and none missing at an end."""

from __future__ import annotations

import errno
import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.case.run import Listener, run
from anisocontact.cli import main
from anisocontact.results import checkpoint, checkpoint_times
from anisocontact.results.files import Disk, WriteError
from anisocontact.solver.stepping.attempts import Attempts, Outcome

#: Accepted increments after which a run of six is disturbed.
DISTURBED = 5


class Killed(BaseException):
    """Nothing handles it: the folder is left as it is, as by SIGKILL."""


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The clock of the checkpoints, which stands still."""
    now = [0.0]
    monkeypatch.setattr(checkpoint_times, "monotonic", lambda: now[0])
    return now


@pytest.fixture
def written(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Accepted increments of which a checkpoint has been written, 0 for the state before them."""
    numbers: list[int] = []
    write = checkpoint_times.keep_checkpoint

    def kept(*arguments: Any) -> None:
        write(*arguments)
        numbers.append(arguments[2] - 1)

    monkeypatch.setattr(checkpoint_times, "keep_checkpoint", kept)
    return numbers


class Gone(Listener):
    """Goes behind some accepted parts."""

    def __init__(self, parts: int) -> None:
        self.parts = parts

    def accepted(self, accepted: Any, summary: Any) -> None:
        self.parts -= 1

    def lost(self) -> str:
        return "nobody listens" if self.parts <= 0 else ""


@pytest.mark.parametrize(
    ("parts", "where"),
    [(1, "increment 1 (0.25 of it)"), (3, "increment 1 (0.75 of it)"), (8, "increment 2")],
)
def test_where_a_run_stopped_is_told_to_the_part(case, parts, where):
    """Requirement: an increment of which a part is done is not said to be done."""
    text = case.read_text(encoding="utf-8")
    case.write_text(text.replace("[solver]", "[solver]\nlargest_increment = 0.25"), "utf-8")
    outcome = run(build(load(case)), case.parent / "out", Gone(parts))
    assert outcome.message == f"nobody listens after step 'press', {where}"
    assert outcome.goes_on


@pytest.mark.parametrize(
    ("every", "seconds", "writing", "increments"),
    [
        (1.0, 0.0, 0.0, [0, 6]),
        (1.0, 0.4, 0.0, [0, 3, 6]),
        (1.0, 0.3, 0.0, [0, 4, 6]),
        (0.0, 0.0, 0.5, [0, 1, 2, 3, 4, 5, 6]),
        (1.0, 1.0, 0.04, [0, 1, 2, 3, 4, 5, 6]),
        (1.0, 1.0, 0.09, [0, 2, 4, 6]),
    ],
)
def test_which_increments_have_one(
    case, clock, written, monkeypatch, every, seconds, writing, increments
):
    """Requirement: one behind so many seconds, but they cost 5 % at most; always one at the end.

    An increment takes some seconds by the clock, and so does writing.
    """
    write = checkpoint_times.keep_checkpoint

    def slow(*arguments: Any) -> None:
        clock[0] += writing
        write(*arguments)

    monkeypatch.setattr(checkpoint_times, "keep_checkpoint", slow)
    built = build(load(case))
    disk, kept = Disk(built.problem.comm), built.solver.persistent()
    checkpoints = checkpoint_times.Checkpoints(case.parent, built.problem.model, every)
    for number in range(7):
        checkpoints.take(disk, number + 1, kept, {})
        clock[0] += seconds
    checkpoints.write(disk)
    assert written == increments


def test_the_case_file_says_how_often(case, clock, written):
    """Requirement: 0 writes one after each increment; what is left out is a second."""
    assert main(["run", str(case), "-o", str(case.parent / "out")]) == 0
    assert written == [0, 6]
    case.write_text(case.read_text().replace("[output]", "[output]\ncheckpoint_every = 0"))
    assert main(["run", str(case), "-o", str(case.parent / "out"), "--overwrite"]) == 0
    assert written[2:] == list(range(7))


@pytest.mark.parametrize(
    ("strategy", "model", "seconds"),
    [
        ("direct", "neo-hookean", 0.4),
        ("condensed", "linear-elastic", 0.0),
        ("condensed", "linear-elastic", 0.4),
        ("condensed", "neo-hookean", 0.4),
    ],
)
def test_killed_some_increments_after_one(
    case, clock, written, monkeypatch, same, strategy, model, seconds
):
    """Requirement: the run goes on from the last checkpoint and ends as if nothing had happened.

    Tables, summary and fields are bit by bit those of an uninterrupted run.
    """
    text = case.read_text().replace('"direct"', f'"{strategy}"').replace("every = 3", "every = 1")
    case.write_text(text.replace('"linear-elastic"', f'"{model}"'))
    whole, out = case.parent / "whole", case.parent / "out"
    assert main(["run", str(case), "-o", str(whole)]) == 0
    with monkeypatch.context() as patch:
        _disturbed(patch, Killed(), clock, seconds)
        with pytest.raises(Killed):
            main(["run", str(case), "-o", str(out)])
    assert written[2:] == ([0, 3] if seconds else [0])
    assert len((out / "history.csv").read_text().splitlines()) == 1 + DISTURBED
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


@pytest.mark.parametrize(
    ("cause", "message"),
    [
        (RuntimeError("unforeseen"), "internal error: RuntimeError: unforeseen"),
        (MemoryError(), "out of memory"),
        (KeyboardInterrupt(), "interrupted"),
        (WriteError("cannot write 'a': No space left on device"), "cannot write 'a'"),
        (None, "step 'drag', increment 4"),
    ],
)
def test_an_end_in_order_keeps_the_last_increment(
    case, clock, written, monkeypatch, same, cause, message
):
    """Requirement: whatever ends a run between two checkpoints, no accepted increment is lost.

    Nor is anything of the increment that failed kept: cuts, moved bodies, worn factors.
    """
    case.write_text(case.read_text().replace('"direct"', '"condensed"'))
    whole, out = case.parent / "whole", case.parent / "out"
    assert main(["run", str(case), "-o", str(whole)]) == 0
    with monkeypatch.context() as patch:
        _disturbed(patch, cause, clock)
        assert main(["run", str(case), "-o", str(out)]) in (1, 3)
    assert message in json.loads((out / "summary.json").read_text())["message"]
    assert written[2:] == [0, DISTURBED]
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


def test_a_disk_that_is_full_for_good(case, clock, monkeypatch, capsys):
    """Requirement: the checkpoint before stays, and the run says that it is not done."""
    out = case.parent / "out"
    save = checkpoint.save_checkpoint

    def full(folder: Path, arrays: Any, facts: dict[str, Any]) -> None:
        if facts["writer"]["summary"]["steps"]:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(folder))
        save(folder, arrays, facts)

    monkeypatch.setattr(checkpoint, "save_checkpoint", full)
    assert main(["run", str(case), "-o", str(out)]) == 3
    assert "error: stopped: cannot write" in capsys.readouterr().err
    stored = checkpoint.load_checkpoint(out)
    assert stored is not None
    assert stored.facts["writer"]["summary"]["steps"] == 0


def test_what_waits_does_not_go_on_with_the_run(case, clock):
    """Requirement: a checkpoint is of the increment after which it was taken, not of later ones.

    Source: the values at that time; the arrays of a term may be those that it works with.
    """
    built = build(load(case))
    kept = built.solver.persistent()
    checkpoints = checkpoint_times.Checkpoints(case.parent, built.problem.model, 1.0)
    disk = Disk(built.problem.comm)
    for number in (1, 2):
        checkpoints.take(disk, number, kept, {"number": number})
    kept.nodal["displacement"] += 1.0
    checkpoints.write(disk)
    stored = checkpoint.load_checkpoint(case.parent)
    assert stored is not None
    assert stored.facts["number"] == 2
    assert not stored.arrays["nodal/displacement"].any()


def _disturbed(
    patch: pytest.MonkeyPatch, cause: BaseException | None, clock: list[float], seconds: float = 0.0
) -> None:
    """Let an increment end by something, or without convergence, when the state has moved.

    Those before it take so many seconds each.
    """
    solve, left = Attempts.solve, [DISTURBED]

    def moved(self: Attempts, *arguments: Any) -> Outcome:
        outcome = solve(self, *arguments)
        left[0] -= 1
        clock[0] += seconds
        if left[0] >= 0:
            return outcome
        if cause is not None:
            raise cause
        return replace(outcome, result=replace(outcome.result, reason="for the test"))

    patch.setattr(Attempts, "solve", moved)
