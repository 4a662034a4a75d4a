"""Where facets go on to beyond their border."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.contact.beyond_border import goes_on, places_beyond
from anisocontact.contact.continued_facets import feet_on_continued
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
