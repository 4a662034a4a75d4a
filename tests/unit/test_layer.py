"""Where slip counts from behind a compliant layer."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.contact.layer import _coordinates


def test_coordinates_lead_as_far_along_the_tangents_of_now() -> None:
    now = np.array([[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    oblique = np.array([[[2.0, 0.0, 1.0], [1.0, 1.0, 0.0]]])
    way = np.array([[[0.3], [0.1]]])
    found = _coordinates(now, oblique, way)
    assert np.einsum("ni,nid->nd", found, oblique)[0, :2] == pytest.approx([0.3, 0.1])


def test_a_point_that_has_left_the_master_edgewise_stays() -> None:
    """Its frame has nothing in common with that of the facet it started from."""
    free = np.array([[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    upright = np.array([[[0.0, 0.0, -1.0], [0.2, 0.7, 0.0]]])
    assert not _coordinates(free, upright, np.ones((1, 2, 1))).any()
