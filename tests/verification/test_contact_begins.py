"""Where and how a contact begins within a step [Konyukhov Schweizerhof 2006, eq. (101)]."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

FROM, TO = np.array([[0.2, -0.1, 0.03]]), np.array([[0.26, 0.02, -0.01]])
#: The gap closes after three quarters of the straight motion.
CLOSES = 0.75


@pytest.fixture
def interface() -> Interface:
    return Interface(
        make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0)),
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(10.0, 10.0)),
        Friction(coefficients=(9.0, 9.0)),
    )


def test_force_is_of_the_slip_in_contact(interface: Interface) -> None:
    """Only the part of the motion after the gap closed makes a force: T = -k (1 - 3/4) dx.

    Tolerance 1e-12: rounding.
    """
    r = interface.update(interface.initial_state(FROM), TO)
    expected = -10.0 * (1.0 - CLOSES) * (TO - FROM)[0, :2]
    assert r.traction[0, :2] == pytest.approx(expected, rel=1e-12)


def test_origin_is_where_the_gap_closed(interface: Interface) -> None:
    """xi_(0) is where the gap closed; a later step leaves it. Tolerance 1e-12: rounding."""
    r = interface.update(interface.initial_state(FROM), TO)
    expected = (FROM + CLOSES * (TO - FROM))[0, :2]
    assert r.state["origin"][0] == pytest.approx(expected, rel=1e-12)
    again = interface.update(r.state, TO + np.array([0.001, 0.0, 0.0]))
    assert again.state["origin"][0] == pytest.approx(expected, rel=1e-12)


def test_loss_and_return(interface: Interface) -> None:
    """Lifted off, a point forgets its force; put back straight, it starts without one."""
    state = interface.update(interface.initial_state(FROM), TO).state
    lifted = interface.update(state, TO + np.array([0.0, 0.0, 0.05]))
    assert lifted.status[0] == 0
    assert not lifted.traction.any()
    back = interface.update(lifted.state, TO)
    assert back.status[0] == 1
    assert not back.traction[0, :2].any()
    assert back.state["origin"][0] == pytest.approx(TO[0, :2], rel=1e-12)
