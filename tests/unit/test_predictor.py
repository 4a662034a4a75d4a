"""Where the next part of an increment is sought from: a block dragged over a bar, cut for turns."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.solver.stepping.predictor import Predictor

OVER = """
[mesh.box.block]
origin = [-0.2, 0, 0]
size = [0.4, 0.3, 0.2]
cells = [4, 2, 2]
[material.block]
model = "neo-hookean"
E = 1000
nu = 0.3
[surface.bar]
shape = "cylinder"
point = [0, 0, -0.5]
axis = [0, 1, 0]
radius = 0.5

[[contact]]
slave = "block.bottom"
master = "bar"
normal = { penalty = 2e4 }
adhesion = { stiffness = [1e4, 1e4] }
friction = { coefficients = [0.2, 0.2] }

[[step]]
name = "press"
increments = 2
displacement = { "block.top" = { x = 0, y = 0, z = -0.02 } }

[[step]]
name = "drag"
increments = 1
displacement = { "block.top" = { x = 0.2, z = -0.06 } }

[output]
pictures = false
"""


def _counted(path: Path) -> tuple[int, int, Any]:
    """Iterations of the drag, parts of it and the force at the end."""
    built = build(load(path))
    parts = [one for one in built.solver.run() if one.step == "drag"]
    return (
        sum(one.iterations for one in parts),
        len(parts),
        built.problem.contacts[0].resultant()[0],
    )


def test_the_way_to_what_was_refused_grows_shorter() -> None:
    """An equilibrium at 8 that a whole increment leads to is refused, and parts go there from 0.

    Requirement: each starts where an even way would have brought it, and none once it is reached.
    Source: by hand, a quarter of the way, then a third of what is left.
    """
    predictor: Any = object.__new__(Predictor)
    predictor._problem = SimpleNamespace(rigid=SimpleNamespace(free=[]))
    predictor.refuse(8.0, 1.0)
    of_a_part = SimpleNamespace(part=0.25, last=0.25)
    assert predictor.state(0.0, None, of_a_part)[0] == pytest.approx(2.0)
    predictor.accept(0.25)
    assert predictor.state(2.0, None, of_a_part)[0] == pytest.approx(4.0)
    predictor.accept(0.75)
    assert predictor.state(8.0, None, of_a_part)[0] == 8.0
    assert predictor._ahead is None


def test_parts_start_on_the_way_to_what_was_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Points turn by more than 15 degrees in the drag: its equilibrium is refused, parts are not.

    Requirement: parts that start on the way to it take fewer corrections than those that start
    from what happened before the drag, and come to the same force. Tolerance: 1e-6, parts and
    Newton's method are the same.
    """
    path = tmp_path / "case.toml"
    path.write_text(OVER)
    used, parts, force = _counted(path)
    monkeypatch.setattr(Predictor, "refuse", lambda *_: None)
    without, as_many, same = _counted(path)
    assert parts == as_many > 1
    assert used < without
    np.testing.assert_allclose(force, same, rtol=0.0, atol=1e-6 * np.linalg.norm(force))


def test_a_run_goes_on_between_parts_bit_by_bit(tmp_path: Path, gone_on: Any) -> None:
    """Requirement: a run stopped behind the first part of the drag ends as one that was not."""
    path = tmp_path / "case.toml"
    path.write_text(OVER)
    whole, out = gone_on(path, 3)
    assert (whole / "history.csv").read_bytes() == (out / "history.csv").read_bytes()
    assert len((whole / "history.csv").read_text().splitlines()) > 1 + 3 + 1
