"""Loads on what the same step prescribes are refused: they would act on nothing, without a word."""

from __future__ import annotations

import tomllib

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.mesh import Body, BoxSpec, Placement, Rotation, build_mesh
from anisocontact.solver import Problem, Solver, Spring, Step

FIXED = {"block.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
TOP = {"block.top": {"z": -0.1}}

WRONG = [
    ({"force": {"block.top": {"z": -1.0}}}, "'press'.force.block.top.z"),
    ({"traction": {"block.top": {"x": 1.0, "z": -1.0}}}, "'press'.traction.block.top.z"),
    ({"pressure": {"block.top": 1.0}}, "'press'.pressure.block.top"),
    ({"force": {"block.bottom": {"y": 1.0}}}, "'press'.force.block.bottom.y"),
]
RIGHT = [
    {"force": {"block.top": {"x": 1.0, "z": 0.0}}},  # another component, and none at all
    {"traction": {"block.right": {"z": 1.0}}},  # shares an edge with what is held
    {"pressure": {"block.right": 1.0}},
    {"body_force": {"block": {"z": -1.0}}},
]


def _solver(*steps: Step, symmetry: tuple[str, ...] = (), turn: float = 0.0, **more) -> Solver:
    box = BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2), **more)
    turned = Placement(rotate=Rotation((0, 0, 1), angle_deg=turn))
    model = build_mesh([Body("block", box, turned)])
    elastic = {"block": make_material("linear-elastic", E=100.0, nu=0.3)}
    return Solver(Problem(model, elastic, symmetry=symmetry), list(steps))


@pytest.mark.parametrize("more", [{}, {"order": 2}, {"cell": "tetrahedron"}])
@pytest.mark.parametrize(("load", "place"), WRONG)
def test_a_load_on_a_prescribed_component_is_one_line(load, place, more):
    with pytest.raises(InputError, match=f"^step {place}: acts on nothing: every node"):
        _solver(Step("press", 1, FIXED | TOP, **load), **more)


@pytest.mark.parametrize("load", RIGHT)
def test_loads_that_act_are_none(load):
    _solver(Step("press", 1, FIXED | TOP, **load))


def test_what_a_step_before_prescribes_still_holds():
    """A displacement that is not freed stays; freed, the load acts."""
    press, load = Step("press", 1, FIXED | TOP), {"force": {"block.top": {"z": -1.0}}}
    with pytest.raises(InputError, match=r"step 'pull'\.force\.block\.top\.z: acts on nothing"):
        _solver(press, Step("pull", 1, **load))
    _solver(press, Step("pull", 1, {"block.top": {"z": None}}, **load))


def test_a_load_across_a_symmetry_plane_is_one_line():
    """Also where the plane is along no axis: a pressure acts along its normal."""
    step = Step("press", 1, FIXED, pressure={"block.right": 1.0})
    with pytest.raises(InputError, match=r"pressure\.block\.right: acts on nothing"):
        _solver(step, symmetry=("block.right",), turn=30.0)
    _solver(Step("press", 1, FIXED, force={"block.right": {"x": 1.0}}), symmetry=("block.right",),
            turn=30.0)  # fmt: skip


def test_the_anchor_of_a_spring_without_stiffness_along_it_is_one_line():
    spring = Spring("pull", "block.right", (5.0, 0.0, 0.0))
    model = build_mesh([Body("block", BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1)))])
    elastic = {"block": make_material("linear-elastic", E=100.0, nu=0.3)}
    problem = Problem(model, elastic, attached=[spring])
    Solver(problem, [Step("pull", 1, FIXED, anchor={"pull": {"x": 0.1, "y": 0.0}})])
    with pytest.raises(InputError, match=r"step 'pull'\.anchor\.pull\.y: .* no stiffness along y"):
        Solver(problem, [Step("pull", 1, FIXED, anchor={"pull": {"x": 0.1, "y": 0.1}})])


def test_in_a_case_file(tmp_path, case_text):
    """The case file comes by the same check, before anything is written."""
    from anisocontact.case import load
    from anisocontact.case.build import build

    text = case_text.replace(
        "increments = 4", 'increments = 4\nforce = { "block.top" = { y = 2.0 } }'
    )
    assert tomllib.loads(text)["step"][1]["force"]
    path = tmp_path / "case.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=r"step 'drag'\.force\.block\.top\.y: acts on nothing"):
        build(load(path))
