"""Blocks that a force presses while they are dragged, or slide without friction."""

from __future__ import annotations

import pytest

DRAGGED = """
title = "Block pressed by a force and dragged"
[mesh.box.base]
origin = [-1, -1, -1]
size = [4, 3, 1]
cells = [8, 6, 2]
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [5, 5, 3]
[material.base]
model = "linear-elastic"
E = 1000
nu = 0.3
[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3
[[contact]]
slave = "block.bottom"
master = "base.top"
friction = { FRICTION }
[[step]]
name = "press"
increments = 3
displacement = { "base.bottom" = { x = 0, y = 0, z = 0 }, "block.top" = { x = 0, y = 0 } }
force = { "block.top" = { z = -10 } }
[[step]]
name = "drag"
increments = 4
displacement = { "block.top" = { x = 0.1, y = 0 } }
"""
ALONG = 'coefficients = [0.3, 0.15], directions = { kind = "constant", vector = [1, 1, 0] }'


@pytest.mark.parametrize("friction", [ALONG, "coefficients = 0"], ids=["friction", "none"])
def test_a_force_presses_and_the_block_is_dragged(friction: str, to_the_end) -> None:
    """Only pressures hold the block against its load, none of its points sticks: that is enough.

    Requirement: at most seven iterations in each increment of the drag, the load on the base to
    1e-8, and next to nothing (1e-6 of the work) taken up by springs that stand for contact. Source:
    equilibrium; pressures of a face resist its motion along the normal and both tilts.
    """
    run = to_the_end(DRAGGED.replace("FRICTION", friction), most=4000)
    assert not run.cuts
    assert max(a.iterations for a in run.accepted if a.step == "drag") <= 7
    assert run.force("drag")[2] == pytest.approx(10.0, rel=1e-8)
    before = next(a for a in reversed(run.accepted) if a.step == "press")
    taken = run.ends["drag"].energies["stabilisation"] - before.energies["stabilisation"]
    assert abs(taken) < 1e-6 * abs(run.ends["drag"].energies["external"])
