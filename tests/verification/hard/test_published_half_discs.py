"""Two half discs that slide past each other, as deep in one another as a fifth of their radius.

Source: sliding of two half discs past each other, a benchmark of large sliding between deformable
bodies [B. Yang, T. A. Laursen, X. Meng, Int. J. Numer. Meth. Engng 62 (2005) 1183]. It has no
closed form. But without friction forces hang on the place alone, and places as far before the
middle of the way as behind it are mirror images: there the side force has the other sign and the
force across is the same, so that the side force does no work in all.

Requirement: both forces mirrored in every increment, orders 1 and 2, slave and master with other
numbers of facets, no cut, and at most 8 corrections. Tolerance: that of Newton's method, measured
6e-11 of the largest force, as each of the meshes is its own mirror image; 6 corrections.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

CASE = """
title = "Half discs"
[idealisation]
kind = "plane-strain"
[mesh.annulus.lower]
inner = 0.5
outer = 1
start_deg = 0
end_deg = 180
cells = [{across}, {around}]
order = {order}
[mesh.annulus.upper]
inner = 0.5
outer = 1
start_deg = 180
end_deg = 360
cells = [{across}, {other}]
order = {order}
move = [-2, 1.6, 0]
[join]
"lower.foot" = ["lower.start", "lower.end", "lower.inner"]
"upper.foot" = ["upper.start", "upper.end", "upper.inner"]
[material.lower]
model = "neo-hookean"
E = 1000
nu = 0.3
[material.upper]
model = "neo-hookean"
E = 1000
nu = 0.3
[[contact]]
slave = "upper.outer"
master = "lower.outer"
friction = {{ coefficients = 0 }}
[[step]]
name = "pass"
increments = 20
displacement = {{ "lower.foot" = {{ x = 0, y = 0 }}, "upper.foot" = {{ x = 4, y = 0 }} }}
"""


@pytest.mark.parametrize(("order", "across", "around"), [(1, 3, 20), (2, 2, 12)])
def test_pass(to_the_end: Callable[..., Any], order: int, across: int, around: int) -> None:
    """Forces before and after the middle of the way."""
    text = CASE.format(order=order, across=across, around=around, other=around + 2)
    run = to_the_end(text)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 8
    (contact,) = run.problem.contacts
    forces = np.array([part.resultants[contact.name][0][:2] for part in run.accepted])
    before, after = forces[:9], forces[10:19][::-1]
    largest = np.abs(forces).max()
    assert (before[4:, 1] > 0.0).all()
    assert before == pytest.approx(after * [-1.0, 1.0], abs=1e-8 * largest)
    assert abs(forces[9, 0]) < 1e-8 * largest
