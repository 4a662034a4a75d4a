"""Meshes of two dimensions: plane strain, plane stress, axisymmetric, with and without twist."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.conftest import difference_errors

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import (
    Axisymmetric,
    Body,
    Idealisation,
    PlaneStrain,
    PlaneStress,
    build_mesh,
    make_shape,
)
from anisocontact.results.paraview import BodyGrid
from anisocontact.solver import Problem, Solver, Spring, Step, Turn
from anisocontact.surfaces import make_surface

E, NU = 1000.0, 0.3
STEEL = make_material("linear-elastic", E=E, nu=NU)
RUBBER = make_material("neo-hookean", E=E, nu=NU)


def rectangle(ideal: Idealisation, cells: tuple[int, int] = (3, 2), **given: Any) -> Any:
    """A block from (0, 0), or from (`start`, 0), of the size 2 x 1."""
    origin, size = (given.pop("start", 0.0), 0.0), given.pop("size", (2.0, 1.0))
    shape = make_shape("rectangle", origin=origin, size=size, cells=cells, **given)
    return build_mesh([Body("b", shape)], idealisation=ideal)


def run(problem: Problem, *steps: Step) -> Problem:
    """Solve."""
    for _ in Solver(problem, list(steps)).run():
        pass
    return problem


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(
    ("ideal", "force", "sideways"),
    [
        (PlaneStrain(thickness=3.0), 6.0 * E / (1.0 - NU**2), NU / (1.0 - NU)),
        (PlaneStress(thickness=3.0), 6.0 * E, NU),
        (Axisymmetric(), 4.0 * np.pi * E, NU),
    ],
)
def test_pressed_between_smooth_plates(ideal, force, sideways, order, cell):
    """Requirement: force and widening of a block without friction. Source: Hooke; the field is
    linear, in the span of all cells, so that only rounding is left."""
    problem = Problem(rectangle(ideal, cell=cell, order=order), {"b": STEEL})
    held = {"b.bottom": {"y": 0.0}, "b.left": {"x": 0.0}, "b.top": {"y": -1e-3}}
    run(problem, Step("press", 1, held))
    assert problem.reactions()["b.top"][1] == pytest.approx(-1e-3 * force, rel=1e-10)
    assert problem.u.x.array.reshape(-1, 3)[:, 0].max() == pytest.approx(2e-3 * sideways, rel=1e-10)


def test_sheet_of_wood_has_its_modulus():
    """Requirement: plane stress of a material whose axes leave the plane of the sheet.

    Source: a bar along d lengthens by `sigma / E(d)`, with the cosines l, m, n of d and the axes
    1/E(d) = l^4/E_1 + m^4/E_2 + n^4/E_3 + sum of l^2 m^2 (1/G_12 - 2 nu_12/E_1) over the pairs
    [Ting 1996, section 2.9]. The field is linear, so that only rounding is left.
    """
    young, nu, shear = (100.0, 20.0, 10.0), (0.3, 0.2, 0.25), (8.0, 5.0, 3.0)
    axes = np.linalg.qr(np.array([[1.0, 0.5, -0.2], [0.4, 1.0, 0.7], [0.3, -0.6, 1.0]]))[0]
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    pairs = [(0, 1), (0, 2), (1, 2)]
    directions = {"first": axes[:, 0], "second": axes[:, 1]}
    wood = make_material("orthotropic", E=young, nu=nu, G=shear, **directions)
    square = axes[0] ** 2
    slope = (square**2 / young).sum() + sum(
        square[i] * square[j] * (1.0 / g - 2.0 * n / young[i])
        for (i, j), n, g in zip(pairs, nu, shear, strict=True)
    )
    ground = Spring("ground", "b.left", (0.0, 1.0, 0.0))
    problem = Problem(rectangle(PlaneStress()), {"b": wood}, (), [ground])
    run(problem, Step("pull", 1, {"b.left": {"x": 0.0}}, traction={"b.right": {"x": 1e-3}}))
    found = problem.u.x.array.reshape(-1, 3)[:, 0].max()
    assert found == pytest.approx(2e-3 * slope, rel=1e-9)


@pytest.mark.parametrize("material", [STEEL, RUBBER])
def test_stress_at_nodes_on_the_axis(material):
    """Requirement: the stress of the files where u / r is 0 / 0.

    Source: a round bar between smooth plates has one stress everywhere; force over area of now.
    """
    problem = Problem(rectangle(Axisymmetric()), {"b": material})
    run(problem, Step("press", 1, {"b.bottom": {"y": 0.0}, "b.top": {"y": -0.01}}))
    stress = BodyGrid(problem).stress()
    radius = 2.0 + problem.u.x.array.reshape(-1, 3)[:, 0].max()
    area = 4.0 * np.pi if material is STEEL else np.pi * radius**2
    exact = np.array([0.0, problem.reactions()["b.top"][1] / area, 0.0, 0.0, 0.0, 0.0])
    assert np.abs(stress - exact).max() < 1e-8 * abs(exact[1])


def test_tube_under_pressure_converges_to_lame():
    """Requirement: axisymmetric strains and pressure. Source: Lame, a = 1, b = 3, p = 10; the error
    of cells of order 2 falls with h^3, asked is 0.9 of that rate."""
    errors = []
    for n in (3, 6):
        problem = Problem(rectangle(Axisymmetric(), (n, 1), start=1.0, order=2), {"b": STEEL})
        ends = {"b.bottom": {"y": 0.0}, "b.top": {"y": 0.0}}
        run(problem, Step("press", 1, ends, pressure={"b.left": 10.0}))
        r = ufl.SpatialCoordinate(problem.model.mesh)[0]
        exact = (1.0 + NU) * 10.0 / (8.0 * E) * ((1.0 - 2.0 * NU) * r + 9.0 / r)
        off = [(problem.u[0] - exact) ** 2, exact**2]
        parts = [fem.assemble_scalar(fem.form(p * ufl.dx(degree=8))) for p in off]
        errors.append(np.sqrt(parts[0] / parts[1]))
    assert np.log2(errors[0] / errors[1]) > 2.7
    assert errors[1] < 1e-3


def test_twisted_bar_has_its_torque():
    """Requirement: twist. Source: Saint-Venant, torque pi G R^4 / 2 times the turn per length; the
    displacement u_z = -k x y (right-handed about y) is that of one cell of order 1."""
    problem = Problem(rectangle(Axisymmetric(lateral=True)), {"b": STEEL})
    turn = Turn((0, 1, 0), 1e-6)
    held = {"b.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
    run(problem, Step("twist", 1, held, rotation={"b.top": turn}))
    u, x = problem.u.x.array.reshape(-1, 3), problem.model.space.tabulate_dof_coordinates()
    assert np.abs(u[:, 2] + 1e-6 * x[:, 0] * x[:, 1]).max() < 1e-5 * 2e-6
    torque = np.pi * E / 2.6 * 16.0 / 2.0 * 1e-6
    assert problem.energies()["elastic"] == pytest.approx(0.5 * torque * 1e-6, rel=1e-9)


@pytest.mark.parametrize("ideal", [PlaneStrain(lateral=True), Axisymmetric(lateral=True)])
def test_rigid_motion_strains_nothing(ideal):
    """Requirement: the gradient is exact at finite turns, about the axis or in the plane.

    Source: F = R. What is left is rounding of the strains of a turn by 40 degrees.
    """
    axis = (0, 1, 0) if ideal.turn.any() else (0, 0, 1)
    problem = Problem(rectangle(ideal), {"b": RUBBER})
    ends = ("b.left", "b.right", "b.bottom", "b.top")
    step = Step("turn", 2, rotation={group: Turn(axis, angle_deg=40.0) for group in ends[1:]})
    run(problem, step)
    assert abs(problem.energies()["elastic"]) < 1e-12 * E


def _law(mu: float = 0.3, angle: float = 0.3, **directions: Any) -> ContactLaw:
    marks = make_directions(angle=angle, **directions) if directions else None
    pair = 0.5 if directions else 1.0
    return ContactLaw(
        NormalLaw(penalty=1e4),
        Adhesion(stiffness=(8e3, pair * 8e3), directions=marks),
        Friction(coefficients=(mu, pair * mu), directions=marks),
    )


MASTERS = {
    "plane": (
        PlaneStrain(thickness=0.5, lateral=True),
        make_surface("cylinder", point=(0.9, 2.9, 0.0), axis=(0, 0, 1), radius=2.0),
        {"name": "constant", "vector": (1, 0, 0)},
    ),
    "axisymmetric": (
        Axisymmetric(lateral=True),
        make_surface("sphere", centre=(0.0, 2.9, 0.0), radius=2.0, axis=(0, 1, 0)),
        {"name": "coordinate-lines"},
    ),
}


@pytest.mark.parametrize("name", list(MASTERS))
@pytest.mark.parametrize(("cell", "order"), [("quadrilateral", 1), ("triangle", 2)])
def test_tangent_by_order(name, cell, order):
    """Halving the step quarters the error of central differences (asserted 3.5 to 4.5).

    Requirement: exact tangents with displacements across the plane, where areas go with the radius
    of now: rubber under a rigid surface with orthotropic friction, and pressure on its side.
    """
    ideal, surface, directions = MASTERS[name]
    model = rectangle(ideal, (5, 2), cell=cell, order=order)
    contact = Contact(
        model, "b.top", surface, _law(0.1, **directions), current_area=True, mortar=False
    )
    problem = Problem(model, {"b": RUBBER}, [contact])
    led: dict[str, Any] = {"displacement": {"b.bottom": {"x": 0.0, "y": 0.03, "z": 0.02}}}
    if ideal.turn.any():
        led = {"rotation": {"b.bottom": Turn((0, 1, 0), -0.04, move=(0.0, 0.03, 0.0))}}
    run(problem, Step("press", 1, pressure={"b.right": 20.0}, **led))
    rng = np.random.default_rng(4)
    x = problem.accepted()
    x.array[:] += rng.normal(0.0, 1e-3, x.getLocalSize())
    problem.set_load_factor(1.0, 1.0)
    problem.evaluate(x)
    assert contact.counts()["slip"] > 1
    direction = x.duplicate()
    direction.array[:] = rng.normal(size=x.getLocalSize())
    errors = difference_errors(problem, x, direction, (1e-6, 5e-7))
    assert 3.5 < errors[0] / errors[1] < 4.5


def test_plane_strain_is_a_slice():
    """Requirement: the same result as a slice of one layer of cells in space, to rounding.

    Source: a slice whose faces stay in their planes has the displacements of plane strain, in the
    span of its cells; friction and strains are finite. Newton's method leaves 1e-8 of the forces.
    """
    surface = make_surface("cylinder", point=(1.0, 2.9, 0.0), axis=(0, 0, 1), radius=2.0)
    flat = rectangle(PlaneStrain(thickness=0.4), (6, 3))
    box = make_shape("box", origin=(0, 0, 0), size=(2, 1, 0.4), cells=(6, 3, 1))
    names = {"b.bottom": "b.front", "b.top": "b.back"}
    slab = build_mesh([Body("b", box)])
    forces = []
    for model, planes in ((flat, {}), (slab, {"b.bottom": {"z": 0.0}, "b.top": {"z": 0.0}})):
        of = (lambda name: name) if model is flat else names.__getitem__
        contact = Contact(model, of("b.top"), surface, _law(), mortar=False)
        problem = Problem(model, {"b": RUBBER}, [contact])
        press = {of("b.bottom"): {"x": 0.0, "y": 0.05}, **planes}
        drag = {of("b.bottom"): {"x": 0.1, "y": 0.05}}
        run(problem, Step("press", 2, press), Step("drag", 3, drag))
        forces.append(contact.resultant()[0])
    assert np.abs(forces[0] - forces[1]).max() < 1e-8 * np.abs(forces[0]).max()


def _stacked(ideal: Idealisation | None, order: int = 1) -> Any:
    """A block on a block, in the plane or as a slice 0.4 thick, with facets that do not match."""
    sizes = {"a": ((0.0, 0.0), (2.0, 1.0), (6, 2)), "b": ((0.0, 1.0), (1.3, 1.0), (5, 2))}
    bodies = []
    for name, (origin, size, cells) in sizes.items():
        if ideal is None:
            given = {"origin": (*origin, 0.0), "size": (*size, 0.4), "cells": (*cells, 1)}
            bodies.append(Body(name, make_shape("box", order=order, **given)))
        else:
            given = {"origin": origin, "size": size, "cells": cells}
            bodies.append(Body(name, make_shape("rectangle", order=order, **given)))
    return build_mesh(bodies) if ideal is None else build_mesh(bodies, idealisation=ideal)


@pytest.mark.parametrize("order", [1, 2])
def test_pair_in_plane_strain_is_a_slice(order):
    """Requirement: bodies in contact with each other as in a slice of one layer, to rounding.

    Source: as of `test_plane_strain_is_a_slice`; the points of a facet of the slice lie above each
    other with equal tractions, and these are of one order less than their number integrates.
    """
    forces = []
    names = {"bottom": "front", "top": "back"}
    for ideal in (PlaneStrain(thickness=0.4), None):
        model, planes, of = _stacked(ideal, order), {}, (lambda name: name)
        if ideal is None:
            of = names.__getitem__
            planes = {f"{body}.{side}": {"z": 0.0} for body in "ab" for side in names}
        contact = Contact(model, f"b.{of('bottom')}", f"a.{of('top')}", _law(), mortar=False)
        problem = Problem(model, {"a": RUBBER, "b": STEEL}, [contact])
        low, high = f"a.{of('bottom')}", f"b.{of('top')}"
        press = {low: {"x": 0.0, "y": 0.0}, high: {"x": 0.0, "y": -0.05}, **planes}
        run(problem, Step("press", 1, press), Step("drag", 2, {high: {"x": 0.1, "y": -0.05}}))
        forces.append(contact.resultant()[0])
    assert np.abs(forces[0] - forces[1]).max() < 1e-8 * np.abs(forces[0]).max()


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("ideal", [PlaneStrain(thickness=0.4, lateral=True), Axisymmetric()])
def test_tangent_of_a_pair_by_order(ideal, order):
    """Halving the step quarters the error of central differences (asserted 3.5 to 4.5).

    Requirement: exact tangents of facets that are swept out of edges, areas of now included.
    """
    contact = Contact(model := _stacked(ideal, order), "b.bottom", "a.top", _law(0.1), mortar=False)
    problem = Problem(model, {"a": RUBBER, "b": RUBBER}, [contact])
    led = {"x": 0.0, "y": -0.05} | ({"z": 0.05} if ideal.lateral else {})
    run(problem, Step("press", 2, {"a.bottom": dict.fromkeys(led, 0.0), "b.top": led}))
    rng = np.random.default_rng(4)
    x = problem.accepted()
    x.array[:] += rng.normal(0.0, 1e-3, x.getLocalSize())
    problem.set_load_factor(1.0, 1.0)
    problem.evaluate(x)
    assert contact.counts()["slip"] > 1
    direction = x.duplicate()
    direction.array[:] = rng.normal(size=x.getLocalSize())
    errors = difference_errors(problem, x, direction, (1e-6, 5e-7))
    assert 3.5 < errors[0] / errors[1] < 4.5


@pytest.mark.parametrize(
    ("ideal", "surface", "directions"),
    [
        (PlaneStrain(), make_surface("sphere", centre=(1, 2.9, 0), radius=2.0), {}),
        (Axisymmetric(), make_surface("sphere", centre=(1, 2.9, 0), radius=2.0), {}),
        (
            Axisymmetric(),
            make_surface("plane", point=(0, 0.9, 0), normal=(0, -1, 0)),
            {"name": "constant", "vector": (1, 0, 0)},
        ),
    ],
)
def test_what_is_not_the_same_in_every_plane_is_refused(ideal, surface, directions):
    """Requirement: a master, or friction, that is not of the symmetry of the body is one line."""
    with pytest.raises(InputError, match="surface and directions are not the same"):
        Contact(rectangle(ideal), "b.top", surface, _law(**directions), mortar=False)


@pytest.mark.parametrize(
    ("ideal", "normal"),
    [(PlaneStrain(), (0, 0, 1)), (PlaneStrain(), (0, -1, 0.1)), (Axisymmetric(), (0, 0, 1))],
)
def test_a_surface_across_the_plane_is_refused(ideal, normal):
    """Requirement: a surface whose normals leave the plane of the mesh is one line."""
    plane = make_surface("plane", point=(0, 0.9, 0), normal=normal)
    with pytest.raises(InputError, match="normal of the surface is not in the plane of the mesh"):
        Contact(rectangle(ideal), "b.top", plane, _law(), mortar=False)


def test_mistakes_are_one_line():
    """Requirement: what a mesh of two dimensions cannot be is said."""
    with pytest.raises(InputError, match="idealisation: missing"):
        rectangle(Idealisation())
    box = Body("b", make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(1, 1, 1)))
    with pytest.raises(InputError, match="the mesh has three dimensions"):
        build_mesh([box], idealisation=PlaneStrain())
    with pytest.raises(InputError, match="the mesh goes to x = -1"):
        rectangle(Axisymmetric(), start=-1.0)
    twisted = _stacked(Axisymmetric(lateral=True))
    with pytest.raises(InputError, match="facets given with twist"):
        Contact(twisted, "b.bottom", "a.top", _law(), mortar=False)
    with pytest.raises(InputError, match="plane stress needs a linear material"):
        Problem(rectangle(PlaneStress()), {"b": RUBBER})
    problem = Problem(rectangle(Axisymmetric()), {"b": STEEL})
    with pytest.raises(InputError, match="for x on 3 shared nodes"):
        run(problem, Step("a", 1, {"b.left": {"x": 0.1}}))
    with pytest.raises(InputError, match="free to move: translation along y"):
        run(problem, Step("a", 1, traction={"b.top": {"x": 1.0}}))
