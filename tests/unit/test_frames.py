"""Tangents of a master at slave points, where a correction has spoilt the mesh."""

from __future__ import annotations

import numpy as np

from anisocontact.contact.frames import Frames


def test_flat_facets_have_no_vectors_and_spoil_no_others():
    """Requirement: a trial in which nodes of a facet lie on one line is refused, not an error.

    A force that is not a number is what corrections are taken back for. Vectors of other points
    are those of sound tangents alone, to the last bit.
    """
    tangents = np.array([[[1.0, 0, 0], [0.3, 2, 0]]] * 3)
    tangents[1] = [[1, 2, 0], [2, 4, 0]]
    normal, covector = np.array([[0.0, 0, 1]] * 3), np.array([[1.0, 2], [3, 4], [-5, 6]])
    found = Frames(tangents, normal).vector(covector)
    assert np.isnan(found[1]).all()
    sound = [0, 2]
    assert np.array_equal(
        found[sound], Frames(tangents[sound], normal[sound]).vector(covector[sound])
    )
    back = np.einsum("nid,nd->ni", tangents[sound], found[sound])
    assert np.abs(back - covector[sound]).max() <= 1e-14 * np.abs(covector).max()
