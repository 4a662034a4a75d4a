"""Tall bodies that contact and their weight alone hold: they come down on an edge, and stand."""

from __future__ import annotations

from typing import Any

import pytest

TOWER = """
[idealisation]
kind = "plane-strain"
thickness = 1
[mesh.rectangle.low]
origin = [0, 0]
size = [1, 3]
cells = [2, 6]
move = [0, 0.02, 0]
[mesh.rectangle.high]
origin = [0, 0]
size = [1, 4]
cells = [3, 12]
move = [0, 3.04, 0]
rotate = { axis = [0, 0, 1], angle_deg = 1 }
[mesh.rectangle.base]
origin = [-2, -1]
size = [5, 1]
cells = [11, 2]
[material.low]
model = "linear-elastic"
E = 1000
nu = 0.3
[material.high]
model = "linear-elastic"
E = 1000
nu = 0.3
[material.base]
model = "linear-elastic"
E = 1000
nu = 0.3
[[contact]]
slave = "low.bottom"
master = "base.top"
friction = { coefficients = 0.3 }
[[contact]]
slave = "high.bottom"
master = "low.top"
friction = { coefficients = 0.3 }
[[step]]
name = "fall"
increments = 2
displacement = { "base.bottom" = { x = 0, y = 0 } }
body_force = { low = { y = -0.1 }, high = { y = -0.1 } }
"""


@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
def test_towers_on_each_other_come_down_on_their_edges(strategy: str, to_the_end: Any) -> None:
    """Two towers, a little apart, the upper inclined by a degree, fall on a base and on each other.

    Requirement: springs that hold a body where an edge of it has touched let it turn about that
    edge only as far as the rest of its foot has to come down: 25 corrections at most, without a
    cut (60 and more where they faded tenfold whatever the body did). Their energy is all that
    the loads do beyond the strain: contact that stops a turn is known as well as what stops a fall.
    Sources: equilibrium, the forces are the weights to 1e-6; the balance of energy to 1e-6 of the
    work, 0.1 where only the first touch counted.
    """
    run = to_the_end(TOWER, solver=f'strategy = "{strategy}"')
    assert not run.cuts
    assert sum(one.iterations for one in run.accepted) <= 25
    assert run.force("fall", 0)[1] == pytest.approx(0.7, rel=1e-6)
    assert run.force("fall", 1)[1] == pytest.approx(0.4, rel=1e-6)
    energies = run.ends["fall"].energies
    assert abs(energies["residual"]) < 1e-6 * energies["external"]
    assert energies["stabilisation"] > 0.5 * energies["external"]
