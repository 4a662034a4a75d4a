"""Crossed tubes that are crushed, on meshes that are symmetric: nodes stand right above edges."""

from __future__ import annotations

import numpy as np

TUBES = """
title = "Two crossed tubes"
[mesh.ring.lower]
inner = 0.8
outer = 1.0
length = 3
cells = [1, 24, 10]
rotate = { axis = [1, 0, 0], angle_deg = 90 }
move = [0, 1.5, 0]
[mesh.ring.upper]
inner = 0.8
outer = 1.0
length = 3
cells = [1, 28, 10]
rotate = { axis = [0, 1, 0], angle_deg = 90 }
move = [-1.5, 0, 2.001]
[group."lower.foot"]
by = "box"
low = [-0.3, -3, -1.1]
high = [0.3, 3, -0.9]
[group."upper.head"]
by = "box"
low = [-3, -0.3, 2.9]
high = [3, 0.3, 3.1]
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
friction = { coefficients = [0.3, 0.1], directions = { kind = "constant", vector = [1, 0, 0] } }
[[step]]
name = "crush"
increments = 10
displacement = { "lower.foot" = { x = 0, y = 0, z = 0 }, "upper.head" = { x = 0, y = 0, z = -0.8 } }
"""


def test_crossed_tubes(to_the_end):
    """Two tubes are crushed by 0.8 radii: neo-Hooke, two friction coefficients, symmetric meshes.

    Requirement: no cut, five iterations an increment, and by symmetry no lateral force, 1e-9 of the
    normal one. In front of an edge a node is as near to one facet as to the next; its place on the
    master is where its normal meets it, and does not jump.
    """
    run = to_the_end(TUBES, most=4000)
    assert not run.cuts
    assert max(a.iterations for a in run.accepted) <= 5
    force = run.force("crush")
    assert np.abs(force[:2]).max() < 1e-9 * force[2]
