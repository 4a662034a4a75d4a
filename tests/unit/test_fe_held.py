"""Symmetry planes, elastic supports and springs: names, values, and in the case file."""

import pytest

from anisocontact.base.errors import InputError

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.cli import main
from anisocontact.mesh import BoxSpec, CylinderSpec, Model, build_box, build_mesh
from anisocontact.mesh.build import Body
from anisocontact.solver import ElasticSupport, Problem, Solver, Spring, Step, Turn

CASE = """
symmetry = ["bar.left", "bar.front"]

[mesh.box.bar]
origin = [0, 0, 0]
size = [1, 1, 2]
cells = [1, 1, 2]

[material.bar]
model = "linear-elastic"
E = 100
nu = 0

[elastic_support."bar.bottom"]
normal = 50

[spring.pull]
group = "bar.top"
stiffness = [0, 0, 50]

[[step]]
name = "pull"
increments = 2
anchor = { pull = { z = 0.6 } }
"""


def small(material="linear-elastic", **held):
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    return Problem(model, {"bar": make_material(material, E=1.0, nu=0.3)}, **held)


def test_a_mesh_without_groups_says_how_to_name_facets():
    """Requirement: where there is no name to choose from the line says where names are made."""
    whole = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    bare = Model(whole.mesh, {"bar": whole.cells("bar")}, {})
    with pytest.raises(InputError) as caught:
        bare.facets("bar.top", "symmetry")
    line = "symmetry: no facet group 'bar.top': the mesh has none; [group] names facets by place"
    assert str(caught.value) == line


@pytest.mark.parametrize(
    ("make", "line"),
    [
        (lambda: ElasticSupport("b.c", -1.0), "elastic_support.b.c.normal: -1.0 given, must be >="),
        (lambda: ElasticSupport("b.c", 0.0), "elastic_support.b.c: both stiffnesses are 0"),
        (lambda: Spring("s", "b.c", (1, -1, 0)), "spring.s.stiffness: (1, -1, 0) given, must be >"),
        (lambda: Spring("s", "b.c", (0, 0, 0)), "spring.s.stiffness: all components are 0"),
        (lambda: Spring("s", "b.c", (1, 1)), "stiffness: (1, 1) given, 3 numbers needed"),
        (
            lambda: Spring("s", "b.c", (1, 1, 1), "b.c"),
            "spring.s.to: 'b.c' given, the group itself",
        ),
        (
            lambda: small(attached=[ElasticSupport("bar.tpo", 1.0)]),
            "elastic_support.bar.tpo: no facet group 'bar.tpo' in the mesh; did you mean 'bar.top'",
        ),
        (
            lambda: small(attached=[Spring("s", "bar.tpo", (1, 1, 1))]),
            "spring.s.group: no facet group 'bar.tpo'",
        ),
        (
            lambda: small(attached=[Spring("s", "bar.top", (1, 1, 1))] * 2),
            "two elastic supports or springs have the name 's'",
        ),
        (lambda: small(symmetry=["bar.lefft"]), "symmetry: no facet group 'bar.lefft'"),
    ],
)
def test_bad_input_is_one_line(make, line):
    """Requirement: one line naming field, what was given, what is allowed."""
    with pytest.raises(InputError) as caught:
        make()
    assert str(caught.value).startswith(line)
    assert "\n" not in str(caught.value)


def test_a_curved_group_is_no_symmetry_plane():
    """Requirement: a group that is not flat is refused in one line."""
    model = build_mesh([Body("bar", CylinderSpec(1.0, 1.0, (8, 1, 1)))])
    materials = {"bar": make_material("linear-elastic", E=1.0, nu=0.3)}
    with pytest.raises(InputError, match=r"'bar.outer' given, its normals differ by .* be flat"):
        Problem(model, materials, symmetry=["bar.outer"])


def test_anchor_of_no_spring_is_found_before_anything_is_solved():
    """Requirement: a spring that is not there, or has no end on ground, is named at once."""
    problem = small(attached=[Spring("pull", "bar.top", (1, 1, 1))])
    with pytest.raises(InputError, match="no spring 'pul' to ground; there are: pull"):
        Solver(problem, [Step("a", 1), Step("b", 1, anchor={"pul": {"x": 1.0}})])


def test_case_with_all_of_them(tmp_path):
    """Planes, a bed and a spring in a case file: bed, bar and spring in series.

    Requirement: case file; reactions of all by name. Source: series of springs, E A / L = 50.
    """
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    built = build(load(path))
    last = list(built.solver.run())[-1]
    force = 0.6 / (3 / 50)
    assert last.reactions["pull"] == pytest.approx([0, 0, force], abs=1e-9)
    assert last.reactions["bar.bottom"] == pytest.approx([0, 0, -force], abs=1e-9)
    assert last.reactions["bar.left"] == pytest.approx([0, 0, 0], abs=1e-9)
    assert built.problem.holding == ["bar.left", "bar.front", "bar.bottom", "pull"]


def test_a_run_goes_on_with_springs_planes_and_turns():
    """Requirement: a run that is restored in the middle of a step, after a turn, goes on as if it
    had not stopped: displacements, reactions and energies. Same machine, same order: 1e-12."""
    ground = Spring("pull", "bar.top", (2.0, 2.0, 3.0))
    turn = Turn((0, 0, 1), 0.3, point=(0.5, 0.5, 0.0))
    held = {"x": 0.0, "y": 0.0, "z": 0.0}
    steps = [
        Step(
            "press", 2, {"bar.right": held}, anchor={"pull": {"z": 0.4}}, pressure={"bar.top": 0.1}
        ),
        Step("turn", 2, rotation={"bar.right": turn}, force={"bar.top": {"x": 0.05}}),
        Step("pull", 4, anchor={"pull": {"x": 0.4}}, body_force={"bar": {"y": 0.01}}),
    ]

    def solver():
        planes = {"symmetry": ["bar.bottom"], "attached": [ground, ElasticSupport("bar.back", 1.0)]}
        return Solver(small("neo-hookean", **planes), steps)

    whole = solver()
    accepted = list(whole.run())
    stopped = solver()
    for found in stopped.run():
        if (found.step, found.increment) == ("pull", 2):
            kept = stopped.persistent()
            break
    again = solver()
    again.restore(kept)
    rest = list(again.run())
    assert len(rest) == 2
    u = whole.problem.u.x.array
    assert abs(again.problem.u.x.array - u).max() < 1e-12 * abs(u).max()
    for one, other in zip(rest, accepted[-2:], strict=True):
        assert one.energies == pytest.approx(other.energies, abs=1e-12)
        for name, force in other.reactions.items():
            assert one.reactions[name] == pytest.approx(force, abs=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('"bar.left"', '"bra.left"', 'symmetry[0]: "bra.left" given, no such body'),
        ('"bar.left"', '"bar.front"', 'symmetry[1]: "bar.front" given twice'),
        ('"bar.left"', '"bar.letf"', "symmetry: no facet group 'bar.letf'"),
        ('"bar.bottom"]', '"bar.botom"]', "elastic_support.bar.botom: no facet group"),
        ("normal = 50", "normal = -50", 'elastic_support."bar.bottom".normal: -50 given'),
        ("normal = 50", "", 'elastic_support."bar.bottom": normal or tangential needed'),
        ("[0, 0, 50]", "[0, 0, 0]", "spring.pull.stiffness: all components are 0"),
        ("[0, 0, 50]", "50", "spring.pull.stiffness: 50 given"),
        ('group = "bar.top"', 'group = "bar.tpo"', "spring.pull.group: no facet group"),
        ('group = "bar.top"', 'group = "top"', 'spring.pull.group: "top" given, "body.group"'),
        ("{ pull =", "{ pul =", 'step[0].anchor: "pul" given, no such spring to ground'),
    ],
)
def test_wrong_case(tmp_path, capsys, old, new, says):
    """Requirement: one line with the place in the file."""
    path = tmp_path / "case.toml"
    assert old in CASE
    path.write_text(CASE.replace(old, new, 1))
    assert main(["check", str(path)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert says in lines[0]


def test_a_run_reports_springs_and_planes(tmp_path, capsys):
    """Requirement: reactions of all that holds a body in history and report; a spring has no
    displacement of its own."""
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 0
    capsys.readouterr()
    header = (tmp_path / "out" / "history.csv").read_text().splitlines()[0].split(",")
    assert {"reactions.pull.z", "reactions.bar.left.x", "energy.springs"} <= set(header)
    assert "displacements.pull.z" not in header
    assert "pull" in (tmp_path / "out" / "report.html").read_text()


def test_motion_out_of_a_plane_is_found_before_anything_is_written(tmp_path, capsys):
    """Requirement: a prescribed motion out of a plane is one line, nothing is written."""
    path = tmp_path / "case.toml"
    out = tmp_path / "out"
    path.write_text(f'{CASE}displacement = {{ "bar.top" = {{ x = 0.1 }} }}\n')
    assert main(["run", str(path), "-o", str(out)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert "moves nodes out of the symmetry plane 'bar.left', by 0.1" in lines[0]
    assert not out.exists()


@pytest.mark.parametrize("before", [[], ["x", "y", "z"], ["z"]])
def test_a_turn_out_of_a_plane_is_found_before_anything_is_solved(before):
    """Requirement: as a motion out of a plane, where it is known from where the turn begins: at
    rest, or where supports have led all of a node; else it is found when the step begins."""
    box = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    material = {"bar": make_material("neo-hookean", E=100.0, nu=0.3)}
    problem = Problem(box, material, symmetry=["bar.left"])
    held = {"bar.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
    led = {"bar.top": dict.fromkeys(before, 0.0) | {"z": 0.01}} if before else {}
    press = Step("press", 1, held | led)
    about_z = Turn((0, 0, 1), angle_deg=2.0, point=(0.5, 0.5, 0.0))
    turn = Step("turn", 1, rotation={"bar.top": about_z})
    steps = [press, turn] if before else [Step("turn", 1, held, rotation={"bar.top": about_z})]
    said = r"step 'turn'.displacement: moves nodes out of the symmetry plane 'bar\.left', by 0\.017"
    if before == ["z"]:
        solver = Solver(problem, steps)
        with pytest.raises(InputError, match=said):
            list(solver.run())
    else:
        with pytest.raises(InputError, match=said):
            Solver(problem, steps)
        along_x = Turn((1, 0, 0), angle_deg=2.0, point=(0.5, 0.5, 0.0))
        Solver(problem, [*steps[:-1], Step("turn", 1, held, rotation={"bar.top": along_x})])
