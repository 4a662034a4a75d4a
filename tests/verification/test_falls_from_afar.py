"""Bodies that only contact can hold come down from far above what holds them."""

from __future__ import annotations

import numpy as np
import pytest
from tests.verification.free_blocks import CLAMP, YOUNG, free_block, laws

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step

LOAD = -5.0
#: What springs of stabilisation may carry of the load, 1e-7, and rounding of places far away.
REST = 1e-6 * abs(LOAD)
HELD = CLAMP | {"shelf.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}


def _above(gap: float, shelf: float | None = None) -> Problem:
    """A block above a base, and above a shelf of its width between them."""
    boxes = {
        "block": BoxSpec((0, 0, gap), (1, 1, 0.5), (4, 4, 2)),
        "base": BoxSpec((-1, -1, -1), (3, 3, 1), (5, 5, 1)),
    }
    if shelf is not None:
        boxes["shelf"] = BoxSpec((-0.1, 0.0, shelf - 0.5), (1.2, 1.0, 0.5), (5, 4, 1))
    model = build_box(boxes)
    law = ContactLaw(*laws())
    masters = [f"{name}.top" for name in boxes if name != "block"]
    contacts = [Contact(model, "block.bottom", one, law=law, name=one) for one in masters]
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    return Problem(model, dict.fromkeys(boxes, elastic), contacts)


def _landed(problem: Problem, held: dict[str, dict[str, float]]) -> tuple[int, int]:
    """Corrections and cuts until the load on the block is carried."""
    solver = Solver(problem, [Step("press", 1, held, {"block.top": {"z": LOAD}})])
    cuts: list[object] = []
    *_, last = solver.run(on_cut=cuts.append)
    carried = sum(contact.resultant()[0] for contact in problem.contacts)
    np.testing.assert_allclose(carried, [0.0, 0.0, -LOAD], atol=REST)
    return last.iterations, len(cuts)


@pytest.mark.parametrize(("gap", "most"), [(5.0, 40), (100.0, 60), (3000.0, 160)])
def test_a_block_comes_down_from_many_of_its_sizes(gap: float, most: int) -> None:
    """A block of size 1 far above a base is loaded at its top.

    Requirement: it lands and the base carries the load, without a cut. Source: boxes around both
    say how far it meets nothing, so that each equilibrium on springs takes a share of what is left,
    and their number grows with the logarithm of the gap. Before, each took a facet: from 100 sizes
    4,000 corrections in seven parts came as near as 85, and the run stopped.
    """
    iterations, cuts = _landed(_above(gap), CLAMP)
    assert cuts == 0
    assert iterations <= most


def test_a_block_comes_down_on_a_surface_without_end() -> None:
    """The same above a plane, whose distance is the least gap.

    Requirement and source: as above.
    """
    iterations, cuts = _landed(free_block(100.0), {})
    assert cuts == 0
    assert iterations <= 60


def test_a_block_does_not_fall_past_a_shelf() -> None:
    """The block falls by 100 sizes on a base, and a shelf of its width lies 60 below it.

    Requirement: the shelf carries the load, and the base nothing. Source: by hand; what is clear
    around a body is what is clear of all that it may touch.
    """
    problem = _above(100.0, shelf=40.0)
    iterations, _ = _landed(problem, HELD)
    base, shelf = (contact.resultant()[0][2] for contact in problem.contacts)
    assert base == 0.0
    assert shelf == pytest.approx(-LOAD, abs=REST)
    assert iterations <= 60
