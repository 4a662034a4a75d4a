"""Displacements led along cylindrical directions: the tube of Lame, turns, releases, sectors."""

import numpy as np
import pytest

from anisocontact.base.errors import InputError

INNER, OUTER, HEIGHT, LED = 1.0, 2.0, 0.25, 0.01
E, NU = 1000.0, 0.3
SHEAR, LAME = E / 2.0 / (1.0 + NU), E * NU / (1.0 + NU) / (1.0 - 2.0 * NU)


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


def ring(cells=(4, 8, 1), angles=(0.0, 90.0), order=2, planes=("start", "end"), **held):
    """A sector of a tube between symmetry planes; of 360 degrees the whole."""
    from anisocontact.bulk import make_material
    from anisocontact.mesh import Body, Placement, RingSpec, build_mesh
    from anisocontact.solver import Problem

    start, end = np.radians(angles)
    whole = {} if angles[1] - angles[0] == 360.0 else {"start": start, "end": end}
    shape = RingSpec(INNER, OUTER, HEIGHT, cells, order=order, **whole)
    model = build_mesh([Body("ring", shape, held.pop("placement", Placement()))])
    material = held.pop("material", make_material("linear-elastic", E=E, nu=NU))
    ends = [f"ring.{name}" for name in (*planes, "bottom", "top")]
    return Problem(model, {"ring": material}, symmetry=ends, **held)


def run(problem, *steps, **options):
    """The last accepted increment."""
    from anisocontact.solver import Solver

    return list(Solver(problem, steps, **options).run())[-1]


def led(**values):
    """Radial, tangential and axial displacements about z, or `axis` and `point`."""
    from anisocontact.solver import Cylindrical

    place = {key: values.pop(key) for key in ("axis", "point") if key in values}
    return Cylindrical(values, **place)


def lame(radius):
    """Radial displacement of a tube, LED at the inner face, none at the outer, plane strain."""
    b = LED / (1.0 / INNER - INNER / OUTER**2)
    return b / radius - b * radius / OUTER**2


def error(problem, exact=lame):
    """Largest difference from a radial displacement, over LED."""
    x = problem.model.space.tabulate_dof_coordinates()
    radius = np.hypot(x[:, 0], x[:, 1])
    away = x * [1.0, 1.0, 0.0] / radius[:, None]
    return np.abs(problem.u.x.array.reshape(-1, 3) - exact(radius)[:, None] * away).max() / LED


PRESS = {"ring.inner": {"radial": LED}, "ring.outer": {"radial": 0.0}}


def press(increments=1, **outer):
    """The inner face is led outwards, the outer one held; the tangential is free, or `outer`."""
    from anisocontact.solver import Step

    given = PRESS | {"ring.outer": PRESS["ring.outer"] | outer}
    return Step("press", increments, cylindrical={k: led(**v) for k, v in given.items()})


@pytest.mark.parametrize(("order", "rate"), [(1, 1.85), (2, 2.85)])
def test_ring_pressed_radially_is_lames(order, rate):
    """A quarter of a tube, radial displacement alone given, tangential ones free.

    Requirement: the displacement of Lame, at the rate of the elements, and the energy that the
    radial forces put in. Source: closed form. Tolerance: orders p + 1 = 2 and 3 of interpolation in
    the largest norm, less 0.15 that coarse meshes leave of it; the energy at 2 p, from below.
    """
    errors, energies = [], []
    for n in (4, 8, 16):
        problem = ring((n, 2 * n, 1), order=order)
        last = run(problem, press(2))
        errors.append(error(problem))
        energies.append(last.energies["external"])
        assert last.energies["residual"] == pytest.approx(0.0, abs=1e-9 * energies[-1])
    assert np.log2(np.array(errors[:-1]) / errors[1:]).min() > rate
    # p = -sigma_r at the inner face, of u = a r + b / r
    b = LED / (1.0 / INNER - INNER / OUTER**2)
    pressure = 2.0 * (LAME + SHEAR) * b / OUTER**2 + 2.0 * SHEAR * b / INNER**2
    stored = 0.5 * pressure * LED * 0.5 * np.pi * INNER * HEIGHT
    assert energies[-1] == pytest.approx(stored, rel=2e-5 if order == 2 else 5e-3)


@pytest.mark.parametrize("angles", [(0.0, 360.0), (20.0, 65.0), (100.0, 190.0)])
def test_any_sector_and_the_whole(angles):
    """Sectors whose cut faces lie askew, their edges in planes and led radially, and all of it.

    Requirement: the displacement of Lame, forces of the faces of the sector as of the closed form.
    Source: closed form. Tolerance: 4 quadratic cells through the wall, 5e-4 of the displacement
    led, twice what the quarter has; 2e-3 for forces, which are of the stresses.
    """
    whole = angles[1] - angles[0] == 360.0
    planes = () if whole else ("start", "end")
    problem = ring((4, 32 if whole else 6, 1), angles, planes=planes)
    # something has to keep the whole from turning
    step = press(tangential=0.0) if whole else press()
    last = run(problem, step)
    assert error(problem) < 5e-4
    b = LED / (1.0 / INNER - INNER / OUTER**2)
    traction = 2.0 * (LAME + SHEAR) * b / OUTER**2 + 2.0 * SHEAR * b / INNER**2
    first, then = np.radians(angles)
    resultant = [np.sin(then) - np.sin(first), np.cos(first) - np.cos(then), 0.0]
    force = traction * INNER * HEIGHT * np.array(resultant)
    # at the edges planes and face share the force on a node, each along its own directions
    assert np.abs(last.reactions["ring.inner"] - force).max() < 2e-3 * traction * INNER * HEIGHT


def test_any_axis():
    """The quarter turned at random and moved, with the axis turned and moved alike.

    Requirement: the displacements turn with it. Source: invariance. Tolerance: 1e-9,
    factorisation, of the displacement led.
    """
    from anisocontact.mesh import Placement, Rotation
    from anisocontact.solver import Step

    turn, move = Rotation((1.0, -2.0, 0.7), 1.1), (3.0, 2.0, 1.0)
    matrix = turn.apply(np.eye(3)).T
    place = {"axis": 2.0 * matrix[:, 2], "point": np.add(move, 0.4 * matrix[:, 2])}
    straight, turned = ring(), ring(placement=Placement(rotate=turn, move=move))
    run(straight, press())
    run(turned, Step("press", 1, cylindrical={k: led(**v, **place) for k, v in PRESS.items()}))
    ours, theirs = (p.u.x.array.reshape(-1, 3) for p in (straight, turned))
    assert np.abs(theirs - ours @ matrix.T).max() < 1e-9 * LED


def test_twist_of_a_tube():
    """The outer face is turned by a tangential displacement, the inner one held altogether.

    Requirement: u_t = c (r - 1 / r) in plane strain, and the moment 4 pi G c a^2 h that is put in,
    which is in the energy. Source: closed form. Tolerance: 5e-4 of what is led, as above.
    """
    from anisocontact.solver import Step

    problem = ring((4, 32, 1), (0.0, 360.0), planes=())
    step = Step(
        "twist",
        1,
        cylindrical={
            "ring.outer": led(tangential=LED, radial=0.0),
            "ring.inner": led(radial=0.0, tangential=0.0),
        },
    )
    last = run(problem, step)
    x = problem.model.space.tabulate_dof_coordinates()
    radius = np.hypot(x[:, 0], x[:, 1])
    c = LED / (OUTER - INNER**2 / OUTER)
    across = np.stack([-x[:, 1], x[:, 0], 0.0 * radius], axis=1) / radius[:, None]
    exact = (c * (radius - INNER**2 / radius))[:, None] * across
    assert np.abs(problem.u.x.array.reshape(-1, 3) - exact).max() < 5e-4 * LED
    moment = 4.0 * np.pi * SHEAR * c * INNER**2 * HEIGHT
    assert last.energies["external"] == pytest.approx(0.5 * moment * LED / OUTER, rel=1e-3)


def test_held_then_freed():
    """The radial support of the inner face is let go after it was led, and the ring springs back.

    Requirement: half of the step along, half of the force is left, so half of the displacement of
    all; at the end nothing. Source: linearity. Tolerance: 1e-8, factorisation.
    """
    from anisocontact.solver import Solver, Step

    problem = ring()
    free = Step("free", 2, cylindrical={"ring.inner": led(radial=None)})
    solver = Solver(problem, [press(), free])
    found = [problem.u.x.array.copy() for _ in solver.run()]
    full, half, end = found
    assert np.abs(full).max() > 0.9 * LED
    assert np.abs(half - 0.5 * full).max() < 1e-8 * LED
    assert np.abs(end).max() < 1e-8 * LED
    assert "ring.inner" not in problem.reactions()


def test_what_is_not_named_stays_and_other_supports_take_over():
    """All three components are held, then one is led, then a displacement along x takes over.

    Requirement: nodes are where the steps have them: those not named stay, those of the group that
    a displacement names are its own. Source: definition. Tolerance: 1e-12.
    """
    from anisocontact.solver import Step

    problem = ring(planes=())
    hold = Step("hold", 1, cylindrical={"ring.inner": led(radial=0.0, tangential=0.0, axial=0.0)})
    lead = Step("lead", 2, cylindrical={"ring.inner": led(radial=LED)})
    run(problem, hold, lead)
    nodes = problem.model.nodes("ring.inner")
    x = problem.model.space.tabulate_dof_coordinates()[nodes]
    away = x * [1.0, 1.0, 0.0] / np.hypot(x[:, 0], x[:, 1])[:, None]
    assert np.abs(problem.u.x.array.reshape(-1, 3)[nodes] - LED * away).max() < 1e-12
    problem = ring(planes=())
    drag = Step("drag", 2, {"ring.inner": {"x": LED, "y": 0.0}})
    run(problem, hold, drag)
    found = problem.u.x.array.reshape(-1, 3)[nodes]
    assert np.abs(found - [LED, 0.0, 0.0]).max() < 1e-12


def test_amplitude_and_finite_strain():
    """A rubber ring whose inner face follows an amplitude, opened to half as much again.

    Requirement: nodes of the face are at R + u of the amplitude, and the energy is balanced at the
    order 2 of the trapezoidal rule. Source: definition and energy. Tolerance: 1e-12; a rate of 1.9.
    """
    from anisocontact.bulk import make_material
    from anisocontact.solver import LoadCurve, Step

    grow = LoadCurve(lambda t: 0.5 * t**2)
    left = []
    for increments in (8, 16):
        problem = ring((3, 6, 1), material=make_material("neo-hookean", E=E, nu=NU))
        lead = {"ring.inner": led(radial=grow)}
        left.append(run(problem, Step("open", increments, cylindrical=lead)).energies["residual"])
    nodes = problem.model.nodes("ring.inner")
    x = problem.model.space.tabulate_dof_coordinates()[nodes]
    found = np.hypot(*(x + problem.u.x.array.reshape(-1, 3)[nodes])[:, :2].T)
    assert np.abs(found - np.hypot(x[:, 0], x[:, 1]) - 0.5).max() < 1e-12
    assert np.log2(left[0] / left[1]) > 1.9


def test_sector_with_cyclic_symmetry():
    """A sixth of the ring whose cut faces follow each other, led radially and twisted.

    Requirement: the whole ring. Source: the same with all of it; slave nodes have what is led from
    the master. Tolerance: 1e-9, the meshes are the same.
    """
    from anisocontact.solver import CyclicSymmetry, Step

    given = {"ring.inner": led(radial=LED), "ring.outer": led(radial=0.0, tangential=LED)}
    step = Step("press", 1, cylindrical=given)
    whole = ring((3, 24, 1), (0.0, 360.0), planes=())
    sector = ring(
        (3, 4, 1), (0.0, 60.0), planes=(), cyclic=[CyclicSymmetry("ring.start", "ring.end", 6)]
    )
    energies = [run(problem, step).energies["elastic"] for problem in (whole, sector)]
    assert 6.0 * energies[1] == pytest.approx(energies[0], rel=1e-9)
    x = [problem.model.space.tabulate_dof_coordinates() for problem in (whole, sector)]
    apart = np.linalg.norm(x[1][:, None] - x[0][None], axis=2)
    u = [problem.u.x.array.reshape(-1, 3) for problem in (whole, sector)]
    assert np.abs(u[1] - u[0][apart.argmin(axis=1)]).max() < 1e-9 * LED


@pytest.mark.parametrize("strategy", ["iterative"])
def test_other_strategies(strategy):
    """The quarter, by Krylov iterations.

    Requirement: the same displacements. Source: the direct strategy. Tolerance: 1e-7, tenfold
    that of the iterations.
    """
    found = []
    for way in ("direct", strategy):
        problem = ring()
        run(problem, press(), strategy=way, options={"snes_rtol": 1e-10})
        found.append(problem.u.x.array.copy())
    assert np.abs(found[1] - found[0]).max() < 1e-7 * LED


def test_mistakes_are_one_line():
    """Contradictions and axes through the nodes are refused before anything is solved.

    Requirement: one line that names step and group. Source: the rule for users' mistakes.
    """
    from anisocontact.solver import CyclicSymmetry, Step

    with pytest.raises(InputError, match=r"no component 'r', allowed: radial, tangential, axial"):
        led(r=1.0)
    with pytest.raises(InputError, match=r"axis: .*must not be zero"):
        led(radial=1.0, axis=(0, 0, 0))
    both = {"ring.inner": {"x": 0.0}}
    with pytest.raises(InputError, match=r"given with a displacement of the same group"):
        Step("press", 1, both, cylindrical={"ring.inner": led(radial=0.0)})
    wrong = {"ring.inner": led(radial=LED), "ring.bottom": led(radial=0.0)}
    problem = ring()
    with pytest.raises(InputError, match=r"cylindrical: .*different displacements.*radial"):
        problem.check([Step("press", 1, cylindrical=wrong)])
    out = {"ring.start": led(tangential=LED)}
    with pytest.raises(InputError, match=r"symmetry plane 'ring.start'|different displacements"):
        problem.check([Step("press", 1, cylindrical=out)])
    on = {"ring.inner": led(radial=LED, point=(INNER, 0.0, 0.0))}
    with pytest.raises(InputError, match=r"nodes of 'ring.inner' are on the axis"):
        problem.check([Step("press", 1, cylindrical=on)])
    sector = ring(
        angles=(0.0, 60.0), planes=(), cyclic=[CyclicSymmetry("ring.start", "ring.end", 6)]
    )
    beside = {"ring.inner": led(radial=LED, point=(0.1, 0.0, 0.0))}
    with pytest.raises(InputError, match=r"cut faces of cyclic\[0\] need the axis of that"):
        sector.check([Step("press", 1, cylindrical=beside)])


def test_in_a_case_file(tmp_path, monkeypatch):
    """The quarter as a case file, and what is wrong in it.

    Requirement: the displacement of the same in Python; mistakes are one line with their place.
    Source: the script. Tolerance: 1e-12.
    """
    from pathlib import Path

    from anisocontact.case import load
    from anisocontact.case.build import build

    monkeypatch.chdir(tmp_path)
    case = """
symmetry = ["ring.start", "ring.end", "ring.bottom", "ring.top"]
[mesh.ring.ring]
inner = 1
outer = 2
length = 0.25
start_deg = 0
end_deg = 90
cells = [4, 8, 1]
order = 2
[material.ring]
model = "linear-elastic"
E = 1000
nu = 0.3
[amplitude.up]
kind = "ramp"
start = 0
end = 1
[[step]]
name = "press"
increments = 1
cylindrical = { "ring.inner" = { radial = VALUE }, "ring.outer" = { radial = 0 } }
"""
    Path("case.toml").write_text(case.replace("VALUE", '{ value = 0.01, amplitude = "up" }'))
    built = build(load("case.toml"))
    list(built.solver.run())
    script = ring()
    run(script, press())
    assert np.abs(built.problem.u.x.array - script.u.x.array).max() < 1e-12
    for wrong, said in (
        ("0.01, axis = [0, 0, 0]", "must not be zero"),
        ('{ value = 1, amplitude = "down" }', "no such amplitude"),
        ('"fre"', "free"),
    ):
        Path("case.toml").write_text(case.replace("VALUE", wrong))
        with pytest.raises(InputError, match=said):
            build(load("case.toml"))


def test_a_tube_is_slid_along_a_shaft_that_alone_keeps_it_from_turning():
    """By more than a facet, led at its outer face; what is tangential is left to friction.

    Requirement: it is not taken for a body that was thrown off, and slides everywhere. Source:
    Coulomb: along the shaft friction times the pressure, whatever that is. Tolerance: 1e-6, that
    of the axial direction of slip.
    """
    from anisocontact.bulk import make_material
    from anisocontact.contact import Contact
    from anisocontact.laws import Friction
    from anisocontact.mesh import Body, build_mesh, make_shape
    from anisocontact.solver import Problem, Step
    from anisocontact.surfaces import make_surface

    tube = make_shape("ring", inner=10, outer=14, length=6, cells=(1, 16, 4))
    model = build_mesh([Body("tube", tube)])
    shaft = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=10)
    contact = Contact(model, "tube.inner", shaft, Friction(coefficients=0.2))
    steel = {"tube": make_material("linear-elastic", E=E, nu=NU)}
    slide = Step("slide", 1, cylindrical={"tube.outer": led(radial=-0.02, axial=-6.0)})
    accepted = run(Problem(model, steel, [contact]), slide)
    assert contact.slave_points.size < 6.0, "by more than a facet"
    normal = contact.last.pressure @ contact.areas
    assert normal > 1000.0
    assert accepted.resultants["tube.inner"][0] == pytest.approx(
        [0, 0, 0.2 * normal], rel=1e-6, abs=1e-6
    )
