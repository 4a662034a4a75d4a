"""Going on with a run: what fits, what is refused, and what a full disk leaves."""

from __future__ import annotations

import errno
import json
import os
import resource
import signal
import subprocess
import sys
import tomllib

import numpy as np
import pytest

pytest.importorskip("anisocontact._fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.case.restart import check_same
from anisocontact.cli import main
from anisocontact.errors import InputError
from anisocontact.results import checkpoint
from anisocontact.results.files import Disk, WriteError
from anisocontact.results.history import flat


@pytest.fixture(autouse=True)
def no_report(monkeypatch):
    """The pictures take longer than the run."""
    monkeypatch.setattr("anisocontact.results.report.write_report", lambda folder: [])


@pytest.fixture
def case(tmp_path, case_text):
    path = tmp_path / "case.toml"
    path.write_text(case_text + '\n[solver]\nstrategy = "direct"\n')
    return path


@pytest.fixture
def whole(case):
    """Results of a run that nothing has disturbed."""
    folder = case.parent / "whole"
    assert main(["run", str(case), "-o", str(folder)]) == 0
    return folder


def same(a, b):
    """Whether two runs left the same numbers and fields, bit by bit."""
    names = ["history.csv", "fields.pvd", "contact.pvd"]
    names += [f"{f}/{p.name}" for f in ("fields", "contact") for p in (a / f).iterdir()]
    summaries = [json.loads((f / "summary.json").read_text()) for f in (a, b)]
    for summary in summaries:
        del summary["wall_time_s"]
    return summaries[0] == summaries[1] and all(
        (a / n).read_bytes() == (b / n).read_bytes() for n in names
    )


def stop_after(monkeypatch, count, number=signal.SIGINT):
    """Let runs get a signal, that of Ctrl-C, behind so many accepted increments."""
    from anisocontact.results.writer import Writer

    keep = Writer.keep

    def interrupted(self, *arguments):
        keep(self, *arguments)
        if self.summary["steps"] == count > 0:
            os.kill(os.getpid(), number)

    monkeypatch.setattr(Writer, "keep", interrupted)


@pytest.mark.parametrize("count", [1, 3])
def test_condensed_goes_on_bit_by_bit(monkeypatch, case, count):
    """What has been condensed is made again from the same numbers in the same order."""
    case.write_text(case.read_text().replace('"direct"', '"condensed"'))
    whole, out = case.parent / "whole", case.parent / "out"
    assert main(["run", str(case), "-o", str(whole)]) == 0
    with monkeypatch.context() as patch:
        stop_after(patch, count)
        assert main(["run", str(case), "-o", str(out)]) == 3
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


def test_condensed_goes_on_as_direct(monkeypatch, case):
    """A checkpoint without the interior of the bodies: another strategy solves for it first.

    Both go on to the tolerance of Newton's method, 1e-8 of the forces at work.
    """
    case.write_text(case.read_text().replace('"direct"', '"condensed"'))
    whole, out = case.parent / "whole", case.parent / "out"
    assert main(["run", str(case), "-o", str(whole)]) == 0
    with monkeypatch.context() as patch:
        stop_after(patch, 1)
        assert main(["run", str(case), "-o", str(out)]) == 3
    assert "pending_in_reach" in "".join(np.load(out / "checkpoint.npz").files)
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


def test_augmented_contact_of_a_free_body_goes_on(monkeypatch, case):
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
def test_ctrl_c_says_how_to_go_on_and_it_does(monkeypatch, capsys, case, whole, count):
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


def test_term_is_like_ctrl_c(monkeypatch, capsys, case, whole):
    """Batch systems send TERM before they kill."""
    out = case.parent / "out"
    with monkeypatch.context() as patch:
        stop_after(patch, 3, signal.SIGTERM)
        assert main(["run", str(case), "-o", str(out)]) == 3
    assert "interrupted after step 'drag', increment 1" in capsys.readouterr().err
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


def test_a_run_that_is_done_goes_on_with_further_steps(capsys, case, whole):
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
        ("normal = { penalty = 1e4 }\n", "", "contact[0].normal: nothing given, the run that is"),
        ('name = "press"', 'name = "push"', "step[0].name: 'push' given, the run"),
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


def test_killed_before_the_first_increment(capsys, case, whole):
    """There is a folder and no accepted increment: the run begins."""
    out = case.parent / "early"
    out.mkdir()
    (out / "run.log").write_text("anisocontact 0.1.0\n")
    (out / ".summary-123.json").write_text("{")
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert "restart   from the beginning" in capsys.readouterr().out
    assert same(whole, out)
    assert not (out / ".summary-123.json").exists()


@pytest.mark.parametrize("kind", ["cut", "noise", "text", "format"])
def test_a_damaged_checkpoint_is_one_line(capsys, case, whole, kind):
    path = whole / "checkpoint.npz"
    if kind == "cut":
        path.write_bytes(path.read_bytes()[:-100])
    elif kind == "noise":
        path.write_bytes(b"PK" + bytes(range(256)))
    elif kind == "text":
        path.write_text("no archive")
    else:
        stored = checkpoint.load_checkpoint(whole)
        assert stored is not None
        facts = json.dumps(stored.facts | {"format": 0}).encode()
        np.savez(path, **stored.arrays, facts=np.frombuffer(facts, dtype=np.uint8))
    assert main(["run", str(case), "-o", str(whole), "--restart"]) == 2
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1
    assert "checkpoint.npz" in error
    assert "pickle" not in error  # what NumPy says of files that it does not know


@pytest.mark.parametrize("victim", ["history", "fields", "summary", "checkpoint", "log"])
def test_a_full_disk_loses_nothing(monkeypatch, capsys, case, whole, victim):
    """Requirement: a full disk is an error that loses nothing: the run goes on when there is room.

    The named file fails from the third accepted increment on.
    """
    from anisocontact.results import collection, writer
    from anisocontact.results.history import History

    owner, name = {
        "history": (History, "append"),
        "fields": (collection, "_write"),
        "summary": (writer, "write_text"),
        "checkpoint": (checkpoint, "save_checkpoint"),
        "log": (writer.Writer, "_append"),
    }[victim]
    real, full = getattr(owner, name), {"now": False}

    def failing(*arguments, **more):
        if full["now"]:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), f"{victim} file")
        return real(*arguments, **more)

    accept = writer.Writer.accept

    def accepting(self, accepted):
        full["now"] = self.summary["steps"] >= 2
        accept(self, accepted)

    out = case.parent / "out"
    with monkeypatch.context() as patch:
        patch.setattr(owner, name, failing)
        patch.setattr(writer.Writer, "accept", accepting)
        assert main(["run", str(case), "-o", str(out)]) == 3
    error = capsys.readouterr().err.splitlines()
    said = f"error: stopped: cannot write '{victim} file': No space left on device"
    assert error[0].startswith(said)
    assert error[-1].startswith("to go on: anisocontact run ")
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


def test_files_that_may_not_grow(case, whole):
    """The same with a limit of the system on the size of a file, which VTK meets too."""
    out = case.parent / "out"
    code = (
        "import resource, signal, sys; from anisocontact.cli import main; "
        "import anisocontact._fenicsx  # MPI needs larger files\n"
        "from anisocontact.results import report; report.write_report = lambda folder: []; "
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN); "
        "resource.setrlimit(resource.RLIMIT_FSIZE, ({0}, {0})); "
        f"sys.exit(main(['run', {str(case)!r}, '-o', {str(out)!r}]))"
    )
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] == resource.RLIM_INFINITY
    largest = max(p.stat().st_size for p in (whole / "contact").iterdir())
    done = subprocess.run(
        [sys.executable, "-c", code.replace("{0}", str(largest - 1))],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 3, done.stderr
    assert "error: stopped: cannot write" in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(out.rglob(".*"))
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


def test_writing_stops_at_the_first_failure():
    from mpi4py import MPI

    disk, calls = Disk(MPI.COMM_SELF), []
    disk.write(lambda: calls.append(1))
    disk.check()

    def full():
        raise OSError(errno.ENOSPC, "No space left on device", "a")

    disk.write(full)
    disk.write(lambda: calls.append(2))
    with pytest.raises(WriteError, match="cannot write 'a': No space left on device"):
        disk.check()
    assert calls == [1]


def test_another_order_of_nodes_finds_its_own(case, whole):
    """Other ranks number nodes and points in another order: they are found by their positions."""
    built = build(load(case))
    stored = checkpoint.load_checkpoint(whole)
    assert stored is not None
    like = built.solver.persistent()
    wanted = checkpoint.distribute(stored, built.problem.model, like)
    chance = np.random.default_rng(3)
    shuffled = {}
    order = {
        "n": chance.permutation(len(stored.arrays["node/body"])),
        "p": chance.permutation(len(stored.arrays["points/0/reference"])),
    }
    for name, values in stored.arrays.items():
        shuffled[name] = values[order[name[0]]] if name[0] in order else values
    found = checkpoint.distribute(
        checkpoint.Stored(shuffled, stored.facts), built.problem.model, like
    )
    assert all(np.array_equal(found.nodal[n], v) for n, v in wanted.nodal.items())
    assert all(np.array_equal(found.points[0][n], v) for n, v in wanted.points[0].items())
    shuffled["node/position"] = shuffled["node/position"] + 1e-3
    with pytest.raises(InputError, match="the mesh is not that of the run that is to go on"):
        checkpoint.distribute(checkpoint.Stored(shuffled, stored.facts), built.problem.model, like)


VARIANTS = {
    "augmented": {"normal = { penalty = 1e4 }": 'method = "augmented"'},
    "finite strain": {'model = "linear-elastic"': 'model = "neo-hookean"'},
    "unsupported": {
        "origin = [0, 0, 0]": "origin = [0, 0, 0.05]",
        'displacement = { "block.top" = { x = 0, y = 0, z = -0.01 } }': (
            'force = { "block.top" = { z = -5 } }'
        ),
        'displacement = { "block.top" = { x = 0.02, y = 0.01 } }': (
            'force = { "block.top" = { x = 0.3 } }'
        ),
    },
}


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("at", [0, 2])
def test_every_state_counts(case, variant, at):
    """Through the file and back: what follows is the same bit by bit, whatever has a history."""
    text = case.read_text()
    for old, new in VARIANTS[variant].items():
        assert old in text
        text = text.replace(old, new)
    case.write_text(text)
    first, second = build(load(case)), build(load(case))
    later = []
    for count, accepted in enumerate(first.solver.run()):
        if count == at:
            model = first.problem.model
            own, common = checkpoint.own_arrays(model, first.solver.persistent())
            checkpoint.save_checkpoint(case.parent, own | common, {})
        elif count > at:
            later.append(accepted)
    stored = checkpoint.load_checkpoint(case.parent)
    assert stored is not None
    like = second.solver.persistent()
    second.solver.restore(checkpoint.distribute(stored, second.problem.model, like))
    again = list(second.solver.run())
    assert len(again) == len(later) == 5 - at
    for a, b in zip(later, again, strict=True):
        assert (a.time, a.iterations, a.residuals) == (b.time, b.iterations, b.residuals)
        assert a.energies == b.energies
    assert np.array_equal(first.problem.u.x.array, second.problem.u.x.array)


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
        "from anisocontact.results import report, writer; report.write_report = lambda folder: []; "
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
