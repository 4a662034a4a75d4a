"""Ties that share nodes, that cannot be, and that are left out."""

from __future__ import annotations

import numpy as np
import pytest
from tests.verification.test_tie import NU, STEEL, UP, halves, solved

from anisocontact.base.errors import InputError
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step, Tie


def three(ties: list[Tie]) -> Problem:
    """A cube of three pieces that meet in a line, under tension."""
    model = build_box(
        {
            "lo": BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 4, 2)),
            "up": BoxSpec((0, 0, 0.5), (0.5, 1, 0.5), (2, 3, 2)),
            "by": BoxSpec((0.5, 0, 0.5), (0.5, 1, 0.5), (3, 5, 3)),
        }
    )
    pull = Step("pull", 1, traction={"up.top": {"z": 10.0}, "by.top": {"z": 10.0}})
    planes = ["lo.left", "up.left", "lo.bottom", "lo.front", "up.front", "by.front"]
    return solved(model, [pull], ties=ties, symmetry=planes)


@pytest.mark.parametrize("side", [Tie("by.left", "up.right"), Tie("up.right", "by.left")])
def test_several_ties_at_a_node(side: Tie):
    """Three bodies glued to each other, with nodes that are slaves twice, or slave and master.

    Requirement: uniform tension to 1e-11. Source, tolerance: as of the patch test.
    """
    problem = three([Tie("up.bottom", "lo.top"), Tie("by.bottom", "lo.top"), side])
    x = problem.model.space.tabulate_dof_coordinates()
    u = problem.u.x.array.reshape(-1, 3)
    exact = x * [-NU * 0.01, -NU * 0.01, 0.01]
    assert np.abs(u - exact).max() < 1e-11 * np.abs(u).max()


def test_ties_in_a_circle_are_refused():
    """Requirement: one line."""
    with pytest.raises(InputError, match=r"in a circle|nothing can follow"):
        three([Tie("up.bottom", "lo.top"), Tie("lo.top", "up.bottom")])


def test_slave_that_is_held_is_refused():
    """Requirement: one line that says what to do."""
    steps = [Step("hold", 1, {"up.bottom": {"z": 0.0}, "lo.bottom": {"z": -0.1}})]
    with pytest.raises(InputError, match=r"tie\[0\].*swap slave and master"):
        solved(halves(), steps, ties=[UP])


def test_far_facets_are_left_out_and_named():
    """A slave that is longer than its master, and one that is farther than the tolerance.

    Requirement: the nodes beside are free and named; what is too far is refused.
    """
    boxes = {
        "lo": BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 1)),
        "up": BoxSpec((0.5, 0, 0.5), (1, 1, 0.5), (4, 4, 1)),
    }
    clamp = [
        Step("lift", 1, {"lo.bottom": dict.fromkeys("xyz", 0.0)}, traction={"up.top": {"z": 1.0}})
    ]
    problem = Problem(build_box(boxes), {"lo": STEEL, "up": STEEL}, ties=[UP])
    (line,) = problem.check(clamp)
    assert "tie[0]: 10 of 25 nodes of 'up.bottom' are not tied" in line
    for _ in Solver(problem, clamp).run():
        assert problem.reactions()["lo.bottom"] == pytest.approx([0.0, 0.0, -1.0], abs=1e-9)
    boxes["up"] = BoxSpec((0, 0, 0.6), (1, 1, 0.5), (4, 4, 1))
    with pytest.raises(InputError, match=r"tie\[0\].tolerance: no facet .* the nearest gap is 0.1"):
        Problem(build_box(boxes), {"lo": STEEL, "up": STEEL}, ties=[UP])
    wide = Tie("up.bottom", "lo.top", tolerance=0.11)
    problem = solved(build_box(boxes), clamp, ties=[wide])
    moment = np.cross([0.5, 0.5, 0.0], problem.reactions()["lo.bottom"])
    assert moment == pytest.approx([-0.5, 0.5, 0.0], abs=1e-9)
