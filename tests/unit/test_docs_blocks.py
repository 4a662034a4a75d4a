"""Every block of the pages works: fragments of case files are cases, lines of Python run.

Tutorials run as they stand (`test_repository_docs.py`, `tests/examples/test_tutorial.py`); these
pages show fragments, which need what the page supposes to be there.
"""

from __future__ import annotations

import copy
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import validate
from anisocontact.case.model import StepSection

DOCS = Path(__file__).parents[2] / "docs"
PAGES = [page for page in sorted(DOCS.rglob("*.md")) if page.parent.name != "tutorials"]
BODIES = ("block", "base", "tube", "plate", "roll", "wheel", "rail", "punch")


def blocks(page: Path, language: str) -> list[str]:
    """The blocks of a language on a page."""
    fence = re.compile(rf"^```{language}\n(.*?)^```", re.DOTALL | re.MULTILINE)
    return fence.findall(page.read_text())


#: What they register would stay: they run in a process of their own.
ELSEWHERE = {("how-to-add", "python"): "test_added_from_outside.py and test_law_open.py"}


def with_blocks(language: str) -> list[Path]:
    return [
        page for page in PAGES if blocks(page, language) and (page.stem, language) not in ELSEWHERE
    ]


#: What the fragments suppose: bodies of a file, a roll that is free to move, a plate, a step.
SUPPOSED: dict[str, Any] = {
    "mesh": {"file": "part.msh"},
    "material": {name: {"model": "neo-hookean", "E": 1.0, "nu": 0.3} for name in BODIES},
    "surface": {
        name: {"shape": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
        for name in ("plate", "roll", "flat", "rounding", "die")
    },
    "rigid": {"roll": {"reference": [0, 0, 0]}},
    "contact": [],
    "step": [{"name": "first", "increments": 1}],
}


def joined(whole: dict[str, Any], part: dict[str, Any]) -> None:
    """Put a fragment into a case: keys of a step into the step, tables into tables."""
    for key, value in part.items():
        if key in StepSection.model_fields:
            whole["step"][0][key] = value
        elif key == "contact":
            sides = {"slave": "block.bottom", "master": "plate"}
            laws: dict[str, Any] = {"friction": {"coefficients": 0.1}}
            whole["contact"] = [sides | ({} if "python" in one else laws) | one for one in value]
        elif isinstance(value, dict) and key in whole:
            whole[key] = whole[key] | value
        else:
            whole[key] = value


def carried(case: dict[str, Any]) -> list[dict[str, Any]]:
    """A contact for each rigid body that has none."""
    masters = {contact["master"] for contact in case["contact"]}
    found = []
    for name, rigid in case["rigid"].items():
        surfaces = rigid.get("surfaces", [] if "faces" in rigid else [name])
        if surfaces and not masters & set(surfaces):
            friction = {"coefficients": 0.1}
            found.append({"slave": "base.top", "master": surfaces[0], "friction": friction})
    return found


@pytest.mark.parametrize("page", with_blocks("toml"), ids=lambda p: p.stem)
def test_fragments_of_case_files_are_cases(page):
    """Each fragment is valid after those before it, in a case that has what it names."""
    case = copy.deepcopy(SUPPOSED)
    for block in blocks(page, "toml"):
        joined(case, tomllib.loads(block))
        whole = case | {"contact": case["contact"] + carried(case)}
        validate(whole)


BLOCK = """
import numpy as np
from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import Interface, ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import ContactProblem, Problem, Solver, Step
from anisocontact.surfaces import make_surface

plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
interface = Interface(
    plane, NormalLaw(penalty=1e3), Adhesion(stiffness=(100, 100)), Friction(coefficients=(0.3, 0.3))
)
model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
materials = {"block": make_material("linear-elastic", E=100.0, nu=0.3)}
"""
#: What the Python blocks of a page suppose, by page.
BEFORE = {
    "amplitudes": BLOCK,
    "two-dimensions": "",
    "own-script": BLOCK
    + """
import ufl
from dolfinx import fem, mesh
from anisocontact.mesh import Model

V = model.space
facet_tags = mesh.meshtags(model.mesh, 2, model.facets("block.bottom"), np.full(1, 3, np.int32))
u, v = fem.Function(V), ufl.TestFunction(V)
residual = 100.0 * ufl.inner(ufl.sym(ufl.grad(u)), ufl.sym(ufl.grad(v))) * ufl.dx
top = fem.locate_dofs_topological(V, 2, model.facets("block.top"))
moved = fem.Constant(model.mesh, np.array([0.0, 0.0, -0.01]))
bcs = [fem.dirichletbc(moved, top, V)]
""",
    "own-law": BLOCK.replace(
        "build_box({", 'build_box({"base": BoxSpec((0, 0, -1), (1, 1, 1), (2, 2, 1)), '
    ),
    "rigid-bodies": BLOCK.replace("(0, 0, 1)\n)", "(0, 0, -1)\n)")
    + """
plane = make_surface("plane", point=(0, 0, 1), normal=(0, 0, -1))
interface = Interface(
    plane, NormalLaw(penalty=1e5), Adhesion(stiffness=(100, 100)), Friction(coefficients=(0.3, 0.3))
)
materials = {"block": make_material("linear-elastic", E=1e5, nu=0.3)}
""",
    "restart": BLOCK
    + """
def build_problem():
    return Problem(model, materials, [Contact(model, "block.bottom", interface)])

problem = build_problem()
steps = [Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})]
""",
    "no-convergence": BLOCK
    + """
from pathlib import Path
from anisocontact.solver import Limits

ends = make_directions(
    "tabulated-grid", lower=(-2, -2), upper=(1.02, 2), counts=(2, 2), vectors=[1, 0, 0] * 4,
    interpolation="bilinear",
)
plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))
friction = Friction(coefficients=(0.3, 0.1), directions=ends)
interface = Interface(plane, NormalLaw(penalty=1e3), Adhesion(stiffness=(100, 100)), friction)
problem = Problem(model, materials, [Contact(model, "block.bottom", interface)])
way = {"block.top": {"x": 0.05, "y": 0.0, "z": -0.01}}
solver = Solver(problem, [Step("drag", 1, way)], limits=Limits(cuts=0))
""",
    "materials": "from anisocontact.bulk import PointState, user_material\n",
    "python-model": "",
    "meshes": "",
    "point-loads": BLOCK + "from anisocontact.point import PrescribedPath, Push\n",
    "direction-fields": BLOCK
    + """
turned = milled = make_directions("constant", vector=(1, 0, 0))
""",
    "adhesion-domain": "",
    "results-folder": "import numpy as np",
}
#: What has to hold afterwards.
AFTER = {
    "python-model": "assert abs(found[0]) < 1e-9 and abs(found[1] + 0.1309) < 1e-3",
    "amplitudes": "assert Solver(Problem(model, materials), steps).cautions == []",
    "own-script": "assert problem.solve() is not None and contact.last.status.max() > 0\n"
    "assert held.last.status.min() > 0 and 0.0 < held.resultant()[0][2] < 0.1\n"
    "assert pressure.x.array.max() < 0.0",
    "own-law": """
u = np.zeros((len(model.space.tabulate_dof_coordinates()), 3))
u[on_plane.couplable()] = (1e-3, 0.0, -1e-3)
for one in (on_plane, on_base):
    answer = one.update(u, 1.0)
    assert np.allclose(answer.traction, (-2.0 / 1.2, 0.0, 10.0))
    assert np.allclose(answer.state["internal"], 1.0)
""",
    "rigid-bodies": "assert abs(problem.rigid.contact_force(die)[2] - 100.0) < 1e-6",
    "restart": "assert again.place == solver.place",
    "no-convergence": "from anisocontact.interface.failed_point import read_failed_point\n"
    "assert read_failed_point(Path('failed_point.json')).evaluate().failure == point.failure",
    "materials": """
law, e = user_material(Damage(3.0, 0.01)), np.diag([0.1, 0.02, 0.0])[None]
assert user_material(Foam(2.0)).young == 5.0
def stress(strain):
    return law.update(PointState(strain, {"largest": np.zeros(1)}, 0.0, e[:, 0]))
differences = (stress(e + 1e-5 * e).stress - stress(e - 1e-5 * e).stress) / 2e-5
assert np.allclose(differences, np.einsum("nijkl,nkl->nij", stress(e).tangent, e), rtol=1e-8)
""",
    "meshes": "assert model.body_names() == ['wheel', 'plate']",
    "two-dimensions": "assert model.idealisation.lateral",
    "point-loads": "",
    "direction-fields": "assert friction.directions_second is milled",
    "adhesion-domain": "import os; assert os.path.getsize('domain.png') > 1000",
    "results-folder": "assert len(x) >= 4 and pressure.max() > 0.0 and (np.diff(x) >= 0.0).all()",
}


@pytest.fixture
def supposed_files(tmp_path, monkeypatch):
    """An empty folder with the files that pages name."""
    monkeypatch.chdir(tmp_path)
    mesh = (Path(__file__).parent / "mutated" / "cases" / "cube.msh").read_text()
    (tmp_path / "wheel.msh").write_text(mesh.replace('"block"', '"volume1"'))
    return tmp_path


@pytest.mark.parametrize("page", with_blocks("python"), ids=lambda p: p.stem)
def test_lines_of_python_run(page, supposed_files, case_text, monkeypatch):
    if page.stem == "results-folder":
        from anisocontact.cli import main

        monkeypatch.setattr("anisocontact.results.writer.Writer._report", lambda self: None)
        Path("first.toml").write_text(case_text)
        assert main(["run", "first.toml"]) == 0
    text = "\n".join([BEFORE[page.stem], *blocks(page, "python"), AFTER[page.stem]])
    exec(compile(text, str(page), "exec"), {"__name__": "__main__"})
