"""Bodies of order 1 and of order 2 in one mesh."""

import numpy as np
import pytest

CELLS = ["hexahedron", "tetrahedron"]


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


def block(name, order, cell, z=0.0, **more):
    """A block, 1 x 1 x 0.5, 2 x 2 x 1 cells."""
    from anisocontact.mesh import Body, BoxSpec, CylinderSpec, Placement

    shape = BoxSpec((0, 0, z), (1, 1, 0.5), (2, 2, 1), cell, order)
    if more.get("round"):
        shape = CylinderSpec(1.0, 0.5, (8, 1, 1), cell, order)
    return Body(name, shape, Placement(move=(more.get("x", 0.0), 0.0, 0.0)))


def problem(bodies, contacts=(), material="neo-hookean", **held):
    """Bodies of one material."""
    from anisocontact.bulk import make_material
    from anisocontact.mesh import build_mesh
    from anisocontact.solver import Problem

    model = build_mesh(bodies)
    materials = {name: make_material(material, E=10.0, nu=0.3) for name in model.body_names()}
    return Problem(model, materials, [make(model) for make in contacts], **held)


def run(problem, *steps):
    """The last accepted increment."""
    from anisocontact.solver import Solver

    return list(Solver(problem, steps, options={"snes_rtol": 1e-11}).run())[-1]


def by_place(problem):
    """Position of a node -> its displacement."""
    places = problem.model.space.tabulate_dof_coordinates().round(9)
    values = problem.u.x.array.reshape(-1, 3)
    return {tuple(x): u for x, u in zip((places + 0.0).tolist(), values, strict=True)}


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("round_body", [False, True], ids=["box", "curved"])
def test_a_linear_body_is_what_it_is_alone(cell, round_body):
    """Two bodies side by side, order 1 and order 2, each under loads that bend it.

    Requirement: each has the displacement, reactions and energy it has alone in a mesh of its own
    order, also beside curved cells. Source: the same problem in two meshes. Tolerance: 1e-8, Newton
    to 1e-11 of the forces in all three. Hexahedra are of linear material here: the rational
    functions of a neo-Hookean one are integrated by more points in a mesh of order 2.
    """
    from anisocontact.solver import Step

    kinds = {"one": {"order": 1}, "two": {"order": 2, "x": 5.0, "round": round_body}}
    bodies = {name: block(name, cell=cell, **kind) for name, kind in kinds.items()}

    def step(names):
        held = {f"{name}.bottom": {"x": 0.0, "y": 0.0, "z": 0.0} for name in names}
        force = {f"{name}.top": {"x": 0.3, "z": -0.5} for name in names}
        weight = {name: {"y": 0.2} for name in names}
        return Step("bend", 2, held, force=force, body_force=weight)

    material = {"hexahedron": "linear-elastic", "tetrahedron": "neo-hookean"}[cell]
    both = problem(bodies.values(), material=material)
    assert both.model.order == 2
    assert both.model.linear == ("one",)
    together = run(both, step(bodies))
    found, energy = by_place(both), 0.0
    for name, body in bodies.items():
        alone = problem([body], material=material)
        last = run(alone, step([name]))
        energy += last.energies["elastic"]
        size = np.abs(alone.u.x.array).max()
        for place, u in by_place(alone).items():
            assert np.abs(found[place] - u).max() < 1e-8 * size
        group = f"{name}.bottom"
        assert together.reactions[group] == pytest.approx(last.reactions[group], abs=1e-8)
    assert together.energies["elastic"] == pytest.approx(energy, rel=1e-8)
    external = together.energies["external"]
    assert abs(together.energies["residual"]) < 0.02 * external


@pytest.mark.parametrize("cell", CELLS)
def test_tangent_with_ties_and_planes(fe, cell):
    """Halving the step quarters the error of the central difference against the tangent.

    Requirement: exact tangent with middle nodes that are tied, on planes too. Source: Taylor.
    Tolerance: the ratio is 4 (1 + O(h^2)); 0.15.
    """
    from anisocontact.solver import Step

    planes = ["one.left", "two.front"]
    supports = {"one.bottom": {"y": 0.0, "z": 0.0}, "two.bottom": {"x": 0.0, "z": 0.0}}
    made = problem([block("one", 1, cell), block("two", 2, cell, x=5.0)], symmetry=planes)
    made.begin(Step("a", 1, supports, pressure={"one.top": 2.0}))
    made.set_load_factor(1.0, 1.0)
    errors = fe.tangent_errors(made, np.random.default_rng(3), 0.01)
    assert np.all(np.abs(errors[:-1] / errors[1:] - 4.0) < 0.15)


@pytest.mark.parametrize("slave", ["one.top", "two.bottom"])
@pytest.mark.parametrize("cell", CELLS)
def test_bodies_of_both_orders_in_contact(cell, slave):
    """A quadratic block presses on a linear one, facets opposite to each other.

    Requirement: uniform pressure, and forces in balance. Source: patch test; matching facets.
    Tolerance: 1e-7 of the pressure, Newton.
    """
    from anisocontact.contact import Contact
    from anisocontact.interface import ContactLaw
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.solver import Step

    law = ContactLaw(
        NormalLaw(penalty=1e3), Adhesion(stiffness=(5.0, 5.0)), Friction(coefficients=(0.3, 0.3))
    )
    master = {"one.top": "two.bottom", "two.bottom": "one.top"}[slave]
    bodies = [block("one", 1, cell), block("two", 2, cell, z=0.5)]
    made = problem(
        bodies,
        [lambda m: Contact(m, slave, master, law=law, mortar=False)],
        material="linear-elastic",
    )
    sides = {
        f"{name}.{side}": {axis: 0.0}
        for name in ("one", "two")
        for side, axis in (("left", "x"), ("right", "x"), ("front", "y"), ("back", "y"))
    }
    ends = {"one.bottom": {"z": 0.0}, "two.top": {"z": -0.01}}
    last = run(made, Step("press", 2, sides | ends))
    # Constrained modulus of each block over its height, the penalty between them, in series.
    modulus = 10.0 * 0.7 / (1.3 * 0.4)
    pressure = 0.01 / (1.0 / modulus + 1e-3)
    assert made.contacts[0].last.pressure == pytest.approx(pressure, rel=1e-7)
    assert last.reactions["two.top"][2] == pytest.approx(-pressure, rel=1e-7)


@pytest.mark.parametrize("cell", CELLS)
def test_slave_nodes_of_a_linear_body_are_its_corners(cell):
    """A linear block on a sphere with multipliers, beside a quadratic body that nothing touches.

    Requirement: nodes in contact and force are those of the block in a mesh of order 1. Source: the
    same problem in two meshes. Tolerance: 1e-8, Newton to 1e-11 of the forces. With middle nodes as
    slaves, whose displacement follows from the corners, the force was up to twice as large.
    """
    from anisocontact.contact import Contact
    from anisocontact.interface import Augmentation, ContactLaw
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.solver import Step
    from anisocontact.surfaces import make_surface

    sphere = make_surface("sphere", centre=(0.5, 0.4, -1.0), radius=1.0)
    law = ContactLaw(
        NormalLaw(penalty=1e3), Adhesion(stiffness=(1e3, 1e3)), Friction(coefficients=(0.3, 0.3))
    )

    def contact(model):
        exact = Augmentation(multipliers="newton")
        return Contact(model, "one.bottom", sphere, law, augmentation=exact, mortar=True)

    found = []
    for more in ([], [block("two", 2, cell, x=5.0)]):
        made = problem([block("one", 1, cell), *more], [contact], material="linear-elastic")
        names = made.model.body_names()
        held = {f"{name}.top": {"x": 0.0, "y": 0.0, "z": 0.0} for name in names}
        steps = (
            Step("press", 2, held | {"one.top": {"x": 0.0, "y": 0.0, "z": -0.05}}),
            Step("drag", 2, held | {"one.top": {"x": 0.1, "y": 0.05, "z": -0.05}}),
        )
        run(made, *steps)
        pair = made.contacts[0]
        found.append((pair.counts(), pair.resultant()[0]))
    assert found[0][0] == found[1][0]
    assert found[0][0]["slip"] > 0
    assert found[1][1] == pytest.approx(found[0][1], abs=1e-8 * np.abs(found[0][1]).max())


@pytest.mark.parametrize("cell", CELLS)
def test_linear_slaves_on_quadratic_masters(cell):
    """Uniform pressure where the slave nodes are the corners of a linear block; forces in balance.

    Requirement: 1e-7 of the pressure. Source: patch test with multipliers; matching facets.
    """
    from anisocontact.contact import Contact
    from anisocontact.interface import Augmentation, ContactLaw
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.solver import Step

    law = ContactLaw(
        NormalLaw(penalty=1e3), Adhesion(stiffness=(5.0, 5.0)), Friction(coefficients=(0.3, 0.3))
    )

    def contact(model):
        exact = Augmentation(multipliers="newton")
        return Contact(model, "one.top", "two.bottom", law, augmentation=exact, mortar=True)

    bodies = [block("one", 1, cell), block("two", 2, cell, z=0.5)]
    made = problem(bodies, [contact], material="linear-elastic")
    sides = {
        f"{name}.{side}": {axis: 0.0}
        for name in ("one", "two")
        for side, axis in (("left", "x"), ("right", "x"), ("front", "y"), ("back", "y"))
    }
    ends = {"one.bottom": {"z": 0.0}, "two.top": {"z": -0.01}}
    last = run(made, Step("press", 2, sides | ends))
    pressure = 0.01 * 10.0 * 0.7 / (1.3 * 0.4)
    assert len(made.contacts[0].state) == 9
    assert made.contacts[0].last.pressure == pytest.approx(pressure, rel=1e-7)
    assert last.reactions["two.top"][2] == pytest.approx(-pressure, rel=1e-7)


def test_a_slave_of_order_1_in_the_plane():
    """Two rectangles, order 1 on order 2.

    Requirement: slave nodes are refused in one line where the master is the other body, and against
    a surface stand for half an edge at the ends and a whole one between them. Source: integrals of
    the shape functions of order 1. Tolerance: rounding.
    """
    from anisocontact.base.errors import InputError
    from anisocontact.contact import Contact
    from anisocontact.laws import Friction
    from anisocontact.mesh import Body, PlaneStrain, build_mesh, make_shape
    from anisocontact.surfaces import make_surface

    upper = make_shape("rectangle", origin=(0, 0), size=(1, 1), cells=(2, 1), order=1)
    lower = make_shape("rectangle", origin=(0, -1), size=(1, 1), cells=(3, 1), order=2)
    bodies = [Body("upper", upper), Body("lower", lower)]
    model = build_mesh(bodies, idealisation=PlaneStrain())
    law = Friction(coefficients=0.1)
    with pytest.raises(InputError, match="order 1 beside bodies of order 2"):
        Contact(model, "upper.bottom", "lower.top", law)
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 1, 0))
    areas = Contact(model, "upper.bottom", plane, law).areas
    assert sorted(areas.tolist()) == pytest.approx([0.25, 0.25, 0.5], rel=1e-12)
