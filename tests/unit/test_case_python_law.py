"""A tangential law of a case file that is a class in a Python file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main

HERE = Path(__file__).parent
LAWS = HERE.parent / "verification" / "laws_in_python.py"

ALONG = 'directions = { kind = "constant", vector = [1, 0.2, 0] }'
CORE = f"""adhesion = {{ stiffness = [4e3, 1e3], {ALONG} }}
friction = {{ coefficients = [0.3, 0.1], sliding_rule = "radial", {ALONG} }}
"""
PYTHON = f"""[contact.python]
file = "{LAWS.as_posix()}"
law = "RadialReturn"
arguments = {{ stiffness = [4e3, 1e3], coefficients = [0.3, 0.1] }}
{ALONG}
"""
BASE = """[mesh.box.base]
origin = [-0.5, -0.5, -0.5]
size = [2, 2, 0.5]
cells = [4, 4, 1]
[material.base]
model = "linear-elastic"
E = 3000
nu = 0.3
"""
#: A law that gives no force, and may fail.
SMOOTH = """
import numpy as np
from anisocontact.interface import LawResult

class Smooth:
    internal = 0

    def update(self, state, kinematics):
        n = len(kinematics.pressure)
        none, block = np.zeros((n, 2)), np.zeros((n, 2, 2))
        return LawResult(none, none, block, none, block, block, state.internal, none[:, 0],
                         none[:, 0])
"""


def case(tmp_path: Path, laws: str, *, meshed: bool = False, name: str = "case") -> Path:
    """The small block with other laws, on its plate or on a second block."""
    text = (HERE / "small_block.toml").read_text(encoding="utf-8")
    first, last = text.index("adhesion ="), text.index("[[step]]")
    text = text[:first] + laws + text[last:]
    if meshed:
        text = text.replace("[material.block]", BASE + "[material.block]")
        text = text.replace('master = "plate"', 'master = "base.top"')
        held = '"base.bottom" = { x = 0, y = 0, z = 0 }, "block.top" = { x = 0, y = 0'
        text = text.replace('"block.top" = { x = 0, y = 0', held)
    text = text.replace("[output]", "[output]\npictures = false")
    path = tmp_path / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    return path


def smooth(tmp_path: Path, change: tuple[str, str] = ("", ""), keys: str = "") -> Path:
    """A case with a law of its own file, beside it."""
    (tmp_path / "smooth.py").write_text(SMOOTH.replace(*change), encoding="utf-8")
    table = '[contact.python]\nfile = "smooth.py"\nlaw = "Smooth"\nisotropic = true\n'
    return case(tmp_path, keys + table)


def numbers(tmp_path: Path, name: str) -> dict:
    return json.loads((tmp_path / name / "summary.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("meshed", [False, True], ids=["plate", "block"])
def test_law_of_the_core_written_in_python(tmp_path, meshed, capsys):
    """The sliding rule "radial" from a Python file gives what the core gives: forces, elastic slip
    and slip to 1e-7 of their size, the tolerance of Newton's method. On a body that deforms both
    laws are isotropic: there the second axis of a law in Python stays normal to the first, that of
    the core follows the material."""
    for name, given in (("core", CORE), ("python", PYTHON)):
        laws = given
        if meshed:
            laws = laws.replace("[4e3, 1e3]", "[2e3, 2e3]").replace("[0.3, 0.1]", "[0.2, 0.2]")
            laws = laws.replace(f", {ALONG}", "")
        path = case(tmp_path, laws, meshed=meshed, name=name)
        assert main(["run", str(path), "-o", str(tmp_path / name)]) == 0
    assert "RadialReturn of " in capsys.readouterr().out
    core, python = (numbers(tmp_path, name)["contacts"][0] for name in ("core", "python"))
    assert core["points"]["slip"] > 0
    assert python["points"] == core["points"]
    for key in ("force", "elastic_slip", "slip", "max_pressure"):
        assert python[key] == pytest.approx(core[key], rel=1e-7, abs=1e-9), key


WRONG = [
    (PYTHON.replace("RadialReturn", "RadialRetur"), "law", 'did you mean "RadialReturn"?'),
    (PYTHON.replace(LAWS.name, "no_laws.py"), "file", "no such file"),
    (PYTHON.replace("coefficients =", "mu ="), "arguments", "unexpected keyword argument 'mu'"),
    (PYTHON.replace("arguments", "argument"), "argument", 'did you mean "arguments"?'),
    (PYTHON[: PYTHON.index("directions")], "directions", "needed unless isotropic = true"),
    (PYTHON + 'directions_on = "slave"\n', "directions_on", '"master"'),
    (PYTHON.replace("[1, 0.2, 0]", "[0, 0, 0]"), "directions.vector", "[0, 0, 0] given"),
]


@pytest.mark.parametrize(("laws", "key", "said"), WRONG, ids=[w[1] + w[2][:9] for w in WRONG])
def test_mistakes_in_the_table(tmp_path, capsys, laws, key, said):
    """One line that names the key, and no results."""
    assert main(["run", str(case(tmp_path, laws)), "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err.strip()
    assert error.startswith(f"error: contact[0].python.{key}: ")
    assert said in error
    assert "\n" not in error
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("laws", "field", "said"),
    [
        ("", "friction", "{ coefficients = 0 } without friction"),
        (CORE + PYTHON, "adhesion", "the whole tangential law"),
        ('evolution = "total"\n' + PYTHON, "evolution", ""),
    ],
)
def test_one_tangential_law(tmp_path, capsys, laws, field, said):
    """Laws of the core or one in Python, not both and not none; a line says what to write."""
    assert main(["check", str(case(tmp_path, laws))]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"error: contact[0].{field}: ")
    assert said in error


FAULTY = [
    (("class Smooth", "class Smooth("), "file: 'smooth.py' cannot be run: smooth.py, line 5"),
    (("import numpy as np", "import nump as np"), "line 2: ModuleNotFoundError: No module named"),
    (("internal = 0", "internal = -1"), "law: Smooth.internal is -1"),
    (("def update", "def change"), "law: Smooth has no method update"),
    (("block, none, block", "block, q, block"), "smooth.py, line 11: NameError: name 'q'"),
    (("(none, none, block", "(none[1:], none, block"), "traction: the law returned an array of"),
    (("class Smooth", "import sys\nsys.exit()\nclass Smooth"), "line 6: SystemExit"),
    (("n = len", "raise SystemExit(0)\n        n = len"), "smooth.py, line 9: SystemExit: 0"),
    (("internal = 0", "__init__ = lambda self: exit(0)"), "SystemExit: 0"),
    (
        ("n = len", "state.internal[:] = 1.0\n        n = len"),
        "line 9: ValueError: assignment dest",
    ),
    (("n = len", "kinematics.increment[:] = 0\n        n = len"), "assignment destination is read"),
    (("return LawResult", "return None and LawResult"), "returned a NoneType, a LawResult needed"),
    (("(none, none, block", "(1j * none, none, block"), "an array of real numbers needed"),
    (("(none, none, block", "([[1], []], none, block"), "[[1], []], an array of real numbers"),
    (("(none, none, block", "(none.astype(str), none, block"), "an array of real numbers needed"),
]


@pytest.mark.parametrize(("change", "said"), FAULTY, ids=[f[0][1][:14] for f in FAULTY])
def test_mistakes_in_the_law(tmp_path, capsys, change, said):
    """One line with the place in the Python file."""
    assert main(["run", str(smooth(tmp_path, change)), "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err.strip()
    assert said in error
    assert "\n" not in error


def test_a_surface_that_cannot_be(tmp_path, capsys):
    """What only the surface itself can judge is one line, whatever the laws."""
    for laws in (CORE, PYTHON):
        path = case(tmp_path, laws)
        plane = 'shape = "plane"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]'
        ring = 'shape = "torus"\ncentre = [0, 0, 0]\naxis = [0, 0, 1]\nradius = 1\ntube = 2'
        text = path.read_text(encoding="utf-8")
        assert plane in text
        path.write_text(text.replace(plane, ring), encoding="utf-8")
        assert main(["check", str(path)]) == 2
        error = capsys.readouterr().err.strip()
        assert error.startswith("error: surface.plate: ")
        assert "tube must be less than radius" in error
        assert "\n" not in error


def test_restart_with_another_law(tmp_path, capsys):
    """A run goes on with the law that it had; a file that changed, or has gone, is refused."""
    path, out = smooth(tmp_path), tmp_path / "out"
    assert main(["run", str(path), "-o", str(out)]) == 0
    assert main(["run", str(path), "-o", str(out), "--restart"]) == 0
    (tmp_path / "smooth.py").write_text(SMOOTH + "\n# another\n", encoding="utf-8")
    assert main(["run", str(path), "-o", str(out), "--restart"]) == 2
    assert "'smooth.py' has changed since the run" in capsys.readouterr().err
    (tmp_path / "smooth.py").unlink()
    assert main(["run", str(path), "-o", str(out), "--restart"]) == 2
    assert capsys.readouterr().err == (
        "error: contact[0].python.file: 'smooth.py' given, no such file\n"
    )


def test_a_law_that_fails_is_no_run_to_go_on_with(tmp_path, capsys):
    """What helps is another law, with which no run goes on: none is offered, and its error is the
    one line."""
    path = smooth(tmp_path)
    law = SMOOTH.replace("internal = 0", "internal, calls = 0, 0")
    failing = "Smooth.calls += 1\n        n = len(kinematics.pressure) // (Smooth.calls < 6)"
    law = law.replace("n = len(kinematics.pressure)", failing)
    (tmp_path / "smooth.py").write_text(law, encoding="utf-8")
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 3
    (line,) = capsys.readouterr().err.splitlines()
    assert "the law Smooth failed: smooth.py, line 10: ZeroDivisionError" in line
    assert (tmp_path / "out" / "checkpoint.npz").is_file()


def test_restart_with_another_file_that_the_law_imports(tmp_path, capsys):
    """A law is what its file imports, too: what lies beside it and has changed is named."""
    (tmp_path / "size.py").write_text("from unit import ONE\n", encoding="utf-8")
    (tmp_path / "unit.py").write_text("ONE = 1.0\n", encoding="utf-8")
    path = smooth(tmp_path, ("import numpy", "import os.path, size\nimport numpy"))
    out = tmp_path / "out"
    assert main(["run", str(path), "-o", str(out)]) == 0
    assert main(["run", str(path), "-o", str(out), "--restart"]) == 0
    (tmp_path / "unit.py").write_text("ONE = 2.0\n", encoding="utf-8")
    assert main(["run", str(path), "-o", str(out), "--restart"]) == 2
    assert "'unit.py' has changed since the run" in capsys.readouterr().err


@pytest.mark.parametrize("changed", ["__init__", "unit", "deep/size", "deep/__init__"])
def test_restart_with_another_file_of_a_package(tmp_path, capsys, changed):
    """Requirement: packages beside the law count as well, and what they import from themselves."""
    files = {
        "__init__": "",
        "unit": "ONE = 1.0\n",
        "deep/__init__": "from ..unit import ONE\n",
        "deep/size": "from . import ONE\n",
    }
    for name, text in files.items():
        file = tmp_path / "sizes_of_law" / f"{name}.py"
        file.parent.mkdir(exist_ok=True, parents=True)
        file.write_text(text, encoding="utf-8")
    path = smooth(tmp_path, ("import numpy", "from sizes_of_law.deep import size\nimport numpy"))
    out = tmp_path / "out"
    assert main(["run", str(path), "-o", str(out)]) == 0
    assert main(["run", str(path), "-o", str(out), "--restart"]) == 0
    (tmp_path / "sizes_of_law" / f"{changed}.py").write_text("ONE = 2.0\n", encoding="utf-8")
    assert main(["run", str(path), "-o", str(out), "--restart"]) == 2
    assert f"'sizes_of_law/{changed}.py' has changed since the run" in capsys.readouterr().err


def test_a_law_that_goes_to_another_folder(tmp_path, monkeypatch):
    """Requirement: paths of a case are relative to where the command is, whatever its files do."""
    path = smooth(tmp_path, ("import numpy", "import os\nos.chdir('/')\nimport numpy"))
    monkeypatch.chdir(tmp_path)
    assert main(["run", path.name, "-o", "out"]) == 0
    assert (tmp_path / "out" / "summary.json").is_file()


def test_check_without_running_the_law(tmp_path, capsys):
    """`check --no-python`: the file is not run, all else is checked, also that it is there."""
    ran, law = tmp_path / "was_run", tmp_path / "smooth.py"
    runs = f"import pathlib\npathlib.Path({str(ran)!r}).touch()\nimport numpy"
    path = smooth(tmp_path, ("import numpy", runs))
    assert main(["check", str(path), "--no-python"]) == 0
    assert not ran.exists()
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1] == "not run   smooth.py: its law is not checked"
    assert main(["check", str(path)]) == 0
    assert ran.exists()
    assert capsys.readouterr().out.splitlines() == lines[:-1]
    law.unlink()
    assert main(["check", str(path), "--no-python"]) == 2
    assert "contact[0].python.file: 'smooth.py' given, no such file" in capsys.readouterr().err
    text = path.read_text(encoding="utf-8")
    law.touch()
    path.write_text(text.replace('"block.top"', '"block.tip"'), encoding="utf-8")
    assert main(["check", str(path), "--no-python"]) == 2
    assert "block.tip" in capsys.readouterr().err


@pytest.mark.parametrize("meshed", [False, True], ids=["plate", "block"])
def test_check_without_running_the_law_on_any_master(tmp_path, meshed):
    laws = PYTHON.replace(f"{ALONG}\n", "isotropic = true\n")
    assert main(["check", str(case(tmp_path, laws, meshed=meshed)), "--no-python"]) == 0


def test_people_are_told_that_check_runs_python(capsys):
    """In the help of the command and in the schema of the case file."""
    assert main(["check", "--help"]) == 0
    assert "Python files" in capsys.readouterr().out
    assert main(["schema"]) == 0
    files = json.loads(capsys.readouterr().out)["$defs"]["Python"]["properties"]["file"]
    assert "`check --no-python` does not" in files["description"]


#: A law whose force is along the slip, or against it with what it dissipates of the wrong sign.
DRIVING = """
import numpy as np
from anisocontact.interface import LawResult

class Smooth:
    internal = 0

    def update(self, state, kinematics):
        slip, pressure = kinematics.increment, kinematics.pressure[:, None]
        block, factor = np.zeros((len(slip), 2, 2)), FACTOR
        traction = factor * pressure * slip
        return LawResult(traction, slip, factor * pressure[..., None] * np.eye(2), factor * slip,
                         block, block, state.internal, -np.sum(traction * slip, axis=1),
                         np.zeros(len(slip)))
"""


@pytest.mark.parametrize(("factor", "told"), [("5.0", True), ("-5.0", False)])
def test_a_law_that_gives_energy_is_told(tmp_path, capsys, factor, told):
    """Requirement: a force along the slip is a warning that names the contact, at once and at the
    end, though its energy is in balance: what supports take the law has given. Source: friction
    that dissipates less than nothing is none.
    """
    path = smooth(tmp_path, (SMOOTH, DRIVING.replace("FACTOR", factor)))
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 0
    said = "contact 'block.bottom on plate': its law gave "
    assert (said in capsys.readouterr().err) == told
    summary = numbers(tmp_path, "out")
    assert any(said in line for line in summary["warnings"]) == told
    assert (summary["energy"]["friction"] < 0.0) == told
    assert summary["energy_residual"]["worst_share"] < 0.05
