"""A collar with play on a post, loaded beside its axis: it jams, or slides down for ever.

Source: statics of a rigid collar of height h whose load hangs x from the axis. It touches at two
heights on both sides, which press N = F x / h; friction there holds it where `2 mu N >= F`, that
is `mu >= h / 2x`, however large the load is: 0.25 here.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.solver import Cut, StoppedError

CASE = """
[mesh.ring.collar]
inner = 10.0
outer = 15.0
length = 20.0
cells = [1, 8, 2]
[material.collar]
model = "linear-elastic"
E = 210e3
nu = 0.3
[surface.post]
shape = "cylinder"
point = [0, 0, 0]
axis = [0, 0, 1]
radius = 9.98
[rigid.arm]
faces = ["collar.outer"]
reference = [40, 0, 10]
[[contact]]
slave = "collar.inner"
master = "post"
friction = {{ coefficients = {friction} }}
[[step]]
name = "load"
increments = 1
load = {{ arm = {{ z = -100 }} }}
motion.arm = {{ x = "free", y = 0, z = "free", rx_deg = 0, ry_deg = "free", rz_deg = 0 }}
"""


def test_it_jams(tmp_path: Path) -> None:
    """Requirement: above h/2x the collar carries its load, without a cut, by friction alone.

    Tolerance: rounding of the forces; it touches at both rims, but for its play.
    """
    case = tmp_path / "case.toml"
    case.write_text(CASE.format(friction=0.3))
    built = build(load(case))
    assert len(list(built.solver.run())) == 1
    (contact,) = built.problem.contacts
    assert contact.resultant()[0][2] == pytest.approx(100.0, rel=1e-6)
    heights = np.sort(contact.points[contact.last.pressure > 0.0, 2])
    np.testing.assert_allclose(heights, [0.0, 20.0], atol=0.05)


@pytest.mark.slow
def test_it_slides_down(tmp_path: Path) -> None:
    """Requirement: below h/2x the run stops after three smaller parts and names friction.

    Source: any load throws the collar farther than all is long. Before, it was cut seven times, in
    thousands of corrections, and at last loads were called small.
    """
    case = tmp_path / "case.toml"
    case.write_text(CASE.format(friction=0.2))
    cuts: list[Cut] = []
    solver = build(load(case)).solver
    with pytest.raises(StoppedError, match="contact and friction do not hold the loads on them"):
        list(solver.run(on_cut=cuts.append))
    assert len(cuts) == 3
