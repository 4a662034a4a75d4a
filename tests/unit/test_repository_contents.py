"""What the repository promises of itself: one version, no machine's paths, light imports."""

import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
NOT_OURS = {"results", "_build", "generated", "build", "dist"}
# A folder of somebody's machine; the lookbehind lets URLs and relative paths pass.
MACHINE_PATH = re.compile(r"(?<![\w.:/$}-])/(?:home|root|Users|work|tmp|mnt|opt|scratch)/\w")


def files() -> Iterator[Path]:
    """Yield the files of the repository, with or without git."""
    for folder, subfolders, names in os.walk(ROOT):
        hidden = {name for name in subfolders if name.startswith(".") and name != ".ci"}
        subfolders[:] = set(subfolders) - hidden - NOT_OURS - {"__pycache__"}
        # in a worktree `.git` is a file, and names its repository
        yield from (Path(folder, name) for name in names if name != ".git")


def test_no_path_of_a_machine() -> None:
    found = []
    for path in files():
        try:
            lines = path.read_text().splitlines()
        except UnicodeDecodeError:
            continue  # pictures and other binary files
        found += [
            f"{path.relative_to(ROOT)}:{i}"
            for i, x in enumerate(lines, 1)
            if MACHINE_PATH.search(x)
        ]
    assert found == []


@pytest.mark.parametrize("line", ["see " + "/home" + "/ann/x", 'open("' + "/tmp" + '/a")'])
def test_a_path_of_a_machine_would_be_seen(line: str) -> None:
    assert MACHINE_PATH.search(line)


def test_version_is_the_same_everywhere() -> None:
    version = PROJECT["project"]["version"]
    citation = (ROOT / "CITATION.cff").read_text()
    changelog = (ROOT / "CHANGELOG.md").read_text()
    latest = re.search(r"^## \[(\d[^\]]*)\]", changelog, re.MULTILINE)
    assert f"\nversion: {version}\n" in citation
    assert latest and latest[1] == version


def test_licence_is_the_same_everywhere() -> None:
    licence = PROJECT["project"]["license"]
    assert f"\nlicense: {licence}\n" in (ROOT / "CITATION.cff").read_text()
    assert (ROOT / "LICENSE").read_text().startswith(f"{licence} License")


def test_every_dependency_is_justified() -> None:
    page = (ROOT / "docs" / "dev" / "dependencies.md").read_text()
    extras = PROJECT["project"]["optional-dependencies"].values()
    lines = [*PROJECT["build-system"]["requires"], *PROJECT["project"]["dependencies"]]
    lines += [line for extra in extras for line in extra if not line.startswith("anisocontact[")]
    names = [re.split(r"[<>=\[; ]", line)[0] for line in lines]
    first_cells = " ".join(re.findall(r"^\| ([^|]+) \|", page, re.MULTILINE))
    assert [name for name in names if name not in first_cells.replace(",", " ").split()] == []


def test_make_help_lists_every_target() -> None:
    makefile = (ROOT / "Makefile").read_text()
    phony = re.search(r"^\.PHONY: (.*)$", makefile, re.MULTILINE)
    assert phony
    documented = re.findall(r"^([a-z]+):.*## ", makefile, re.MULTILINE)
    assert sorted(phony[1].split()) == sorted(documented)


@pytest.mark.parametrize("failing", ["", "wheel", "clang", "test"])
def test_ci_runs_what_a_person_runs(tmp_path: Path, failing: str) -> None:
    """Targets of `make`, the tests last whatever came of the others; it fails if one does."""
    make = tmp_path / "make"
    make.write_text(f'#!/bin/sh\necho "$1"\n[ "$1" != "{failing}" ]\n')
    make.chmod(0o755)
    env = os.environ | {"PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"}
    script = str(ROOT / ".ci" / "run")
    done = subprocess.run([script], env=env, capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["wheel", "sanitize", "clang", "test"]
    assert (done.returncode != 0) == bool(failing)


@pytest.mark.parametrize(
    "module", ["anisocontact", "anisocontact.interface", "anisocontact.base.registry"]
)
def test_point_level_imports_nothing_heavy(module: str) -> None:
    heavy = {"dolfinx", "petsc4py", "ufl", "gmsh", "pydantic", "pyvista", "matplotlib", "rich"}
    code = f"import sys, {module}; print(*sys.modules)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert heavy & set(out.stdout.split()) == set()
