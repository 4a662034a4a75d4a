"""Mortar contact: the law at slave nodes, with dual functions over the overlaps of the facets."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation
from tests.verification.slid_blocks import force_of, linear_force, offset_pair, slid

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact, doubtful_sides
from anisocontact.interface import ContactLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

Floats = npt.NDArray[np.float64]

YOUNG, PRESSURE, PENALTY = 1000.0, 10.0, 4e4
CELLS = ("hexahedron", "tetrahedron")


def _blocks(cell: str, order: int, overhang: float = 0.0) -> Model:
    width = 1.0 + overhang
    upper = BoxSpec((0, 0, 0), (1, 1, 0.5), (4, 4, 2), cell=cell, order=order)
    lower = BoxSpec((0, 0, -0.5), (width, width, 0.5), (3, 3, 2), cell=cell, order=order)
    return build_box({"upper": upper, "lower": lower})


def _distort(model: Model, share: float) -> None:
    """Move the nodes where the bodies meet at random, inside of the border."""
    x = model.mesh.geometry.x
    inner = (np.abs(x[:, 2]) < 1e-9) & np.all(np.abs(x[:, :2] - 0.5) < 0.499, axis=1)
    x[inner, :2] += np.random.default_rng(3).uniform(-share, share, (inner.sum(), 2)) / 4.0


def _law() -> ContactLaw:
    adhesion, friction = Adhesion(stiffness=(1e3, 1e3)), Friction(coefficients=(0.3, 0.3))
    return ContactLaw(NormalLaw(penalty=PENALTY), adhesion, friction)


def _mortar(model: Model, master: Any = "lower.top", **options: Any) -> Contact:
    return Contact(model, "upper.bottom", master, _law(), mortar=True, **options)


def _pressed(model: Model, augmented: bool) -> tuple[Contact, Floats, float]:
    """Uniform compression; the contact, the displacement and the overlap of a penalty."""
    augmentation = Augmentation(tangential=False) if augmented else None
    contact = _mortar(model, current_area=False, augmentation=augmentation)
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    problem = Problem(model, {"upper": elastic, "lower": elastic}, [contact])
    held: dict[str, Any] = {f"{body}.left": {"x": 0.0} for body in ("upper", "lower")}
    held |= {f"{body}.front": {"y": 0.0} for body in ("upper", "lower")}
    overlap = 0.0 if augmented else PRESSURE / PENALTY
    held |= {"lower.bottom": {"z": 0.0}, "upper.top": {"z": -(PRESSURE / YOUNG + overlap)}}
    for _ in Solver(problem, [Step("press", 1, held)], options={"snes_rtol": 1e-10}).run():
        pass
    return contact, problem.u.x.array.reshape(-1, 3), overlap


def _patch_errors(model: Model, augmented: bool) -> tuple[float, float]:
    contact, u, overlap = _pressed(model, augmented)
    at = model.space.tabulate_dof_coordinates()
    exact = 1e-2 * (np.array([0.3, 0.3, -1.0]) * (at + np.array([0.0, 0.0, 0.5])))
    exact[np.unique(model.space.dofmap.list[model.cells("upper")]), 2] -= overlap
    pressure = float(np.abs(contact.last.pressure / PRESSURE - 1.0).max())
    return pressure, float(np.abs(u - exact).max() / np.abs(exact).max())


@pytest.mark.parametrize("augmented", [False, True], ids=["penalty", "multipliers"])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("cell", CELLS)
def test_patch(cell: str, order: int, augmented: bool) -> None:
    """Uniform compression across meshes that do not match: 1e-8 at every node.

    Source: uniform stress. The dual functions of a facet sum to one, and products with the shape
    functions of the master are polynomials on triangles and parallelograms, which the rule
    integrates; what is left is Newton's tolerance times the condition of the system.
    """
    assert max(_patch_errors(_blocks(cell, order), augmented)) < 1e-8


@pytest.mark.parametrize("augmented", [False, True], ids=["penalty", "multipliers"])
@pytest.mark.parametrize(
    ("cell", "order"), [("hexahedron", 1), ("tetrahedron", 1), ("tetrahedron", 2)]
)
def test_patch_of_distorted_facets(cell: str, order: int, augmented: bool) -> None:
    """The same with nodes moved by a quarter of a facet: 1e-5, on triangles 1e-8.

    On quadrilaterals that are no parallelograms shape functions are no polynomials of the position.
    """
    model = _blocks(cell, order)
    _distort(model, 0.25)
    assert max(_patch_errors(model, augmented)) < (1e-5 if cell == "hexahedron" else 1e-8)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("cell", CELLS)
def test_partly_covered_facets(cell: str, order: int) -> None:
    """A master that ends within slave facets: uniform pressure on what it covers, 1e-8.

    Nodes with less than 5 % of their weight are left out. Source: a uniform traction over the
    covered part is in the span of the dual functions, which sum to one there; a stiff slave keeps
    the gap uniform.
    """
    upper = BoxSpec((0, 0, 0), (1, 1, 0.5), (4, 4, 1), cell=cell, order=order)
    lower = BoxSpec((0.13, 0.21, -0.5), (0.63, 0.55, 0.5), (3, 3, 1), cell=cell, order=order)
    model = build_box({"upper": upper, "lower": lower})
    contact = Contact(model, "upper.bottom", "lower.top", _law(), mortar=True, current_area=False)
    u = np.zeros_like(model.space.tabulate_dof_coordinates())
    u[np.unique(model.space.dofmap.list[model.cells("upper")]), 2] = -PRESSURE / PENALTY
    contact.update(u, 1.0)
    contact.commit()
    carried = contact.covered() > 0.05
    np.testing.assert_allclose(contact.last.pressure[carried], PRESSURE, rtol=1e-8)
    np.testing.assert_allclose(contact.resultant()[0][2], PRESSURE * 0.63 * 0.55, rtol=1e-8)


def _on(master: str) -> Any:
    if master == "facets":
        return "lower.top"
    return make_surface("sphere", centre=(0.6, 0.5, -10.0), radius=10.05)


@pytest.mark.parametrize("current_area", [True, False])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("master", ["facets", "sphere"])
def test_tangent(master: str, cell: str, order: int, current_area: bool) -> None:
    """Tangent of overlaps, normals, areas, history and directions: error of second order.

    Sliding and sticking nodes over warped, sheared facets that have slid over others, with axes
    that turn along the master. Source: central differences; at steps of 1e-5 and 1e-6 the error
    falls a hundredfold until rounding (2e-8 of the largest entry) is reached.
    """
    model = offset_pair(cell, order)
    rays = make_directions("polar", axis=((5.0, 3.0, 0.0), (0, 0, 1.0)))
    law = ContactLaw(
        NormalLaw(penalty=100.0),
        Adhesion(stiffness=(60.0, 90.0), directions=rays),
        Friction(coefficients=(0.3, 0.5), directions=rays),
    )
    contact = Contact(
        model, "upper.bottom", _on(master), law, mortar=True, current_area=current_area
    )
    u = slid(contact, model)
    way = np.random.default_rng(5).normal(size=u.shape)
    force_of(contact, u)
    assert min(contact.counts()[name] for name in ("stick", "slip")) > 0
    exact = linear_force(contact, way)
    errors = []
    for h in (1e-5, 1e-6):
        found = (force_of(contact, u + h * way) - force_of(contact, u - h * way)) / (2.0 * h)
        errors.append(np.abs(found - exact).max() / np.abs(exact).max())
    assert errors[1] < max(errors[0] / 50.0, 2e-8)


def test_forces_balance() -> None:
    """Forces on both bodies add up to nothing: 1e-12, whatever is covered and however warped."""
    model = offset_pair("hexahedron", 1)
    contact = _mortar(model)
    force = force_of(contact, slid(contact, model))
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * np.abs(force).sum()


@pytest.mark.parametrize(("current_area", "area"), [(True, 1.32), (False, 1.0)])
@pytest.mark.parametrize("master", ["facets", "sphere"])
def test_area(master: str, current_area: bool, area: float) -> None:
    """A slave stretched by 1.1 and 1.2: its area of now or of the reference, whole, 1e-12."""
    model = offset_pair("hexahedron", 1)
    contact = _mortar(model, _on(master), current_area=current_area)
    x = model.space.tabulate_dof_coordinates()
    u = np.zeros_like(x)
    block = np.unique(model.space.dofmap.list[model.cells("upper")])
    u[block, :2] = x[block, :2] * [0.1, 0.2]
    contact.update(u, 1.0)
    contact.commit()
    assert contact.areas.sum() == pytest.approx(area, rel=1e-12)


def test_rotation() -> None:
    """Both bodies turned by 70 degrees as one, in between of increments: forces turn, 1e-9.

    Source: slip is that of material points that were opposite each other, and history is turned
    with the normals.
    """
    model = offset_pair("hexahedron", 1)
    x = model.space.tabulate_dof_coordinates()
    turn = Rotation.from_euler("xyz", (20.0, -50.0, 70.0), degrees=True)
    forces = []
    for rotation in (Rotation.identity(), turn):
        contact = _mortar(model)
        contact.update(np.zeros_like(x), 1.0)
        contact.commit()
        u = slid(contact, model)
        contact.update(u, 1.0)
        contact.commit()
        u[:, 0] += 1e-3 * x[:, 2]
        forces.append(rotation.inv().apply(force_of(contact, rotation.apply(x + u) - x)))
    assert np.abs(forces[0] - forces[1]).max() < 1e-9 * np.abs(forces[0]).max()


def test_stick_on_a_plane_of_symmetry() -> None:
    """Nodes on a plane of symmetry that stick carry no traction across it, matching or not.

    Source: symmetry. Dual functions of these nodes reach one side of the plane alone, where the
    master moves across it; multipliers would hold against that without end. Along the plane and
    elsewhere tractions stay below 5 % of mu p: equal bodies do not slip.
    """
    for below in (3, 4):
        upper = BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 2))
        lower = BoxSpec((0, 0, -0.5), (1, 1, 0.5), (below, below, 2))
        model = build_box({"upper": upper, "lower": lower})
        adhesion, friction = Adhesion(stiffness=(4e4, 4e4)), Friction(coefficients=(0.3, 0.3))
        law = ContactLaw(NormalLaw(penalty=PENALTY), adhesion, friction)
        contact = Contact(
            model, "upper.bottom", "lower.top", law, mortar=True, augmentation=Augmentation()
        )
        steel = make_material("linear-elastic", E=YOUNG, nu=0.3)
        problem = Problem(model, {"upper": steel, "lower": steel}, [contact])
        held: dict[str, Any] = {f"{body}.front": {"y": 0.0} for body in ("upper", "lower")}
        still = {"x": 0.0, "y": 0.0}
        held |= {"upper.top": {**still, "z": -0.01}, "lower.bottom": {**still, "z": 0.0}}
        for _ in Solver(problem, [Step("press", 2, held)]).run():
            pass
        across = contact.last.traction[np.abs(contact.points[:, 1]) < 1e-9, 1]
        assert np.abs(across).max() < 1e-9 * PRESSURE
        inner = np.all(np.abs(contact.points[:, :2] - 0.5) < 0.45, axis=1)
        shear = np.linalg.norm(contact.last.traction[inner, :2], axis=1)
        assert shear.max() < 0.05 * 0.3 * PRESSURE


@pytest.mark.parametrize("mortar", [True, False])
def test_a_stiff_and_fine_slave_is_told(mortar: bool) -> None:
    """A slave ten times as stiff and finer than the master is a warning that names what to do.

    The other way round, and with equal bodies, nothing is said.
    """
    model = _blocks("hexahedron", 1)
    stiff, soft = (make_material("linear-elastic", E=e, nu=0.3) for e in (10.0 * YOUNG, YOUNG))
    for upper, sides, said in (
        (stiff, ("upper.bottom", "lower.top"), True),
        (stiff, ("lower.top", "upper.bottom"), False),
        (soft, ("upper.bottom", "lower.top"), False),
    ):
        contact = Contact(model, *sides, _law(), mortar=mortar)
        Problem(model, {"upper": upper, "lower": soft}, [contact])
        lines = doubtful_sides([contact])
        assert bool(lines) == said
        assert not said or "swap slave and master" in lines[0]


def _dragged() -> tuple[Problem, list[Step]]:
    upper = BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 1))
    lower = BoxSpec((-0.4, 0, -0.5), (2, 2, 0.5), (5, 5, 1))
    model = build_box({"upper": upper, "lower": lower})
    contact = _mortar(model, augmentation=Augmentation())
    steel = make_material("linear-elastic", E=YOUNG, nu=0.3)
    problem = Problem(model, {"upper": steel, "lower": steel}, [contact])
    still = {"x": 0.0, "y": 0.0}
    press: dict[str, Any] = {f"{body}.front": {"y": 0.0} for body in ("upper", "lower")}
    press |= {"lower.bottom": {**still, "z": 0.0}, "upper.top": {**still, "z": -0.005}}
    return problem, [Step("press", 2, press), Step("drag", 3, {"upper.top": {"x": 0.2}})]


@pytest.mark.parametrize("strategy", ["direct", "condensed"])
def test_a_run_goes_on_bit_by_bit(strategy: str) -> None:
    """Weights, planes and multipliers of the accepted state are all that is needed: same bits."""
    problem, steps = _dragged()
    solver = Solver(problem, steps, strategy=strategy)
    kept: Any = None
    for count, _ in enumerate(solver.run(), start=1):
        if count == 3:
            kept = deepcopy(solver.persistent())
    again, steps = _dragged()
    other = Solver(again, steps, strategy=strategy)
    other.restore(kept)
    for _ in other.run():
        pass
    assert np.array_equal(again.u.x.array, problem.u.x.array)
    assert problem.contacts[0].counts()["slip"] > 0


def test_multipliers_are_extrapolated_with_displacements() -> None:
    """A load in proportion: from the third increment on at most two corrections, without a cut.

    Source: at small displacements the answer to a load that grows in proportion does, sticking and
    slipping nodes with it, so that what is extrapolated is the solution to the square of the
    displacements. Pressures of the increment before take half of the nodes beyond the bound of
    friction, as adhesion is physical; then some tens of corrections and a cut follow.
    """
    upper = BoxSpec((0, 0, 0), (1, 1, 0.5), (6, 6, 3))
    lower = BoxSpec((-0.5, -0.5, -0.5), (2, 2, 0.5), (9, 9, 2))
    model = build_box({"upper": upper, "lower": lower})
    law = ContactLaw(
        NormalLaw(penalty=1e5), Adhesion(stiffness=(1e5, 1e5)), Friction(coefficients=(0.3, 0.3))
    )
    augmentation = Augmentation(tangential=False)
    contact = Contact(
        model, "upper.bottom", "lower.top", law, mortar=True, augmentation=augmentation
    )
    steel = make_material("linear-elastic", E=YOUNG, nu=0.3)
    problem = Problem(model, {"upper": steel, "lower": steel}, [contact])
    still = {"x": 0.0, "y": 0.0}
    press = {"lower.bottom": {**still, "z": 0.0}, "upper.top": {**still, "z": -0.01}}
    done = list(Solver(problem, [Step("press", 5, press)]).run())
    assert contact.counts()["slip"] > 4
    assert all(accepted.done == 1.0 for accepted in done)
    assert max(accepted.iterations for accepted in done[2:]) <= 2
