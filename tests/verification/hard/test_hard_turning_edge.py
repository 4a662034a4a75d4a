"""Edges of blocks that turn by much, with a small share of the friction."""

import numpy as np
import pytest

from anisocontact.base.limits import FOLLOWED

CASE = """
[idealisation]
kind = "plane-strain"
[mesh.rectangle.block]
origin = [0, 0]
size = [1, 0.5]
cells = [24, 12]
[material.block]
model = "neo-hookean"
E = 1000.0
nu = 0.3
[mesh.rectangle.base]
origin = [-0.5, -0.5]
size = [2, 0.5]
cells = [32, 8]
[material.base]
model = "neo-hookean"
E = 500.0
nu = 0.3
[[contact]]
slave = "block.bottom"
master = "base.top"
pass = "single"
normal = {{ penalty = 1e5 }}
adhesion = {{ stiffness = [1e5, 1e5] }}
friction = {{ coefficients = 0.3 }}
[[step]]
name = "press"
increments = 5
displacement = {{ "block.top" = {{ x = 0, y = -0.1 }}, "base.bottom" = {{ x = 0, y = 0 }} }}
[[step]]
name = "drag"
increments = {drag}
displacement = {{ "block.top" = {{ x = 0.12 }} }}
"""


def test_a_point_at_the_edge_is_no_reason_to_cut(to_the_end):
    """Requirement: points are followed as far as the force that friction has there asks for.

    One of 48 points, with a tenth of the friction, turns by 20 degrees in the sixth increment of
    the drag. Source: four times as many increments. Tolerance: some tenths of a per cent of the
    force, what `FOLLOWED` stands for. How far the contact turns is the cubic mean, weighted with
    the tangential forces, to rounding.
    """
    run, fine = (to_the_end(CASE.format(drag=drag), most=6000) for drag in (6, 24))
    contact = run.problem.contacts[0]
    last, turn = contact.last, contact.last.state["turn"]
    weights = np.linalg.norm(contact.areas[:, None] * last.traction_t, axis=1)
    mean = np.average(turn**3, weights=weights) ** (1 / 3)
    assert contact.turn() == pytest.approx(mean, rel=1e-12)
    assert turn.max() > 1.2 * FOLLOWED > 1.2 * mean
    assert run.cuts == []
    force, expected = run.force("drag"), fine.force("drag")
    assert np.linalg.norm(force - expected) < 1e-3 * np.linalg.norm(expected)
