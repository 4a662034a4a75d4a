"""Materials and formats of meshes are added from outside, literally as the page says."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CASE = """
from anisocontact._fenicsx import MPI
from anisocontact.case import load
from anisocontact.case.build import build

built = build(load("case.toml"))
list(built.solver.run())
print(built.problem.materials["bar"].young, *built.problem.reactions()["bar.top"])
"""
BAR = """
[mesh.box.bar]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [1, 1, 1]

[material.bar]
model = "blatz-ko"
G = {shear}

[[step]]
name = "pull"
increments = 2
[step.displacement]
"bar.bottom" = {{ z = 0 }}
"bar.left" = {{ x = 0 }}
"bar.front" = {{ y = 0 }}
"bar.top" = {{ z = 0.5 }}
"""


def run(tmp_path: Path, section: str, more: str) -> subprocess.CompletedProcess[str]:
    """The code of a section of the page and then more, in a process of its own."""
    pytest.importorskip("anisocontact._fenicsx", exc_type=ImportError)
    page = (ROOT / "docs" / "dev" / "how-to-add.md").read_text().partition(f"## {section}\n")[2]
    code = re.search(r"```python\n(.*?)```", page, re.S)
    assert code is not None
    script = f"import anisocontact._fenicsx\n{code[1]}\n{more}"
    return subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False
    )


def test_material_of_the_page_runs_in_a_case_file(tmp_path):
    """Requirement: a class and a decorator are all it takes.

    Source: uniaxial tension of Blatz and Ko's foam, s the stretch along: the free sides have
    `t = s^(-1/4)`, the force is `G (s t^2 - s^-2) / s`. Tolerance: that of Newton's method.
    """
    (tmp_path / "case.toml").write_text(BAR.format(shear=2.0))
    done = run(tmp_path, "A material", CASE)
    assert done.returncode == 0, done.stderr
    young, _, _, force = map(float, done.stdout.split())
    stretch = 1.5
    assert young == 5.0
    assert force == pytest.approx(2.0 * (stretch**0.5 - stretch**-2) / stretch, rel=1e-8)


def test_its_parameters_are_checked_as_all_are(tmp_path):
    (tmp_path / "case.toml").write_text(BAR.format(shear=-2.0))
    done = run(tmp_path, "A material", CASE)
    assert "material.bar.G: -2.0 given, must be > 0" in done.stderr


UNIT_CUBE = {
    "points": [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))],
    "hexahedra": [list(range(8))],
    "body": "cube",
    "lower": [[0, 1, 2, 3]],
}
READ = """
from anisocontact.mesh import MeshFile, build_mesh

model = build_mesh([MeshFile("cube.json")])
print(model.body_names(), model.facet_names(), model.count_facets("cube.lower"))
"""


def test_format_of_the_page_is_read(tmp_path):
    """Requirement: a function and a decorator are all it takes."""
    (tmp_path / "cube.json").write_text(json.dumps(UNIT_CUBE))
    done = run(tmp_path, "A format of meshes", READ)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "['cube'] ['cube.lower'] 1\n"


def test_its_groups_are_checked_as_all_are(tmp_path):
    (tmp_path / "cube.json").write_text(json.dumps(UNIT_CUBE | {"lower": [[0, 1, 2, 7]]}))
    done = run(tmp_path, "A format of meshes", READ)
    text = "facet group 'lower': 1 of 1 facets belong to no cell of a body"
    assert text in done.stderr
