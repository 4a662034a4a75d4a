"""Steady slip of an elastic block on a plane with orthotropic friction."""

import numpy as np
import pytest

MARKS = np.radians(20.0)  # direction of the first axis of friction to x
FRICTION = (0.3, 0.1)
ANGLES = (0, 15, 30, 45, 60, 90)


def dragged(fe, interface, direction):
    """Tangential and normal resultant after a slide that is long against the elastic lengths."""
    from anisocontact.solver import Step

    block = fe.block(interface)
    x, y = 0.3 * np.array(direction)
    block.run(
        Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}),
        Step("drag", 30, {"block.top": {"x": x, "y": y}}),
    )
    assert block.contact.counts()["slip"] == block.contact.areas.size
    force, _ = block.contact.resultant()
    return force[:2], force[2]


@pytest.mark.parametrize("degrees", ANGLES)
def test_maximum_dissipation_follows_the_closed_form(fe, degrees):
    """Resultant of steady slip at an angle q to the first axis of friction.

    Requirement: direction and size within 0.5 %. Source: stationarity of the dissipation with
    respect to the force, T/N = -(m1^2 cos q, m2^2 sin q)/h, h^2 = m1^2 cos^2 q + m2^2 sin^2 q.
    Tolerance: in the steady state every point has this very force, whatever the mesh. What is left
    of the start dies out exponentially with the slide; after 0.3, against elastic lengths of
    0.01, only the tolerance of Newton (1e-8) remains, and 1e-6 leaves room for it.
    """
    q = np.radians(degrees)
    m, e = np.array(FRICTION), np.array([np.cos(q), np.sin(q)])
    principal = -(m**2) * e / np.linalg.norm(m * e)
    c, s = np.cos(MARKS), np.sin(MARKS)
    expected = np.array([[c, -s], [s, c]]) @ principal

    interface = fe.interface(coefficients=FRICTION, angle=MARKS)
    force, pressure = dragged(fe, interface, (np.cos(MARKS + q), np.sin(MARKS + q)))

    assert np.linalg.norm(force / pressure - expected) < 1e-6 * np.linalg.norm(expected)


@pytest.mark.parametrize("degrees", ANGLES)
@pytest.mark.parametrize("adhesion_degrees", [20.0, 65.0], ids=["coaxial", "turned"])
def test_explicit_follows_its_closed_form(fe, degrees, adhesion_degrees):
    """Resultant of steady slip with the sliding force (96) and the history of centres (123).

    Requirement: within 0.5 % of T = -N S F S e / sqrt(SFSe . F . SFSe), e the direction of slip,
    S = -B. Source: fixed point of (113), (114), (123) with (96), [Konyukhov Schweizerhof 2006].
    Tolerance: as for maximum dissipation.
    """
    stiffness = (4e3, 1e3)
    q = MARKS + np.radians(degrees)
    e = np.array([np.cos(q), np.sin(q)])
    s_tensor = fe.tensor(stiffness, np.radians(adhesion_degrees))
    f_tensor = fe.tensor(tuple(m**-2 for m in FRICTION), MARKS)
    h = s_tensor @ f_tensor @ s_tensor @ e
    expected = -h / np.sqrt(h @ f_tensor @ h)

    interface = fe.interface(
        stiffness=stiffness,
        coefficients=FRICTION,
        angle=MARKS,
        adhesion_angle=np.radians(adhesion_degrees),
        rule="explicit",
        history="centre",
    )
    force, pressure = dragged(fe, interface, e)

    assert np.linalg.norm(force / pressure - expected) < 1e-6 * np.linalg.norm(expected)
