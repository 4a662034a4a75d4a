"""Build sdist and wheel from what git has, install and use the wheel in clean environments.

`make wheel` calls this. Nothing of the checkout is used but its last commit, and both are left in
`dist` when they are good. Each Python has the wheel with the base dependencies, traces a point, is
told what a run of finite elements lacks, gets the extra `fem`, and solves a case. A Python that is
not on the machine is skipped, and said to be.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
import tomllib
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CONSTRAINTS = ROOT / "tools" / "constraints.txt"
DIST = ROOT / "dist"
VERSIONS = ("3.12", "3.13")
#: What is built with beside `build-system.requires`.
BUILDERS = ("cmake", "ninja")
#: Of the sdist: a case of each kind that is done in a second.
POINT = "examples/point/sledge.toml"
BLOCK = "tests/unit/small_block.toml"
#: Every module, so that one that the wheel lacks is named.
IMPORT_ALL = """
import importlib, pkgutil, anisocontact
for module in pkgutil.walk_packages(anisocontact.__path__, "anisocontact."):
    if not module.name.endswith("__main__"):
        importlib.import_module(module.name)
assert "site-packages" in anisocontact.__file__, anisocontact.__file__
"""
SDIST = "import sys; from scikit_build_core import build; build.build_sdist(sys.argv[1])"
IS_PYTHON = "import sys, venv, ensurepip; print('{}.{}'.format(*sys.version_info))"


type Words = Sequence[str | Path]


class WheelError(Exception):
    """One line that says what is wrong with the wheel."""


def say(line: str) -> None:
    """Print one stage."""
    print(f"wheel: {line}", flush=True)


def environment(folder: Path) -> dict[str, str]:
    """Variables of a user who has nothing of ours: no import path, no settings, own caches."""
    paths = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")
    settings = ("PIP_TARGET", "PIP_PREFIX", "PIP_USER", "PYTHONDONTWRITEBYTECODE")
    env = {name: value for name, value in os.environ.items() if name not in (*paths, *settings)}
    env |= {"PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_NO_INPUT": "1", "PYTHONNOUSERSITE": "1"}
    env |= {"MPLBACKEND": "Agg", "MPLCONFIGDIR": str(folder / "matplotlib")}
    if "CC" not in env:  # the compiler that Python was built with may not be on this machine
        found = next((name for name in ("cc", "gcc", "clang") if shutil.which(name)), None)
        env |= {"CC": found} if found else {}
    return env


def run(command: Words, folder: Path, code: int = 0) -> subprocess.CompletedProcess[str]:
    """Run a command in a folder.

    Raises:
        WheelError: it ended with another code; the tail of what it said has been printed.
    """
    words = [str(word) for word in command]
    result = subprocess.run(
        words,
        cwd=folder,
        env=environment(folder),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    if result.returncode != code:
        print("\n".join((result.stdout + result.stderr).splitlines()[-40:]), file=sys.stderr)
        raise WheelError(f"{' '.join(words)[:200]}: code {result.returncode}, see above")
    return result


def source(folder: Path) -> Path:
    """Unpack the tree of the last commit; without git, the checkout is what there is."""
    archive, tree = folder / "commit.tar", folder / "commit"
    try:
        run(["git", "-C", ROOT, "archive", "--output", archive, "HEAD"], folder)
    except (FileNotFoundError, WheelError):
        say("no git here: built from the files of the checkout that .gitignore leaves")
        return ROOT
    with tarfile.open(archive) as file:
        file.extractall(tree, filter="data")
    return tree


def make_venv(python: str, place: Path) -> Path:
    """Make a virtual environment; return its Python."""
    run([python, "-m", "venv", place], place.parent)
    return place / "bin" / "python"


def install(python: Path, *what: str | Path) -> None:
    """Install into the environment of a Python, in the versions of constraints.txt.

    Most of what packages have is never imported: bytecode of it would take longer than to install.
    """
    pip: Words = [python, "-m", "pip", "install", "--quiet", "--progress-bar", "off"]
    run([*pip, "--no-compile", "--constraint", CONSTRAINTS, *what], python.parents[2])


def build(python: str, folder: Path) -> tuple[Path, Path]:
    """Build the sdist, and from that the wheel.

    Returns:
        The wheel, and the folder with what the sdist has.
    """
    tree = source(folder)
    project = tomllib.loads((tree / "pyproject.toml").read_text())
    builder = make_venv(python, folder / "builder")
    install(builder, *project["build-system"]["requires"], *BUILDERS)
    run([builder, "-c", SDIST, folder], tree)
    (sdist,) = folder.glob("*.tar.gz")
    with tarfile.open(sdist) as file:
        file.extractall(folder, filter="data")
    # cmake and ninja are in the environment, which nobody has activated
    path = f"PATH={builder.parent}{os.pathsep}{os.environ.get('PATH', os.defpath)}"
    command: Words = ["env", path, builder, "-m", "pip", "wheel", "--no-deps"]
    run([*command, "--no-build-isolation", "--wheel-dir", folder, sdist], folder)
    (wheel,) = folder.glob("*.whl")
    return wheel, folder / sdist.name.removesuffix(".tar.gz")


def use(python: Path, wheel: Path, tree: Path, folder: Path) -> None:
    """Install the wheel, trace a point, install the extra, solve a case.

    Raises:
        WheelError: something of it fails.
    """
    command = python.with_name("anisocontact")
    install(python, wheel)
    run([command, "trace", tree / POINT, "-o", "trace"], folder)
    said = run([command, "run", tree / BLOCK, "-o", "block"], folder, code=2).stderr
    if said.count("\n") != 1 or "pip install 'anisocontact[fem]'" not in said:
        raise WheelError(f"without the extra `fem` a run says: {said}")
    install(python, f"{wheel}[fem]")
    run([python, "-m", "pip", "check"], folder)
    run([python, "-c", IMPORT_ALL], folder)
    run([command, "run", tree / BLOCK, "-o", "block"], folder)
    for report in ("trace/report.html", "block/report.html"):
        if not (folder / report).is_file():
            raise WheelError(f"no {report}")


def find(version: str) -> str | None:
    """A Python of this version that can make environments: running, on PATH, of pyenv or uv."""
    for candidate in candidates(version):
        command = [candidate, "-c", IS_PYTHON]
        try:
            said = subprocess.run(command, capture_output=True, text=True, check=False).stdout
        except OSError:
            continue
        if said.strip() == version:
            return candidate
    return None


def candidates(version: str) -> Iterator[str]:
    """Where a Python of this version may be."""
    yield getattr(sys, "_base_executable", "") or sys.executable
    yield from filter(None, [shutil.which(f"python{version}")])
    root = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    yield from map(str, sorted(root.glob(f"versions/{version}.*/bin/python")))
    if uv := shutil.which("uv"):
        command = [uv, "python", "find", "--no-project", version]
        yield from subprocess.run(
            command, capture_output=True, text=True, check=False
        ).stdout.split()


def check(folder: Path) -> list[str]:
    """Build the wheel and use it in every Python that is here; the versions it was used in.

    Raises:
        WheelError: something fails, or no Python is here.
    """
    found = {version: find(version) for version in VERSIONS}
    pythons = {version: python for version, python in found.items() if python is not None}
    if not pythons:
        raise WheelError(f"no Python {' or '.join(VERSIONS)} found")
    say("building sdist and wheel of the last commit")
    wheel, tree = build(next(iter(pythons.values())), folder)

    def used(version: str, python: str) -> None:
        say(f"using {wheel.name} in Python {version} ({python})")
        place = folder / version
        place.mkdir()
        use(make_venv(python, place / "venv"), wheel, tree, place)

    with ThreadPoolExecutor() as pool:  # each waits for processes of its own
        list(pool.map(used, pythons.keys(), pythons.values()))
    DIST.mkdir(exist_ok=True)
    for built in (*folder.glob("*.tar.gz"), wheel):
        shutil.copy(built, DIST)
    return list(pythons)


def main() -> int:
    """Check the wheel; return the exit code."""
    began = time.monotonic()
    try:
        with tempfile.TemporaryDirectory(prefix="anisocontact-wheel-") as folder:
            used = check(Path(folder))
    except WheelError as error:
        print(f"error: wheel: {error}", file=sys.stderr)
        return 1
    for version in sorted(set(VERSIONS).difference(used)):
        say(f"skipped Python {version}: not found on this machine")
    say(f"good in Python {' and '.join(used)}, in {DIST.name} ({time.monotonic() - began:.0f} s)")
    return 0


if __name__ == "__main__":
    sys.exit(main())
