"""Limit loads of friction against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.solver.stepping.limit_load import PressedPoints, limit, withdrawal
from anisocontact.solver.stepping.static_limit import StaticBalance, friction_needed

MU = 0.3
EVERY = np.eye(6)


def _points(arms: np.ndarray, normal: np.ndarray, force: np.ndarray) -> PressedPoints:
    across = np.eye(3) - np.einsum("ni,nj->nij", normal, normal)
    return PressedPoints(arms, normal, force, MU * across)


def _ring(count: int = 24) -> PressedPoints:
    """Points of unit normal force in all on a circle of radius 1 in the plane z = 0."""
    at = 2.0 * np.pi * np.arange(count) / count
    arms = np.column_stack([np.cos(at), np.sin(at), 0.0 * at])
    normal = np.tile([0.0, 0.0, 1.0], (count, 1))
    return _points(arms, normal, np.full(count, 1.0 / count))


def test_a_force_and_a_moment_on_a_ring() -> None:
    """Friction holds mu N along, and mu N r about the axis.

    Source: balance of a rigid ring that slides, or turns about its axis. The tolerance is what the
    least squares leave where points rest.
    """
    pressed = np.array([0.0, 0.0, -1.0, 0.0, 0.0, 0.0])
    along, about = pressed.copy(), pressed.copy()
    along[0], about[5] = 0.5, 0.5
    for load in (along, about):
        found = limit(_ring(), EVERY, load)
        assert found is not None
        assert found.held == pytest.approx(MU / 0.5, rel=1e-5)
    assert found.motion[5] == pytest.approx(2.0, rel=1e-5)


@pytest.mark.parametrize("beside", [0.5, 1.0])
def test_a_force_beside_the_middle_is_held_less(beside: float) -> None:
    """Two points at a distance of 2, the force across their line beside their middle.

    Source: the nearer one carries `(1 + beside) / 2` of it, and at most mu N / 2.
    """
    arms = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    normal = np.tile([0.0, 0.0, 1.0], (2, 1))
    load = np.array([0.0, 1.0, -1.0, 0.0, 0.0, beside])
    found = limit(_points(arms, normal, np.array([0.5, 0.5])), EVERY, load)
    assert found is not None
    assert found.held == pytest.approx(MU / (1.0 + beside), rel=1e-4)


def test_what_the_normal_forces_carry_is_not_left_to_friction() -> None:
    """Points on a slope of 0.1 that can move along x alone.

    Source: balance along x, in which the normal forces carry 0.1 of the 0.5, and friction along the
    slope at most mu times the cosine.
    """
    sine, cosine = 0.1, np.sqrt(0.99)
    ring = _ring()
    normal = np.tile([-sine, 0.0, cosine], (24, 1))
    load = np.array([0.5, 0.0, -1.0, 0.0, 0.0, 0.0])
    found = limit(_points(ring.arms, normal, ring.force), EVERY[:1], load)
    assert found is not None
    assert found.held == pytest.approx(MU * cosine / (0.5 - sine), rel=1e-6)


def test_an_ellipse_holds_along_a_direction_what_its_radius_there_is() -> None:
    """Coefficients 0.4 and 0.2 along x and y, a force at 30 degrees.

    Source: the force is on the friction ellipse, `sqrt(T . F T) = N`.
    """
    ring = _ring()
    friction = np.zeros((24, 3, 3))
    friction[:, 0, 0], friction[:, 1, 1] = 0.4, 0.2
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    points = PressedPoints(ring.arms, ring.normal, ring.force, friction)
    found = limit(points, EVERY, np.array([c, s, -1.0, 0.0, 0.0, 0.0]))
    assert found is not None
    assert found.held == pytest.approx(1.0 / np.hypot(c / 0.4, s / 0.2), rel=1e-5)


def test_a_belt_slides_around_its_drum_alone() -> None:
    """A belt over a quarter of a drum of radius 10 under two tensions of 1 and 0.5.

    Source: it can turn about the axis; of the tensions the moment is 10 (1 - 0.5), of friction at
    most mu r times the sum of the pressure, which is taken for 1.
    """
    at = np.linspace(np.pi / 4, 3 * np.pi / 4, 31)
    normal = np.column_stack([np.cos(at), np.sin(at), 0.0 * at])
    force = np.full(31, 1.0 / 31)
    load = np.array([0.0, -1.0, 0.0, 0.0, 0.0, 5.0])
    found = limit(_points(10.0 * normal, normal, force), EVERY[[0, 1, 5]], load)
    assert found is not None
    assert found.held == pytest.approx(MU * 10.0 / 5.0, rel=1e-3)


def test_nothing_is_said_of_a_body_that_no_motion_is_left_to() -> None:
    """Pressed from both sides along x and along z: it can slide along y alone, without a load."""
    arms = np.array([[0.0, 0, -1], [0.1, 0, -1], [1, 0, 0], [1, 0.1, 0]])
    normal = np.array([[0.0, 0, 1], [0, 0, 1], [-1, 0, 0], [-1, 0, 0]])
    load = np.array([1.0, 0.0, -1.0, 0.0, 0.0, 0.0])
    assert limit(_points(arms, normal, np.ones(4)), EVERY[:3], load) is None


@pytest.mark.parametrize("degrees", [40.0, 50.0, 60.0])
def test_a_ladder_that_stands_too_flat_needs_more_friction(degrees: float) -> None:
    """A ladder on a floor and against a wall, loaded in its middle, friction 0.3 at both.

    Source: with m times the friction it slides at both ends from tan(a) = (1 - f^2) / 2 f on,
    f = 0.3 m [statics of a ladder]. The tolerance is that of the search.
    """
    a = np.radians(degrees)
    end = 0.5 * np.array([np.cos(a), np.sin(a), 0.0])
    normal = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    ladder = StaticBalance.of_body(
        _points(np.array([-end, end]), normal, np.ones(2)),
        EVERY[[0, 1, 5]],
        np.array([0.0, -1.0, 0.0, 0.0, 0.0, 0.0]),
    )
    needed = friction_needed(ladder)
    slope = np.tan(a)
    least = (np.sqrt(slope**2 + 1.0) - slope) / MU
    assert needed == pytest.approx(max(least, 1.0), rel=2e-3)


def test_friction_that_is_needed_follows_its_ellipse() -> None:
    """Coefficients 0.4 and 0.2, a force of a half at 30 degrees; none that pulls away is held.

    Source: as above; nothing but contact that pulls could balance a pull. The corners of the
    polygon are 0.5 % outside of the ellipse.
    """
    ring = _ring()
    friction = np.zeros((24, 3, 3))
    friction[:, 0, 0], friction[:, 1, 1] = 0.4, 0.2
    points = PressedPoints(ring.arms, ring.normal, ring.force, friction)
    c, s = 0.5 * np.cos(np.pi / 6), 0.5 * np.sin(np.pi / 6)
    load = np.array([c, s, -1.0, 0.0, 0.0, 0.0])
    needed = friction_needed(StaticBalance.of_body(points, EVERY, load))
    assert needed == pytest.approx(np.hypot(c / 0.4, s / 0.2), rel=6e-3)
    pull = StaticBalance.of_body(points, EVERY, np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0]))
    assert friction_needed(pull) == np.inf


@pytest.mark.parametrize("load", [(0.0, 1.0), (0.3, 1.0), (0.0, -0.1), (0.0, -2.0)])
def test_a_wedge_that_is_pulled_out(load: tuple[float, float]) -> None:
    """A wedge between two walls at 15 degrees that press with 1 each, which has no sliding motion.

    Source: the least of friction over what loads and normal forces work, of all translations in
    its plane that go into no wall, by brute force; pulled along its middle that is
    `2 mu cos a / (F + 2 sin a)`. Tolerance: the polygon around the friction circle. Of one that is
    pressed in nothing is found.
    """
    lean = np.radians(15.0)
    normal = np.array([[-np.cos(lean), np.sin(lean), 0.0], [np.cos(lean), np.sin(lean), 0.0]])
    wedge = _points(np.zeros((2, 3)), normal, np.ones(2))
    force = np.array([*load, 0.0, 0.0, 0.0, 0.0])
    assert limit(wedge, EVERY[:2], force) is None
    found = withdrawal(wedge, EVERY[:2], force)
    angle = np.linspace(0.0, 2.0 * np.pi, 36001)
    way = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    work = way @ (force[:3] + normal.sum(axis=0))
    free = (way @ normal.T >= -1e-9).all(axis=1) & (work > 0.0)
    if not free.any():
        assert found is None
        return
    assert found is not None
    tangential = way[free, None] - (way[free] @ normal.T)[..., None] * normal
    held = MU * np.linalg.norm(tangential, axis=2).sum(axis=1) / work[free]
    assert found.held == pytest.approx(held.min(), rel=0.006)
    if load == (0.0, 1.0):
        assert found.held == pytest.approx(
            2.0 * MU * np.cos(lean) / (1.0 + 2.0 * np.sin(lean)), rel=0.006
        )
