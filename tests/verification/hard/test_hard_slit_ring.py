"""A slit ring whose skin meets itself: edges of its ends, where faces meet at a right angle."""

from __future__ import annotations

import numpy as np

RING = """
[idealisation]
kind = "plane-strain"
[mesh.annulus.r]
inner = 0.8
outer = 1.0
cells = [3, 60]
start_deg = 1
end_deg = 359
[group."r.skin"]
by = "all"
[group."r.up"]
by = "box"
low = [-0.3, 0.9, -1]
high = [0.3, 1.1, 1]
[group."r.down"]
by = "box"
low = [-0.3, -1.1, -1]
high = [0.3, -0.9, 1]
[group."r.left"]
by = "box"
low = [-1.1, -0.2, -1]
high = [-0.9, 0.2, 1]
[join]
"r.ends" = ["r.start", "r.end"]
[material.r]
model = "neo-hookean"
E = 1000
nu = 0.3
[[contact]]
slave = "r.{group}"
master = "r.{group}"
self_contact = true
friction.coefficients = 0.3
[[step]]
name = "press"
increments = 3
[step.displacement]
"r.up" = {{ y = -0.05 }}
"r.down" = {{ y = 0.04 }}
"r.left" = {{ x = 0 }}
"""


def test_skin_of_a_slit_ring(to_the_end):
    """The whole skin as one group has the force of the two ends alone, whose edges are borders.

    Requirement: 1e-3 of the force, as places of the same nodes differ by the facets around the
    edge (measured 1e-4). With normals that are the mean of an end and the wall beside it the force
    is 20 % less, leans by 20 degrees and slides.
    """
    skin, ends = (to_the_end(RING.format(group=group)) for group in ("skin", "ends"))
    assert not skin.cuts
    force, expected = skin.force("press"), ends.force("press")
    assert np.linalg.norm(expected) > 0.0
    assert np.linalg.norm(force - expected) < 1e-3 * np.linalg.norm(expected)
