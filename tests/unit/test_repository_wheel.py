"""Sdist and wheel have all that git has, and an index can show what they say of themselves."""

import importlib.util
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
BUILD = """
import sys
from scikit_build_core import build
build.build_sdist(sys.argv[1])
build.build_wheel(sys.argv[1], {"wheel.cmake": "false", "wheel.py-api": "py3"})
"""


def tracked() -> set[str]:
    """Names of the files that git has and that are there."""
    command = ["git", "-C", str(ROOT), "ls-files", "-z"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        pytest.skip("no git")
    if done.returncode != 0:
        pytest.skip("no checkout of git")
    return {name for name in done.stdout.split("\0") if name and (ROOT / name).is_file()}


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> tuple[set[str], set[str], str]:
    """Names in the sdist, names in the wheel without the core, and the wheel's metadata."""
    pytest.importorskip("scikit_build_core")
    tree, out = tmp_path_factory.mktemp("tree"), tmp_path_factory.mktemp("dist")
    for name in tracked():
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tree / name)
    command = [sys.executable, "-c", BUILD, str(out)]
    done = subprocess.run(command, cwd=tree, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (sdist,), (wheel,) = out.glob("*.tar.gz"), out.glob("*.whl")
    with tarfile.open(sdist) as file:
        names = {one.name.partition("/")[2] for one in file.getmembers() if one.isfile()}
    with zipfile.ZipFile(wheel) as file:
        (metadata,) = (name for name in file.namelist() if name.endswith("/METADATA"))
        return names, set(file.namelist()), file.read(metadata).decode()


def test_sdist_has_what_git_has(packages: tuple[set[str], set[str], str]) -> None:
    assert packages[0] - {"PKG-INFO"} == tracked()


def test_wheel_has_the_whole_package(packages: tuple[set[str], set[str], str]) -> None:
    """All of `src/anisocontact`; the core is compiled from `cpp`, which is not in it."""
    ours = {name.removeprefix("src/") for name in tracked() if name.startswith("src/")}
    assert {name for name in packages[1] if ".dist-info/" not in name} == ours


def test_an_index_can_show_the_description(packages: tuple[set[str], set[str], str]) -> None:
    """An index has no files of ours beside the page: links and pictures have to be absolute."""
    _, _, text = packages[2].partition("\n\n")
    assert text.startswith("# anisocontact\n")
    targets = re.findall(r"\]\(\s*<?([^)\s>]+)", text) + re.findall(r"(?:src|href)=\W?(\S+)", text)
    assert [target for target in targets if not target.startswith("https://")] == []


def test_supported_pythons_are_named() -> None:
    """Classifiers name the oldest Python and all that `make wheel` tries."""
    spec = importlib.util.spec_from_file_location("wheel_check", ROOT / "tools" / "wheel.py")
    assert spec and spec.loader
    module: ModuleType = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    named = re.findall(r":: (3\.\d+)\n", "\n".join(PROJECT["classifiers"]) + "\n")
    assert named == list(module.VERSIONS)
    assert PROJECT["requires-python"] == f">={named[0]}"
