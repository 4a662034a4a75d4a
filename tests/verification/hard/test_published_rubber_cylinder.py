"""A rubber cylinder pressed between two plates to half of its diameter.

The reference forces are from memory, and not read again in the manual.

Source: T. Sussman, K. J. Bathe, A finite element formulation for nonlinear incompressible elastic
and inelastic analysis, Comput. Struct. 26 (1987) 357; verification problem 211 of Ansys: radius
0.2 m, Mooney-Rivlin constants 0.293 and 0.177 MPa, without friction. The force is 250 kN per metre
where the plates have come 0.1 m closer, 1400 where they have come 0.2 m.

Requirement: both forces, order 1 and 2, no cut, at most 6 corrections in each of eight increments;
at most 32 where it takes two increments. Tolerance: 2 %, as the source
has two digits (64 x 8 cells of order 2: 252.9 and 1414.9; measured 252.0 and 1410.7, 253.2 and
1415.4; 5 corrections, 25 in two increments).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

CASE = """
title = "Rubber cylinder"
symmetry = ["roll.left", "roll.top"]
[idealisation]
kind = "plane-strain"
[mesh.disc.roll]
radius = 0.2
cells = {cells}
part = "quarter"
order = {order}
[material.roll]
model = "mooney-rivlin"
C10 = 293
C01 = 177
bulk_modulus = 1e6
[surface.plate]
shape = "plane"
point = [0, -0.2, 0]
normal = [0, 1, 0]
[rigid.plate]
reference = [0, -0.2, 0]
[[contact]]
slave = "roll.outer"
master = "plate"
friction = {{ coefficients = 0 }}
[[step]]
name = "press"
increments = {increments}
motion = {{ plate = {{ y = 0.1 }} }}
"""


@pytest.mark.parametrize(("cells", "order"), [([64, 8], 1), ([32, 4], 2)])
def test_force_of_a_rubber_cylinder(
    to_the_end: Callable[..., Any], cells: list[int], order: int
) -> None:
    """At a quarter and at half of the diameter."""
    run = to_the_end(CASE.format(cells=cells, order=order, increments=8))
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 6
    name = run.problem.contacts[0].name
    force = [2.0 * part.resultants[name][0][1] for part in run.accepted]
    assert [force[3], force[7]] == pytest.approx([250.0, 1400.0], rel=0.02)


def test_all_of_it_in_two_increments(to_the_end: Callable[..., Any]) -> None:
    """Half of the points come to the plate in one increment."""
    run = to_the_end(CASE.format(cells=[32, 4], order=2, increments=2))
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 32
    assert 2.0 * run.force("press")[1] == pytest.approx(1400.0, rel=0.02)
