"""Elastic supports, springs and symmetry planes against closed forms, and their tangents."""

import numpy as np
import pytest

CELLS = [("hexahedron", 1), ("hexahedron", 2), ("tetrahedron", 1), ("tetrahedron", 2)]
NOTHING = {"x": 0.0, "y": 0.0, "z": 0.0}
LINEAR = {"model": "linear-elastic", "E": 100.0, "nu": 0.3}


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


def make(bodies, material=LINEAR, contacts=(), **held):
    """Bodies of one material."""
    from anisocontact.bulk import make_material
    from anisocontact.mesh import build_mesh
    from anisocontact.solver import Problem

    model = build_mesh(bodies)
    materials = {name: make_material(**material) for name in model.body_names()}
    return Problem(model, materials, [make(model) for make in contacts], **held)


def run(problem, *steps, **options):
    """The last accepted increment."""
    from anisocontact.solver import Solver

    return list(Solver(problem, steps, options=options).run())[-1]


def bar(name, cell="hexahedron", order=1, **place):
    """A bar along z, length 2, area 0.5; with E = 100 its stiffness is 25."""
    from anisocontact.mesh import Body, BoxSpec, Placement

    shape = BoxSpec((0, 0, 0), (1.0, 0.5, 2.0), (1, 1, 2), cell, order)
    return Body(name, shape, Placement(**place))


@pytest.mark.parametrize(("cell", "order"), CELLS)
def test_bar_and_spring_in_series(cell, order):
    """The far end of a spring on a bar is moved by d.

    Requirement: force d / (1/k + L/(E A)), energies of both, work at the anchor. Source: series of
    springs; the traction is uniform, which every element holds. Tolerance: 1e-9, factorisation.
    """
    from anisocontact.solver import Spring, Step

    spring = Spring("pull", "bar.top", (0.0, 0.0, 10.0))
    slim = LINEAR | {"nu": 0.0}
    problem = make([bar("bar", cell, order)], slim, attached=[spring])
    step = Step("pull", 3, {"bar.bottom": NOTHING}, anchor={"pull": {"z": 0.7}})
    last = run(problem, step)
    force = 0.7 / (1 / 10 + 1 / 25)
    assert last.reactions["pull"] == pytest.approx([0, 0, force], rel=1e-9)
    assert last.reactions["bar.bottom"] == pytest.approx([0, 0, -force], abs=1e-9)
    assert last.energies["springs"] == pytest.approx(force**2 / 20, rel=1e-9)
    assert last.energies["elastic"] == pytest.approx(force**2 / 50, rel=1e-9)
    assert last.energies["external"] == pytest.approx(0.5 * force * 0.7, rel=1e-9)
    assert abs(last.energies["residual"]) < 1e-9 * force


def test_spring_between_two_bars():
    """Two bars, the spring between them: all three in series.

    Requirement and source as above; the bars are 5 apart and share nothing but the spring.
    """
    from anisocontact.solver import Spring, Step

    between = Spring("link", "upper.bottom", (3.0, 3.0, 10.0), to="lower.top")
    bars = [bar("lower"), bar("upper", move=(0.0, 0.0, 7.0))]
    problem = make(bars, LINEAR | {"nu": 0.0}, attached=[between])
    ends = {"lower.bottom": NOTHING, "upper.top": NOTHING | {"z": 0.9}}
    last = run(problem, Step("pull", 1, ends))
    force = 0.9 / (1 / 10 + 2 / 25)
    assert last.reactions["upper.top"] == pytest.approx([0, 0, force], abs=1e-9)
    assert last.reactions["lower.bottom"] == pytest.approx([0, 0, -force], abs=1e-9)
    assert last.reactions["link"] == pytest.approx([0, 0, -force], abs=1e-9)


@pytest.mark.parametrize(("cell", "order"), CELLS)
def test_block_on_an_elastic_support(cell, order):
    """A stiff block under a pressure p on its top and a force along its bed.

    Requirement: u_z = -p / k_n, u_x = F / (k_t A) on two beds, reactions and energy. Source:
    springs in parallel. Tolerance: 1e-5, the block is 1e7 times stiffer than its bed.
    """
    from anisocontact.solver import ElasticSupport, Step

    beds = [ElasticSupport("bar.bottom", 20.0, 5.0), ElasticSupport("bar.top", 0.0, 5.0)]
    problem = make([bar("bar", cell, order)], LINEAR | {"E": 1e8}, attached=beds)
    load = Step("press", 2, pressure={"bar.top": 3.0}, body_force={"bar": {"x": 0.2}})
    last = run(problem, load)
    u = problem.u.x.array.reshape(-1, 3)
    assert np.abs(u - [0.2 / 5.0, 0.0, -3.0 / 20.0]).max() < 1e-5 * 0.15
    assert last.reactions["bar.bottom"] == pytest.approx([-0.1, 0, 1.5], abs=1e-5)
    stored = 0.5 * 20.0 * 0.5 * 0.15**2 + 0.5 * 10.0 * 0.5 * 0.04**2
    assert last.energies["springs"] == pytest.approx(stored, rel=1e-5)
    assert abs(last.energies["residual"]) < 1e-5 * stored


def tube(angles, order=2, **held):
    """Sector of a thick tube, a = 1, b = 2, height 0.25, by symmetry planes alone."""
    from anisocontact.mesh import Body, RingSpec

    start, end = np.radians(angles)
    sector = RingSpec(1.0, 2.0, 0.25, (6, 6, 1), order=order, start=start, end=end)
    planes = [f"tube.{side}" for side in ("start", "end", "bottom", "top")]
    return make([Body("tube", sector)], symmetry=planes, **held)


def radial_solution(bed):
    """A and B of u = A r + B / r under a pressure 10 inside and a bed k outside, plane strain.

    sigma_r = 2 (lambda + G) A - 2 G B / r^2; at r = 1 it is -10, at r = 2 it is -k u.
    """
    shear, lame = 100.0 / 2.6, 100.0 * 0.3 / (1.3 * 0.4)
    inside = [2.0 * (lame + shear), -2.0 * shear]
    outside = [2.0 * (lame + shear) + 2.0 * bed, -shear / 2.0 + bed / 2.0]
    return np.linalg.solve([inside, outside], [-10.0, 0.0])


@pytest.mark.parametrize("angles", [(0, 90), (20, 65), (100, 190)])
@pytest.mark.parametrize("bed", [0.0, 150.0])
def test_tube_between_oblique_planes(angles, bed):
    """A sector of a tube between planes of any direction, on an elastic support.

    Requirement: the solution of the whole tube, and forces across the planes that balance the
    pressure. Source: Lame with a bed. Tolerance: the error of 6 quadratic cells through the wall,
    which is below 2e-4 of the largest displacement; forces 1e-3.
    """
    from anisocontact.solver import ElasticSupport, Step

    attached = [ElasticSupport("tube.outer", bed)] if bed else []
    problem = tube(angles, attached=attached)
    last = run(problem, Step("press", 1, pressure={"tube.inner": 10.0}))
    x = problem.model.space.tabulate_dof_coordinates()
    radius = np.hypot(x[:, 0], x[:, 1])
    a, b = radial_solution(bed)
    exact = (a + b / radius**2)[:, None] * (x * [1, 1, 0])
    found = problem.u.x.array.reshape(-1, 3)
    assert np.abs(found - exact).max() < 2e-4 * np.abs(exact).max()
    # Of the hoop stress 2 (lambda + G) A + 2 G B / r^2 through the wall.
    shear, lame = 100.0 / 2.6, 100.0 * 0.3 / (1.3 * 0.4)
    hoop = 0.25 * (2.0 * (lame + shear) * a + 2.0 * shear * b * 0.5)
    for side, angle, sign in (("start", angles[0], -1.0), ("end", angles[1], 1.0)):
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        normal = sign * np.array([-s, c, 0.0])
        error = last.reactions[f"tube.{side}"] - hoop * normal
        assert np.linalg.norm(error) < 1e-3 * abs(hoop) + 1e-4


@pytest.mark.parametrize(("cell", "order"), CELLS)
def test_planes_turn_with_the_problem(cell, order):
    """A block between three planes, then all of it turned at random.

    Requirement: displacements and forces turn with it; corners lie in three oblique planes.
    Source: invariance. Tolerance: 1e-9, factorisation. The block as it stands is compared with
    prescribed components, to which planes along the axes are the same.
    """
    from anisocontact.mesh import Rotation
    from anisocontact.solver import Step

    planes = ["bar.left", "bar.front", "bar.bottom"]
    press = {"bar.top": 3.0, "bar.right": 1.0}
    turn = Rotation((1.0, -2.0, 0.7), 1.1)
    straight, turned = (
        make([bar("bar", cell, order, **place)], symmetry=planes)
        for place in ({}, {"rotate": turn, "move": (3.0, 2.0, 1.0)})
    )
    fixed = make([bar("bar", cell, order)])
    axes = {"bar.left": {"x": 0.0}, "bar.front": {"y": 0.0}, "bar.bottom": {"z": 0.0}}
    of_fixed = run(fixed, Step("press", 1, axes, pressure=press))
    of_straight, of_turned = (run(p, Step("press", 1, pressure=press)) for p in (straight, turned))
    u, v, w = (p.u.x.array.reshape(-1, 3) for p in (fixed, straight, turned))
    assert np.abs(u - v).max() < 1e-9 * np.abs(u).max()
    assert np.abs(u @ turn.matrix().T - w).max() < 1e-9 * np.abs(u).max()
    for group in planes:
        force = of_straight.reactions[group]
        assert force == pytest.approx(of_fixed.reactions[group], abs=1e-9)
        assert turn.matrix() @ force == pytest.approx(of_turned.reactions[group], abs=1e-9)


def test_oblique_plane_with_prescribed_components():
    """A block that stands on an oblique plane and whose top is led along that plane.

    Requirement: prescribed components and planes at the same nodes; where a prescribed motion lies
    in the plane it goes through, the reactions balance. Source: translation of a rigid body.
    """
    from anisocontact.mesh import Rotation
    from anisocontact.solver import Step

    turn = Rotation((0.0, 1.0, 0.0), np.radians(30.0))
    problem = make([bar("bar", rotate=turn)], symmetry=["bar.left", "bar.bottom"])
    along = turn.matrix() @ [0.0, 0.3, 0.0]
    last = run(problem, Step("shift", 1, {"bar.front": dict(zip("xyz", along, strict=True))}))
    assert np.abs(problem.u.x.array.reshape(-1, 3) - along).max() < 1e-9
    assert max(np.abs(force).max() for force in last.reactions.values()) < 1e-9


def test_prescribed_motion_out_of_a_plane_is_refused():
    """Requirement: one line with the plane and how far it leads."""
    from anisocontact.base.errors import InputError
    from anisocontact.solver import Step

    problem = make([bar("bar")], symmetry=["bar.left"])
    with pytest.raises(InputError, match=r"out of the symmetry plane 'bar.left', by 0\.1"):
        run(problem, Step("shift", 1, {"bar.bottom": NOTHING | {"x": 0.1}}))


def test_tangent_of_everything_that_holds(fe):
    """Halving the step quarters the error of the central difference against the tangent.

    Requirement: exact tangent with oblique planes, springs, elastic supports and a pressure that
    follows, at finite strain. Source: Taylor. Tolerance: the ratio is 4 (1 + O(h^2)); 0.15.
    """
    from anisocontact.mesh import Rotation
    from anisocontact.solver import ElasticSupport, Spring, Step

    turn = Rotation((1.0, -2.0, 0.7), 1.1)
    attached = [ElasticSupport("bar.right", 20.0, 5.0), Spring("pull", "bar.top", (3.0, 4.0, 5.0))]
    soft = {"model": "neo-hookean", "E": 10.0, "nu": 0.3}
    planes = ["bar.left", "bar.front"]
    problem = make([bar("bar", rotate=turn)], soft, attached=attached, symmetry=planes)
    loads = Step("a", 1, {"bar.bottom": {"x": 0.0}}, pressure={"bar.back": 2.0})
    problem.begin(loads)
    problem.set_load_factor(1.0, 1.0)
    errors = fe.tangent_errors(problem, np.random.default_rng(3), 0.02)
    assert np.all(np.abs(errors[:-1] / errors[1:] - 4.0) < 0.15)


def test_planes_of_bodies_in_contact():
    """Two blocks that stick to each other, held by planes and, again, by prescribed components.

    Requirement: planes work with the couplings of meshed contact. Source: the same problem without
    planes. Tolerance: 1e-7, Newton to 1e-10 in both.
    """
    from anisocontact.contact import Contact
    from anisocontact.interface import ContactLaw
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.mesh import Body, BoxSpec
    from anisocontact.solver import Step

    law = ContactLaw(
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(500.0, 500.0)),
        Friction(coefficients=(0.3, 0.3)),
    )
    bodies = [
        Body("upper", BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 1))),
        Body("lower", BoxSpec((0, 0, -0.5), (1, 1, 0.5), (2, 2, 1))),
    ]

    def touching(model):
        return Contact(model, "upper.bottom", "lower.top", law=law, mortar=False)

    sides = ["upper.left", "lower.left", "upper.front", "lower.front"]
    axes = {group: {"x" if "left" in group else "y": 0.0} for group in sides}
    results = []
    for planes, supports in ((sides, {}), ((), axes)):
        problem = make(bodies, contacts=[touching], symmetry=planes)
        ends = {"lower.bottom": {"z": 0.0}, "upper.top": {"z": -0.02}}
        run(problem, Step("press", 2, ends | supports), snes_rtol=1e-10)
        results.append(problem.u.x.array.copy())
    assert np.abs(results[0] - results[1]).max() < 1e-7 * np.abs(results[1]).max()
    assert np.abs(results[0]).max() > 0.01
