"""Tied facet groups: patch test, rotations, bending, a thick tube, strategies, two dimensions."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.conftest import difference_errors

from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact, close_gaps
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import (
    Axisymmetric,
    Body,
    BoxSpec,
    Model,
    PlaneStrain,
    build_box,
    build_mesh,
    make_shape,
)
from anisocontact.rigid import RigidBody
from anisocontact.solver import CoupledFace, Problem, Solver, Step, Tie, Turn
from anisocontact.surfaces import make_surface

E, NU = 1000.0, 0.3
STEEL = make_material("linear-elastic", E=E, nu=NU)
RUBBER = make_material("neo-hookean", E=E, nu=NU)
PLANES = ["lo.left", "lo.front", "up.left", "up.front", "lo.bottom"]
UP, DOWN = Tie("up.bottom", "lo.top"), Tie("lo.top", "up.bottom")


def halves(
    interface: str = "flat",
    cell: str = "hexahedron",
    orders: tuple[int, int] = (1, 1),
    cells: tuple[Any, Any] = ((3, 4, 2), (4, 3, 2)),
) -> Model:
    """The unit cube of two halves whose meshes do not match; the interface may be moved along z."""
    model = build_box(
        {
            "lo": BoxSpec((0, 0, 0), (1, 1, 0.5), cells[0], cell, orders[0]),
            "up": BoxSpec((0, 0, 0.5), (1, 1, 0.5), cells[1], cell, orders[1]),
        }
    )
    x, y, z = model.mesh.geometry.x.T
    shift = {
        "flat": 0.0 * x,
        "tilted": 0.15 * (x - 0.4) + 0.1 * y,
        "corrugated": 0.1 * np.sin(3.0 * x),
        "curved": 0.1 * np.sin(3.0 * x) * np.cos(2.0 * y),
    }[interface]
    model.mesh.geometry.x[:, 2] += 4.0 * z * (1.0 - z) * shift
    return model


def solved(model: Model, steps: list[Step], material: Any = STEEL, **given: Any) -> Problem:
    """Two halves, glued, after these steps."""
    options = {"snes_rtol": given.pop("rtol", 1e-12)}
    strategy = given.pop("strategy", "direct")
    problem = Problem(model, dict.fromkeys(model.body_names(), material), **given)
    for _ in Solver(problem, steps, options=options, strategy=strategy).run():
        pass
    return problem


def pulled(model: Model, **given: Any) -> float:
    """How far the displacement of a cube under tension is from a linear one, over the largest."""
    pull = Step("pull", 1, traction={"up.top": {"z": 10.0}})
    problem = solved(model, [pull], symmetry=PLANES, **given)
    x, u = model.space.tabulate_dof_coordinates(), problem.u.x.array.reshape(-1, 3)
    linear, *_ = np.linalg.lstsq(x, u, rcond=None)
    return float(np.abs(u - x @ linear).max() / np.abs(u).max())


@pytest.mark.parametrize("tie", [UP, DOWN])
@pytest.mark.parametrize("orders", [(1, 1), (2, 2), (1, 2)])
@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
@pytest.mark.parametrize("interface", ["flat", "tilted"])
def test_patch(interface: str, cell: str, orders: tuple[int, int], tie: Tie):
    """Uniform tension across an interface whose meshes do not match, with symmetry planes on it.

    Requirement: the linear field to 1e-11. Source: the dual functions that are left sum to one, and
    linear displacements satisfy the conditions. Tolerance: Newton to 1e-12.
    """
    assert pulled(halves(interface, cell, orders), ties=[tie]) < 1e-11


@pytest.mark.parametrize("order", [1, 2])
def test_patch_on_a_corrugated_interface(order: int):
    """The same where curved surfaces lie on each other: strips along y, three against four.

    Requirement, source, tolerance: as of the flat one.
    """
    cells = (3, 4, 2), (3, 3, 2)
    assert pulled(halves("corrugated", orders=(order, order), cells=cells), ties=[UP]) < 1e-11


def test_patch_at_finite_strain():
    """Requirement, source, tolerance: as at small strain."""
    assert pulled(halves("tilted"), material=RUBBER, ties=[UP]) < 1e-11


@pytest.mark.slow
def test_patch_on_a_curved_interface_converges():
    """Facets of surfaces that are curved both ways leave gaps, which are of second order.

    Requirement: order 1.5 at least in the largest error. Source: gaps are O(h^2). Tolerance: the
    largest error of few meshes.
    """
    errors = []
    for n in (1, 2, 4):
        cells = (3 * n, 4 * n, 2 * n), (4 * n, 3 * n, 2 * n)
        errors.append(pulled(halves("curved", cells=cells), ties=[UP]))
    assert errors[0] < 2e-3
    assert np.log2(errors[0] / errors[2]) / 2.0 > 1.5


@pytest.mark.parametrize(("cell", "order"), [("hexahedron", 1), ("tetrahedron", 2)])
def test_rotation(cell: str, order: int):
    """Two glued bodies turned together by 100 degrees, gaps between their facets and all.

    Requirement: distances of all nodes to 1e-11, no energy. Source: objectivity. Tolerance: Newton
    to 1e-12.
    """
    model = halves("curved", cell, (order, order), ((2, 2, 1), (3, 2, 1)))
    turn = Turn(axis=(1, 2, 3), angle_deg=100.0, point=(0.3, 1.0, 2.0))
    step = Step("turn", 3, rotation={"lo.bottom": turn})
    problem = solved(model, [step], RUBBER, ties=[UP])
    reference = model.space.tabulate_dof_coordinates()
    x = reference + problem.u.x.array.reshape(-1, 3)
    before, after = (np.linalg.norm(p[:, None] - p, axis=2) for p in (reference, x))
    assert np.abs(after - before).max() < 1e-11
    assert abs(problem.energies()["elastic"]) < 1e-11


@pytest.mark.parametrize(
    ("cell", "order"), [("hexahedron", 1), ("hexahedron", 2), ("tetrahedron", 2)]
)
def test_gaps_that_are_closed_leave_none(cell: str, order: int):
    """The upper half stands off by a wedge of 0.005 to 0.025; its nodes are moved onto the lower.

    Requirement: every gap is closed, and nothing is strained by it: the pulled cube has the uniform
    strain of the one that was drawn without gaps. Tolerance: rounding.
    """
    model = halves("flat", cell, (order, order))
    x = model.mesh.geometry.x
    own = np.unique(model.mesh.geometry.dofmaps[0][model.cells("up")])
    x[own, 2] += 2.0 * (1.0 - x[own, 2]) * (0.005 + 0.02 * x[own, 0])
    count, far = close_gaps(model, "up.bottom", "lo.top", 0.1)
    lower = on_bottom(model)
    assert count == {1: 5 * 4, 2: 9 * 7}[order]
    assert far == pytest.approx(0.025)
    assert x[lower, 2] == pytest.approx(0.5, abs=1e-12)
    assert pulled(model, ties=[UP]) < 1e-11
    assert close_gaps(model, "up.bottom", "lo.top", 0.1)[1] < 1e-12


def on_bottom(model: Model) -> np.ndarray:
    """Nodes of the geometry on the lower side of the upper half."""
    from anisocontact.base.fenicsx import dolfinx

    mesh = model.mesh
    mesh.topology.create_connectivity(2, 3)
    nodes = dolfinx.mesh.entities_to_geometry(mesh, 2, model.facets("up.bottom"), False)
    return np.isin(np.arange(len(mesh.geometry.x)), nodes)


def test_gaps_beyond_the_tolerance_stay():
    model = halves()
    own = np.unique(model.mesh.geometry.dofmaps[0][model.cells("up")])
    model.mesh.geometry.x[own, 2] += 0.02
    before = model.mesh.geometry.x.copy()
    assert close_gaps(model, "up.bottom", "lo.top", 0.01) == (0, 0.0)
    assert model.mesh.geometry.x == pytest.approx(before, abs=0.0)


def test_a_cell_that_would_be_flat_is_said():
    model = halves()
    x = model.mesh.geometry.x
    own = np.unique(model.mesh.geometry.dofmaps[0][model.cells("up")])
    x[own, 2] -= 0.3
    with pytest.raises(InputError, match=r"leaves a cell .* of its volume; tolerance is too large"):
        close_gaps(model, "up.bottom", "lo.top", 0.4)


def test_tangent():
    """Derivative of the residual at finite strain against central differences.

    Requirement: second order. Source: definition. Tolerance: of the order of few steps.
    """
    problem = Problem(halves("curved"), {"lo": RUBBER, "up": RUBBER}, ties=[UP], symmetry=PLANES)
    problem.begin(Step("pull", 1, traction={"up.top": {"z": 10.0}}))
    problem.set_load_factor(1.0, 1.0)
    x, direction = problem.new_vector(), problem.new_vector()
    rng = np.random.default_rng(0)
    x.array[:] = 0.02 * rng.standard_normal(problem.unknowns)
    direction.array[:] = rng.standard_normal(problem.unknowns)
    first, second = difference_errors(problem, x, direction, [2e-3, 1e-3])
    assert second < 1e-3
    assert 1.8 < np.log2(first / second) < 2.2


def tip(glued: bool, n: int, order: int) -> float:
    """Deflection of a cantilever under a shear traction, of one piece or cut along its length."""
    if glued:
        lo = BoxSpec((0, 0, 0), (8, 1, 0.5), (8 * n, 2 * n, n), order=order)
        up = BoxSpec((0, 0, 0.5), (8, 1, 0.5), (12 * n, 3 * n, n), order=order)
        boxes, ties = {"lo": lo, "up": up}, [UP]
    else:
        boxes = {"lo": BoxSpec((0, 0, 0), (8, 1, 1), (12 * n, 3 * n, 2 * n), order=order)}
        ties = []
    model = build_box(boxes)
    clamp = {f"{name}.left": dict.fromkeys("xyz", 0.0) for name in boxes}
    load = {f"{name}.right": {"z": 0.1} for name in boxes}
    problem = solved(model, [Step("bend", 1, clamp, traction=load)], ties=ties)
    x, u = model.space.tabulate_dof_coordinates(), problem.u.x.array.reshape(-1, 3)
    return float(u[np.isclose(x[:, 0], 8.0), 2].mean())


@pytest.mark.slow
def test_bending():
    """A cantilever cut along its length and glued against the uncut one, slave nodes clamped too.

    Requirement: trilinear cells converge with order 1.6 at least, quadratic ones are within 0.6 %.
    Source: the uncut beam of finer quadratic cells. Tolerance: its own trilinear cells have orders
    1.75 and 1.96, its quadratic ones 0.3 % on a mesh as coarse.
    """
    fine = tip(glued=False, n=2, order=2)
    assert tip(glued=True, n=1, order=2) == pytest.approx(fine, rel=6e-3)
    errors = [fine - tip(glued=True, n=n, order=1) for n in (1, 2, 4)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders[-1] > 1.6


def tube(n: int, order: int, tie: Tie) -> float:
    """Error of the displacement of the bore of a thick tube of two glued tubes, relative."""
    quarter = {"length": 0.2, "end_deg": 90.0, "order": order}
    a = make_shape("ring", inner=1.0, outer=1.5, cells=(2 * n, 4 * n, 1), **quarter)
    b = make_shape("ring", inner=1.5, outer=2.0, cells=(2 * n, 6 * n, 1), **quarter)
    model = build_mesh([Body("lo", a), Body("up", b)])
    planes = [
        f"{body}.{side}" for body in ("lo", "up") for side in ("start", "end", "top", "bottom")
    ]
    push = Step("push", 1, pressure={"lo.inner": 10.0})
    problem = solved(model, [push], symmetry=planes, ties=[tie])
    x, u = model.space.tabulate_dof_coordinates(), problem.u.x.array.reshape(-1, 3)
    radius = np.hypot(x[:, 0], x[:, 1])
    bore = np.isclose(radius, 1.0)
    radial = np.linalg.norm(u[bore, :2], axis=1)
    # Lame: u = (1 + nu)/E p a^2/(b^2 - a^2) ((1 - 2 nu) r + b^2/r) at r = a = 1, b = 2
    exact = (1.0 + NU) / E * 10.0 / 3.0 * (1.0 - 2.0 * NU + 4.0)
    return float(np.abs(radial / exact - 1.0).max())


@pytest.mark.parametrize("tie", [Tie("up.inner", "lo.outer"), Tie("lo.outer", "up.inner")])
def test_thick_tube(tie: Tie):
    """A tube under inner pressure of two tubes glued along a circle, cells 4 against 6 around.

    Requirement: straight cells with order 1.7 at least, curved ones of order 2 below 1e-3.
    Source: Lame. Tolerance: the largest error of coarse meshes.
    """
    first, second = (tube(n, 1, tie) for n in (1, 2))
    assert np.log2(first / second) > 1.7
    assert tube(1, 2, tie) < 1e-3


def dragged(strategy: str, material: Any) -> np.ndarray:
    """Reaction of two glued blocks that are pressed on a plane with friction and dragged."""
    model = build_box(
        {
            "lo": BoxSpec((0, 0, 0), (1, 1, 0.4), (4, 4, 2)),
            "up": BoxSpec((0, 0, 0.4), (1, 1, 0.4), (3, 3, 1)),
        }
    )
    laws = NormalLaw(penalty=1e4), Adhesion(stiffness=1e4), Friction(coefficients=0.3)
    plane = Interface(make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)), *laws)
    steps = [
        Step("press", 1, {"up.top": {"x": 0.0, "y": 0.0, "z": -0.01}}),
        Step("drag", 2, {"up.top": {"x": 0.06}}),
    ]
    contacts = [Contact(model, "lo.bottom", plane, mortar=False)]
    problem = solved(model, steps, material, contacts=contacts, ties=[DOWN], strategy=strategy)
    force = problem.reactions()["up.top"]
    assert np.hypot(*force[:2]) == pytest.approx(0.3 * abs(force[2]), rel=1e-3)
    return force


@pytest.mark.parametrize("material", [STEEL, RUBBER], ids=["linear", "finite"])
def test_strategies(material: Any):
    """Contact at one body, supports at the other, glue in between: all strategies agree.

    Requirement: forces to 1e-9, friction mu N to what still sticks. Source: the same equations.
    Tolerance: Newton to 1e-12.
    """
    direct, condensed, iterative = (
        dragged(strategy, material) for strategy in ("direct", "condensed", "iterative")
    )
    assert np.abs(condensed - direct).max() < 1e-9 * np.abs(direct).max()
    assert np.abs(iterative - direct).max() < 1e-9 * np.abs(direct).max()


def test_tied_body_on_a_reference_point():
    """A tied body whose outer face follows a rigid body under a moment.

    Requirement: the moment arrives at the support, 1e-8. Source: balance of moments.
    Tolerance: the solution.
    """
    model = halves()
    head = RigidBody("head", (0.5, 0.5, 1.0), free=True)
    face = CoupledFace("up.top", head)
    step = Step(
        "turn",
        1,
        {"lo.bottom": dict.fromkeys("xyz", 0.0)},
        motion={"head": dict.fromkeys(("x", "y", "z", "rx", "ry", "rz"))},
        load={"head": {"rz": 1.0, "z": 2.0}},
    )
    problem = solved(model, [step], ties=[UP], coupled=[face])
    force = problem.support_forces()
    arms = model.space.tabulate_dof_coordinates() - [0.5, 0.5, 0.0]
    held = np.isclose(arms[:, 2], 0.0)
    assert np.cross(arms[held], force[held]).sum(axis=0)[2] == pytest.approx(-1.0, rel=1e-8)
    assert problem.reactions()["lo.bottom"][2] == pytest.approx(-2.0, rel=1e-8)


@pytest.mark.parametrize("order", [1, 2])
def test_two_dimensions(order: int):
    """Blocks in plane strain, and a thick tube of two by its meridian, with meshes that differ.

    Requirement: uniform tension to 1e-10; the bore of the tube to 1 % and, of order 2, 1e-4.
    Source: Hooke; Lame. Tolerance: the solution; the error of four and six cells along the radius.
    """

    def pair(ideal: Any, start: float) -> Model:
        shapes = (
            make_shape("rectangle", origin=(start, 0), size=(0.5, 1), cells=(6, 4), order=order),
            make_shape(
                "rectangle", origin=(start + 0.5, 0), size=(0.5, 1), cells=(6, 6), order=order
            ),
        )
        bodies = [Body(name, shape) for name, shape in zip(("lo", "up"), shapes, strict=True)]
        return build_mesh(bodies, idealisation=ideal)

    tie = Tie("up.left", "lo.right")
    planes = ["lo.left", "lo.bottom", "up.bottom"]
    pull = Step("pull", 1, traction={"up.right": {"x": 10.0}})
    model = pair(PlaneStrain(thickness=1.0), 0.0)
    problem = solved(model, [pull], ties=[tie], symmetry=planes)
    x, u = model.space.tabulate_dof_coordinates(), problem.u.x.array.reshape(-1, 3)
    strain = (1.0 - NU**2) / E * 10.0
    exact = x * [strain, -NU / (1.0 - NU) * strain, 0.0]
    assert np.abs(u - exact).max() < 1e-10 * np.abs(u).max()
    model = pair(Axisymmetric(), 1.0)
    held = [f"{name}.{side}" for name in ("lo", "up") for side in ("bottom", "top")]
    push = Step("push", 1, pressure={"lo.left": 10.0})
    problem = solved(model, [push], ties=[tie], symmetry=held)
    x, u = model.space.tabulate_dof_coordinates(), problem.u.x.array.reshape(-1, 3)
    lame = (1.0 + NU) / E * 10.0 / 3.0 * (1.0 - 2.0 * NU + 4.0)
    assert u[np.isclose(x[:, 0], 1.0), 0] == pytest.approx(lame, rel=1e-2 if order == 1 else 1e-4)


SCRIPT = """
import numpy as np
from tests.verification.test_tie import RUBBER, dragged
from anisocontact.base.fenicsx import MPI
found = [dragged(strategy, RUBBER) for strategy in ("direct", "iterative")]
if MPI.COMM_WORLD.rank == 0:
    print(*map(repr, np.concatenate(found).tolist()))
"""


@pytest.mark.mpi
@pytest.mark.slow
def test_processes_change_nothing():
    """Glued blocks that are dragged, on one and on two processes.

    Requirement: forces to 1e-9. Source: the same equations. Tolerance: Newton to 1e-12.
    """
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    root = Path(__file__).parents[2]
    found = []
    for count in (1, 2):
        command = ["mpirun", "-n", str(count), sys.executable, "-c", SCRIPT]
        done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        found.append(np.array(done.stdout.split(), dtype=float))
    assert np.abs(found[0] - found[1]).max() < 1e-9 * np.abs(found[0]).max()
