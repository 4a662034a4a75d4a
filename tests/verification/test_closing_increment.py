"""Friction in the increment in which a gap closes.

A block rests on springs of one stiffness k in every direction, g above a plane, and is loaded with
tractions in proportion, s p. It comes along a straight way, touches at s_c = k g / p_z and, while s
grows,

    N = s p_z - k g,    T = - (s - s_c) p_t   where it sticks, |T| = mu N where it slips,

with a constant direction of T, whatever number of increments the way is taken in. With a penalty in
series, as stiff along the normal as along the plane, it sticks at the same traction.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import Augmentation, ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import ElasticSupport, Problem, Solver, Step
from anisocontact.surfaces import make_surface

STIFFNESS, GAP, DOWN = 100.0, 0.01, 3.0
#: Share of the load at which the block touches, and the pressure at the end.
TOUCH = STIFFNESS * GAP / DOWN
PRESSURE = DOWN - STIFFNESS * GAP
ALONG = np.array([1.0, 0.5])


def landed(
    coefficients: tuple[float, float],
    increments: int,
    *,
    rule: str = "maximum-dissipation",
    meshed: bool = False,
    penalty: float | None = None,
    multipliers: str = "auto",
) -> tuple[np.ndarray, Contact]:
    """Traction at the slave nodes in the end, and the contact; with multipliers or a penalty."""
    boxes, held = {"block": BoxSpec((0, 0, GAP), (1, 1, 0.5), (2, 2, 1))}, {}
    if meshed:
        boxes["base"] = BoxSpec((-0.5, -0.5, -0.5), (2, 2, 0.5), (3, 3, 1))
        held = {f"base.{side}": {"x": 0.0, "y": 0.0, "z": 0.0} for side in ("bottom", "top")}
    model = build_box(boxes)
    marks = make_directions("constant", vector=(1, 0, 0), angle=0.4)
    law = ContactLaw(
        NormalLaw(penalty=penalty or 1e4),
        Adhesion(stiffness=penalty or 3e3),
        Friction(coefficients=coefficients, sliding_rule=rule, directions=marks),
    )
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = Contact(
        model,
        "block.bottom",
        "base.top" if meshed else Interface(plane, law),
        law=law if meshed else None,
        mortar=True,
        augmentation=None if penalty else Augmentation(multipliers=multipliers),
    )
    bodies = {name: make_material("linear-elastic", E=1e4, nu=0.0) for name in boxes}
    bed = ElasticSupport("block.bottom", normal=STIFFNESS, tangential=STIFFNESS)
    load = {"block.bottom": {"x": ALONG[0], "y": ALONG[1], "z": -DOWN}}
    problem = Problem(model, bodies, [contact], [bed])
    list(Solver(problem, [Step("land", increments, held, traction=load)]).run())
    return contact.last.traction, contact


def check(traction: np.ndarray, along: np.ndarray, pressure: float = PRESSURE) -> None:
    """Every node has this traction, to what Newton's method and multipliers leave: 1e-6 of N."""
    exact = np.tile([*along, pressure], (len(traction), 1))
    np.testing.assert_allclose(traction, exact, rtol=0.0, atol=1e-6 * PRESSURE)


@pytest.mark.parametrize("meshed", [False, True], ids=["plane", "mesh"])
@pytest.mark.parametrize("increments", [1, 2, 5])
def test_sticks(increments: int, meshed: bool) -> None:
    """Springs carry what they did at the touch, the contact all that came later.

    Source: equilibrium, T = - (1 - s_c) p_t. Without friction in the increment in which the gap
    closes T is none in one increment.
    """
    traction, contact = landed((0.9, 0.9), increments, meshed=meshed)
    check(traction, -(1.0 - TOUCH) * ALONG)
    assert np.all(contact.last.status == 1)


@pytest.mark.parametrize("increments", [1, 3])
def test_penalty_sticks(increments: int) -> None:
    """Penalties e in series have always done so: both parts are e / (e + k) of the above."""
    traction, _ = landed((0.9, 0.9), increments, penalty=1e3)
    share = 1e3 / (1e3 + STIFFNESS)
    check(traction, -(1.0 - TOUCH) * ALONG * share, PRESSURE * share)


@pytest.mark.parametrize("increments", [1, 2, 5])
@pytest.mark.parametrize("multipliers", ["newton", "uzawa"])
def test_slips(increments: int, multipliers: str) -> None:
    """Where the way is flatter than friction is steep it slips, T = - mu N p_t / |p_t|.

    Nothing is dissipated in the increment of the touch, and nothing is won.
    """
    traction, contact = landed((0.2, 0.2), increments, multipliers=multipliers)
    check(traction, -0.2 * PRESSURE * ALONG / np.linalg.norm(ALONG))
    assert np.all(contact.last.status == 2)
    assert np.all(contact.state["dissipation"] >= 0.0)


@pytest.mark.parametrize("rule", ["maximum-dissipation", "radial"])
def test_slips_on_a_texture(rule: str) -> None:
    """With anisotropic friction one increment and five end with one force.

    Source: the loads grow in proportion, and so do N, T and the slip from the touch on; rules that
    are implicit answer the same in every part of the way.
    """
    one, contact = landed((0.25, 0.08), 1, rule=rule)
    assert np.all(contact.last.status == 2)
    five, _ = landed((0.25, 0.08), 5, rule=rule)
    check(five, one[0, :2])
