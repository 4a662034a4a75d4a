"""Where facets go on to beyond their border."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.contact.beyond_border import goes_on, places_beyond
from anisocontact.contact.continued_facets import feet_on_continued
from anisocontact.contact.semismooth import Semismooth
from anisocontact.interface import Augmentation
from anisocontact.surfaces import FacetSurface

#: A trapezoid whose sides meet at xi_2 = 2.
TRAPEZOID = [[0, 0, 0], [1, 0, 0], [0.25, 1, 0], [0.75, 1, 0]]


@pytest.mark.parametrize(("to", "there"), [(1.5, True), (1.99, False), (2.0, False), (2.5, False)])
def test_a_facet_goes_on_until_its_sides_meet(to: float, there: bool) -> None:
    """Beyond it is turned over, and at the point it has no area: no place of the surface."""
    surface = FacetSurface(TRAPEZOID, [[0, 1, 2, 3]], "quad4")
    facet = np.zeros(1, dtype=np.int32)
    start, far = np.array([[0.5, 1.0]]), np.array([[0.5, to]])
    assert goes_on(surface, facet, start, far).tolist() == [there]


@pytest.mark.parametrize(("turn", "there"), [(1.2, True), (3.5, False)])
def test_the_foot_on_the_other_side_of_an_arc_is_none(turn: float, there: bool) -> None:
    """An arc of 40 degrees and points above where it goes on, by a fifth of it and by far more.

    Newton's method comes to a place inside the arc from far out: slip from there would have the
    wrong sense, and begins at the border.
    """
    angle, radius = np.radians(40.0), 1.05
    at = [(0, 0), (1, 0), (0, 1), (1, 1), (0.5, 0), (0, 0.5), (1, 0.5), (0.5, 1), (0.5, 0.5)]
    nodes = np.array([(np.sin(t * angle), y, np.cos(t * angle)) for t, y in at])
    surface = FacetSurface(nodes, [list(range(9))], "quad9")
    x = np.array([[radius * np.sin(turn * angle), 0.5, radius * np.cos(turn * angle)]])
    start, away = np.array([[1.0, 0.5]]), np.linalg.norm(x - nodes[6], axis=1)
    facet = np.zeros(1, dtype=np.int32)
    xi, gap = places_beyond(surface, "quad9", x, facet, start, away)
    assert xi[0, 0] > 1.0 if there else np.array_equal(xi, start)
    assert gap[0] == pytest.approx(0.05 if there else 0.0, abs=0.02)  # a parabola


@pytest.mark.parametrize(("height", "gap"), [(0.2, 0.2), (-0.2, 0.0)])
@pytest.mark.parametrize(("to", "xi"), [(1.4, 1.4), (4.0, 2.0)])
def test_a_place_is_at_most_a_length_beyond_the_border(
    height: float, gap: float, to: float, xi: float
) -> None:
    """Nearer to it than that it is the foot; a point below a facet is not above it."""
    surface = FacetSurface([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2, 3]], "quad4")
    x, start = np.array([[to, 0.5, height]]), np.array([[1.0, 0.5]])
    away = np.linalg.norm(x - [1.0, 0.5, 0.0], axis=1)
    found, above = places_beyond(surface, "quad4", x, np.zeros(1, dtype=np.int32), start, away)
    np.testing.assert_allclose(found, [[xi, 0.5]], atol=1e-12)
    np.testing.assert_allclose(above, [gap], atol=1e-12)


@pytest.mark.parametrize("tangential", [True, False])
def test_multipliers_let_points_that_come_down_slip_from_the_touch_on(tangential: bool) -> None:
    """Points beyond a border and higher than the tolerance; physical adhesion counts all the way.

    Source: a point whose gap closes has slipped from where it touches, wherever it was.
    """
    made = Semismooth(Augmentation(tangential=tangential), 1.0, (1e3, 1e2), None)
    state: Any = np.zeros(3, dtype=[("gap", float)])
    state["gap"] = 0.0, 0.1, 0.0
    held = made.held_beyond(state, np.array([True, True, False]))
    assert held.tolist() == [True, not tangential, False]


def test_a_facet_without_a_normal_has_no_foot() -> None:
    """Requirement: not a number and no warning; the others have theirs."""
    surface = FacetSurface(
        [*TRAPEZOID, [0, 0, 1], [0, 0, 1], [1, 0, 1], [1, 0, 1]],
        [[0, 1, 2, 3], [4, 5, 6, 7]],
        "quad4",
    )
    x, facets = np.array([[0.5, 1.2, 0.3], [0.5, 0.1, 1.3]]), np.array([0, 1], dtype=np.int32)
    xi, foot, _ = feet_on_continued(surface, x, facets, np.full((2, 2), 0.5))
    np.testing.assert_allclose(foot[0], [0.5, 1.2, 0.0], atol=1e-12)
    assert np.isnan(xi[1]).all()
