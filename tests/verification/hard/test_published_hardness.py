"""Rigid ball pressed into metal until it flows all around, and let go.

Requirement: mean pressure over the yield stress within 4 %: 2.84 - 0.92 (1 - cos(pi a/R)) with the
radius a of the contact; at most 15 corrections an increment in the mean, without a cut.
Source: fit to finite elements [Jackson Green 2005], quoted from memory; 2.84 is Tabor's hardness of
three yield stresses. Reason: the edge of the contact is known to half a facet, 4 % of a, of which
the mortar weights leave 2 % of the area. Corrections: 70 in all and 25 with letting go; 96 and 32
before contact was settled in each, 432 and 82 before tangents of what flows had a share of the
elastic one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

YIELD, DEPTH, PRESSES = 400.0, 0.03, 6
#: Corrections of an increment, in the mean.
MEAN = 15

CASE = f"""
[idealisation]
kind = "axisymmetric"

[mesh.rectangle.block]
origin = [0, -1]
size = [1, 1]
cells = [40, 40]
ratio = [10, 0.1]

[material.block]
model = "plastic"
E = 210e3
nu = 0.3
yield_stress = {YIELD}
strain = "logarithmic"

[surface.ball]
shape = "sphere"
centre = [0, 1, 0]
radius = 1

[rigid.ball]
reference = [0, 1, 0]

[[contact]]
slave = "block.top"
master = "ball"
friction = {{ coefficients = [0, 0] }}

[[step]]
name = "press"
increments = {PRESSES}
displacement = {{ "block.bottom" = {{ x = 0, y = 0 }} }}
motion = {{ ball = {{ y = -{DEPTH} }} }}

[output]
pictures = false
"""


LET_GO = """
[[step]]
name = "let go"
increments = 1
motion = { ball = { y = 0 } }
"""


def test_hardness(to_the_end: Callable[..., Any]) -> None:
    """Mean pressure under the ball, and corrections."""
    run = to_the_end(CASE, most=6000)
    contact = run.problem.contacts[0]
    area = contact.areas[contact.last.pressure > 0.0].sum()
    expected = 2.84 - 0.92 * (1.0 - np.cos(np.sqrt(np.pi * area)))
    assert -run.force("press")[1] / area / YIELD == pytest.approx(expected, rel=0.04)
    assert not run.cuts
    assert sum(part.iterations for part in run.accepted) <= MEAN * PRESSES


def test_let_go_at_once(to_the_end: Callable[..., Any]) -> None:
    """The ball leaves its dent in one increment, all points at once."""
    run = to_the_end(
        CASE.replace(f"-{DEPTH}", "-0.005").replace(f"= {PRESSES}", "= 1") + LET_GO, most=6000
    )
    assert run.force("let go")[1] == pytest.approx(0.0, abs=1e-6 * abs(run.force("press")[1]))
    assert not run.cuts
    assert sum(part.iterations for part in run.accepted) <= 2 * MEAN
