"""The set-up finds a Python and a compiler, or says in one line what is missing."""

import importlib.util
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
OK = 'echo "ok $0"'
OLD = "exit 1"
BARE = 'echo "lacks venv and Python.h"'


class Machine:
    """A machine whose PATH holds fakes only."""

    def __init__(self, folder: Path) -> None:
        self.bin = folder / "bin"
        self.env = {"PATH": str(self.bin), "HOME": str(folder / "home")}

    def add(self, name: str, script: str) -> Path:
        path = self.bin / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)
        return path

    def find(self, **env: str) -> subprocess.CompletedProcess[str]:
        command = ["/bin/sh", str(ROOT / "tools" / "find-python")]
        return subprocess.run(
            command, env=self.env | env, capture_output=True, text=True, check=False
        )

    def finds(self, **env: str) -> str:
        result = self.find(**env)
        assert result.returncode == 0, result.stderr
        return result.stdout.strip()

    def complains(self, **env: str) -> str:
        result = self.find(**env)
        assert result.returncode == 1
        assert result.stdout == ""
        assert result.stderr.count("\n") == 1, "one line, no more"
        assert result.stderr.startswith("error: ")
        return result.stderr


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    (tmp_path / "bin").mkdir()
    return Machine(tmp_path)


def test_the_running_python_is_recognised(machine: Machine) -> None:
    assert Path(machine.finds(PYTHON=sys.executable)).is_file()


def test_an_old_python3_is_passed_over(machine: Machine) -> None:
    machine.add("python3", OLD)
    new = machine.add("python3.13", OK)
    assert machine.finds() == str(new)


def test_a_shim_without_its_version_is_passed_over(machine: Machine) -> None:
    machine.add("python3.12", "echo 'pyenv: python3.12: command not found' >&2; exit 127")
    good = machine.add("python3", OK)
    assert machine.finds() == str(good)


def test_the_variable_wins(machine: Machine) -> None:
    machine.add("python3.12", OK)
    chosen = machine.add("chosen", OK)
    assert machine.finds(PYTHON=str(chosen)) == str(chosen)


def test_a_wrong_variable_is_no_reason_to_take_another(machine: Machine) -> None:
    machine.add("python3.12", OK)
    old = machine.add("old", OLD)
    assert f"PYTHON={old} is no Python >= 3.12" in machine.complains(PYTHON=str(old))


def test_pyenv_versions_are_found(machine: Machine, tmp_path: Path) -> None:
    root = tmp_path / "py env"
    machine.add("pyenv", f"echo '{root}'")
    machine.add("../py env/versions/3.9.18/bin/python", OK)
    new = machine.add("../py env/versions/3.13.0/bin/python", OK)
    assert Path(machine.finds()).resolve() == new.resolve()


def test_uv_pythons_are_found(machine: Machine) -> None:
    managed = machine.add("managed/python", OK)
    machine.add("uv", f'[ "$1 $2" = "python find" ] && echo "{managed}"')
    assert machine.finds() == str(managed)


def test_a_python_without_headers_comes_last(machine: Machine) -> None:
    machine.add("python3.12", BARE)
    whole = machine.add("python3.13", OK)
    assert machine.finds() == str(whole)


def test_what_a_python_lacks_is_named(machine: Machine) -> None:
    machine.add("python3.12", BARE)
    assert "python3.12 lacks venv and Python.h" in machine.complains()


@pytest.mark.parametrize(
    ("tool", "advice"),
    [
        ("uv", "uv python install 3.12"),
        ("conda", "conda create"),
        ("dnf", "sudo dnf install"),
        ("apt-get", "sudo apt-get install"),
        ("nothing", "install uv"),
    ],
)
def test_without_python_one_line_says_how_to_get_it(
    machine: Machine, tool: str, advice: str
) -> None:
    machine.add("python3", OLD)
    machine.add(tool, "exit 1")
    line = machine.complains()
    assert "no Python >= 3.12 found" in line
    assert advice in line


@pytest.fixture
def bootstrap(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    spec = importlib.util.spec_from_file_location("bootstrap", ROOT / "tools" / "bootstrap.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(module, "STAMPS", tmp_path / "stamps")
    monkeypatch.setattr(module, "LOG", tmp_path / "setup.log")
    monkeypatch.delenv("CXX", raising=False)
    return module


def test_a_missing_compiler_is_named(
    bootstrap: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(bootstrap.SetupError, match=r"no C\+\+ compiler found.*apt-get install g"):
        bootstrap.check_compilers()


def test_an_old_compiler_is_named(
    bootstrap: ModuleType, monkeypatch: pytest.MonkeyPatch, machine: Machine
) -> None:
    old = machine.add("old-cxx", OLD)
    monkeypatch.setenv("CXX", str(old))
    with pytest.raises(bootstrap.SetupError, match=r"old-cxx does not compile C\+\+20"):
        bootstrap.check_compilers()


def test_a_missing_system_library_is_named(bootstrap: ModuleType) -> None:
    script = "echo 'OSError: libGLU.so.1: cannot open shared object file' >&2; exit 1"
    with pytest.raises(bootstrap.SetupError, match=r"libGLU\.so\.1 not found.*libglu1-mesa"):
        bootstrap.run("checking", ["/bin/sh", "-c", script])


def test_a_failure_shows_the_end_of_the_log(
    bootstrap: ModuleType, capfd: pytest.CaptureFixture[str]
) -> None:
    script = "for i in $(seq 100); do echo line $i; done; exit 1"
    with pytest.raises(bootstrap.SetupError, match=r"building failed.*setup\.log"):
        bootstrap.run("building", ["/bin/sh", "-c", script])
    shown = capfd.readouterr().err.splitlines()
    assert shown[-1] == "line 100"
    assert len(shown) == 25


def test_a_stage_is_done_until_its_files_change(bootstrap: ModuleType, tmp_path: Path) -> None:
    source = tmp_path / "a.cpp"
    source.write_text("int a;")
    stage = bootstrap.Stage("core", ["key", source])
    assert not stage.is_done()
    stage.done()
    assert bootstrap.Stage("core", ["key", source]).is_done()
    source.write_text("int b;")
    assert not bootstrap.Stage("core", ["key", source]).is_done()


def test_extras_are_resolved_without_the_project_itself(bootstrap: ModuleType) -> None:
    project = {
        "build-system": {"requires": ["builder"]},
        "project": {
            "dependencies": ["base"],
            "optional-dependencies": {
                "fem": ["solver"],
                "mkl": ["large"],
                "dev": ["anisocontact[fem]", "linter"],
            },
        },
    }
    assert bootstrap.requirements(project) == ["base", "builder", "linter", "solver"]
