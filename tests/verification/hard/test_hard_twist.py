"""Twisted blocks: directions on a master whose facets turn by unequal amounts."""

from __future__ import annotations

import numpy as np

TWIST = """
title = "Twisting blocks"
[mesh.box.upper]
origin = [-0.5, -0.5, 1.0]
size = [1, 1, 1]
cells = [4, 4, 2]
[mesh.box.lower]
origin = [-0.75, -0.75, 0]
size = [1.5, 1.5, 1]
cells = [6, 6, 2]
[material.upper]
model = "neo-hookean"
E = 1000
nu = 0.3
[material.lower]
model = "neo-hookean"
E = 1000
nu = 0.3
[[contact]]
slave = "upper.bottom"
master = "lower.top"
friction = { coefficients = [0.5, 0.3], directions = { kind = "constant", vector = [1, 0, 0] } }
[[step]]
name = "press"
increments = 2
displacement."lower.bottom" = { x = 0, y = 0, z = 0 }
displacement."upper.top" = { x = 0, y = 0, z = -0.2 }
[[step]]
name = "twist"
increments = 12
displacement."lower.bottom" = { x = 0, y = 0, z = 0 }
rotation."upper.top" = { axis = [0, 0, 1], angle_deg = 90 }
"""


def test_twisted_blocks_with_directions_on_the_base(to_the_end):
    """A block is twisted by 90 degrees on a base whose marks turn with it: neo-Hooke, both slide.

    Source: the blocks of Puso and Laursen (2004), with two coefficients of friction. Requirement:
    no cut, multipliers in every increment, and by symmetry about the axis no lateral force, 1e-8 of
    the normal one. What the marks of the base do has to be continuous where nodes pass the edges of
    its facets: the middle node stands above a vertex, others cross edges.
    """
    run = to_the_end(TWIST)
    assert not run.cuts
    assert max(a.iterations for a in run.accepted) <= 6
    force = run.force("twist")
    assert np.abs(force[:2]).max() < 1e-8 * force[2]
