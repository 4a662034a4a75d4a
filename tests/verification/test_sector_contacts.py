"""Contacts of curved surfaces in a sector: slave nodes at its cut faces, masters beyond them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.contact.narrow import is_narrow
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, Model, PlaneStrain, build_mesh, make_shape
from anisocontact.solver import CyclicSymmetry, Cylindrical, Problem, Solver, Step, Turn

STIFF = NormalLaw(penalty=1e3), Adhesion(stiffness=1e3)


def tyre_on_hub(parts: int, of: int, *, plane: bool, order: int, inner: float = 1.0) -> Model:
    """One of so many parts of a hub of three facets to each of `of` parts, and of a tyre of two."""
    each = of // parts
    turn = {} if parts == 1 else {"start": 0.1, "end": 0.1 + 2.0 * math.pi / parts}
    name, length = ("annulus", {}) if plane else ("ring", {"length": 0.4})
    bodies = []
    for body, ends, around in (("hub", (0.7, 1.0), 3), ("tyre", (inner, 1.3), 2)):
        cells = (1, around * each) if plane else (1, around * each, 1)
        shape: dict[str, Any] = {"cells": cells, "order": order, **length, **turn}
        bodies.append(Body(body, make_shape(name, inner=ends[0], outer=ends[1], **shape)))
    return build_mesh(bodies, **({"idealisation": PlaneStrain()} if plane else {}))


def cut(parts: int) -> list[CyclicSymmetry]:
    """Cut faces of both bodies, to either side; none of a whole."""
    hub = CyclicSymmetry("hub.start", "hub.end", max(parts, 2))
    tyre = CyclicSymmetry("tyre.end", "tyre.start", max(parts, 2))
    return [] if parts == 1 else [hub, tyre]


def pressed_and_turned(
    parts: int, of: int, *, plane: bool, order: int, degrees: float, increments: int, **how: Any
) -> np.ndarray:
    """Largest and least pressure, and the moment of all parts, after the turn."""
    model = tyre_on_hub(parts, of, plane=plane, order=order)
    contact = Contact(model, "tyre.inner", "hub.outer", Friction(coefficients=0.1), **how)
    rubber = make_material("neo-hookean", E=1000.0, nu=0.3)
    problem = Problem(model, {"hub": rubber, "tyre": rubber}, [contact], cyclic=cut(parts))
    across = {} if plane else {"axial": 0.0}
    fixed = {"hub.inner": {"x": 0.0, "y": 0.0} | ({} if plane else {"z": 0.0})}
    inward = Cylindrical({"radial": -0.02, "tangential": 0.0, **across})
    turn = Turn(axis=(0, 0, 1), angle=math.radians(degrees))
    steps = [
        Step("press", 1, fixed, cylindrical={"tyre.outer": inward}),
        Step("turn", increments, fixed, rotation={"tyre.outer": turn}),
    ]
    for _ in Solver(problem, steps, strategy="direct", options={"snes_rtol": 1e-11}).run():
        pass
    pressure = contact.last.pressure
    return np.array([pressure.max(), pressure.min(), parts * contact.resultant()[1][2]])


@pytest.mark.parametrize(
    ("parts", "how"),
    [
        (6, {"plane": True, "order": 2, "degrees": 3.0, "increments": 1}),
        (9, {"plane": True, "order": 1, "degrees": 42.0, "increments": 1}),
        (3, {"plane": True, "order": 1, "degrees": 4.0, "increments": 1, "degree": 2}),
        (6, {"plane": False, "order": 1, "degrees": 4.0, "increments": 1}),
    ],
    ids=["order 2", "past a sector", "points", "space"],
)
def test_a_curved_slave_slides_as_the_whole_does(parts: int, how: dict[str, Any]):
    """A tyre that is pressed on a hub and turned on it, of few facets, which slips everywhere.

    Requirement: pressures and the moment are those of the whole ring of the same cells, at slave
    nodes, at integration points, and where the tyre has turned past a sector. Source: the solution
    of the whole is the same in every sector. Tolerance: 1e-8 of Newton to 1e-11. With the facets of
    one side alone pressures at the cut are several times too large.
    """
    whole, found = (pressed_and_turned(one, parts, **how) for one in (1, parts))
    assert abs(whole[2]) > 0.1, "friction acts"
    assert found == pytest.approx(whole, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize(("plane", "order"), [(True, 2), (False, 1)])
def test_the_tangent_at_the_cut_is_exact(plane: bool, order: int):
    """Requirement: central differences of forces come to the tangent of a contact that goes on
    beyond the cut faces with the second order of their width, with the tyre turned so that its
    nodes at the cut lie on facets of both sides. Its master is closed: 18 facets share the nodes
    between them, in three rows of 36 in the plane and in two of 18 in space.

    Source: Taylor. Tolerance: 5 % of the order, that of the next term.
    """
    model = tyre_on_hub(6, 6, plane=plane, order=order, inner=0.997)
    law = ContactLaw(*STIFF, Friction(coefficients=0.1))
    contact = Contact(model, "tyre.inner", "hub.outer", law, mortar=True, current_area=True)
    rubber = make_material("neo-hookean", E=1000.0, nu=0.3)
    Problem(model, {"hub": rubber, "tyre": rubber}, [contact], cyclic=cut(6))
    x, random = model.space.tabulate_dof_coordinates(), np.random.default_rng(5)
    used = np.array([1.0, 1.0, 0.0]) if plane else np.ones(3)
    u, way = used * 1e-3 * random.standard_normal(x.shape), used * random.standard_normal(x.shape)
    tyre = np.unique(model.space.dofmap.list[model.cells("tyre")])
    c, s = math.cos(0.06), math.sin(0.06)
    u[tyre] += x[tyre] @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) - x[tyre]

    def force(by: float) -> np.ndarray:
        contact.update(u + by * way, 1.0)
        out = np.zeros_like(x)
        contact.add_force(out)
        return out

    force(0.0)
    master: Any = contact.master
    assert len(np.unique(master.sides.master.nodes)) == (108 if plane else 36)
    assert np.count_nonzero(contact.trial.pressure) > 1
    exact = np.zeros_like(x)
    for rows, columns, blocks in contact.answer.couplings():
        along = np.einsum("pab,pb->pa", blocks, way[columns].reshape(len(columns), -1))
        np.add.at(exact, rows, -along.reshape(*rows.shape, 3))
    errors = []
    for width in (5e-5, 2.5e-5):
        differences = (force(width) - force(-width)) / (2.0 * width)
        errors.append(np.linalg.norm(differences - exact))
    assert errors[1] < 1e-3 * np.linalg.norm(exact)
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, rel=0.05)


def test_cut_faces_whose_meshes_do_not_match_are_told():
    """Requirement: a contact with slave nodes at the cut faces that have facets of their own side
    alone is named before the run with the angle between the normals of both sides; one whose cut
    faces match is not.

    Source: a tyre of twelve facets has 30 degrees from one to the next. Tolerance: as written.
    """
    for moved in (0.0, 0.1):
        model = tyre_on_hub(6, 6, plane=False, order=1)
        x = model.mesh.geometry.x
        angle, radius = np.arctan2(x[:, 1], x[:, 0]), np.hypot(x[:, 0], x[:, 1])
        x[(angle > 0.1 + math.pi / 3.0 - 1e-6) & (radius < 1.0 + 1e-9), 2] *= 1.0 - moved
        contact = Contact(model, "tyre.inner", "hub.outer", Friction(coefficients=0.1))
        steel = make_material("linear-elastic", E=1000.0, nu=0.3)
        problem = Problem(model, {"hub": steel, "tyre": steel}, [contact], cyclic=cut(6))
        held = {"hub.inner": {"x": 0.0, "y": 0.0, "z": 0.0}}
        outside = Cylindrical({"radial": -0.01, "tangential": 0.0, "axial": 0.0})
        step = Step("press", 1, held, cylindrical={"tyre.outer": outside})
        told = [line for line in Solver(problem, [step]).cautions if "degrees apart" in line]
        assert len(told) == (moved > 0.0)
        assert all(line.startswith("contact 'tyre.inner': slave nodes") for line in told)
        assert all("cyclic[1]" in line and "30 degrees apart" in line for line in told)


def test_what_is_held_beyond_the_cut_is_held_along_turned_directions() -> None:
    """All nodes are prescribed along radial directions, which a contact is told.

    Requirement: every slave node and what is opposite to it are held along the normal, those next
    to the cut too, whose master is turned by a sector.
    """
    model = tyre_on_hub(6, 36, plane=False, order=1)
    contact = Contact(model, "tyre.inner", "hub.outer", Friction(coefficients=0.1))
    rubber = make_material("neo-hookean", E=1000.0, nu=0.3)
    Problem(model, {"hub": rubber, "tyre": rubber}, [contact], cyclic=cut(6))
    away = model.positions * [1.0, 1.0, 0.0]
    away /= np.linalg.norm(away, axis=1)[:, None]
    contact.take_supports(away[:, :, None] * away[:, None], [])
    assert contact.trials.immovable.all()


def test_what_supports_hold_on_both_sides_is_that_of_the_whole() -> None:
    """A tyre is pressed on its hub, and one end of both is held along the directions of a cylinder.

    Requirement: as many points as in the whole have no pressure of their own, those at the cut
    too, whose master follows what is held, and all others have theirs. Source: the solution of the
    whole is the same in every sector. Tolerance: 1e-8, that of Newton's method.
    """
    counts, pressures = [], []
    for parts in (1, 6):
        model = tyre_on_hub(parts, 36, plane=False, order=1)
        contact = Contact(model, "tyre.inner", "hub.outer", Friction(coefficients=0.1))
        steel = make_material("linear-elastic", E=1000.0, nu=0.3)
        problem = Problem(model, {"hub": steel, "tyre": steel}, [contact], cyclic=cut(parts))
        still = Cylindrical({"radial": 0.0, "tangential": 0.0, "axial": 0.0})
        ends = {"tyre.bottom": still, "hub.bottom": still}
        step = Step("press", 1, cylindrical=ends, pressure={"tyre.outer": 1.0})
        (accepted,) = Solver(problem, [step], strategy="direct").run()
        counts.append(parts * accepted.undetermined[contact.name])
        pressures.append([contact.last.pressure.max(), contact.last.pressure.min()])
    assert counts == [72, 72]
    assert pressures[1] == pytest.approx(pressures[0], rel=1e-8)


@pytest.mark.parametrize("plane", [True, False], ids=["plane", "space"])
@pytest.mark.parametrize("parts", [1, 6])
def test_a_contact_that_is_closed_all_around_is_not_narrow(plane: bool, parts: int) -> None:
    """A ring of six facets, all of whose nodes are pressed, and one of its sectors with one facet.

    Requirement: nothing is told of a contact narrower than two facets, of the sector as of the
    whole: nodes around a node at the cut are in two other sectors. In space a run with its results
    ended there with an error of the program itself.
    """
    turn = {} if parts == 1 else {"start": 0.1, "end": 0.1 + 2.0 * math.pi / parts}
    name, length = ("annulus", {}) if plane else ("ring", {"length": 0.4})
    cells = (1, 6 // parts) if plane else (1, 6 // parts, 1)
    bodies = [
        Body(body, make_shape(name, inner=inner, outer=outer, cells=cells, **length, **turn))
        for body, inner, outer in (("hub", 0.7, 1.0), ("tyre", 1.0, 1.3))
    ]
    model = build_mesh(bodies, **({"idealisation": PlaneStrain()} if plane else {}))
    contact = Contact(model, "tyre.inner", "hub.outer", Friction(coefficients=0.1))
    rubber = make_material("linear-elastic", E=1000.0, nu=0.3)
    problem = Problem(model, {"hub": rubber, "tyre": rubber}, [contact], cyclic=cut(parts))
    fixed = {"hub.inner": {"x": 0.0, "y": 0.0} | ({} if plane else {"z": 0.0})}
    across = {} if plane else {"axial": 0.0}
    inward = {"tyre.outer": Cylindrical({"radial": -0.02, "tangential": 0.0, **across})}
    (_,) = Solver(problem, [Step("press", 1, fixed, cylindrical=inward)]).run()
    assert contact.last.pressure.min() > 0.0
    assert is_narrow(contact) is False
