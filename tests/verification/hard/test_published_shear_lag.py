"""A strip that an elastic layer holds on a floor is pulled at its end: shear lag, and its slip.

Source: O. Volkersen, Luftfahrtforschung 15 (1938) 41; H. L. Cox, Br. J. Appl. Phys. 3 (1952) 72.
The layer has the stiffness K for each area, one of its own along each of two axes; the strip of the
thickness t does not contract, and gives way along the pull by E and sideways by its shear modulus
G:

    t diag(E, G) u'' = K u ,   u'(0) = 0 ,   u = cosh(M x) c ,   M^2 = (t diag(E, G))^-1 K .

Where the axes lean, the strip drifts sideways and carries shear, though no force is across the
pull. Where the layer holds no more than mu p, its end slips on a length s, with axes along the
pull: there E t u'' = mu p.

Requirement: force of the end, traction at every node along and across, place to which slip goes;
corrections. Tolerance: measured 0.25 % of the force and 0.12 % of the largest traction with 40
cells of order 1, whose friction is a sum over nodes, (h / l)^2 / 12 too large for cells of h on the
length l of shear lag; 2e-5 and 1.2e-4 with order 2. Where it slips 0.06 %, as friction below the
strip bends it by a moment that the pressure takes; place within a node. Two and five corrections.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.linalg import expm, sqrtm
from scipy.optimize import brentq
from tests.verification.hard.case_texts import on_a_floor

LENGTH, THICK, E, PRESSED = 20.0, 0.05, 1000.0, 0.01

LAWS = """
[contact.adhesion]
stiffness = [{along}, {across}]
directions = {{ kind = "constant", vector = [1, 0, 0], angle_deg = {angle} }}
[contact.friction]
coefficients = {friction}
[[step]]
name = "press"
increments = 1
pressure."strip.top" = {pressed}
[[step]]
name = "pull"
increments = 1
displacement."strip.right" = {{ x = {pull} }}
"""


def case(
    cells: int,
    order: int,
    stiffness: tuple[float, float],
    angle: float,
    friction: float,
    pull: float,
) -> str:
    """The case: cells along the strip, axes of the layer at an angle, way of the end."""
    size = (LENGTH, THICK)
    strip = on_a_floor("strip", size, (cells, 1), E, lateral=True, order=order)
    along, across = stiffness
    return strip + LAWS.format(
        along=along, across=across, angle=angle, friction=friction, pressed=PRESSED, pull=pull
    )


def strip(
    angle: float, stiffness: tuple[float, float], pull: float
) -> tuple[Callable[[float], npt.NDArray[np.float64]], float]:
    """Traction on the strip along x and z at a place, and the force at its end."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    axes = np.array([[c, -s], [s, c]])  # about the normal, upwards
    layer = axes.T @ np.diag(stiffness) @ axes
    gives = THICK * np.diag([E, 0.5 * E])
    rate = np.real(sqrtm(np.linalg.solve(gives, layer)))

    def part(x: float, sign: float) -> npt.NDArray[np.float64]:
        return np.asarray(0.5 * (expm(rate * x) + sign * expm(-rate * x)))

    slope = rate @ part(LENGTH, -1.0)
    ends = np.linalg.solve(np.array([part(LENGTH, 1.0)[0], slope[1]]), [pull, 0.0])
    return (lambda x: -layer @ part(x, 1.0) @ ends), float((gives @ slope @ ends)[0])


@pytest.mark.parametrize(
    ("angle", "stiffness", "order"),
    [(0.0, (4.0, 0.8), 1), (35.0, (4.0, 0.8), 1), (-50.0, (4.0, 0.8), 2), (35.0, (4.0, 0.1), 2)],
)
def test_layer_with_axes(
    to_the_end: Callable[..., Any],
    angle: float,
    stiffness: tuple[float, float],
    order: int,
) -> None:
    """Tractions along and across the pull, of a layer that holds them all."""
    pull = 2e-4
    run = to_the_end(case(40, order, stiffness, angle, 100, pull))
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 2
    traction, force = strip(angle, stiffness, pull)
    (contact,) = run.problem.contacts
    assert np.all(contact.last.status == 1)
    exact = np.array([traction(x) for x in contact.points[:, 0]])
    found = contact.last.traction[:, ::2]
    assert run.force("pull")[0] == pytest.approx(-force, rel=4e-3 if order == 1 else 1e-4)
    assert run.force("pull")[2] == pytest.approx(0.0, abs=1e-6 * force)
    assert np.abs(found - exact).max() < (2e-3 if order == 1 else 3e-4) * np.abs(exact).max()


@pytest.mark.parametrize(("cells", "order"), [(80, 1), (40, 2)])
def test_end_that_slips(to_the_end: Callable[..., Any], cells: int, order: int) -> None:
    """Friction 0.3, a layer of 4 for each area, in one increment."""
    friction, layer, pull = 0.3 * PRESSED, 4.0, 5e-3
    gives, most = E * THICK, friction / layer
    rate = np.sqrt(layer / gives)

    def slope(slips: float) -> float:
        return float(rate * np.tanh(rate * (LENGTH - slips)) * most)

    def end(slips: float) -> float:
        return most + slope(slips) * slips + 0.5 * friction * slips**2 / gives

    slips = float(brentq(lambda s: end(s) - pull, 0.0, LENGTH))
    force = gives * slope(slips) + friction * slips
    run = to_the_end(case(cells, order, (layer, layer), 0.0, 0.3, pull))
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 6
    (contact,) = run.problem.contacts
    place, slipping = contact.points[:, 0], contact.last.status == 2
    assert run.force("pull")[0] == pytest.approx(-force, rel=1e-3)
    assert abs(place[slipping].min() - (LENGTH - slips)) < 0.25
    assert np.all(slipping == (place >= place[slipping].min()))
