"""Sliding while the pressure changes, and loss and return of contact, through the interface.

Requirement: decreasing N, loss and return of contact. Source: |T|_F <= N holds at the N of the same
step; a point without contact has no force and no history, and starts anew where it comes back
[Konyukhov Schweizerhof 2006, section 4.3, eq. (101)]. Tolerances are roundings: 1e-12 of the
pressure.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

PENALTY, MU = 1e3, np.array([0.4, 0.2])
MARKS = make_directions("constant", vector=(1, 0, 0), angle=0.3)


@pytest.fixture
def itf(rule):
    return Interface(
        make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0)),
        NormalLaw(penalty=PENALTY),
        Adhesion(stiffness=(4e2, 1e2), directions=MARKS),
        Friction(coefficients=MU, directions=MARKS, sliding_rule=rule.name, **rule.parameters),
    )


def part_of_limit(r):
    """|T|_F/N."""
    return np.linalg.norm(r.traction_principal / MU, axis=1) / r.pressure


def drag(itf, x, steps):
    state = itf.initial_state(x)
    for step in steps:
        x = x + step
        response = itf.update(state, x)
        state = response.state
    return response, x


def test_force_falls_with_the_pressure(itf):
    """Dragged while it is lifted, down to a thousandth of the pressure: on the ellipse of each
    step."""
    response, x = drag(itf, np.array([[0.0, 0.0, -4e-3]]), [[6e-3, 1e-3, 0.0]] * 4)
    assert response.status == 2
    for depth in np.geomspace(4e-3, 4e-6, 12)[1:]:
        x = np.array([[x[0, 0] + 2e-3, x[0, 1] - 5e-4, -depth]])
        response = itf.update(response.state, x)
        assert response.status == 2 and not response.failed.any()
        assert response.pressure[0] == pytest.approx(PENALTY * depth, rel=1e-12)
        assert part_of_limit(response)[0] == pytest.approx(1.0, rel=1e-12)


def test_lifted_in_place_the_force_falls_with_the_pressure(itf):
    """No increment but along the normal: the held force leaves the shrinking ellipse and slips
    back, dissipating; the elastic slip does not grow."""
    response, x = drag(itf, np.array([[0.0, 0.0, -4e-3]]), [[6e-3, 1e-3, 0.0]] * 4)
    elastic = np.linalg.norm(response.state["elastic"])
    dissipated = response.state["dissipation"][0]
    for depth in (2e-3, 5e-4, 5e-5):
        x = x * [1, 1, 0] - [0.0, 0.0, depth]
        response = itf.update(response.state, x)
        assert response.status == 2 and not response.failed.any()
        assert part_of_limit(response)[0] == pytest.approx(1.0, rel=1e-12)
        assert response.state["dissipation"][0] > dissipated
        dissipated = response.state["dissipation"][0]
    assert np.linalg.norm(response.state["elastic"]) < elastic


def test_loss_and_return(itf):
    """Lifted off: no traction, no tangent, no history but what has accumulated. Back in contact the
    force is that of a fresh point, from the place where the gap closed."""
    response, x = drag(itf, np.array([[0.0, 0.0, -4e-3]]), [[6e-3, 1e-3, 0.0]] * 4)
    kept = response.state["dissipation"][0], response.state["slip_accumulated"][0]
    assert kept[0] > 0.0
    off = itf.update(response.state, x * [1, 1, 0] + [0.02, 0.01, 1e-3])
    assert off.status == 0
    np.testing.assert_array_equal(off.traction, 0.0)
    np.testing.assert_array_equal(off.tangent, 0.0)
    for name in ("stored", "elastic", "traction", "slip", "pressure"):
        np.testing.assert_array_equal(off.state[name], 0.0)
    assert (off.state["dissipation"][0], off.state["slip_accumulated"][0]) == kept

    back = off.state["xi"] + [2e-4, 1e-4]
    x = np.column_stack([back, [-1e-3]])
    again = itf.update(off.state, x)
    # half of the way up to the surface was without contact (gap 1e-3 -> -1e-3)
    start = off.state["xi"] + [1e-4, 5e-5]
    fresh = itf.update(itf.initial_state(np.column_stack([start, [0.0]])), x)
    np.testing.assert_allclose(again.traction, fresh.traction, rtol=0, atol=1e-12)
    assert again.state["dissipation"][0] >= kept[0]


def test_update_is_pure(itf):
    """The committed state is not changed, and the same call gives the same bits."""
    response, x = drag(itf, np.array([[0.0, 0.0, -4e-3]]), [[6e-3, 1e-3, 0.0]] * 3)
    before = response.state.copy()
    a = itf.update(response.state, x + 1e-3)
    b = itf.update(response.state, x + 1e-3)
    np.testing.assert_array_equal(before, response.state)
    np.testing.assert_array_equal(a.traction, b.traction)
    np.testing.assert_array_equal(a.state, b.state)
