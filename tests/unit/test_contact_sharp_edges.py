"""Facets that make the averaged normal of a slave node."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.contact.sharp_edges import counting

UP = np.array([0.0, 0.0, 1.0])


def _normals(*degrees: float) -> np.ndarray:
    """Outward normals in a plane, by their angles from downwards."""
    angle = np.radians(degrees)
    return np.stack([np.sin(angle), 0.0 * angle, -np.cos(angle)], axis=1)


@pytest.mark.parametrize(
    ("degrees", "kept"),
    [
        ((0, 90), [1, 0]),  # the edge of a block on its base
        ((0, 0, 90, 90), [1, 1, 0, 0]),
        ((-45, 45), [1, 1]),  # a wedge that stands on its edge
        ((-10, 35, 80), [1, 1, 0]),
        ((60, 150), [1, 0]),  # what faces the master most
        ((0, 45), [1, 1]),  # chords of a coarse circle
        ((0, 180), [1, 0]),  # the front of a closed crack, whose normals cancel exactly
    ],
)
def test_facets_that_count(degrees: tuple[float, ...], kept: list[int]) -> None:
    """Facets within 60 degrees of facing the master, or of the one that faces it most."""
    around: Any = SimpleNamespace(
        offsets=np.array([0, len(degrees)]),
        facets=np.arange(len(degrees)),
        nodes=np.zeros((1, 1), dtype=np.int32),
    )
    x = np.zeros((1, 3))
    found = counting(around, _normals(*degrees), x, lambda x, *_: np.tile(UP, (len(x), 1)))
    assert found.tolist() == kept
    assert counting(around, _normals(*degrees), x, None).tolist() == [1] * len(degrees)
