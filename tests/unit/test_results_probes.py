"""Values at places, forces and moments, and when fields are written: against closed forms."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results import Results
from anisocontact.results.history import read_history
from anisocontact.results.stress_invariants import principal, von_mises

CASE = """
[mesh.box.bar]
origin = [0, 0, 0]
size = [1, 2, 3]
cells = [2, 2, 3]
order = {order}
cell = "{cell}"
move = [1, 0, 0]

[material.bar]
model = "linear-elastic"
E = 1000
nu = 0.3

[[step]]
name = "pull"
increments = 2
[step.displacement]
"bar.bottom" = {{ z = 0 }}
"bar.left" = {{ x = 0 }}
"bar.front" = {{ y = 0 }}
"bar.top" = {{ z = 0.03 }}

[[step]]
name = "back"
increments = 2
displacement = {{ "bar.top" = {{ z = 0.015 }} }}

[output]
pictures = false
steps = ["back"]
times = [0.4]

[output.probe.line]
point = [1.1, 0.3, 0.0]
to = [1.9, 1.9, 3.0]
count = 4
quantities = ["displacement", "stress", "principal_stress", "von_mises"]

[output.probe.end]
group = "bar.top"
quantities = ["displacement"]

[output.resultant.grip]
group = "bar.top"
about = [1.5, 0, 0]

[output.resultant.waist]
body = "bar"
point = [0, 0, 1.4]
normal = [0, 0, 2]
"""


@pytest.fixture
def run(tmp_path):
    def run(order=1, cell="hexahedron", text=CASE):
        (tmp_path / "case.toml").write_text(text.format(order=order, cell=cell))
        code = main(["run", str(tmp_path / "case.toml"), "-o", str(tmp_path / "out")])
        return code, tmp_path / "out"

    return run


@pytest.mark.parametrize(("order", "cell"), [(1, "tetrahedron"), (2, "hexahedron")])
def test_a_bar_that_is_pulled(run, order, cell):
    """Requirement: uniform tension, eps = u/L: stress E eps along z, lateral strain -nu eps.

    Round-off of the solution: the exact displacement is in every space.
    """
    code, out = run(order, cell)
    assert code == 0
    table = read_history(out / "probes" / "line.csv")
    assert table["step"].tolist() == ["pull"] * 8 + ["back"] * 8
    place = np.linspace([1.1, 0.3, 0.0], [1.9, 1.9, 3.0], 4)
    strain = np.repeat([0.005, 0.01, 0.0075, 0.005], 4)
    for k, axis in enumerate("xyz"):
        assert np.allclose(table[f"position.{axis}"].reshape(4, 4), place[:, k])
        away = np.tile(place[:, k] - (1.0, 0.0, 0.0)[k], 4)
        exact = away * strain * (-0.3, -0.3, 1.0)[k]
        assert np.allclose(table[f"displacement.{axis}"], exact, atol=1e-12)
    assert np.allclose(table["stress.ZZ"], 1000.0 * strain, rtol=1e-9)
    assert np.allclose(table["stress.XY"], 0.0, atol=1e-9)
    assert np.allclose(table["principal_stress.1"], 1000.0 * strain, rtol=1e-9)
    assert np.allclose(table["principal_stress.3"], 0.0, atol=1e-8)
    assert np.allclose(table["von_mises"], 1000.0 * strain, rtol=1e-9)
    end = read_history(out / "probes" / "end.csv")
    assert len(end["point"]) == 4 * (9 if order == 1 else 25)
    assert np.allclose(end["displacement.z"][-1], 0.015)
    assert "stress.ZZ" not in end


def test_forces_moments_and_times(run):
    """Requirement: F = E A eps = 10 at the end; moments of it about the axes the case names.

    What holds the top pulls it upwards at (1.5, 1): M = r x F, about the origin and (1.5, 0, 0),
    at small strain in the mesh. The part in front of the section does the same to the rest.
    """
    code, out = run()
    assert code == 0
    history = Results(out).history
    force = 1000.0 * 2.0 * np.array([0.005, 0.01, 0.0075, 0.005])
    for name, x in (("grip", 0.0), ("waist", 1.5)):
        at = f"resultants.{name}"
        assert np.allclose(history[f"{at}.force.z"], force, rtol=1e-9)
        assert np.allclose(history[f"{at}.force.x"], 0.0, atol=1e-9)
        assert np.allclose(history[f"{at}.moment.x"], force, rtol=1e-9)
        assert np.allclose(history[f"{at}.moment.y"], -x * force, atol=1e-9)
    assert np.allclose(history["reactions.bar.top.z"], force)
    stress = json.loads((out / "summary.json").read_text())["stress"]["bar"]
    assert stress["von_mises"] == pytest.approx(5.0, rel=1e-9)
    assert stress["largest_principal"] == pytest.approx(5.0, rel=1e-9)
    assert stress["least_principal"] == pytest.approx(0.0, abs=1e-9)
    # the start, the increment after time 0.4, and all of the last step
    assert Results(out).times.tolist() == [0.0, 0.5, 1.5, 2.0]


@pytest.mark.parametrize(
    ("order", "cell"), [(1, "tetrahedron"), (1, "hexahedron"), (2, "hexahedron")]
)
@pytest.mark.parametrize("z", [1.0, 2.0])
def test_a_section_through_nodes(run, order, cell, z):
    """Requirement: a plane in which nodes lie, which rounding puts on either side, carries the
    weight in front of it: that of the mean of both layers, exact where the load is uniform.

    Source: 2 A (3 - z) of a load of 2 per volume. Tolerance: round-off of the solution.
    """
    text = CASE.replace("normal = [0, 0, 2]", "normal = [0, 0, 2]\nabout = [2, 1, 0]")
    text = text.replace("point = [0, 0, 1.4]", f"point = [0, 0, {z}]")
    text = text.replace('group = "bar.top"\nabout', 'group = "bar.bottom"\nabout')
    first, last = text.index("[[step]]"), text.index("[output]")
    step = '[[step]]\nname = "back"\nincrements = 1\nbody_force = {{ bar = {{ z = -2 }} }}\n'
    held = 'displacement = {{ "bar.bottom" = {{ x = 0, y = 0, z = 0 }} }}\n'
    code, out = run(order, cell, text[:first] + step + held + text[last:])
    assert code == 0
    history = Results(out).history
    area = history["reactions.bar.bottom.z"][-1] / 6.0
    assert history["resultants.waist.force.z"][-1] == pytest.approx(-2.0 * area * (3.0 - z))


def test_principal_stresses_of_a_shear():
    """Requirement: pure shear t has t, 0, -t and the equivalent stress sqrt(3) t."""
    shear = np.array([[0.0, 0.0, 0.0, 2.0, 0.0, 0.0]])
    assert np.allclose(principal(shear), [[2.0, 0.0, -2.0]], atol=1e-15)
    assert np.allclose(von_mises(shear), 2.0 * np.sqrt(3.0))
    assert np.allclose(principal(np.array([[1.0, 2.0, 3.0, 0.0, 0.0, 0.0]])), [[3.0, 2.0, 1.0]])
    none = principal(np.vstack([shear, np.full((1, 6), np.nan)]))
    assert np.isfinite(none[0]).all()
    assert np.isnan(none[1]).all()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('steps = ["back"]', 'steps = ["bak"]', 'output.steps[0]: no step "bak"'),
        ("to = [1.9, 1.9", "to = [1.9, 2.9", "output.probe.line: (1.63333, 2.03333, 2) given, "),
        ('group = "bar.top"\nq', 'group = "bar.tip"\nq', "output.probe.end.group: no facet group"),
        ('["displacement"]', '["gap"]', "output.probe.end.quantities: 'gap' given, those of a"),
        ('body = "bar"', 'body = "rod"', "output.resultant.waist.body: no body 'rod'"),
        (
            "point = [0, 0, 1.4]",
            "point = [0, 0, 3.1]",
            "output.resultant.waist.point: all of the body 'bar' is behind the plane",
        ),
        (
            "point = [0, 0, 1.4]",
            "point = [0, 0, -1]",
            "output.resultant.waist.point: all of the body 'bar' is in front of the plane",
        ),
        ("normal = [0, 0, 2]", "", "output.resultant.waist.normal: a body needs it"),
        ("[output.probe.end]", '[output.probe."a/b"]', 'output.probe: "a/b" given, a name of'),
        ("[output.probe.end]", f"[output.probe.{'e' * 300}]", "needed, at most 100 bytes"),
        ("times = [0.4]", "times = [0.4, 3]", "output.times[1]: 3 given, the run ends at 2"),
        ("count = 4", "count = 1_000_000_000", "count: 1000000000 given, must be at most 1e+06"),
        ("to = [1.9, 1.9, 3.0]", "to = [1.1, 0.3, 0.0]", "output.probe.line.to: the same point"),
    ],
)
def test_mistakes_are_one_line(run, capsys, old, new, said):
    assert old in CASE
    code, out = run(text=CASE.replace(old, new))
    assert code == 2
    assert not out.exists()
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


CANTILEVER = """
[mesh.box.beam]
origin = [0, -0.5, -0.5]
size = [10, 1, 1]
cells = [5, 1, 1]
order = 2

[material.beam]
model = "{model}"
E = 1000
nu = 0.0

[[step]]
name = "bend"
increments = 1
displacement = {{ "beam.left" = {{ x = 0, y = 0, z = 0 }} }}
force = {{ "beam.right" = {{ x = 10, y = 0.01 }} }}

[output]
pictures = false

[output.resultant.foot]
group = "beam.left"
about = [5, 0, 0]

[output.resultant.outer]
body = "beam"
point = [5, 0, 0]
normal = [1, 0, 0]
about = [5, 0, 0]

[output.resultant.inner]
body = "beam"
point = [5, 0, 0]
normal = [-1, 0, 0]
about = [5, 0, 0]
"""


@pytest.mark.parametrize("model", ["linear-elastic", "st-venant-kirchhoff"])
def test_moments_of_a_beam_that_bends(run, model):
    """Requirement: the moment in the middle is that of the parts on either side and of the clamp;
    at small strain F_y L/2, whatever the force along the axis; at finite strain the axial force
    has the deflection of the end for an arm.

    Source: balance of moments; beam in tension, y(L) = F_y/(P k) (k L - tanh k L), k^2 = P/(E I).
    Tolerance: Newton's; 2 % of P y(L), shear and the change of the section are not in the beam.
    """
    code, out = run(text=CANTILEVER.replace("{model}", model))
    assert code == 0
    foot, outer, inner = (
        Results(out).history[f"resultants.{name}.moment.z"][0]
        for name in ("foot", "outer", "inner")
    )
    assert outer == pytest.approx(-inner, rel=1e-7)
    assert foot == pytest.approx(inner, rel=1e-7)
    if model == "linear-elastic":
        assert outer == pytest.approx(0.05, rel=1e-7)
    else:
        k = np.sqrt(12.0 * 10.0 / 1000.0)
        arm = 0.01 / (10.0 * k) * (10.0 * k - np.tanh(10.0 * k))
        assert outer == pytest.approx(0.01 * (10.1 - 5.0) - 10.0 * arm, abs=0.02 * 10.0 * arm)


ON_A_BED = """
[mesh.box.block]
origin = [0, 0, 0]
size = [2, 1, 1]
cells = [2, 1, 2]

[material.block]
model = "linear-elastic"
E = 1000
nu = 0.0

[elastic_support."block.bottom"]
normal = 50
tangential = 20

[[step]]
name = "load"
increments = 1
force = { "block.top" = { x = 0.03, z = -0.1 } }

[output]
pictures = false

[output.resultant.foot]
group = "block.bottom"
about = [1, 0.5, 1]
"""


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=[pytest.mark.mpi, pytest.mark.slow])])
def test_resultant_of_an_elastic_support(tmp_path, ranks):
    """Requirement: an elastic support is one of the supports of its group, as in `reactions`:
    force and moment balance those of the load, which are about the middle of the top.

    Source: balance of forces and moments. Tolerance: round-off of the solution.
    """
    (tmp_path / "case.toml").write_text(ON_A_BED)
    out = tmp_path / "out"
    arguments = ["run", str(tmp_path / "case.toml"), "-o", str(out)]
    if ranks == 1:
        assert main(arguments) == 0
    else:
        if shutil.which("mpirun") is None:
            pytest.skip("no mpirun")
        command = ["mpirun", "-n", str(ranks), sys.executable, "-m", "anisocontact", *arguments]
        subprocess.run(command, check=True, capture_output=True, timeout=100)
    foot = Results(out).summary["resultants"]["foot"]
    assert np.allclose(foot["force"], [-0.03, 0.0, 0.1], atol=1e-11)
    assert np.allclose(foot["force"], Results(out).summary["reactions"]["block.bottom"], atol=1e-11)
    assert np.allclose(foot["moment"], 0.0, atol=1e-11)


def test_resultant_of_a_group_that_nothing_holds(tmp_path, capsys):
    """Requirement: it is refused in one line with the groups that are held, before anything is
    written: it would be zero, though a contact or a load may act there."""
    text = ON_A_BED.replace('group = "block.bottom"', 'group = "block.top"')
    (tmp_path / "case.toml").write_text(text)
    for command in (["check"], ["run", "-o", str(tmp_path / "out")]):
        assert main([command[0], str(tmp_path / "case.toml"), *command[1:]]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert "output.resultant.foot.group: no support holds a node of 'block.top'" in line
        assert "groups with supports: block.bottom;" in line
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("restart", [False, True])
def test_a_section_of_a_body_that_relaxes(tmp_path, restart):
    """Requirement: a section carries what the supports do, in every increment, of a material that
    knows time, too; also after a restart.

    Source: balance of forces; what relaxes in one increment more is 3 to 16 % here.
    Tolerance: Newton's.
    """
    text = CANTILEVER.replace('"{model}"', '"viscoelastic"\ng = [0.5]\ntau = [1.0]')
    held = 'displacement = { "beam.right" = { x = 0.01 } }'
    text = text.replace("force = {{", "# force = {{").replace("{{", "{").replace("}}", "}")
    text += f'\n[[step]]\nname = "hold"\nincrements = 2\nduration = 2.0\n{held}\n'
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(text)
    assert main(["run", str(case), "-o", str(out)]) == 0
    if restart:
        case.write_text(text + '\n[[step]]\nname = "more"\nincrements = 2\nduration = 2.0\n')
        assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    history = Results(out).history
    foot, outer = (history[f"resultants.{name}.force.x"] for name in ("foot", "outer"))
    assert len(foot) == (5 if restart else 3)
    assert np.allclose(foot, -outer, rtol=1e-7, atol=1e-12)
    assert abs(foot[-1]) > 0.1


ONE_CELL = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [1, 1, 1]

[material.block]
model = "linear-elastic"
E = 1000
nu = 0.0

[[step]]
name = "press"
increments = 1
displacement = { "block.bottom" = { x = 0, y = 0, z = 0 }, "block.top" = { z = -0.01 } }

[output]
pictures = false

[output.probe.middle]
point = [0.5, 0.5, 0.25]
"""


@pytest.mark.mpi
@pytest.mark.slow
def test_a_point_where_a_process_has_no_nodes(tmp_path):
    """Requirement: a point is probed where two of three processes have nothing of the mesh.

    Source: the displacement of a bar, u = 0.25 times that of its top. Tolerance: round-off.
    """
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    (tmp_path / "case.toml").write_text(ONE_CELL)
    run = ["run", str(tmp_path / "case.toml"), "-o", str(tmp_path / "out")]
    command = ["mpirun", "-n", "3", sys.executable, "-m", "anisocontact", *run]
    done = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 0, done.stderr
    table = np.genfromtxt(
        tmp_path / "out" / "probes" / "middle.csv", delimiter=",", names=True, deletechars=""
    )
    assert table["displacement.z"] == pytest.approx(-0.0025, rel=1e-10)
