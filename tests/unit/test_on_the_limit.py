"""A point that has slipped is on the limit of friction: rounding is not to say what comes next."""

from __future__ import annotations

import numpy as np
import pytest
from tests.conftest import make_interface

STICK, SLIP = 1, 2


@pytest.mark.parametrize("rule", ["maximum-dissipation", "linear", "coaxial", "radial"])
def test_a_point_that_rests_after_slip_sticks(rule: str) -> None:
    """Seen again where they are, slipped points all stick; moved on, they slip again.

    The trial force is on the limit then. Decided by rounding, 18 to 59 % of the points slipped, and
    Newton's method began every increment with another tangent for each order of the sums. The
    elastic slip is 1e-3, so that rounding of positions of 1 is 1e-13 of the limit.
    """
    interface = make_interface(rule=rule, penalty=1e4, stiffness=(4e3, 1e3), angle=0.4)
    rng = np.random.default_rng(1)
    x = np.column_stack([rng.uniform(-1.0, 1.0, (500, 2)), np.full(500, -1e-3)])
    way = np.pad(rng.standard_normal((500, 2)), ((0, 0), (0, 1))) * 0.1
    begun = interface.update(interface.initial_state(x), x)
    slipped = interface.update(begun.state, x + way)
    assert np.all(slipped.status == SLIP)
    for noise in (0.0, 3e-16, -3e-16):
        rests = interface.update(slipped.state, (x + way) * (1.0 + noise))
        assert np.all(rests.status == STICK)
        np.testing.assert_allclose(rests.traction, slipped.traction, rtol=0.0, atol=1e-9)
    moves = interface.update(slipped.state, x + way + 1e-6 * way)
    assert np.all(moves.status == SLIP)
