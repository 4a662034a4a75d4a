"""A ball turns on a block: axisymmetric with twist."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.results import Results

CASE = Path(__file__).parents[2] / "examples" / "drill" / "case.toml"


@pytest.mark.slow
def test_torque_is_that_of_friction_around(tmp_path, solved):
    """Torque once everything slips.

    Requirement: the integral of mu_2 p r over the contact, mu_2 the coefficient around. Source: the
    pressure of Hertz with the force of the run, 3 pi/16 mu_2 P a. Tolerance: a block of 20 a and a
    ball that is no parabola (a/R = 0.1), 0.9 %; the radial force of the press step still falls.
    """
    results: Results = solved(CASE, tmp_path / "out")
    history = results.history
    force = -history["contacts.0.force.y"][-1]
    radius = (0.75 * force * 10.0 * (1.0 - 0.3**2) / 1000.0) ** (1.0 / 3.0)
    torque = history["rigid.ball.support_moment.y"][-1]
    assert torque == pytest.approx(3.0 * np.pi / 16.0 * 0.1 * force * radius, rel=0.01)
    assert history["contacts.0.force.x"][-1] < 0.1 * force
