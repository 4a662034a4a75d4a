"""The command among other programs: pipes, signals, terminals, encodings, and machines that lack.

Requirement: the conventions of POSIX for utilities; exit codes are those that `--help` names. Runs
are separate processes where the process itself is the matter.
"""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.compiler import lack_of_compiler
from anisocontact.base.errors import MachineError
from anisocontact.base.machine import lack
from anisocontact.base.signals import held_back, on_signals
from anisocontact.cli import main
from anisocontact.results.checkpoint import load_checkpoint
from anisocontact.results.read import Results
from anisocontact.solver.system.problem import Problem

COMMAND = (sys.executable, "-m", "anisocontact")
#: Names and texts that terminals, rich, HTML and Matplotlib would read as something else.
STEP = "[/red] $a_$ <b> \x1b]0;owned\x07 \u202e:smile:"
BODY = "bl[bold]\x1b[31m$x"
TITLE = "<i>\x1b[2J\nof two lines [/]"
SHOWN = STEP.replace("\x1b", "\\x1b").replace("\x07", "\\x07").replace("\u202e", "\\u202e")


@pytest.fixture
def case(tmp_path: Path, unpictured: str) -> Path:
    """The small case in a folder of its own, without pictures."""
    path = tmp_path / "case.toml"
    path.write_text(unpictured)
    return path


@pytest.fixture
def long(case: Path) -> Path:
    """A case that goes on until it is stopped."""
    case.write_text(case.read_text().replace("increments = 4", "increments = 4000"))
    return case


def arguments(case: Path) -> list[str]:
    return ["run", str(case), "-o", str(case.parent / "out")]


def started(case: Path, *before: str) -> subprocess.Popen[str]:
    pipe = subprocess.PIPE
    return subprocess.Popen(
        [*before, *COMMAND, *arguments(case)], stdout=pipe, stderr=pipe, text=True
    )


def summary(case: Path) -> dict[str, object]:
    text = (case.parent / "out" / "summary.json").read_text()
    found: dict[str, object] = json.loads(text)
    return found


def read_until(run: subprocess.Popen[str], beginning: str) -> None:
    assert run.stdout is not None
    for line in run.stdout:
        if line.startswith(beginning):
            return


@pytest.mark.parametrize("after", ["case", "drag 2"])
def test_a_reader_that_goes_ends_the_run_quietly(long: Path, after: str) -> None:
    """`anisocontact run ... | head -1`: not a word, not done, and what converged is kept."""
    with started(long) as run:
        read_until(run, after)
        assert run.stdout is not None and run.stderr is not None
        run.stdout.close()
        error = run.stderr.read()
    assert (run.returncode, error) == (3, "")
    found = summary(long)
    assert found["status"] == "stopped"
    assert str(found["message"]).startswith("nobody reads what is printed any more")
    assert found["steps"] >= (3 if after == "drag 2" else 0)  # type: ignore[operator]
    stored = load_checkpoint(long.parent / "out")
    assert stored is not None
    assert stored.facts["writer"]["summary"]["steps"] == found["steps"]


@pytest.mark.parametrize(
    "sent",
    [[signal.SIGTERM], [signal.SIGHUP], [signal.SIGHUP, signal.SIGHUP, signal.SIGTERM]],
)
def test_signals_end_the_run_after_the_increment(long: Path, sent: list[signal.Signals]) -> None:
    """As a first Ctrl-C; a terminal that is closed and a launcher send more than one."""
    with started(long) as run:
        read_until(run, "drag 2")
        for one in sent:
            run.send_signal(one)
        _, error = run.communicate(timeout=60)
    assert run.returncode == 3
    lines = error.splitlines()
    assert lines[0].startswith("error: stopped: interrupted after step 'drag', increment ")
    assert lines[1:] == [f"to go on: anisocontact {' '.join(arguments(long))} --restart"]
    assert str(summary(long)["message"]).startswith("interrupted")


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT"])
def test_signals_before_the_run(case: Path, name: str) -> None:
    """PETSc is there and no increment has begun: one line, nothing written."""
    code = (
        "import os, signal, sys; import anisocontact.case.build as b; from anisocontact.cli import "
        f"main; b.build = lambda file: os.kill(os.getpid(), signal.{name}); sys.exit(main())"
    )
    command = [sys.executable, "-c", code, *arguments(case)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (3, "error: interrupted\n")
    assert not (case.parent / "out").exists()


@pytest.fixture
def hang_up() -> Iterator[None]:
    """A signal of a terminal that is closed ends the process, also where `nohup` has started it."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.usefixtures("hang_up")
def test_signals_while_modules_are_loaded() -> None:
    """They are answered afterwards, once each: an exception there would end the process in C++.

    Signals come to this thread: of one to the process another thread may take notice, later.
    """
    taken: list[int] = []
    with on_signals(taken.append):
        with held_back() as answer:
            signal.raise_signal(signal.SIGTERM)
            with held_back():
                signal.raise_signal(signal.SIGINT)
            assert taken == []
            answer()
            assert sorted(taken) == [signal.SIGINT, signal.SIGTERM]
            signal.raise_signal(signal.SIGHUP)
            assert taken[2:] == [signal.SIGHUP]
        assert len(taken) == 3
    code = (
        "import os, signal, sys, anisocontact.cli; main = sys.modules['anisocontact.cli.main']; "
        "main.started_together = lambda: os.kill(os.getpid(), signal.SIGTERM); "
        "sys.exit(main.main(['info']))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (3, "error: interrupted\n")


def test_what_nohup_ignores_stays_ignored() -> None:
    """A signal that whoever started the process wants ignored is."""
    taken: list[int] = []
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with on_signals(taken.append):
            signal.raise_signal(signal.SIGHUP)
            signal.raise_signal(signal.SIGTERM)
        assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)
    assert taken == [signal.SIGTERM]


@pytest.mark.parametrize("command", ["info", "check", "run"])
def test_output_that_is_full(case: Path, command: str) -> None:
    """`> /dev/full`: one line says so, a run stops before its first increment."""
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full")
    words = {"info": ["info"], "check": ["check", str(case)], "run": arguments(case)}[command]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [*COMMAND, *words], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == 3
    line, *others = done.stderr.splitlines()
    assert line.startswith("error: ")
    assert "what is printed cannot be written (No space left on device: send it elsewhere)" in line
    assert len(others) == (command == "run")
    if command == "run":
        assert summary(case)["steps"] == 0


def test_no_output_at_all(case: Path) -> None:
    """`>&-`, as some daemons start programs."""
    done = subprocess.run(
        ["/bin/sh", "-c", 'exec "$@" >&-', "sh", *COMMAND, *arguments(case)],
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    assert done.returncode == 0
    assert done.stderr.startswith("warning: ") and done.stderr.count("\n") == 1
    assert summary(case)["status"] == "done"


def test_an_encoding_that_lacks_letters(case: Path) -> None:
    """What the encoding of the terminal has not is written as an escape."""
    case.write_text(case.read_text().replace("turned", "3 µm hohe gedrehte"))
    done = subprocess.run(
        [*COMMAND, "check", str(case)],
        env=os.environ | {"PYTHONIOENCODING": "ascii"},
        capture_output=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"Small block on a 3 \\xb5m hohe gedrehte plate" in done.stdout


def test_names_that_are_no_utf_8(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Files of an older system keep the bytes of their names, which DOLFINx and VTK do not take."""
    out = case.parent / os.fsdecode(b"D\xfcse")
    words = ["run", str(case), "-o", str(out)]
    done = subprocess.run([*COMMAND, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("/D\\udcfcse\n")
    assert (out / "history.csv").is_file()
    assert main(["report", str(out)]) == 0
    assert capsys.readouterr().err == ""


@pytest.fixture
def named(case: Path) -> Path:
    """Title, body, groups and steps with names that mean something to whoever shows them."""
    text = case.read_text()
    for old, new in {"Small block": TITLE, "press": STEP, "block": BODY, "plate": "p[/]"}.items():
        text = text.replace(old, json.dumps(new)[1:-1])
    for table in ("mesh.box", "material", "surface"):
        for name in (BODY, "p[/]"):
            shown = json.dumps(name)
            text = text.replace(f"[{table}.{shown[1:-1]}]", f"[{table}.{shown}]")
    case.write_text(text)
    return case


def on_terminal(command: list[str]) -> tuple[int, str]:
    """Exit code of a command whose output is a terminal, and what it shows."""
    ours, theirs = pty.openpty()
    shown = b""
    with subprocess.Popen(command, stdout=theirs, stderr=theirs) as run:
        os.close(theirs)
        while True:
            try:
                part = os.read(ours, 4096)
            except OSError:  # the other end is closed
                break
            if not part:
                break
            shown += part
    os.close(ours)
    return run.returncode, shown.decode()


def test_names_on_a_terminal(named: Path) -> None:
    """Brackets are no markup, and nothing of a name moves the cursor."""
    code, shown = on_terminal([*COMMAND, *arguments(named)])
    assert code == 0, shown
    assert SHOWN in shown
    for raw in ("\x1b]0", "\x07", "\u202e", "\x1b[2J"):
        assert raw not in shown


def test_names_in_files(named: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Log and report have them letter by letter, and all pictures are drawn.

    Tables have them as they were given, for programs that look for them.
    """
    out = named.parent / "out"
    named.write_text(named.read_text().replace("pictures = false\n", ""))
    assert main(arguments(named)) == 0
    said = capsys.readouterr()
    (warned,) = said.err.splitlines()
    assert warned.startswith("warning: contact of bl[bold]\\x1b[31m$x.bottom with p[/]: the penet")
    assert "case      <i>\\x1b[2J\\nof two lines [/]" in said.out
    log, page = (out / "run.log").read_text(), (out / "report.html").read_text()
    for text in (said.out, log, page):
        assert "\x1b" not in text and "\x07" not in text
    assert f"{SHOWN} 1  " in log
    assert "picture" not in log
    assert SHOWN.replace("<b>", "&lt;b&gt;") in page
    assert "<b>" not in page and "<i>" not in page
    assert set(Results(out).history["step"].tolist()) == {STEP, "drag"}
    assert {path.stem for path in (out / "pictures").iterdir()} >= {"force", "domain", "pressure"}


def test_a_trace_with_such_a_title(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (Path(__file__).parents[2] / "examples" / "point" / "rules.toml").read_text()
    lines = [line for line in text.splitlines() if not line.startswith("title")]
    case = tmp_path / "trace.toml"
    case.write_text("\n".join([f"title = {json.dumps(TITLE + ' $a_$')}", *lines]))
    assert main(["trace", str(case), "-o", str(tmp_path / "out")]) == 0
    assert "\x1b" not in capsys.readouterr().out
    page = (tmp_path / "out" / "report.html").read_text()
    assert "\x1b" not in page and "&lt;i&gt;\\x1b[2J\\nof two lines [/] $a_$" in page


@pytest.mark.parametrize(
    ("variables", "said"),
    [
        ({"CC": "no-such-compiler"}, "no C compiler, 'no-such-compiler' is not found"),
        ({"CC": "false"}, "the C compiler 'false' does not compile forms (exit code 1)"),
        ({"XDG_CACHE_HOME": "{case}"}, "compiled forms cannot be kept in '{case}/fenics' (Not a"),
    ],
)
def test_forms_that_cannot_be_compiled(case: Path, variables: dict[str, str], said: str) -> None:
    """No compiler, one that fails, a cache that cannot be written: one line with the cure."""
    given = {"XDG_CACHE_HOME": str(case.parent)} | variables
    given = {name: value.format(case=case) for name, value in given.items()}
    done = subprocess.run(
        [*COMMAND, *arguments(case)],
        env=os.environ | given,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 3
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"error: {said.format(case=case)}")
    assert "in the variable CC" in line or "set XDG_CACHE_HOME" in line


def test_a_machine_that_compiles_lacks_nothing(tmp_path: Path) -> None:
    assert lack_of_compiler(tmp_path) is None


@pytest.mark.parametrize(
    "error", [MemoryError("Unable to allocate 74.5 GiB"), OSError(28, "No space left on device")]
)
def test_what_the_machine_lacks_stops_a_run(
    case: Path,
    error: Exception,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Memory or disk that end in the middle: one line, and what converged is kept."""
    evaluate: Callable[..., object] = Problem.evaluate
    count = [0]

    def failing(self: Problem, x: object) -> object:
        count[0] += 1
        if count[0] > 8:
            raise error
        return evaluate(self, x)

    monkeypatch.setattr(Problem, "evaluate", failing)
    case.write_text(case.read_text() + '\n[solver]\nstrategy = "direct"\n')
    assert main(arguments(case)) == 3
    first, second = capsys.readouterr().err.splitlines()
    assert first.startswith(f"error: stopped: {lack(error)}; what converged is in ")
    assert second.endswith("--restart")
    assert summary(case)["message"] == str(lack(error))


def test_factors_without_memory(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """MUMPS says that it has no memory; that is not taken for a body without support.

    It says so where its limit (ICNTL(23), here 1 MB) is below what it needs.
    """
    text = case.read_text().replace("[3, 3, 2]", "[12, 12, 6]")
    options = "options = { mat_mumps_icntl_23 = 1 }"
    case.write_text(f'{text}\n[solver]\nstrategy = "direct"\n{options}\n')
    assert main(arguments(case)) == 3
    error = capsys.readouterr().err
    assert error.startswith("error: stopped: MUMPS (INFOG(1) = -19) had no memory for the factors")
    assert 'strategy = "iterative"' in error


def test_lack_is_told_from_mistakes_of_the_program() -> None:
    assert lack(FileNotFoundError(2, "No such file", "x")) is None
    assert lack(MachineError("a", "b")) is not None
    petsc = RuntimeError("PETSc says a lot")
    petsc.ierr = 55  # type: ignore[attr-defined]
    assert str(lack(petsc)).startswith("out of memory: take")
