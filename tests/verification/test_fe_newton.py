"""Newton's method on the assembled system."""

from itertools import pairwise

import numpy as np
import pytest


@pytest.mark.parametrize("rule", ["maximum-dissipation", "radial", "explicit"])
@pytest.mark.parametrize("start_degrees", [0.0, 40.0])
def test_quadratic_tail(fe, rule, start_degrees):
    """In a slide that turns, the last corrections square the residual.

    Requirement: quadratic tail. Source: Newton's method with the exact tangent of a residual that
    is smooth where no point changes its status. Tolerance: for residuals between 1e-13 (round-off)
    and 1e-2, log r_(k+1) / log r_k tends to 2 as the constant of the quadratic law
    loses its weight. 1.8 separates it from linear convergence, where it is nearly 1.
    """
    from anisocontact.solver import Step

    block = fe.block(fe.interface(angle=np.radians(start_degrees), rule=rule))
    steps = [
        Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}),
        Step("along x", 4, {"block.top": {"x": 0.04}}),
        Step("along y", 8, {"block.top": {"y": 0.08}}),
    ]
    orders = []
    for accepted in block.run(*steps, snes_rtol=1e-12):
        if accepted.step == "along y" and accepted.contacts["block.bottom"]["slip"] == 36:
            r = [v for v in accepted.residuals if 1e-13 < v < 1e-2]
            orders += [np.log(b) / np.log(a) for a, b in pairwise(r) if a < 1e-3]
    assert len(orders) >= 3
    assert min(orders) > 1.8
