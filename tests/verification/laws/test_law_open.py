"""The registries of the core are open: a rule, a surface and a field are added as the page says.

Requirement: what docs/dev/how-to-add.md shows, literally (a header, its name in the registry, a
sample), and a toy rule with a parameter appear in the bindings, in the registries, in `anisocontact
info` and in the schema of the case file, and pass the conformance suites. They are added to a copy
of the sources, which is built without optimisation.
"""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parents[2]
TESTS = "tests/verification"
HEADERS = "cpp/include/anisocontact"
REGISTRY = f"{HEADERS}/law/registry.hpp"
PAGE = (ROOT / "docs/dev/how-to-add.md").read_text()
#: Section of the page -> registry, what its list begins with, file of the samples, what is before
#: the new one there.
ADDED = {
    "A sliding rule": ("law", "MaximumDissipation,", "laws/conftest.py", "list[Rule]] = {\n"),
    "A surface": ("surface", "Plane,", "conftest.py", "    return [_plane(), "),
    "A direction field": (
        "anisotropy",
        "Constant,",
        "test_anisotropy_conformance.py",
        "dict[str, Any]]] = {\n",
    ),
}
SAMPLES = ("conftest.py", "surface_sample.py", "profile_samples.py")
SUITES = (
    "test_surface_geometry.py",
    "test_surface_projection.py",
    "test_anisotropy_conformance.py",
)
USES = ("cmake", "ninja", "nanobind")


def add_as_the_page_says(root, section):
    """A header, its name in the registry, and a sample: three places of a copy of the sources."""
    text = PAGE.partition(f"\n## {section}\n")[2].partition("\n## ")[0]
    registry, first, samples, before = ADDED[section]
    (header,) = re.findall(r"```cpp\n(.*?)```", text, re.S)
    (sample,) = re.findall(r"```python\n(.*?)```", text, re.S)
    name = re.findall(rf"`({registry}/[\w/]+\.hpp)`", text.partition("```cpp")[0])[-1]
    (root / HEADERS / name).write_text(header)
    (made,) = re.findall(r"^class (\w+)", header, re.M)
    listed = root / HEADERS / registry / "registry.hpp"
    replace_once(listed, "#pragma once\n", f'#pragma once\n#include "anisocontact/{name}"\n')
    replace_once(listed, first, f"{made}, {first}")
    entry = sample.rstrip().removesuffix(",")
    replace_once(root / TESTS / samples, before, f"{before}{entry},\n")


def replace_once(path, old, new):
    text = path.read_text()
    assert text.count(old) == 1, f"{old!r} in {path.name}"
    path.write_text(text.replace(old, new))


# An editable install of the package finds its own sources before PYTHONPATH: it is taken out.
START = """
import runpy, sys
sys.meta_path[:] = [f for f in sys.meta_path if "anisocontact" not in type(f).__module__]
sys.argv = sys.argv[1:]
runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
"""


def run(command, root):
    """Output of a command that finds the sources of the copy and the environment's programs."""
    programs = [str(Path(sys.executable).parent), os.environ["PATH"]]
    env = os.environ | {"PYTHONPATH": str(root / "src"), "PATH": os.pathsep.join(programs)}
    r = subprocess.run(
        [str(c) for c in command], cwd=root, env=env, capture_output=True, text=True, check=False
    )
    assert r.returncode == 0, r.stdout[-4000:] + r.stderr[-4000:]
    return r.stdout


def module(root, *arguments):
    """Output of `python -m` with the package of the copy."""
    return run([sys.executable, "-c", START, *arguments], root)


@pytest.fixture(scope="module")
def extended(tmp_path_factory):
    """A copy of the sources with the toy, built."""
    missing = [name for name in USES if not (importlib.util.find_spec(name) or shutil.which(name))]
    assert not missing, f"needed to build the copy: {missing}"
    root = tmp_path_factory.mktemp("extended")
    for folder in ("cpp", "src"):
        shutil.copytree(ROOT / folder, root / folder, ignore=shutil.ignore_patterns("*.so"))
    shutil.copytree(HERE, root / TESTS / "laws", ignore=shutil.ignore_patterns("__pycache__"))
    for name in (*SAMPLES, *SUITES):
        shutil.copy(HERE.parent / name, root / TESTS)
    for name in ("CMakeLists.txt", "LICENSE"):
        shutil.copy(ROOT / name, root)

    shutil.copy(HERE / "toy_rule.hpp", root / "cpp/include/anisocontact/law/rules/toy.hpp")
    include = '#include "anisocontact/law/rules/radial.hpp"\n'
    replace_once(root / REGISTRY, include, include + include.replace("radial", "toy"))
    replace_once(
        root / REGISTRY, "Registry<MaximumDissipation,", "Registry<Toy, MaximumDissipation,"
    )
    sample = '    "radial": [Rule("radial")],\n'
    toy = '    "toy": [Rule("toy", {"weight": 0.4})],\n'
    replace_once(root / TESTS / "laws/conftest.py", sample, sample + toy)
    for section in ADDED:
        add_as_the_page_says(root, section)

    configure = ["cmake", "-S", ".", "-B", "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Quick"]
    run([*configure, f"-DPython_EXECUTABLE={sys.executable}"], root)
    run(["cmake", "--build", "build", "-j", "2"], root)
    (core,) = (root / "build").glob("_core.*")
    shutil.copy(core, root / "src/anisocontact")
    info = root / "src/anisocontact-0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: anisocontact\nVersion: 0\n")
    return root


USE = """
import anisocontact, json
from anisocontact.base import registry
from anisocontact.laws import Friction, slide

e = registry.entry(registry.sliding_rules(), "toy")
problem = [[[50.0, 0.0], [0.0, 50.0]]], [[[4.0, 0.0], [0.0, 25.0]]], [[1.0, 1.0]], [1.0]
toy, plain = slide(*problem, "toy", weight=0.0), slide(*problem)
print(json.dumps({
    "file": anisocontact.__file__,
    "parameters": [(p.name, p.kind, p.bound) for p in e.parameters],
    "rule": Friction(coefficients=(0.3, 0.3), sliding_rule="toy", weight=0.4).rule,
    "difference": abs(toy.traction - plain.traction).max(),
}))
"""


@pytest.mark.slow
def test_bindings_and_registry(extended):
    (extended / "src/use.py").write_text(USE)
    r = json.loads(module(extended, "use"))
    assert Path(r["file"]).is_relative_to(extended)
    assert r["parameters"] == [["weight", "scalar", "non-negative"]]
    assert r["rule"] == ["toy", {"weight": [0.4]}]
    # without the circle the toy is maximum dissipation; roundings of forces of size 1
    assert r["difference"] < 1e-15


@pytest.mark.slow
@pytest.mark.parametrize("command", ["info", "schema"])
def test_command(extended, command):
    printed = module(extended, "anisocontact", command)
    assert "toy" in printed and "weight of the circle" in printed
    assert all(f"{name}" in printed for name in ("collinear", "skew-plane", "rays"))


def conformance(root, chosen, *files):
    """What passes of the suites as they are, run on the copy."""
    printed = module(
        root,
        *("pytest", "-q", "-rA", "-p", "no:cacheprovider", "-c", os.devnull),
        *("--rootdir", root, "--import-mode=importlib", "-k", chosen),
        *(root / TESTS / file for file in files),
    )
    assert "failed" not in printed
    return [line for line in printed.splitlines() if line.startswith("PASSED")]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["toy", "collinear"])
def test_conformance(extended, name):
    """Every test of a rule, for the new one, too."""
    passed = conformance(extended, f"{name} or sample", "laws/test_law_conformance.py")
    assert len([line for line in passed if name in line]) >= 12
    assert any("test_every_rule_has_a_sample" in line for line in passed)


@pytest.mark.slow
def test_conformance_of_surface_and_field(extended):
    """Every test of surfaces for the new one, and of fields for the new one on it."""
    passed = conformance(extended, "skew-plane or has_a_sample", *SUITES)
    assert any("test_every_registered_surface_has_a_sample" in line for line in passed)
    assert any("test_every_entry_has_a_sample" in line for line in passed)
    assert len([line for line in passed if "surface" in line and "skew-plane" in line]) >= 15
    assert len([line for line in passed if "rays" in line and "skew-plane" in line]) >= 4
