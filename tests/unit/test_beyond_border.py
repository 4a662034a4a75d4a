"""Where facets go on to beyond their border."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.contact.beyond_border import goes_on
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
