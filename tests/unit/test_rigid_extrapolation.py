"""Bodies that turn go on about their axes: where the next part of an increment is sought from."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from anisocontact.solver.stepping.rigid_extrapolation import TURNS, rigid_way, turned_on

POINTS = np.random.default_rng(5).uniform(-1.0, 1.0, (20, 3)) * [1.0, 2.0, 0.5] + [3.0, 0.0, 1.0]
EVERY = np.ones(3, dtype=np.bool_)


def _alone(values: Any) -> Any:
    return values


def _screw(share: float) -> Any:
    """A turn by 0.7 about an axis that passes beside the points, and a way along it."""
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    turn = Rotation.from_rotvec(0.7 * share * axis).as_matrix()
    point = np.array([0.3, -2.0, 0.5])
    return turn, lambda x: point + (x - point) @ turn.T + 0.4 * share * axis


@pytest.mark.parametrize("ratio", [0.25, 1.0, 1.7])
@pytest.mark.parametrize("flat", [False, True])
def test_a_rigid_motion_goes_on_as_itself(ratio: float, flat: bool) -> None:
    """Requirement: a screw by a share of itself, of points in space and in a plane (a meridian).

    Source: its closed form, turns by SciPy. Tolerance: 1e-12, rounding of a singular value
    decomposition.
    """
    points = POINTS * [1.0, 1.0, 0.0] if flat else POINTS
    _, once = _screw(1.0)
    _, more = _screw(ratio)
    found = turned_on(points, once(points), ratio, _alone, EVERY)
    np.testing.assert_allclose(found, more(once(points)), atol=1e-12)


def test_what_is_no_rigid_motion_turns_with_the_body() -> None:
    """Requirement: a stretch that is added in a part is added again, in directions of the body.

    Source: x -> Q (x + e) from where the body was, e = d (x - mean) symmetric, so that its polar
    decomposition leaves Q. Tolerance: as above.
    """
    turn, once = _screw(1.0)
    centred = POINTS - POINTS.mean(axis=0)
    principal = np.linalg.svd(centred, full_matrices=False)[2]
    added = centred @ (principal.T * [0.02, -0.01, 0.03]) @ principal
    after = once(POINTS + added)
    found = turned_on(POINTS, after, 1.0, _alone, EVERY)
    np.testing.assert_allclose(found, once(after) + added @ (turn @ turn).T, atol=1e-12)


@pytest.mark.parametrize(
    "after",
    [
        POINTS + np.array([1.0, 2.0, 3.0]),
        POINTS @ Rotation.from_rotvec([0.0, 0.0, 0.9 * TURNS]).as_matrix().T,
        POINTS * [1.03, 0.98, 1.0],
    ],
)
def test_what_hardly_turns_goes_on_along_its_chord(after: np.ndarray) -> None:
    """A way, a small turn and a stretch are left to the chord, and so are points on a line."""
    assert rigid_way(POINTS, after, _alone) is None
    line = POINTS * [1.0, 0.0, 0.0]
    assert rigid_way(line, line @ Rotation.from_rotvec([0, 0, 0.5]).as_matrix().T, _alone) is None


def test_a_section_of_a_body_of_revolution_turns_about_its_axis_alone() -> None:
    """A turn of the section strains circles, and is not taken for a rigid motion; a twist is."""
    twist = POINTS @ Rotation.from_rotvec([0.0, 0.3, 0.0]).as_matrix().T
    tilt = POINTS @ Rotation.from_rotvec([0.0, 0.0, 0.3]).as_matrix().T
    about_y = np.array([False, True, False])
    assert turned_on(POINTS, twist, 1.0, _alone, about_y) is not None
    assert turned_on(POINTS, tilt, 1.0, _alone, about_y) is None


def test_a_body_that_a_tool_turns_is_found_where_it_is(fe: Any) -> None:
    """A bar of rubber that follows a tool, which turns by 15 degrees an increment beside it.

    Requirement: from the third increment on the rigid motion goes on, which is the equilibrium, and
    at most one correction is left of it; a chord would strain the bar by 7 %.
    """
    from anisocontact.bulk import make_material
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import CoupledFace, Problem, Solver, Step

    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 2, 4), (1, 2, 4))})
    head = RigidBody("head", np.array([3.0, 1.0, 4.0]), free=True)
    rubber = make_material("neo-hookean", E=10.0, nu=0.3)
    problem = Problem(model, {"bar": rubber}, coupled=[CoupledFace("bar.top", head)])
    turn = Step("turn", 5, motion={"head": {"x": 0, "y": 0, "z": 0, "rx": 0, "ry": 1.309, "rz": 0}})
    used = [one.iterations for one in Solver(problem, [turn]).run()]
    assert used[0] > 2
    assert max(used[2:]) <= 1
    assert len(used) == 5
