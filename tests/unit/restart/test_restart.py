"""Going on with a run: what fits and what is refused."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import tomllib

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.case.restart import check_same
from anisocontact.cli import main
from anisocontact.results.history import flat


@pytest.mark.parametrize("model", ["linear-elastic", "neo-hookean"])
@pytest.mark.parametrize("count", [1, 3])
def test_condensed_goes_on_bit_by_bit(monkeypatch, case, count, model, same, stop_after):
    """What has been condensed is made again from the same numbers in the same order."""
    text = case.read_text().replace('"direct"', '"condensed"')
    case.write_text(text.replace('"linear-elastic"', f'"{model}"'))
    whole, out = case.parent / "whole", case.parent / "out"
    assert main(["run", str(case), "-o", str(whole)]) == 0
    with monkeypatch.context() as patch:
        stop_after(patch, count)
        assert main(["run", str(case), "-o", str(out)]) == 3
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


LID = """
[mesh.box.lid]
origin = [0, 0, 0.5]
size = [1, 1, 0.5]
cells = [2, 3, 1]

[material.lid]
model = "linear-elastic"
E = 2000
nu = 0.2

[[tie]]
slave = "lid.bottom"
master = "block.top"
"""


@pytest.mark.parametrize("tied", [False, True])
def test_condensed_goes_on_as_direct(monkeypatch, case, stop_after, tied):
    """A checkpoint without the interior of the bodies: another strategy solves for it first.

    Both go on to the tolerance of Newton's method, 1e-8 of the forces at work. With ties the
    checkpoint has all of the state; without the forces of the supports a fourth of the work was
    missing then.
    """
    text = case.read_text().replace('"direct"', '"condensed"')
    case.write_text(text.replace('"block.top" =', '"lid.top" =') + LID if tied else text)
    whole, out = case.parent / "whole", case.parent / "out"
    assert main(["run", str(case), "-o", str(whole)]) == 0
    with monkeypatch.context() as patch:
        stop_after(patch, 1)
        assert main(["run", str(case), "-o", str(out)]) == 3
    assert ("pending_in_reach" in "".join(np.load(out / "checkpoint.npz").files)) is not tied
    case.write_text(case.read_text().replace('"condensed"', '"direct"'))
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    ends = [json.loads((f / "summary.json").read_text()) for f in (whole, out)]
    for key in ("contacts", "reactions", "energy"):
        a, b = (np.array([v for _, v in flat(end[key]) if isinstance(v, float)]) for end in ends)
        np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-6 * np.abs(a).max())


def test_a_restored_state_is_whole_when_it_is_asked_for(case):
    """Displacement, reactions and energies of a restored problem before it goes on."""
    case.write_text(case.read_text().replace('"direct"', '"condensed"'))
    first = build(load(case))
    for accepted in first.solver.run():
        if accepted.step == "drag":
            break
    kept = first.solver.persistent()
    wanted = first.problem.u.x.array.copy()
    for ask in ("reactions", "energies", "u"):
        second = build(load(case))
        second.solver.restore(kept)
        if ask == "u":
            np.testing.assert_allclose(second.problem.u.x.array, wanted, rtol=0.0, atol=1e-12)
        elif ask == "energies":
            found = second.problem.energies()
            for name, value in accepted.energies.items():
                assert found[name] == pytest.approx(value, abs=1e-10 * found["elastic"])
        else:
            for group, force in accepted.reactions.items():
                np.testing.assert_allclose(second.problem.reactions()[group], force, atol=1e-7)


def test_augmented_contact_of_a_free_body_goes_on(monkeypatch, case, same, stop_after):
    """Multipliers, the level of their penalties and stabilisation go on bit by bit."""
    text = case.read_text().replace("normal = { penalty = 1e4 }", 'method = "augmented"')
    text = text.replace("stiffness = [4e3, 1e3]", 'stiffness = "auto"')
    text = text.replace(
        'displacement = { "block.top" = { x = 0, y = 0, z = -0.01 } }',
        'traction = { "block.top" = { z = -20 } }',
    ).replace(
        'displacement = { "block.top" = { x = 0.02, y = 0.01 } }',
        'traction = { "block.top" = { x = 1.5, y = 0.5 } }',
    )
    case.write_text(text)
    whole, out = case.parent / "whole", case.parent / "out"
    assert main(["run", str(case), "-o", str(whole)]) == 0
    with monkeypatch.context() as patch:
        stop_after(patch, 3)
        assert main(["run", str(case), "-o", str(out)]) == 3
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


@pytest.mark.parametrize("count", [1, 2, 4])
def test_ctrl_c_says_how_to_go_on_and_it_does(
    monkeypatch, capsys, case, whole, count, same, stop_after
):
    """Requirement: Ctrl-C finishes the increment, keeps all and says the exact command."""
    out = case.parent / "out folder"
    with monkeypatch.context() as patch:
        stop_after(patch, count)
        assert main(["run", str(case), "-o", str(out)]) == 3
    error = capsys.readouterr().err.splitlines()
    assert error[0].startswith("error: stopped: interrupted after step ")
    assert error[1] == f"to go on: anisocontact run {case} -o '{out}' --restart"
    assert json.loads((out / "summary.json").read_text())["steps"] == count
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert f"restart   after {count} accepted increments" in capsys.readouterr().out
    assert same(whole, out)


def test_ctrl_c_in_the_last_increment_stops_nothing(
    monkeypatch, capsys, case, whole, same, stop_after
):
    """Requirement: a run of which all increments are done is done, whatever was asked for then."""
    out, count = case.parent / "out", json.loads((whole / "summary.json").read_text())["steps"]
    with monkeypatch.context() as patch:
        stop_after(patch, count)
        assert main(["run", str(case), "-o", str(out)]) == 0
    assert "stopped" not in capsys.readouterr().err
    assert json.loads((out / "summary.json").read_text())["status"] == "done"
    assert same(whole, out)


def test_term_is_like_ctrl_c(monkeypatch, capsys, case, whole, same, stop_after):
    """Batch systems send TERM before they kill."""
    out = case.parent / "out"
    with monkeypatch.context() as patch:
        stop_after(patch, 3, signal.SIGTERM)
        assert main(["run", str(case), "-o", str(out)]) == 3
    assert "interrupted after step 'drag', increment 1" in capsys.readouterr().err
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


def test_a_run_that_is_done_goes_on_with_further_steps(capsys, case, whole, same):
    """A further step may be added; the result is that of both steps in one run."""
    more = '\n[[step]]\nname = "back"\nincrements = 2\ndisplacement = { "block.top" = { x = 0 } }\n'
    case.write_text(case.read_text().replace("\n[output]", f"{more}\n[output]"))
    assert main(["run", str(case), "-o", str(whole), "--restart"]) == 0
    at_once = case.parent / "at once"
    assert main(["run", str(case), "-o", str(at_once)]) == 0
    assert same(whole, at_once)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("E = 1000", "E = 1001", "material.block.E: 1001 given, the run that is to go on had 1000"),
        ("cells = [3, 3, 2]", "cells = [3, 4, 2]", "mesh.box.block.cells[1]: 4 given, the run"),
        ("increments = 2", "increments = 3", "step[0].increments: 3 given, the run"),
        ("normal = { penalty = 1e5 }\n", "", "contact[0].normal: nothing given, the run that is"),
        ('name = "press"', 'name = "push"', "step[0].name: 'push' given, the run"),
        (
            "[output]",
            '[[contact]]\nslave = "block.left"\nmaster = "plate"\n'
            "friction = { coefficients = 0 }\n[output]",
            "contact: 2 of them given, the run that is to go on had 1 of them",
        ),
    ],
)
def test_a_case_file_that_does_not_fit_is_refused(capsys, case, case_text, whole, old, new, line):
    case.write_text(case_text.replace(old, new, 1))
    before = (whole / "history.csv").read_bytes()
    assert main(["run", str(case), "-o", str(whole), "--restart"]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"error: {line}")
    assert len(error.splitlines()) == 1
    assert (whole / "history.csv").read_bytes() == before


def test_what_may_change(case_text):
    before = tomllib.loads(case_text)
    later = case_text.replace("y = 0.01 }", "y = 0.02 }").replace("every = 3", "every = 1")
    now = tomllib.loads(f"{later.replace('Small block', 'Block')}\n[solver]\ncuts = 3\n")
    check_same(before, now, begun=1)
    with pytest.raises(InputError, match=r"step\[1\].displacement.block.top.y: 0.02 given"):
        check_same(before, now, begun=2)


def test_nothing_to_go_on_with(capsys, case, tmp_path):
    assert main(["run", str(case), "-o", str(tmp_path / "none"), "--restart"]) == 2
    assert "holds no run to go on with" in capsys.readouterr().err
    assert not (tmp_path / "none").exists()
    assert main(["run", str(case), "--restart", "--overwrite"]) == 2
    assert "not allowed with" in capsys.readouterr().err


def test_results_without_checkpoint_are_kept(capsys, case, whole):
    (whole / "checkpoint.npz").unlink()
    before = (whole / "history.csv").read_bytes()
    assert main(["run", str(case), "-o", str(whole), "--restart"]) == 2
    assert "has results but no checkpoint" in capsys.readouterr().err
    assert (whole / "history.csv").read_bytes() == before


def test_killed_before_the_first_increment(capsys, case, whole, same):
    """There is a folder and no accepted increment: the run begins."""
    out = case.parent / "early"
    out.mkdir()
    (out / "run.log").write_text("anisocontact 0.1.0\n")
    (out / ".summary-123.json").write_text("{")
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert "restart   from the beginning" in capsys.readouterr().out
    assert same(whole, out)
    assert not (out / ".summary-123.json").exists()


@pytest.mark.mpi
@pytest.mark.slow
@pytest.mark.parametrize(("before", "after"), [(1, 2), (2, 1), (2, 2)])
def test_another_number_of_processes(case, whole, before, after):
    """Requirement: restart on another number of ranks agrees to 1e-10.

    Newton goes on to 1e-13, so that its tolerance is not what is seen.
    """
    from shutil import which

    start = which("mpiexec") or which("mpirun")
    if start is None:
        pytest.skip("no mpiexec")
    case.write_text(case.read_text() + "options = { snes_rtol = 1e-13 }\n")
    out = case.parent / "out"
    code = (
        "import os, signal, sys; from anisocontact.cli import main; "
        "from contextlib import nullcontext; "
        "from anisocontact.results import report_process, writer; "
        "report_process.report_beside = lambda wanted: nullcontext(lambda folder: []); "
        "keep = writer.Writer.keep; stop = int(sys.argv.pop(1))\n"
        "def kept(self, *a):\n"
        "    keep(self, *a)\n"
        "    if self.summary['steps'] == stop: os.kill(os.getpid(), signal.SIGINT)\n"
        "writer.Writer.keep = kept; sys.exit(main(sys.argv[1:]))"
    )

    def run(ranks, stop, folder, *more):
        command = [start, "-n", str(ranks), sys.executable, "-c", code, str(stop)]
        return subprocess.run(
            [*command, "run", str(case), "-o", str(folder), *more],
            capture_output=True,
            text=True,
            check=False,
            timeout=120,
        )

    straight = case.parent / "straight"
    assert run(1, 99, straight).returncode == 0
    stopped = run(before, 4, out)
    assert stopped.returncode == 3, stopped.stderr
    ended = run(after, 99, out, "--restart")
    assert ended.returncode == 0, ended.stderr
    a, b = (json.loads((f / "summary.json").read_text()) for f in (straight, out))
    assert b["ranks"] == after
    assert a["steps"] == b["steps"]
    for key in ("contacts", "reactions", "energy"):
        wanted, found = (np.array(_numbers(s[key])) for s in (a, b))
        assert np.abs(wanted - found).max() < 1e-10 * np.abs(wanted).max()


def _numbers(nested):
    """All floating-point numbers of nested values."""
    if isinstance(nested, dict):
        nested = list(nested.values())
    if isinstance(nested, list):
        return [n for one in nested for n in _numbers(one)]
    return [nested] if isinstance(nested, float) else []
