"""The command: what it prints, its exit codes, and that it is quick to answer."""

from __future__ import annotations

import gc
import json
import os
import signal
import subprocess
import sys

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import build_parser, main
from anisocontact.solver import Progress


@pytest.fixture
def case(tmp_path, unpictured):
    """The small case in a folder of its own."""
    path = tmp_path / "case.toml"
    path.write_text(unpictured)
    return path


def test_a_script_that_calls_the_command_keeps_its_collector(capsys):
    """Settings of the interpreter are those of the command's own process: see `command`."""
    before = gc.get_threshold()
    assert main(["--version"]) == 0
    assert gc.get_threshold() == before


def test_help_names_every_command_and_the_exit_codes(capsys):
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    for word in ("run", "check", "schema", "info", "exit codes"):
        assert word in text


def test_help_loads_nothing_heavy():
    code = (
        "import sys; from anisocontact.cli import main; main(['--help']); "
        "print(sorted({'numpy', 'pydantic', 'dolfinx', 'pyvista', 'matplotlib', 'rich'} "
        "& set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


#: The plate of the small block as a body of its own.
BASE = """
[mesh.box.base]
origin = [-1, -1, -0.5]
size = [3, 3, 0.5]
cells = [5, 5, 1]
[material.base]
model = "linear-elastic"
E = 1000
nu = 0.3
"""


def test_a_run_imports_only_what_it_uses(unpictured, tmp_path):
    """What a case of two bodies without pictures does without takes as long to import as it runs.

    Some packages of NumPy are in the list of imported modules, and are executed when something asks
    for them.
    """
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    case = unpictured.replace('master = "plate"', 'master = "base.top"') + BASE
    clamped = '"base.bottom" = { x = 0, y = 0, z = 0 }, "block.top" ='
    (tmp_path / "case.toml").write_text(case.replace('"block.top" =', clamped))
    code = (
        "import sys; from anisocontact.cli import main; "
        f"end = main(['run', {str(tmp_path / 'case.toml')!r}, '-o', {str(tmp_path / 'out')!r}]); "
        "print(end, sorted({'scipy.spatial', 'matplotlib', 'pyvista', 'gmsh', 'rich', 'pandas', "
        "'numpy.f2py.crackfortran', 'numpy.testing._private', 'unittest', "
        "'numpy.polynomial.legendre', 'anisocontact.contact.tie_weights', 'anisocontact.mesh.inp', "
        "'anisocontact.solver.strategies.iterative.newton'} & set(sys.modules))); "
        "import numpy; print(callable(numpy.f2py.run_main), "
        "callable(numpy.testing.assert_equal), numpy.polynomial.Polynomial([0, 1])(2))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-2:] == ["0 []", "True True 2.0"]


def test_finite_elements_import_no_compiler():
    """What compiles forms is imported where one is compiled, whole, and not to find one."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    code = (
        "import sys, anisocontact.base.fenicsx; "
        "heavy = {'pycparser', 'ffcx.codegeneration.C', 'ffcx.codegeneration.lnodes'}; "
        "print(sorted(heavy & set(sys.modules))); "
        "import ffcx.compiler, ffcx.codegeneration.C as C; "
        "from ffcx.codegeneration.C import file_template; "
        "print(C.file.file_template is file_template, file_template.libraries)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    first, second = done.stdout.splitlines()
    assert first == "[]"
    assert second.startswith("True [")


@pytest.mark.parametrize("arguments", [[], ["walk"], ["run"], ["run", "a", "b"], ["info", "--jso"]])
def test_wrong_arguments(capsys, arguments):
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "error" in captured.err


def test_schema_is_json(capsys):
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out)["properties"]["contact"]


def test_info_lists_versions_and_registries(capsys):
    assert main(["info"]) == 0
    text = capsys.readouterr().out
    for word in ("dolfinx", "petsc", "plane", "maximum-dissipation", "linear-elastic", "angle_deg"):
        assert word in text
    assert main(["info", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["versions"]["python"] == ".".join(map(str, sys.version_info[:3]))
    entries = {entry["name"]: entry for entry in facts["registries"]["sliding rules"]}
    assert entries["explicit"]["parameters"][0]["default"] == "centre"


def test_check_says_what_is_in_a_case(capsys, case):
    assert main(["check", str(case)]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "case      Small block on a turned plate",
        "body      block: linear-elastic",
        # (3+1)(3+1)(2+1) nodes, 3*3*2 cells
        "mesh      48 nodes, 18 cells of order 1, 144 unknowns",
        "contact   block.bottom on plate: 9 slave facets, penalty 1e+04, maximum-dissipation, "
        "at slave nodes (mortar), penalties",
        "step      press: 2 increments, block.top",
        "step      drag: 4 increments, block.top",
        "body      block: 18 hexahedra of order 1, box (0, 0, 0) to (1, 1, 0.5), "
        "edges 0.25 to 0.3333",
        "quality   block: worst 1, mean 1",
        *(
            f"group     block.{side}: 6 facets, area 0.5"
            for side in ("left", "right", "front", "back")
        ),
        *(f"group     block.{end}: 9 facets, area 1" for end in ("bottom", "top")),
    ]
    assert [entry.name for entry in case.parent.iterdir()] == ["case.toml"]


def test_run_in_a_pipe_prints_a_line_for_each_increment(capsys, case):
    out = case.parent / "out"
    assert main(["run", str(case), "-o", str(out)]) == 0
    captured = capsys.readouterr()
    (said,) = captured.err.splitlines()  # a soft penalty on a coarse mesh
    assert said.startswith("warning: contact of block.bottom with plate: the penetration was up to")
    lines = captured.out.splitlines()
    assert [line.split("  ")[0] for line in lines if "residual" in line] == [
        *(f"press {i}" for i in (1, 2)),
        *(f"drag {i}" for i in (1, 2, 3, 4)),
    ]
    assert lines[-1] == f"done      {out}"


def test_results_are_not_overwritten_unasked(capsys, case):
    out = case.parent / "out"
    arguments = ["run", str(case), "-o", str(out)]
    assert main(arguments) == 0
    before = (out / "summary.json").read_bytes()
    (out / "notes.txt").write_text("mine")
    capsys.readouterr()
    assert main(arguments) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert (out / "summary.json").read_bytes() == before
    assert main([*arguments, "--overwrite"]) == 0
    assert (out / "notes.txt").read_text() == "mine"


def test_a_folder_that_is_not_ours_is_never_touched(capsys, case):
    arguments = ["run", str(case), "-o", str(case.parent), "--overwrite"]
    assert main(arguments) == 2
    assert "case.toml" in capsys.readouterr().err
    assert [entry.name for entry in case.parent.iterdir()] == ["case.toml"]


def test_default_folder(monkeypatch, capsys, case):
    monkeypatch.chdir(case.parent)
    assert main(["run", "case.toml"]) == 0
    assert (case.parent / "results" / case.parent.name / "summary.json").is_file()


def test_a_run_that_cannot_go_on_keeps_what_converged(capsys, case, unpictured, no_detours):
    """Pressing takes four iterations; the whole drag in one takes more, without detours."""
    text = unpictured.replace("increments = 4", "increments = 1")
    text = text.replace("[[contact]]", '[[contact]]\npass = "single"')
    case.write_text(text + "[solver]\ncuts = 0\noptions = { snes_max_it = 4 }\n")
    out = case.parent / "out"
    assert main(["run", str(case), "-o", str(out)]) == 3
    error = capsys.readouterr().err
    assert error.startswith("error: stopped: step 'drag', increment ")
    assert "Traceback" not in error
    summary = json.loads((out / "summary.json").read_text())
    assert summary["status"] == "stopped"
    assert "drag" in summary["message"]
    rows = (out / "history.csv").read_text().splitlines()
    assert len(rows) == 1 + summary["steps"] >= 3


def test_ctrl_c_ends_after_the_increment_and_keeps_it(case, unpictured):
    case.write_text(unpictured.replace("increments = 4", "increments = 4000"))
    out = case.parent / "out"
    command = [sys.executable, "-m", "anisocontact", "run", str(case), "-o", str(out)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as run:
        assert run.stdout is not None
        for line in run.stdout:
            if line.startswith("drag 2"):
                break
        run.send_signal(signal.SIGINT)
        _, error = run.communicate(timeout=60)
    assert run.returncode == 3
    assert "interrupted after step 'drag'" in error
    summary = json.loads((out / "summary.json").read_text())
    assert summary["status"] == "stopped"
    assert len((out / "history.csv").read_text().splitlines()) == 1 + summary["steps"]


def test_a_first_ctrl_c_says_once_what_it_does(monkeypatch, capsys, case):
    from anisocontact.cli.progress import Lines

    def interrupted(_: Lines, progress: Progress) -> None:
        if (progress.step, progress.iteration) == ("drag", 0):
            os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(Lines, "iteration", interrupted)
    assert main(["run", str(case), "-o", str(case.parent / "out")]) == 3
    said = capsys.readouterr().out.splitlines()
    assert said.count("stopping after this increment; a second Ctrl-C stops at once") == 1
    assert [line for line in said if line.startswith("drag")][-1].startswith("drag 1 ")


def test_an_internal_error_is_one_line_and_its_details_in_the_log(monkeypatch, capsys, case):
    from anisocontact.results.writer import Writer

    def broken(*_: object) -> None:
        raise RuntimeError("a bug\nof two lines")

    monkeypatch.setattr(Writer, "accept", broken)
    out = case.parent / "out"
    assert main(["run", str(case), "-o", str(out)]) == 1
    error = capsys.readouterr().err
    assert error.splitlines() == [
        f"error: internal: RuntimeError: a bug of two lines; details in {out / 'run.log'}"
    ]
    log = (out / "run.log").read_text()
    assert "Traceback" in log
    assert main(["run", str(case), "-o", str(out), "--overwrite", "--debug"]) == 1
    *traced, last = capsys.readouterr().err.splitlines()
    assert last == error.strip()
    assert traced[0].startswith("Traceback") and "    raise RuntimeError(" in "\n".join(traced)
    assert json.loads((out / "summary.json").read_text())["status"] == "stopped"


def test_a_terminal_shows_a_bar_and_loses_nothing(case):
    """On a terminal the iterations are drawn; the log has the same lines as in a pipe."""
    pty = pytest.importorskip("pty")
    out = case.parent / "out"
    main_end, child_end = pty.openpty()
    command = [sys.executable, "-m", "anisocontact", "run", str(case), "-o", str(out)]
    with subprocess.Popen(command, stdout=child_end, stderr=child_end) as run:
        os.close(child_end)
        shown = b""
        while True:
            try:
                part = os.read(main_end, 4096)
            except OSError:  # the other end is closed
                break
            if not part:
                break
            shown += part
    os.close(main_end)
    assert run.returncode == 0
    text = shown.decode()
    assert "drag 4/4" in text
    assert "iteration" in text
    log = (out / "run.log").read_text()
    assert [f"drag {i}  " in log for i in (1, 2, 3, 4)] == [True] * 4


def test_no_pictures_until_they_are_asked_for(capsys, case):
    """`output.pictures = false`: the run draws nothing; `report` does, from the folder alone."""
    out = case.parent / "out"
    assert main(["run", str(case), "-o", str(out)]) == 0
    assert not (out / "report.html").exists()
    assert not (out / "pictures").exists()
    capsys.readouterr()
    assert main(["report", str(out)]) == 0
    assert capsys.readouterr().out == f"report    {out / 'report.html'}\n"
    assert "Small block on a turned plate" in (out / "report.html").read_text()
    assert (out / "pictures" / "pressure.png").is_file()


@pytest.mark.parametrize(
    ("command", "missing", "code"),
    [
        ("check", "mpi4py,dolfinx,petsc4py,basix,ufl,pyvista,vtkmodules,gmsh", 2),
        ("run", "mpi4py,dolfinx,petsc4py,basix,ufl,pyvista,vtkmodules,gmsh", 2),
        ("check", "petsc4py", 2),
        ("run", "dolfinx", 2),
    ],
)
@pytest.mark.parametrize("launcher", ["", "PMI_RANK"])
def test_a_part_of_the_extra_is_missing(case, command, missing, code, launcher):
    """All of `fem` or a part of it: one line says what to install, no error of the program."""
    code_text = (
        f"import sys; sys.modules.update(dict.fromkeys({missing.split(',')!r})); "
        f"from anisocontact.cli import main; sys.exit(main(['{command}', {str(case)!r}]))"
    )
    if launcher and "mpi4py" not in missing:
        pytest.skip("MPI is there, and would look for its launcher")
    done = subprocess.run(
        [sys.executable, "-c", code_text],
        env=os.environ | ({launcher: "0"} if launcher else {}),
        cwd=case.parent,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == code
    (line,) = done.stderr.splitlines()
    assert line.startswith("error: the finite-element level is not installed")
    assert "pip install 'anisocontact[fem]'" in line


def test_no_memory_for_the_finite_elements(tmp_path, case_text, monkeypatch, capsys):
    """A library that is there and has no room is no library that is missing."""
    case = tmp_path / "case.toml"
    case.write_text(case_text)

    def no_room() -> None:
        raise ImportError("basix.so: failed to map segment from shared object", name="dolfinx")

    monkeypatch.setattr("anisocontact.mesh.shapes", no_room)
    assert main(["run", str(case)]) == 3
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: out of memory (for a library): take a coarser mesh")


def test_no_finite_elements_installed(tmp_path, case_text):
    """Without DOLFINx schema and info still work, and a run says what to install."""
    case = tmp_path / "case.toml"
    case.write_text(case_text)
    code = (
        "import sys; sys.modules['dolfinx'] = None; from anisocontact.cli import main; "
        "assert main(['schema']) == 0 and main(['info']) == 0; "
        f"sys.exit(main(['run', {str(case)!r}]))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("error: the finite-element level is not installed: ")
    assert len(done.stderr.splitlines()) == 1
    assert "dolfinx" in done.stdout
    assert "not installed" in done.stdout


def test_every_argument_has_help():
    parsers = [build_parser()]
    for action in parsers[0]._actions:
        if hasattr(action, "choices") and isinstance(action.choices, dict):
            parsers += action.choices.values()
    assert len(parsers) >= 5
    for parser in parsers:
        for action in parser._actions:
            assert action.help or action.dest == "command"


@pytest.mark.parametrize("given", ["", " "])
def test_an_empty_results_folder_is_refused(case, capsys, monkeypatch, given):
    """A variable of a shell that was never set is no wish for results/<name>: one line."""
    monkeypatch.chdir(case.parent)
    assert main(["run", str(case), "-o", given]) != 0
    line = f"error: --output: {given!r} given, the name of a folder needed"
    assert capsys.readouterr().err.splitlines() == [line]
    assert not (case.parent / "results").exists()
