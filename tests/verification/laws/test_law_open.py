"""The registry of sliding rules is open: a new rule in four places, and everything follows.

Requirement: a toy law that is added as docs/dev/how-to-add.md says (its header, a registry line, a
page, values for its parameters in the samples of these tests) appears in the bindings, in the
registry, in `anisocontact info` and in the schema of the case file, and passes the conformance
suite. The toy is added to a copy of the sources, which is built without optimisation.
"""

from __future__ import annotations

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parents[2]
REGISTRY = "cpp/include/anisocontact/law/registry.hpp"
USES = ("cmake", "ninja", "nanobind")


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
    shutil.copytree(HERE, root / "tests", ignore=shutil.ignore_patterns("__pycache__"))
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
    replace_once(root / "tests/conftest.py", sample, sample + toy)

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


@pytest.mark.slow
def test_conformance(extended):
    """The suite as it is, run on the copy: every test of it for the toy, too."""
    printed = module(
        extended,
        *("pytest", "-q", "-rA", "-p", "no:cacheprovider", "-c", os.devnull),
        *("--rootdir", extended, "--import-mode=importlib", "-k", "toy or sample"),
        extended / "tests/test_law_conformance.py",
    )
    passed = [line for line in printed.splitlines() if line.startswith("PASSED")]
    assert len(passed) >= 15 and "failed" not in printed
    assert any("test_every_rule_has_a_sample" in line for line in passed)
