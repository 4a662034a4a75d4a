"""Make or refresh `.venv`: dependencies, the compiled core, a check that the finite elements work.

`tools/setup` calls this with a Python >= 3.12. Each stage is skipped while the files it depends on
are the same as when it last ended well, so that a second call takes a fraction of a second.
"""

from __future__ import annotations

import compileall
import fcntl
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
BUILD = VENV / "build"
STAMPS = VENV / "stamps"
LOG = VENV / "setup.log"
CONSTRAINTS = ROOT / "tools" / "constraints.txt"

CXX20 = "#include <concepts>\n#include <span>\ntemplate <std::integral T> T f(T t) { return t; }\n"
# A form that FFCx has to compile here and now, with the C compiler.
SMOKE = """
import dolfinx_solver
import dolfinx, gmsh, ufl
from mpi4py import MPI
mesh = dolfinx.mesh.create_unit_cube(MPI.COMM_SELF, 1, 1, 1)
x = ufl.SpatialCoordinate(mesh)
form = dolfinx.fem.form(x[0] * x[1] * ufl.dx(mesh))
assert abs(dolfinx.fem.assemble_scalar(form) - 0.25) < 1e-12
"""
#: Extras that are large and that nothing needs.
LEFT_OUT = {"mkl"}
COMPILERS = "sudo apt-get install g++ (Fedora: sudo dnf install gcc-c++; conda: conda install gxx)"
GMSH_LIBRARIES = (
    "sudo apt-get install libglu1-mesa libxcursor1 libxft2 libxinerama1 "
    "(Fedora: sudo dnf install mesa-libGLU libXcursor libXft libXinerama)"
)


class SetupError(Exception):
    """One line that says what is missing and how to get it."""


def say(line: str) -> None:
    """Print one stage."""
    print(f"set-up: {line}", flush=True)


class Stage:
    """A stage of the set-up: done while the texts and files it depends on stay the same."""

    def __init__(self, name: str, parts: Iterable[str | Path]) -> None:
        self.stamp = STAMPS / name
        total = hashlib.sha256()
        for part in parts:
            content = part.read_bytes() if isinstance(part, Path) else b""
            total.update(f"{part}\0{len(content)}\0".encode() + content)
        self.key = total.hexdigest()

    def is_done(self) -> bool:
        """Tell whether the stage ended well with the same inputs."""
        return self.stamp.is_file() and self.stamp.read_text() == self.key

    def done(self) -> None:
        """Leave the stamp."""
        STAMPS.mkdir(exist_ok=True)
        self.stamp.write_text(self.key)


def environment() -> dict[str, str]:
    """Return the environment of pip and CMake: the venv's tools first, no user-wide install."""
    elsewhere = ("PIP_TARGET", "PIP_PREFIX", "PIP_ROOT", "PIP_REQUIRE_VIRTUALENV", "VIRTUAL_ENV")
    env = {name: value for name, value in os.environ.items() if name not in elsewhere}
    env["PATH"] = f"{VENV / 'bin'}{os.pathsep}{env.get('PATH', os.defpath)}"
    env |= {"PIP_USER": "0", "PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_NO_INPUT": "1"}
    env["PYTHONNOUSERSITE"] = "1"
    return env


def run(what: str, command: Sequence[str | Path]) -> None:
    """Run a command with its output in the log.

    Raises:
        SetupError: the command failed; the tail of the log has been printed.
    """
    with LOG.open("ab") as log:
        start = log.tell()
        log.write(f"\n$ {' '.join(map(str, command))}\n".encode())
        log.flush()
        result = subprocess.run(
            [str(part) for part in command],
            cwd=ROOT,
            env=environment(),
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            check=False,
        )
    if result.returncode:
        output = LOG.read_bytes()[start:].decode(errors="replace")
        missing = re.search(r"(lib[\w.+-]+): cannot open shared object file", output)
        if missing:
            raise SetupError(f"{what}: system library {missing[1]} not found: {GMSH_LIBRARIES}")
        print("\n".join(output.splitlines()[-25:]), file=sys.stderr)
        raise SetupError(f"{what} failed, see above; the whole log is {LOG.relative_to(ROOT)}")


def check_compilers() -> None:
    """Raise a SetupError unless a C++20 compiler (the core) and a C compiler (forms) are there."""
    candidates = [os.environ["CXX"]] if os.environ.get("CXX") else ["c++", "g++", "clang++"]
    found = [name for name in candidates if shutil.which(name.split()[0])]
    if not found:
        raise SetupError(f"no C++ compiler found ({', '.join(candidates)}): {COMPILERS}")
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "probe.cpp")
        source.write_text(CXX20)
        command = [*found[0].split(), "-std=c++20", "-c", str(source), "-o", f"{source}.o"]
        if subprocess.run(command, capture_output=True, check=False).returncode:
            raise SetupError(
                f"{found[0]} does not compile C++20: set CXX to g++ >= 11 or clang++ >= 15, "
                f"or get one: {COMPILERS}"
            )
    c_compiler = os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc"
    if not any(shutil.which(name) for name in (c_compiler.split()[0], "cc", "gcc", "clang")):
        raise SetupError(f"no C compiler found ({c_compiler}), FFCx compiles forms: {COMPILERS}")


def requirements(project: dict[str, Any]) -> list[str]:
    """Return all that the project needs to build, run and be tested, without the project itself."""
    extras = project["project"]["optional-dependencies"]
    wanted = [*project["build-system"]["requires"], *project["project"]["dependencies"]]
    wanted += [line for name, extra in extras.items() if name not in LEFT_OUT for line in extra]
    return sorted({line for line in wanted if not line.startswith("anisocontact[")})


def make_venv() -> None:
    """Make `.venv` with this Python, anew where the checkout was moved or Python changed."""
    base = getattr(sys, "_base_executable", "") or sys.executable
    stage = Stage("venv", [str(ROOT), sys.version])
    if stage.is_done() and PYTHON.is_file():
        return
    say(f"making .venv with Python {sys.version.split()[0]} ({base})")
    command = [base, "-m", "venv", *(["--clear"] if stage.stamp.is_file() else []), str(VENV)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode:
        print(result.stdout + result.stderr, file=sys.stderr)
        raise SetupError(f"{base} could not make .venv, see above; or set PYTHON to another Python")
    stage.done()


def install_dependencies(project: dict[str, Any]) -> None:
    """Install everything from the package index, in the versions of constraints.txt."""
    wanted = requirements(project)
    stage = Stage("dependencies", [*wanted, CONSTRAINTS])
    if not stage.is_done():
        check_compilers()
        say(f"installing dependencies: a few minutes the first time ({LOG.relative_to(ROOT)})")
        pip: list[str | Path] = [PYTHON, "-m", "pip", "install", "--progress-bar", "off"]
        run("installing dependencies", [*pip, "--constraint", CONSTRAINTS, *wanted])
        stage.done()
    check = Stage("finite-elements", [stage.key])
    if not check.is_done():
        say("checking the finite elements")
        run("checking the finite elements", [ROOT / "tools" / "venv-run", "python", "-c", SMOKE])
        check.done()


def build_core() -> None:
    """Install the project in editable mode, or compile again what changed of its C++."""
    sources = ROOT.glob("cpp/**/*.?pp")
    project = Stage("project", [ROOT / "pyproject.toml", ROOT / "CMakeLists.txt"])
    core = Stage("core", [project.key, *sorted(sources)])
    if core.is_done():
        return
    check_compilers()
    say("building the C++ core")
    if project.is_done():
        site = sysconfig.get_path("platlib", vars={"base": str(VENV), "platbase": str(VENV)})
        cmake = VENV / "bin" / "cmake"
        run("building the core", [cmake, "--build", BUILD, "--parallel"])
        run("installing the core", [cmake, "--install", BUILD, "--prefix", site])
    else:
        settings = [f"build-dir={BUILD}", "cmake.define.ANISOCONTACT_WERROR=ON"]
        editable: list[str | Path] = [
            PYTHON,
            "-m",
            "pip",
            "install",
            "--no-deps",
            "--no-build-isolation",
        ]
        config = [f"--config-settings={setting}" for setting in settings]
        run("building the core", [*editable, *config, "--editable", ROOT])
        project.done()
    core.done()


def main() -> int:
    """Bring `.venv` up to date; return the exit code."""
    checkout = os.open(ROOT, os.O_RDONLY)
    try:
        # One set-up at a time in a checkout: a second `make` waits here.
        fcntl.flock(checkout, fcntl.LOCK_EX)
        project = tomllib.loads((ROOT / "pyproject.toml").read_text())
        make_venv()
        install_dependencies(project)
        build_core()
        # pip makes bytecode of what it copies; ours is read where it is
        compileall.compile_dir(ROOT / "src", quiet=2)
    except SetupError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    finally:
        os.close(checkout)
    return 0


if __name__ == "__main__":
    sys.exit(main())
