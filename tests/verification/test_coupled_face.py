"""Faces that move rigidly with a reference point: closed forms, invariance, tangent, processes."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from anisocontact.base.errors import InputError

NOTHING = {"x": 0.0, "y": 0.0, "z": 0.0}
FREE = dict.fromkeys(("x", "y", "z", "rx", "ry", "rz"))
SLIM = {"model": "linear-elastic", "E": 1200.0, "nu": 0.0}
RUBBER = {"model": "neo-hookean", "E": 10.0, "nu": 0.3}


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe: Any) -> None:
    """All tests here need DOLFINx."""


def bar(
    material: dict[str, Any],
    cells: tuple[int, int, int] = (1, 1, 4),
    size: tuple[float, float, float] = (1.0, 2.0, 8.0),
    order: int = 2,
    faces: tuple[str, ...] = ("top",),
    shift: float = 0.0,
    springs: dict[str, float] | None = None,
    **more: Any,
) -> tuple[list[Any], Any]:
    """A bar along z whose ends follow reference points in their middles, and these."""
    from anisocontact.bulk import make_material
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import CoupledFace, Problem

    model = build_box({"bar": BoxSpec((0, 0, 0), size, cells, "hexahedron", order)})
    at = {"top": size[2], "bottom": 0.0}
    middle = np.array([size[0] / 2 + shift, size[1] / 2, 0.0])
    points = [middle + np.array([0.0, 0.0, at[face]]) for face in faces]
    heads = [
        RigidBody(face, point, free=True, springs=springs)
        for face, point in zip(faces, points, strict=True)
    ]
    coupled = [CoupledFace(f"bar.{head.name}", head) for head in heads]
    return heads, Problem(model, {"bar": make_material(**material)}, coupled=coupled, **more)


def run(problem: Any, *steps: Any, **options: Any) -> Any:
    """The last accepted increment."""
    from anisocontact.solver import Solver

    return list(Solver(problem, steps, options={"snes_rtol": 1e-12}, **options).run())[-1]


@pytest.mark.parametrize("strategy", ["direct", "iterative"])
def test_beam_under_a_moment_and_a_force(strategy):
    """A beam of E I = 800 about y, E A = 2400 is bent and pulled at its free end.

    Requirement: turn M L / (E I), deflection M L^2 / (2 E I), elongation F L / (E A); what acts
    does the work. Source: pure bending, which for nu = 0 leaves sections plane and which elements
    of order 2 hold exactly. Tolerance: 1e-9, factorisation and FGMRES.
    """
    from anisocontact.solver import Step

    inertia = 2.0 * 1.0**3 / 12.0
    (head,), problem = bar(SLIM | {"E": 1200.0})
    moment, force, length = 0.5, 2.4, 8.0
    pull = Step(
        "a",
        2,
        {"bar.bottom": NOTHING},
        motion={"top": FREE},
        load={"top": {"ry": moment, "z": force}},
    )
    last = run(problem, pull, strategy=strategy)
    angle = moment * length / (1200.0 * inertia)
    exact = [angle * length / 2.0, 0.0, force * length / 2400.0, 0.0, angle, 0.0]
    assert head.accepted.values == pytest.approx(exact, abs=1e-9)
    assert last.reactions["bar.bottom"] == pytest.approx([0, 0, -force], abs=1e-9)
    assert problem.rigid.contact_force(head) == pytest.approx(
        [0, 0, -force, 0, -moment, 0], abs=1e-9
    )
    assert problem.rigid.support(head) == pytest.approx(0.0, abs=1e-12)
    work = 0.5 * (moment * angle + force * exact[2])
    assert last.energies["external"] == pytest.approx(work, rel=1e-9)
    assert last.energies["elastic"] == pytest.approx(work, rel=1e-9)


def test_prescribed_components_answer_with_force_and_moment():
    """The same beam, its end turned by an angle and held across; the point is off the middle.

    Requirement: moment about the reference point and force of a beam with both ends held: with the
    turn alone free to follow, `4 E I / L angle` and `6 E I / L^2 angle` without shear, to
    which `1 / (1 + phi)` terms come, phi = 12 E I / (k G A L^2). Source: Timoshenko's beam;
    k = 5/6. Tolerance: 1 %, the clamped ends and k of a rectangle.
    """
    from anisocontact.solver import Step

    (head,), problem = bar(SLIM, (4, 2, 16), shift=0.25)
    angle, length, bend, shear = 1e-3, 8.0, 1200.0 / 6.0, 5.0 / 6.0 * 600.0 * 2.0
    # the point is 0.25 off the axis: held along z there, it goes up on the axis by 0.25 angle
    run(problem, Step("a", 1, {"bar.bottom": NOTHING}, motion={"top": {"ry": angle}}))
    phi = 12.0 * bend / (shear * length**2)
    moment = (4.0 + phi) / (1.0 + phi) * bend / length * angle
    across = 6.0 / (1.0 + phi) * bend / length**2 * angle
    along = 2400.0 / length * 0.25 * angle
    found = problem.rigid.support(head)
    assert found[0] == pytest.approx(-across, rel=0.01)
    assert found[2] == pytest.approx(along, rel=0.01)
    assert found[4] == pytest.approx(moment + 0.25 * along, rel=0.01)
    assert np.abs(found[[1, 3, 5]]).max() < 1e-9 * moment


def test_a_rigid_motion_strains_nothing():
    """Both ends of a rubber bar are led through one rigid motion of 150 degrees.

    Requirement: no energy and no forces at its end, whatever the axis. Source: invariance.
    Tolerance: 1e-9 of E, Newton to 1e-12.
    """
    from anisocontact.solver import Step, Turn

    heads, problem = bar(RUBBER, (1, 1, 2), faces=("top", "bottom"))
    turn = Turn((1.0, -2.0, 0.5), angle_deg=150.0, point=(3.0, 1.0, 0.0), move=(0.5, 0.0, 1.0))
    last = run(problem, Step("a", 5, rotation={head.name: turn for head in heads}))
    x = problem.model.space.tabulate_dof_coordinates()
    assert x + problem.u.x.array.reshape(-1, 3) == pytest.approx(turn.path(x, 1.0), abs=1e-8)
    assert last.energies["elastic"] < 1e-12
    assert max(np.abs(problem.rigid.support(head)).max() for head in heads) < 1e-7


def test_a_strip_is_rolled_into_an_arc():
    """A slim strip whose end is turned by 120 degrees and free to follow.

    Requirement: moment E I angle / L; the end is at `L (1 - cos a) / a, L sin a / a`. Source:
    elastica under a moment, an arc; strain h a / (2 L) = 2.6 %. Tolerance: 2 %, neo-Hookean and
    linear in strain differ by that order.
    """
    from anisocontact.solver import Step

    (head,), problem = bar(RUBBER | {"nu": 0.0}, (1, 1, 20), (1.0, 1.0, 40.0))
    angle = np.radians(120.0)
    led = {"x": None, "y": None, "z": None, "ry": angle}
    run(problem, Step("a", 8, {"bar.bottom": NOTHING}, motion={"top": led}))
    place = [40.0 * (1.0 - np.cos(angle)) / angle, 0.0, 40.0 * (np.sin(angle) / angle - 1.0)]
    assert head.accepted.translation == pytest.approx(place, abs=0.02 * 40.0)
    assert problem.rigid.support(head)[4] == pytest.approx(10.0 / 12.0 * angle / 40.0, rel=0.02)


@pytest.mark.parametrize("material", [SLIM, RUBBER])
def test_tangent_of_a_coupled_face(fe, material):
    """Halving the step quarters the error of the central difference against the tangent.

    Requirement: exact tangent at a random state, half of the components free, springs at the
    point; where arms do not turn there is no error. Source: Taylor. Tolerance: 4 (1 + O(h^2)),
    0.15.
    """
    from anisocontact.solver import Spring, Step

    attached = [Spring("pull", "bar.top", (3.0, 4.0, 5.0))]
    springs = {"x": 1.0, "y": 2.0, "z": 3.0, "rx": 4.0, "ry": 5.0, "rz": 6.0}
    _, problem = bar(material, (1, 1, 2), springs=springs, attached=attached, order=1)
    free = {"x": None, "ry": None, "rz": None}
    load = {"top": {"x": 1.0, "ry": 2.0}}
    problem.begin(Step("a", 1, {"bar.bottom": NOTHING}, motion={"top": free}, load=load))
    problem.set_load_factor(1.0, 1.0)
    errors = fe.tangent_errors(problem, np.random.default_rng(3), 0.05)
    if material is SLIM:
        assert errors.max() < 1e-9
    else:
        assert np.all(np.abs(errors[:-1] / errors[1:] - 4.0) < 0.15)


def test_two_bodies_share_a_point():
    """Two bars beside each other on one reference point, which is pulled.

    Requirement: springs in parallel; the second bar is held by the first one's support alone.
    Tolerance: 1e-9, factorisation.
    """
    from anisocontact.bulk import make_material
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import CoupledFace, Problem, Step

    boxes = {
        "a": BoxSpec((0, 0, 0), (1, 1, 2), (1, 1, 2)),
        "b": BoxSpec((3, 0, 2), (1, 1, 4), (1, 1, 2)),
    }
    head = RigidBody("head", (2.0, 0.5, 2.0), free=True)
    coupled = [CoupledFace("a.top", head), CoupledFace("b.bottom", head)]
    slim = make_material("linear-elastic", E=100.0, nu=0.0)
    problem = Problem(build_box(boxes), {"a": slim, "b": slim}, coupled=coupled)
    led = {"z": None}
    run(
        problem,
        Step("a", 1, {"a.bottom": NOTHING}, motion={"head": led}, load={"head": {"z": 3.0}}),
    )
    assert head.accepted.translation == pytest.approx([0, 0, 3.0 / 50.0], abs=1e-12)
    ends = {"a.bottom": NOTHING, "b.top": NOTHING}
    run(problem, Step("a", 1, ends, motion={"head": led}, load={"head": {"z": 3.0}}))
    assert head.accepted.translation == pytest.approx([0, 0, 3.0 / 75.0], abs=1e-12)


@pytest.mark.parametrize(
    ("more", "steps", "says"),
    [
        (
            {"symmetry": ["bar.left"]},
            {},
            "nodes of 'bar.top', which follows the rigid body 'top', have a symmetry plane as well",
        ),
        (
            {},
            {"displacement": {"bar.left": {"x": 0.0}, "bar.bottom": NOTHING}},
            "which follows the rigid body 'top', have a prescribed displacement as well",
        ),
        ({}, {"motion": {"top": {"z": None}}}, "'bar' is free to move: translation along z"),
        (
            {},
            {"motion": {"top": FREE}},
            "'bar' is free to move: translation along x, y and z, rotation about x, y and z",
        ),
    ],
)
def test_what_cannot_be_is_one_line(more, steps, says):
    """Requirement: found before anything is solved, with names."""
    from anisocontact.solver import Solver, Step

    with pytest.raises(InputError) as caught:
        _, problem = bar(SLIM, **more)
        Solver(problem, [Step("a", 1, **steps)])
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("same", "ends"),
    [
        (True, "have the coupled face 'bar.left' as well; make one group of the two by [join]"),
        (False, "have the coupled face 'bar.left' as well"),
    ],
)
def test_faces_that_share_nodes_are_to_be_joined_where_one_body_has_both(same, ends):
    """Requirement: the line says how one body takes both; two bodies cannot."""
    from anisocontact.bulk import make_material
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import CoupledFace, Problem

    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    head, other = (RigidBody(name, (0, 0, 1), free=True) for name in ("head", "other"))
    coupled = [CoupledFace("bar.left", head if same else other), CoupledFace("bar.top", head)]
    with pytest.raises(InputError) as caught:
        Problem(model, {"bar": make_material(**SLIM)}, coupled=coupled)
    start = "coupled.bar.top: 2 nodes of 'bar.top', which follows the rigid body 'head', "
    assert str(caught.value) == start + ends


def test_condensed_says_that_it_cannot():
    """Requirement: among the obstacles of the strategy, so that `auto` takes another."""
    from anisocontact.solver import Step, Task
    from anisocontact.solver.strategies.condensed.strategy import CondensedStrategy

    _, problem = bar(SLIM)
    step = Step("a", 1, {"bar.bottom": NOTHING})
    obstacles = CondensedStrategy().obstacles(Task(problem, [step], "", {}))
    assert "a face follows a rigid body" in list(obstacles)


SCRIPT = """
import numpy as np
from tests.verification.test_coupled_face import NOTHING, RUBBER, bar, run
from anisocontact.solver import Step

(head,), problem = bar(RUBBER, (2, 2, 4), (1.0, 1.0, 4.0), order=1)
load = {"top": {"x": 0.02, "rz": 0.05, "ry": 0.03}}
free = dict.fromkeys(("x", "ry", "rz"))
step = Step("a", 2, {"bar.bottom": NOTHING}, motion={"top": free}, load=load)
for strategy in ("direct", "iterative"):
    (head,), problem = bar(RUBBER, (2, 2, 4), (1.0, 1.0, 4.0), order=1)
    run(problem, step, strategy=strategy)
    found = np.concatenate([head.accepted.values, problem.rigid.support(head)])
    if problem.comm.rank == 0:
        print(*map(repr, found.tolist()))
"""


def on_processes(script: str, count: int) -> np.ndarray:
    """The two rows of numbers that a script prints on some processes."""
    command = ["mpirun", "-n", str(count), sys.executable, "-c", script]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return np.array(done.stdout.split(), dtype=float).reshape(2, -1)


@pytest.mark.mpi
@pytest.mark.slow
def test_processes_change_nothing():
    """Pose and supports of a reference point on one and on three processes, and by both strategies.

    Requirement: 1e-8. Source: the same equations. Tolerance: Newton to 1e-12, FGMRES, and sums in
    another order.
    """
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    values = np.concatenate([on_processes(SCRIPT, count) for count in (1, 3)])
    assert np.abs(values - values[0]).max() < 1e-8 * np.abs(values).max()
