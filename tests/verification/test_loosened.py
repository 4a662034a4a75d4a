"""Bodies that friction lets go under loads that stay: what presses them falls."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.solver import StoppedError

MU, LOAD = 0.3, 3.0

CASE = f"""
title = "A block between a floor and a jaw"
[idealisation]
kind = "plane-strain"
[mesh.rectangle.block]
origin = [0, 0]
size = [2, 1]
cells = [6, 3]
[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3
[surface.floor]
shape = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
[surface.jaw]
shape = "plane"
point = [0, 1, 0]
normal = [0, -1, 0]
[surface.post]
shape = "plane"
point = [{{post}}, 0, 0]
normal = [-1, 0, 0]
[rigid.jaw]
reference = [0, 1, 0]
[[contact]]
slave = "block.bottom"
master = "floor"
{{given}}
friction = {{{{ coefficients = {MU} }}}}
[[contact]]
slave = "block.top"
master = "jaw"
{{given}}
friction = {{{{ coefficients = {MU} }}}}
{{more}}
[[step]]
name = "press"
increments = 1
motion.jaw = {{{{ y = -0.01 }}}}
[[step]]
name = "pull"
increments = 1
force = {{{{ "block.right" = {{{{ x = {LOAD} }}}} }}}}
[[step]]
name = "open"
increments = {{increments}}
motion.jaw = {{{{ y = {{way}} }}}}
"""
AT_A_POST = """[[contact]]
slave = "block.right"
master = "post"
friction = { coefficients = 0 }
"""


def _solver(path: Path, given: str, *, more: str, increments: int, way: float) -> Any:
    text = CASE.format(given=given, more=more, increments=increments, way=way, post=2.05)
    path.write_text(text)
    return build(load(path)).solver


@pytest.mark.parametrize("given", ['method = "penalty"', pytest.param("", marks=pytest.mark.slow)])
def test_a_body_that_a_clamp_lets_go_is_told(tmp_path: Path, given: str) -> None:
    """A block that a jaw presses on a floor, pulled by 3 as the jaw opens.

    Requirement: a run that ends with the last state in which friction holds it, within 3 % of the
    limit, and tells the load and what friction holds, that of both normal forces; no more than four
    cuts. Source: Coulomb, `2 mu N`. Tolerance: the four digits that are told.
    """
    solver = _solver(tmp_path / "case.toml", given, more="", increments=4, way=0.0)
    cuts: list[Any] = []
    with pytest.raises(StoppedError) as error:
        list(solver.run(on_cut=cuts.append))
    pressed = sum(
        contact.resultant()[0] @ [0.0, side, 0.0]
        for contact, side in zip(solver.problem.contacts, (1.0, -1.0), strict=True)
    )
    pattern = r"come to 3 along \(1, 0, 0\), and friction holds ([\d.]+) there at most, "
    (held,) = re.findall(pattern, str(error.value))
    assert float(held) == pytest.approx(MU * pressed, rel=1e-3)
    assert LOAD <= float(held) < 1.03 * LOAD
    assert "with what presses on it now, which falls: load it less" in str(error.value)
    assert len(cuts) <= 4


@pytest.mark.parametrize("given", ["", 'method = "penalty"'])
def test_a_body_that_is_let_go_comes_to_rest_at_a_post(tmp_path: Path, given: str) -> None:
    """The same block in front of a post, with a jaw that does not open all the way.

    Requirement: the run comes to its end, where friction holds `2 mu N` and the post the rest.
    Source: equilibrium. Tolerance: 1e-6 of the load, residuals are solved to 1e-8.
    """
    solver = _solver(tmp_path / "case.toml", given, more=AT_A_POST, increments=3, way=-0.0015)
    last = list(solver.run())[-1]
    floor, jaw, post = (contact.resultant()[0] for contact in solver.problem.contacts)
    assert last.step == "open" and last.done == 1.0
    assert -post[0] == pytest.approx(LOAD - MU * (floor[1] - jaw[1]), abs=1e-6 * LOAD)
    assert post[0] < -0.3 * LOAD
