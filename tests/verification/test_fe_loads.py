"""Loads and rotations against closed forms, and their tangents."""

import numpy as np
import pytest

CELLS = [("hexahedron", 1), ("hexahedron", 2), ("tetrahedron", 1), ("tetrahedron", 2)]
NOTHING = {"x": 0.0, "y": 0.0, "z": 0.0}


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


def problem_of(material, **bodies):
    """Bodies of one material."""
    from anisocontact.bulk import make_material
    from anisocontact.mesh import Body, build_mesh
    from anisocontact.solver import Problem

    model = build_mesh([Body(name, shape) for name, shape in bodies.items()])
    return Problem(model, {name: make_material(**material) for name in bodies})


def run(problem, *steps, **options):
    """All accepted increments."""
    from anisocontact.solver import Solver

    return list(Solver(problem, steps, options=options).run())


def bar(cell="hexahedron", order=1, nu=0.0):
    """A bar along z of length 2 on its lower end, E = 100."""
    from anisocontact.mesh import BoxSpec

    shape = BoxSpec((0, 0, 0), (1.0, 0.5, 2.0), (1, 1, 4), cell, order)
    return problem_of({"model": "linear-elastic", "E": 100.0, "nu": nu}, bar=shape)


@pytest.mark.parametrize(("cell", "order"), CELLS)
def test_bar_under_its_own_weight(cell, order):
    """A bar of length L hangs from its upper end under a force q per volume.

    Requirement: displacement -q (L^2 - z^2) / (2 E) at nodes, energy q^2 A L^3 / (6 E), reaction
    q A L. Source: u'' = q / E. Exact at order 2, which holds the parabola; at order 1 hexahedra
    are exact at nodes (Green's function is in the space), and the energy is short of it by the
    square of the cells, 1.6 % here. Tetrahedra of order 1 are not exact at nodes; of them energy
    and reaction are looked at. Tolerance: 1e-9, factorisation.
    """
    problem = bar(cell, order)
    from anisocontact.solver import Step

    weight = Step("hang", 2, {"bar.top": NOTHING}, body_force={"bar": {"z": -3.0}})
    last = run(problem, weight)[-1]
    z = problem.model.space.tabulate_dof_coordinates()[:, 2]
    exact = -3.0 * (4.0 - z**2) / 200.0
    error = np.abs(problem.u.x.array.reshape(-1, 3)[:, 2] - exact).max() / np.abs(exact).max()
    assert error < 1e-9 or (cell, order) == ("tetrahedron", 1)
    assert last.reactions["bar.top"] == pytest.approx([0.0, 0.0, 3.0], abs=1e-8)
    energy = 9.0 * 0.5 * 8.0 / 600.0
    assert last.energies["elastic"] == pytest.approx(energy, rel=1e-9 if order == 2 else 0.02)
    # Linear, two increments: the trapezoidal rule is exact.
    assert last.energies["residual"] == pytest.approx(0.0, abs=1e-9 * energy)


@pytest.mark.parametrize(("cell", "order"), CELLS)
def test_force_on_a_group_has_its_resultant(cell, order):
    """Requirement: a force on a facet group is a uniform traction with that resultant.

    Source: a bar under a force F along it is uniform, u = F z / (E A); held forces stay over a
    second step that gives another component. Tolerance: 1e-9, factorisation.
    """
    from anisocontact.solver import Step

    problem = bar(cell, order)
    pull = Step("pull", 1, {"bar.bottom": NOTHING}, force={"bar.top": {"z": 5.0}})
    last = run(problem, pull, Step("shear", 1, force={"bar.top": {"x": 0.1}}))[-1]
    assert last.reactions["bar.bottom"] == pytest.approx([-0.1, 0.0, -5.0], abs=1e-8)
    alone = bar(cell, order)
    run(alone, pull)
    z = alone.model.space.tabulate_dof_coordinates()[:, 2]
    found = alone.u.x.array.reshape(-1, 3)[:, 2]
    assert np.abs(found - 5.0 * z / 50.0).max() < 1e-9 * 0.2


def cylinder_under_pressure(cells, order, cell="hexahedron"):
    """Quarter of a thick cylinder, a = 1, b = 2, E = 1000, nu = 0.3, plane strain, p = 10."""
    from anisocontact.mesh import RingSpec
    from anisocontact.solver import Step

    quarter = RingSpec(1.0, 2.0, 0.25, (cells, cells, 1), cell, order, end=np.pi / 2)
    problem = problem_of({"model": "linear-elastic", "E": 1000.0, "nu": 0.3}, tube=quarter)
    planes = {"tube.start": {"y": 0.0}, "tube.end": {"x": 0.0}}
    planes |= {"tube.bottom": {"z": 0.0}, "tube.top": {"z": 0.0}}
    run(problem, Step("press", 1, planes, pressure={"tube.inner": 10.0}))
    return problem


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
@pytest.mark.parametrize("order", [1, 2])
def test_thick_cylinder_converges_to_lame(order, cell):
    """Requirement: pressure on a curved face; errors fall with the order of the elements.

    Source: Lame. The mean square error of the displacement falls with h^(order + 1); asked is 0.9
    of that rate between 4 and 8 cells through the wall, where linear tetrahedra are still stiff.
    """
    errors = [displacement_error(cylinder_under_pressure(n, order, cell)) for n in (4, 8)]
    assert np.log2(errors[0] / errors[1]) > 0.9 * (order + 1)
    assert errors[1] < {1: 0.02, 2: 2e-4}[order]


def displacement_error(problem):
    """Root of the mean square of the error over that of the displacement."""
    from anisocontact.base.fenicsx import fem, ufl

    x = ufl.SpatialCoordinate(problem.model.mesh)
    square = x[0] ** 2 + x[1] ** 2
    # u = (1 + nu) p a^2 / (E (b^2 - a^2)) ((1 - 2 nu) r + b^2 / r)
    factor = 1.3 * 10.0 / 3000.0 * (0.4 + 4.0 / square)
    exact = ufl.as_vector([factor * x[0], factor * x[1], 0.0])
    off = problem.u - exact
    parts = [ufl.inner(off, off), ufl.inner(exact, exact)]
    return np.sqrt(np.divide(*(fem.assemble_scalar(fem.form(p * ufl.dx(degree=8))) for p in parts)))


def soft(shape):
    """A body at finite strain."""
    return problem_of({"model": "neo-hookean", "E": 10.0, "nu": 0.3}, body=shape)


def shapes(cell, order):
    """A curved and a straight body."""
    from anisocontact.mesh import BoxSpec, RingSpec

    sector = RingSpec(1.0, 2.0, 1.0, (1, 2, 1), cell, order, end=np.pi / 2)
    return [("outer", sector), ("top", BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 1), cell, order))]


@pytest.mark.parametrize(("cell", "order"), CELLS)
def test_tangent_of_a_pressure_that_follows(fe, cell, order):
    """Halving the step quarters the error of the central difference against the tangent.

    Requirement: exact tangent of pressures at finite strain. Source: Taylor. Tolerance: the ratio
    of two errors is 4 (1 + O(h^2)); 0.15. The load is so large that its part counts.
    """
    from anisocontact.solver import Step

    rng = np.random.default_rng(3)
    for group, shape in shapes(cell, order):
        problem = soft(shape)
        problem.begin(Step("press", 1, {"body.bottom": NOTHING}, pressure={f"body.{group}": 30.0}))
        problem.set_load_factor(1.0, 1.0)
        errors = fe.tangent_errors(problem, rng, 0.02)
        assert np.all(np.abs(errors[:-1] / errors[1:] - 4.0) < 0.15)
        assert errors[-1] < 1e-5


def enclosed_volume(problem, group):
    """Integral of x . n / 3 over a facet group in the deformed configuration, by UFL."""
    from anisocontact.base.fenicsx import fem, ufl

    model, u = problem.model, problem.u
    sides = fem.compute_integration_domains(
        fem.IntegralType.exterior_facet, model.mesh.topology, model.facets(group)
    )
    ds = ufl.Measure("ds", domain=model.mesh, subdomain_data=[(1, sides)])
    F = ufl.Identity(3) + ufl.grad(u)
    area = ufl.cofac(F).T * ufl.FacetNormal(model.mesh)
    x = ufl.SpatialCoordinate(model.mesh) + u
    return fem.assemble_scalar(fem.form(ufl.inner(x, area) / 3.0 * ds(1)))


@pytest.mark.parametrize("order", [1, 2])
def test_work_of_a_pressure_is_pressure_times_volume(order):
    """A soft ball under a pressure all around.

    Requirement: work `integral of p dV` of the volume that is left, and the energy of the body.
    Source: thermodynamics of a fluid around a body; the volume by UFL with Nanson's formula.
    Tolerance: the trapezoidal rule over 20 increments of a smooth curve, second order, 1e-3; the
    balance of energies shares it.
    """
    from anisocontact.mesh import BallSpec
    from anisocontact.solver import Solver, Step

    ball = BallSpec(1.0, (8, 1), "eighth", order=order)
    problem = soft(ball)
    planes = {"body.left": {"x": 0.0}, "body.front": {"y": 0.0}, "body.top": {"z": 0.0}}
    volumes = [enclosed_volume(problem, "body.outer")]
    step = Step("press", 20, planes, pressure={"body.outer": 8.0})
    energies = {}
    for accepted in Solver(problem, [step]).run():
        energies = accepted.energies
        volumes.append(enclosed_volume(problem, "body.outer"))
    pressures = np.linspace(0.0, 8.0, 21)
    work = -np.sum(0.5 * (pressures[1:] + pressures[:-1]) * np.diff(volumes))
    assert volumes[-1] < 0.7 * volumes[0]
    assert energies["external"] == pytest.approx(work, rel=1e-3)
    assert energies["elastic"] == pytest.approx(work, rel=1e-3)


@pytest.mark.parametrize("finite", [False, True], ids=["linear", "finite"])
def test_pressure_follows_only_at_finite_strain(finite):
    """A body turned as a whole under pressure on one face, at small strain by no more than it may.

    Requirement: at finite strain the reaction turns with the body, at small strain it does not.
    Source: `-p n A` of the face, stiff enough for its area to stay. Tolerance: 1e-4, p / E.
    """
    from anisocontact.mesh import BoxSpec
    from anisocontact.solver import Step, Turn

    model, angle = ("neo-hookean", 90.0) if finite else ("linear-elastic", 4.0)
    box = BoxSpec((0, 0, 0), (1.0, 1.0, 1.0), (1, 1, 1))
    problem = problem_of({"model": model, "E": 1e5, "nu": 0.0}, body=box)
    turn = Turn((0, 1, 0), np.radians(angle), point=(0.5, 0.5, 0.0))
    step = Step("turn", 9, rotation={"body.bottom": turn}, pressure={"body.top": 3.0})
    last = run(problem, step)[-1]
    # The face is turned from z to x.
    exact = [3.0, 0.0, 0.0] if finite else [0.0, 0.0, 3.0]
    assert last.reactions["body.bottom"] == pytest.approx(exact, abs=1e-3)


@pytest.mark.parametrize("order", [1, 2])
def test_a_group_is_led_along_a_circle(order):
    """Both ends of a body are turned by 3 x 90 degrees, the last time while the axis moves.

    Requirement: nodes of the group follow the rotation at every increment, the body is not
    strained, and what is not named is held where the turn ended. Source: rotation of rigid bodies;
    Newton to 1e-10.
    """
    from anisocontact.mesh import CylinderSpec
    from anisocontact.solver import Solver, Step, Turn

    problem = soft(CylinderSpec(1.0, 1.0, (8, 1, 1), order=order))
    axis = (0.0, 1.0, 2.0)
    steps = []
    for k, move in enumerate([(0, 0, 0), (0, 0, 0), (3.0, 0, 0)]):
        turn = Turn(axis, np.pi / 2, point=(1.0, 0.0, 0.5), move=move)
        steps.append(
            Step(f"turn {k}", 6, rotation=dict.fromkeys(["body.bottom", "body.top"], turn))
        )
    steps.append(Step("rest", 1))
    x = problem.model.space.tabulate_dof_coordinates()
    turned = 0.0
    for accepted in Solver(problem, steps, options={"snes_rtol": 1e-10}).run():
        if accepted.step_index < 3:
            turned = accepted.step_index + accepted.increment / 6
        n = np.array(axis) / np.linalg.norm(axis)
        arm = x - np.array([1.0, 0.0, 0.5])
        c, s = np.cos(turned * np.pi / 2), np.sin(turned * np.pi / 2)
        along = np.outer(arm @ n, n)
        exact = arm * c + np.cross(n, arm) * s + along * (1.0 - c) - arm
        exact[:, 0] += 3.0 * max(turned - 2.0, 0.0)
        found = problem.u.x.array.reshape(-1, 3)
        assert np.abs(found - exact).max() < 1e-7
    assert accepted.step == "rest"
    assert abs(accepted.energies["elastic"]) < 1e-10
