"""Augmented Lagrangian: what does not depend on the penalty, exact contact, physical adhesion."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.augmentation import Augmentation
from anisocontact.bulk import make_material
from anisocontact.contact import Contact, FacetContact
from anisocontact.interface import Interface, PairLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

YOUNG = 1000.0
SIZE = 0.25


def _run(
    penalty: float,
    meshed: bool,
    coefficients: tuple[float, float],
    *,
    adhesion: float | None = None,
    unit: float = 1.0,
) -> tuple[np.ndarray, Any]:
    """Press a block, then drag it; `penalty` in units of 10 E over the facet size.

    Returns the contact force after each increment and the contact.
    """
    boxes = {"block": BoxSpec((0, 0, 0), (unit, unit, 0.5 * unit), (4, 4, 2))}
    support = {}
    if meshed:
        boxes["base"] = BoxSpec(
            (-0.5 * unit, -0.5 * unit, -0.5 * unit), (2 * unit, 2 * unit, 0.5 * unit), (6, 6, 1)
        )
        support = {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
    model = build_box(boxes)
    stiffness = 10.0 * penalty * YOUNG / (SIZE * unit)
    marks = make_directions("constant", vector=(1, 0, 0), angle=np.pi / 6)
    laws = (
        NormalLaw(penalty=stiffness),
        Adhesion(stiffness=(adhesion or stiffness,) * 2),
        Friction(coefficients=coefficients, directions=marks),
    )
    augmentation = Augmentation(tangential=adhesion is None)
    contact: Contact | FacetContact
    if meshed:
        contact = FacetContact(
            model,
            "block.bottom",
            "base.top",
            law=PairLaw(*laws),
            current_area=False,
            augmentation=augmentation,
        )
    else:
        plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        contact = Contact(model, "block.bottom", Interface(plane, *laws), augmentation=augmentation)
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    problem = Problem(model, dict.fromkeys(boxes, elastic), [contact])
    press = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01 * unit}} | support
    steps = [
        Step("press", 2, press),
        Step("drag", 3, {"block.top": {"x": 0.015 * unit, "y": 0.0}}),
    ]
    return np.array([contact.resultant()[0] for _ in Solver(problem, steps).run()]), contact


@pytest.mark.parametrize("meshed", [False, True], ids=["plane", "block"])
@pytest.mark.parametrize("coefficients", [(0.3, 0.15), (50.0, 40.0)], ids=["slip", "stick"])
def test_resultants_do_not_depend_on_the_penalty(
    meshed: bool, coefficients: tuple[float, float]
) -> None:
    """Four decades of the penalty: the same force to 1e-4, penetration below 1e-6 of a facet.

    Requirement: issue of the augmented Lagrangian; block on plane and on a block that does not
    match, pressed and dragged. Tolerances are those of the requirement; measured: 2e-8 and 1e-8.
    """
    forces = []
    for penalty in (1e-2, 1.0, 1e2):
        found, contact = _run(penalty, meshed, coefficients)
        forces.append(found)
        in_contact = contact.state["status"] != 0
        assert in_contact.any()
        assert np.abs(contact.state["gap"][in_contact]).max() < 1e-6 * SIZE
        assert np.abs(contact.elastic_slip()).max() < 5e-6 * SIZE
    for found in forces[1:]:
        difference = np.linalg.norm(found - forces[0], axis=1)
        assert np.all(difference < 1e-4 * np.linalg.norm(forces[0], axis=1))


def test_physical_adhesion_stays() -> None:
    """A block that sticks gives way by its adhesion, whatever the normal penalty.

    Source: with the sides free to shear, the tangential force of a block of low height on springs
    S per area is below A S u; the same S under a penalty contact four decades stiffer gives the
    force within 1e-4. The elastic slip is T / S at every point.
    """
    soft = 400.0
    ends = []
    for penalty in (1e-1, 1e2):
        forces, contact = _run(penalty, False, (50.0, 40.0), adhesion=soft)
        ends.append(forces[-1])
        slip = contact.elastic_slip()
        traction = contact.last.traction_t
        np.testing.assert_allclose(traction, -soft * slip, atol=1e-9 * np.abs(traction).max())
        assert np.abs(slip).max() > 1e-2 * SIZE
    assert np.linalg.norm(ends[0] - ends[1]) < 1e-4 * np.linalg.norm(ends[0])


def test_units() -> None:
    """Lengths a million times as large, the same stresses: forces 1e12 times as large, 1e-9."""
    metre, _ = _run(1.0, False, (0.3, 0.15))
    micro, _ = _run(1.0, False, (0.3, 0.15), unit=1e6)
    np.testing.assert_allclose(micro, 1e12 * metre, atol=1e-9 * np.abs(micro).max())


def test_patch() -> None:
    """Uniform pressure on a block that may spread: the stress of the load at every point.

    Source: equilibrium of a bar under pressure p, N = p, exact for every element that holds a
    linear field; the plane is met exactly, so the foot stays at z = 0 to 1e-6 of a facet.
    """
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 2))})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    laws = (
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(1e-3, 1e-3)),
        Friction(coefficients=(1e-6, 1e-6)),
    )
    contact = Contact(
        model,
        "block.bottom",
        Interface(plane, *laws),
        augmentation=Augmentation(tangential=False),
    )
    problem = Problem(model, {"block": make_material("linear-elastic", E=YOUNG, nu=0.3)}, [contact])
    held = {"block.left": {"x": 0.0}, "block.front": {"y": 0.0}}
    down = Step("down", 1, held | {"block.top": {"z": -0.005}})
    for _ in Solver(problem, [down]).run():
        pass
    np.testing.assert_allclose(contact.last.pressure, 0.01 * YOUNG, rtol=1e-5)
    assert np.abs(contact.state["gap"]).max() < 1e-6 / 3.0
