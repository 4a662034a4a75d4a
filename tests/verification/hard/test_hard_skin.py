"""Slaves that go around sharp edges: the whole skin of a block in the place of its lower face."""

from __future__ import annotations

import numpy as np
import pytest

PAIR = """
title = "Block on a softer base"
[material.block]
model = "neo-hookean"
E = 1000
nu = 0.3
[material.base]
model = "neo-hookean"
E = 500
nu = 0.3
"""

SPACE = """
[mesh.box.base]
origin = [-1, -1, -1]
size = [3.1, 3.2, 1]
cells = [5, 5, 2]
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [4, 4, 4]
[join]
"block.skin" = ["block.bottom", "block.left", "block.right", "block.front", "block.back"]
[[contact]]
slave = "block.GROUP"
master = "base.top"
friction = { coefficients = [0.4, 0.2], directions = { kind = "constant", vector = [1, 1, 0] } }
[[step]]
name = "press"
increments = 4
displacement = { "base.bottom" = { x = 0, y = 0, z = 0 }, "block.top" = { x = 0, y = 0, z = -0.1 } }
[[step]]
name = "drag"
increments = 4
displacement = { "block.top" = { x = 0.2, y = 0.05 } }
"""

PLANE = """
[idealisation]
kind = "plane-strain"
[mesh.rectangle.base]
origin = [-1, -1]
size = [3.1, 1]
cells = [7, 3]
[mesh.rectangle.block]
origin = [0, 0]
size = [1, 1]
cells = [5, 5]
[join]
"block.skin" = ["block.bottom", "block.left", "block.right"]
[[contact]]
slave = "block.GROUP"
master = "base.top"
friction = { coefficients = 0.4 }
[[step]]
name = "press"
increments = 4
displacement = { "base.bottom" = { x = 0, y = 0 }, "block.top" = { x = 0, y = -0.1 } }
[[step]]
name = "drag"
increments = 4
displacement = { "block.top" = { x = 0.2 } }
"""


@pytest.mark.parametrize("case", [SPACE, PLANE], ids=["space", "plane"])
def test_the_skin_is_as_good_as_the_face_that_touches(case: str, to_the_end) -> None:
    """A block sinks into its base and slides, slave by one face or by all.

    Requirement: the same forces, 1e-9, and as many iterations. Source: the sides of the block touch
    nothing; averaged normals at its edges are those of the lower face, and what stands across them,
    as the base beside the block does, does not face them.
    """
    runs = [to_the_end(PAIR + case.replace("GROUP", group)) for group in ("bottom", "skin")]
    for step in ("press", "drag"):
        one, other = (run.force(step) for run in runs)
        np.testing.assert_allclose(other, one, atol=1e-9 * np.linalg.norm(one))
    assert not any(run.cuts for run in runs)
    counts = [[a.iterations for a in run.accepted] for run in runs]
    assert counts[1] == counts[0]
