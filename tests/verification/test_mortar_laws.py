"""Mortar contact: every law at slave nodes, directions on either body, blocks that slide."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from tests.verification.laws_in_python import RadialReturn

from anisocontact.anisotropy import make_directions
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, PythonLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box

Floats = npt.NDArray[np.float64]

PRESSURE, PENALTY = 10.0, 4e4


def _law() -> ContactLaw:
    adhesion, friction = Adhesion(stiffness=(1e3, 1e3)), Friction(coefficients=(0.3, 0.3))
    return ContactLaw(NormalLaw(penalty=PENALTY), adhesion, friction)


def _sliding_forces(
    law: ContactLaw, pieces: int, size: float = 1.0, mortar: bool = True
) -> Iterator[Floats]:
    """Forces on a rigid block that slides along a base, in equal increments."""
    upper = BoxSpec((0.1, 0.05, 0), (1, 1, 1), (3, 3, 1))
    lower = BoxSpec((-0.5, -0.5, -1), (2.2, 2.1, 1), (4, 5, 1))
    model = build_box({"upper": upper, "lower": lower})
    contact = Contact(model, "upper.bottom", "lower.top", law, mortar=mortar, current_area=False)
    block = np.unique(model.space.dofmap.list[model.cells("upper")])
    u = np.zeros_like(model.space.tabulate_dof_coordinates())
    u[block, 2] = -PRESSURE / PENALTY
    for _ in range(pieces):
        u[block, :2] += size * np.array([0.3, 0.4]) / pieces
        contact.update(u, 0.1)
        contact.commit()
        yield contact.resultant()[0]


def test_sliding_across_facets() -> None:
    """A rigid block over the facets of a flat base: mu N against the way, 1e-9, however cut.

    Source: Coulomb friction; elastic slip stays within its ellipse and is carried from facet to
    facet.
    """
    area = PRESSURE * 1.0
    for pieces in (1, 7):
        *_, last = _sliding_forces(_law(), pieces)
        np.testing.assert_allclose(last, area * np.array([-0.18, -0.24, 1.0]), rtol=1e-9)


@pytest.mark.parametrize("angle", [0.0, 0.5])
@pytest.mark.parametrize("on", ["master", "slave"])
def test_directions_of_either_body(on: str, angle: float) -> None:
    """Orthotropic friction of a block in steady sliding, directions on either body: 1e-8.

    Source: maximum dissipation, T = - N M^2 e / sqrt(e . M^2 e) with the coefficients along the
    axes in M and the way e. Angles turn about the normal of the master, which points up, whichever
    body carries the directions (docs/theory/meshed-contact.md).
    """
    marks = make_directions("constant", vector=(1.0, 0.3, 0.0), angle=angle)
    adhesion = Adhesion(stiffness=1e5)
    friction = Friction(coefficients=(0.3, 0.1), directions=marks, directions_on=on)
    law = ContactLaw(NormalLaw(penalty=PENALTY), adhesion, friction)
    *_, last = _sliding_forces(law, 7)
    turned = np.arctan2(0.3, 1.0) + angle
    axes = np.array([[np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]])
    shares = np.array([0.3, 0.1]) * (axes @ np.array([0.6, 0.8]))
    expected = -(axes.T @ (np.array([0.3, 0.1]) * shares)) / np.linalg.norm(shares)
    np.testing.assert_allclose(last / PRESSURE, [*expected, 1.0], atol=1e-8)


MARKS = make_directions("constant", vector=(1.0, 0.3, 0.0))
STIFF: dict[str, Any] = {"stiffness": (600.0, 900.0), "directions": MARKS}
MU: dict[str, Any] = {"coefficients": (0.3, 0.1), "directions": MARKS}
LAWS: dict[str, tuple[Any, Any]] = {
    rule: (Adhesion(**STIFF), Friction(sliding_rule=rule, **MU, **more))
    for rule, more in {
        "maximum-dissipation": {},
        "explicit": {"history": "centre"},
        "radial": {},
        "linear": {},
        "coaxial": {},
        "slip-ellipse": {"slip_axes": (0.2, 0.4)},
    }.items()
}
LAWS |= {
    model: (Adhesion(model, **STIFF, **more), Friction(**MU))
    for model, more in {
        "maxwell": {"relaxation_time": (0.3, 0.5)},
        "kelvin-voigt": {"viscosity": (50.0, 70.0)},
        "standard-linear-solid": {"stiffness_maxwell": 300.0, "relaxation_time": (0.3, 0.5)},
    }.items()
}
LAWS["python"] = (PythonLaw(RadialReturn((600.0, 900.0), (0.3, 0.1)), directions=MARKS), None)


@pytest.mark.parametrize("name", LAWS)
def test_every_law_is_asked_as_at_points(name: str) -> None:
    """From stick into slip: force in every increment as from integration points, 1e-9.

    Source: the state of a rigid block on a flat base is the same everywhere, so that it does not
    matter where the law is asked; its answers there have tests of their own.
    """
    law = ContactLaw(NormalLaw(penalty=PENALTY), *LAWS[name])
    at_nodes, at_points = (
        np.array(list(_sliding_forces(law, 9, 0.04, mortar))) for mortar in (True, False)
    )
    np.testing.assert_allclose(at_nodes, at_points, atol=1e-9 * PRESSURE)
    shear = np.linalg.norm(at_nodes[:, :2], axis=1)
    assert shear.min() > 0.5
    assert shear.max() < 3.0 + 1e-9


def test_a_slave_that_leans_against_its_master() -> None:
    """A rigid block, tilted by 14 degrees and pressed in, slides along a flat base, then turns.

    Requirement: turns are those along an increment, however far the averaged normal of the slave
    is from that of the master; slip is the way along the contact plane. Source: rigid motions:
    nothing turns while the block slides by (0.06, 0.08), which is (0.06 cos t, 0.08) along a plane
    tilted by t; then it turns by 0.1. Tolerances: 1e-7 radian, the root of rounding; slip 1e-6, its
    elastic part at this stiffness.
    """
    law = ContactLaw(
        NormalLaw(penalty=1.0), Adhesion(stiffness=(1e6, 1e6)), Friction(coefficients=(0.1, 0.1))
    )
    upper = BoxSpec((0.1, 0.05, 0), (1, 1, 1), (3, 3, 1))
    lower = BoxSpec((-0.5, -0.5, -1), (2.2, 2.1, 1), (4, 5, 1))
    model = build_box({"upper": upper, "lower": lower})
    contact = Contact(model, "upper.bottom", "lower.top", law, mortar=True, current_area=False)
    x = np.array(model.space.tabulate_dof_coordinates())
    block = np.unique(model.space.dofmap.list[model.cells("upper")])
    u, centre, angle = np.zeros_like(x), np.array([0.6, 0.5, 0.0]), 0.25

    def move(angle: float, way: tuple[float, float]) -> Floats:
        cos, sin = np.cos(angle), np.sin(angle)
        turn = np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])
        u[block] = (x[block] - centre) @ turn.T + centre - x[block] + (*way, -0.3)
        contact.update(u, 0.1)
        contact.commit()
        return np.array(contact.state["slip_accumulated"])

    before = move(angle, (0.0, 0.0))
    for i in (1, 2):
        slipped = move(angle, (0.06 * i, 0.08 * i))
        assert contact.counts()["slip"] == 16
        assert contact.state["turn"].max() < 1e-7
        np.testing.assert_allclose(
            slipped - before, np.hypot(0.06 * np.cos(angle), 0.08), atol=1e-6
        )
        before = slipped
    move(angle + 0.1, (0.12, 0.16))
    np.testing.assert_allclose(contact.state["turn"], 0.1, atol=1e-7)
