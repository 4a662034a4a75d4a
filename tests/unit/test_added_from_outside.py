"""Materials and formats of meshes are added from outside, literally as the page says."""

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from anisocontact.results import Results
from anisocontact.results.no_energy import NO_ENERGY

ROOT = Path(__file__).parents[2]
CASE = """
from anisocontact.base.fenicsx import MPI
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


RELAX = """
[mesh.box.bar]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [2, 1, 1]

[material.bar]
model = "standard-linear-solid"
E = 2.0
E_1 = 3.0
nu = 0.3
tau = 0.5

[[step]]
name = "pull"
increments = 1
duration = 0.1
[step.displacement]
"bar.bottom" = { z = 0 }
"bar.left" = { x = 0 }
"bar.front" = { y = 0 }
"bar.top" = { z = 0.01 }

[[step]]
name = "hold"
increments = 3
duration = 0.6

[output]
pictures = false
"""
RUN_AND_GO_ON = """
import os, signal

from anisocontact.cli import main
from anisocontact.results.writer import Writer

keep = Writer.keep

def interrupted(self, *arguments):
    keep(self, *arguments)
    if self.summary["steps"] == 3:
        os.kill(os.getpid(), signal.SIGINT)

assert main(["run", "case.toml", "-o", "whole"]) == 0
Writer.keep = interrupted
assert main(["run", "case.toml", "-o", "out"]) == 3
Writer.keep = keep
assert main(["run", "case.toml", "-o", "out", "--restart"]) == 0
"""


def run(
    tmp_path: Path,
    section: str,
    more: str,
    number: int = 0,
    before: Sequence[str] = (),
    after: Sequence[str] = (),
) -> Any:
    """A block of code of a section of the page and then more, in a process of its own.

    What stands `before` starts it, `after` are its arguments.
    """
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    page = (ROOT / "docs" / "dev" / "how-to-add.md").read_text().partition(f"## {section}\n")[2]
    codes = re.findall(r"```python\n(.*?)```", page.partition("\n## ")[0], re.S)
    script = f"import anisocontact\n{codes[number]}\n{more}"
    command = [*before, sys.executable, "-c", script, *after]
    return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)


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


def test_material_with_a_history_relaxes_and_goes_on(tmp_path):
    """Requirement: internal variables advance with accepted increments, and are in checkpoints.

    Source: a bar that is stretched in one increment and held; backward Euler leaves the strain
    `e (tau / (tau + dt))` of the Maxwell element after each. The sides are free, so that the force
    is `E e + E_1 e_1`. Tolerance: that of Newton's method. The true stress at the nodes is
    `force (1 + e) / J`. A run that was halted while it relaxed is the whole one, bit by bit.
    """
    (tmp_path / "case.toml").write_text(RELAX)
    done = run(tmp_path, "A material", RUN_AND_GO_ON, 1)
    assert done.returncode == 0, done.stderr
    history = (tmp_path / "whole" / "history.csv").read_bytes()
    assert history == (tmp_path / "out" / "history.csv").read_bytes()
    results = Results(tmp_path / "whole")
    steps = np.array([0.1] + [0.2] * 3)
    maxwell = 0.01 * np.cumprod(0.5 / (0.5 + steps))
    force = results.history["reactions.bar.top.z"]
    np.testing.assert_allclose(force, 2.0 * 0.01 + 3.0 * maxwell, rtol=1e-7)
    for found in (results, Results(tmp_path / "out")):
        stress = found.fields().point_data["stress"]
        true = force[-1] / (1.0 - 0.3 * 0.01) ** 2
        np.testing.assert_allclose(stress, [[0, 0, true, 0, 0, 0]] * len(stress), atol=1e-7 * true)
    assert results.summary["energy"]["elastic"] == NO_ENERGY


ON_TWO = """
import sys

from anisocontact.cli import main
from anisocontact.results.writer import Writer

if sys.argv[1] == "halted":
    import os, signal
    keep = Writer.keep

    def interrupted(self, *arguments):
        keep(self, *arguments)
        if self.summary["steps"] == 3:
            os.kill(os.getpid(), signal.SIGTERM)

    Writer.keep = interrupted
sys.exit(main(["run", "case.toml", "-o", "out", *sys.argv[2:]]))
"""


@pytest.mark.slow
@pytest.mark.mpi
def test_history_of_a_material_goes_to_other_processes(tmp_path):
    """Requirement: internal variables are found again by another number of processes.

    Source: the closed form of the test above, of a run that was halted on two processes and goes on
    in one. Tolerance: that of Newton's method.
    """
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    (tmp_path / "case.toml").write_text(RELAX)
    two = ("timeout", "-k", "5", "200", "mpirun", "-n", "2")
    halted = run(tmp_path, "A material", ON_TWO, 1, before=two, after=("halted",))
    assert halted.returncode == 3, halted.stderr
    done = run(tmp_path, "A material", ON_TWO, 1, after=("on", "--restart"))
    assert done.returncode == 0, done.stderr
    maxwell = 0.01 * np.cumprod(0.5 / (0.5 + np.array([0.1] + [0.2] * 3)))
    force = Results(tmp_path / "out").history["reactions.bar.top.z"]
    np.testing.assert_allclose(force, 2.0 * 0.01 + 3.0 * maxwell, rtol=1e-7)


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


CHOOSE = """
from anisocontact.mesh import Body, build_mesh, make_selector, make_shape

box = Body("box", make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(2, 2, 2)))
ball = make_selector("ball", point=(0, 0, 0), radius=1.01)
print(build_mesh([box], {"box.corner": [ball]}).count_facets("box.corner"))
"""


def test_selector_of_the_page_chooses(tmp_path):
    """Of the cells' facets at a corner, 1/2 wide, those three that end within a ball of 1.01."""
    done = run(tmp_path, "A selector of facets", CHOOSE)
    assert done.stdout == "3\n", done.stderr


def test_its_groups_are_checked_as_all_are(tmp_path):
    (tmp_path / "cube.json").write_text(json.dumps(UNIT_CUBE | {"lower": [[0, 1, 2, 7]]}))
    done = run(tmp_path, "A format of meshes", READ)
    text = "facet group 'lower': 1 of 1 facets belong to no cell of a body"
    assert text in done.stderr


WRITE = """
import sys

from anisocontact.cli import main
from anisocontact.cli.info import facts

assert main(["run", "case.toml", "-o", "out"]) == 0
names = [entry["name"] for entry in facts()["registries"]["output quantities"]]
assert {"mobilised", "normal_force"} <= set(names)
sys.path.insert(0, PAGES)
from reference_pages import quantities_page
from anisocontact.results.quantities import FILES, quantities
assert "| `mobilised` | 1 | tangential traction over" in quantities_page(quantities(), FILES)
"""


def test_quantities_of_the_page_are_written(tmp_path):
    """Requirement: a function and a decorator make array or number, page and name in `[output]`.

    Source: what else is in the files. Arrays that are not chosen are not there, but for those that
    pictures are made of. Tolerance: rounding.
    """
    case = (ROOT / "tests/unit/small_block.toml").read_text()
    chosen = '[output]\npictures = false\nquantities = ["mobilised", "stress"]\n'
    (tmp_path / "case.toml").write_text(case.replace("[output]\n", chosen))
    pytest.importorskip("sphinx")
    pages = f"PAGES = {str(ROOT / 'docs' / '_ext')!r}\n"
    done = run(tmp_path, "An output quantity", pages + WRITE)
    assert done.returncode == 0, done.stderr
    results = Results(tmp_path / "out")
    points, fields = results.contact().point_data, results.fields().point_data
    size = np.linalg.norm(points["traction_principal"], axis=1)
    np.testing.assert_allclose(points["mobilised"] * points["pressure"], size, atol=1e-12)
    assert 0.0 < points["mobilised"].max() < 1.0
    assert ("gap" in points, "von_mises" in fields, "stress" in fields) == (False, False, True)
    normal = points["pressure"] @ points["area"]
    assert results.history["contacts.0.normal_force"][-1] == pytest.approx(normal, rel=1e-12)


def test_quantities_that_there_are_not_are_refused(tmp_path):
    case = (ROOT / "tests/unit/small_block.toml").read_text()
    (tmp_path / "case.toml").write_text(
        case.replace("[output]\n", '[output]\nquantities = ["mobilized"]\n')
    )
    check = 'from anisocontact.cli import main\nmain(["check", "case.toml"])'
    done = run(tmp_path, "An output quantity", check)
    assert "output.quantities[0]: 'mobilized' given; did you mean \"mobilised\"?" in done.stderr


SOLVE = """
from anisocontact.cli import main
from anisocontact.cli.info import facts

assert main(["run", "case.toml", "-o", "out"]) == 0
assert main(["run", "direct.toml", "-o", "direct"]) == 0
names = [entry["name"] for entry in facts()["registries"]["strategies"]]
assert names == ["auto", "direct", "condensed", "iterative", "petsc-lu"]
"""


def test_strategy_of_the_page_solves(tmp_path):
    """Requirement: a class and a decorator make a strategy that a case file can ask for.

    Source: the strategy `direct`. Tolerance: that of Newton's method.
    """
    case, _, _ = (ROOT / "tests/unit/small_block.toml").read_text().rpartition("[[step]]")
    case += "[output]\npictures = false\n"
    for name, strategy in (("case", "petsc-lu"), ("direct", "direct")):
        text = f'{case}\n[solver]\nstrategy = "{strategy}"\n'
        (tmp_path / f"{name}.toml").write_text(text)
    done = run(tmp_path, "A strategy", SOLVE)
    assert done.returncode == 0, done.stderr
    found, known = (Results(tmp_path / folder) for folder in ("out", "direct"))
    assert found.summary["strategy"] == "petsc-lu"
    np.testing.assert_allclose(
        found.history["contacts.0.force.z"], known.history["contacts.0.force.z"], rtol=1e-7
    )


SWING = """
from anisocontact.case import load
from anisocontact.case.build import build

path = Path("case.toml")
path.write_text(TEXT)
built = build(load(path))
print(*(accepted.reactions["bar.bottom"][2] for accepted in built.solver.run()))
"""
SWUNG = BAR.replace('"blatz-ko"\nG = {shear}', '"linear-elastic"\nE = 1e3\nnu = 0').format()
SWUNG = (
    SWUNG.partition("[[step]]")[0]
    + """
[amplitude.ring]
kind = "decay"
period = 1.0
tau = 0.5

[[step]]
name = "ring"
increments = 8
displacement = { "bar.bottom" = { x = 0, y = 0, z = 0 } }
force = { "bar.top" = { z = { amplitude = "ring", value = 2 } } }
"""
)


def test_amplitude_of_the_page_leads_a_load(tmp_path):
    """Requirement: a class and a decorator are all it takes; the force is the formula's."""
    more = f"from pathlib import Path\nTEXT = {SWUNG!r}\n{SWING}"
    done = run(tmp_path, "An amplitude", more)
    assert done.returncode == 0, done.stderr
    time = np.arange(1, 9) / 8
    exact = -2.0 * np.exp(-time / 0.5) * np.sin(2.0 * np.pi * time)
    np.testing.assert_allclose([float(v) for v in done.stdout.split()], exact, atol=1e-12)
