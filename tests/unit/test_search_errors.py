"""A mistake in what describes a surface of facets gives one line that names it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from anisocontact.base.errors import InputError
from anisocontact.surfaces.facets import FacetSets, FacetSurface, outward_flips

SQUARE = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
TETRAHEDRON = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
FACES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


def square() -> FacetSurface:
    return FacetSurface(SQUARE, [[0, 1, 2, 3]], "quad4")


MISTAKES: list[tuple[Callable[[], object], str]] = [
    (
        lambda: FacetSurface(SQUARE, [[0, 1, 2, 3]], "quad5"),
        "topology: given 'quad5', allowed: tri3, tri6, quad4, quad8, quad9",
    ),
    (
        lambda: FacetSurface(SQUARE, [[0, 1, 2]], "quad4"),
        "connectivity: array of int64 of shape (1, 3) given, integers of shape (k, 4) needed for "
        "quad4",
    ),
    (
        lambda: FacetSurface(SQUARE, [[0.0, 1.0, 2.0]], "tri3"),
        "connectivity: array of float64 of shape (1, 3) given, integers of shape (k, 3) needed for "
        "tri3",
    ),
    (
        lambda: FacetSurface(SQUARE, [[0, 1, 4]], "tri3"),
        "connectivity: facet 0: node 4 given, 0 to 4 (excluded) allowed",
    ),
    (
        lambda: FacetSurface(SQUARE, [[0, 1, 2], [1, -1, 3]], "tri3"),
        "connectivity: facet 1: node -1 given, 0 to 4 (excluded) allowed",
    ),
    (
        lambda: FacetSurface(SQUARE, [[0, 1, 1]], "tri3"),
        "connectivity: facet 0: node 1 given twice",
    ),
    (
        lambda: FacetSurface(SQUARE, [[[0, 1, 2]], [[1, 3, 2]]], ["tri3"]),
        "topology: 1 given for 2 blocks",
    ),
    (
        lambda: FacetSurface([[0, 0], [1, 0]], [[0, 1, 2]], "tri3"),
        "coordinates: an array of shape (2, 2) given, (n, 3) needed",
    ),
    (
        lambda: FacetSurface([*SQUARE[:3], [np.nan, 1, 0]], [[0, 1, 2, 3]], "quad4"),
        "coordinates: point 3 is not finite",
    ),
    (
        lambda: FacetSurface(SQUARE, [[0, 1, 2, 3]], "quad4", flip=[True, False]),
        "flip: shape (2,) given, (1,) needed",
    ),
    (
        lambda: square().update(SQUARE[:3]),
        "coordinates: an array of shape (3, 3) given, (4, 3) needed",
    ),
    (
        lambda: square().project([[0, 0]]),
        "x: an array of shape (1, 2) given, (n, 3) needed",
    ),
    (
        lambda: square().project([[0, 0, 1]], hint=[0, 0]),
        "hint: shape (2,) given, (1,) needed",
    ),
    (
        lambda: square().project([[0, 0, 1]], named=[0, 0]),
        "named: shape (2,) given, (1,) needed",
    ),
    (
        lambda: square().project([[0, 0, 1]], max_distance=-1.0),
        "max_distance: given -1.0, must not be negative",
    ),
    (
        lambda: square().project([[0, 0, 1]], max_distance=np.nan),
        "max_distance: given nan, must not be negative",
    ),
    (
        lambda: square().project([[0, 0, 1]], max_distance=[1.0, 2.0]),
        "max_distance: shape (2,) given, one number or (1,) needed",
    ),
    (
        lambda: square().project(
            [[0, 0, 1]], exclude=FacetSets(np.zeros(3, np.int64), np.zeros(0, np.int32))
        ),
        "exclude: sets for 2 points given, 1 needed",
    ),
    (
        lambda: square().geometry([1], [[0.0, 0.0]]),
        "facet: given 1, 0 to 0 allowed",
    ),
    (
        lambda: square().jet([0], [[0.0, 0.0], [1.0, 1.0]]),
        "xi: an array of shape (2, 2) given, (1, 2) needed",
    ),
    (
        lambda: square().within([[0, 0, 0]], -1.0),
        "distance: given -1.0, must not be negative",
    ),
    (
        lambda: square().rings([-1]),
        "facet: given -1, 0 to 0 allowed",
    ),
]


@pytest.mark.parametrize(("mistake", "line"), MISTAKES, ids=[line[:40] for _, line in MISTAKES])
def test_mistakes(mistake: Callable[[], object], line: str) -> None:
    with pytest.raises(InputError) as error:
        mistake()
    assert str(error.value) == line


def test_orientation_says_which_way_the_normals_point() -> None:
    """Outward, inward, one facet the other way round, open."""
    outward = FacetSurface(TETRAHEDRON, FACES, "tri3").orientation()
    assert outward.outward is True and outward.volume == pytest.approx(1 / 6, rel=1e-15)
    assert str(outward) == "normals point outward"
    inward = FacetSurface(TETRAHEDRON, FACES, "tri3", flip=[True] * 4).orientation()
    assert inward.outward is False and inward.volume == pytest.approx(-1 / 6, rel=1e-15)
    assert str(inward) == "normals point inward"
    wrong = FacetSurface(TETRAHEDRON, FACES, "tri3", flip=[False, True, False, False]).orientation()
    assert wrong.outward is None and wrong.inconsistent.tolist() == [0, 1, 2, 3]
    assert str(wrong) == "normals of 4 facets disagree with a neighbour, the first is facet 0"
    open_ = FacetSurface(TETRAHEDRON, FACES[:3], "tri3").orientation()
    assert open_.outward is None and not open_.closed and np.isnan(open_.volume)
    assert str(open_) == "the surface is open: it has no outside"


def test_flips_from_points_inside() -> None:
    """Facets in any order of nodes get their normals to leave the body."""
    rng = np.random.default_rng(1)
    mixed = [rng.permutation(f) for f in FACES]
    inside = np.full((4, 3), 0.2)
    flip = outward_flips(TETRAHEDRON, mixed, "tri3", inside)
    surface = FacetSurface(TETRAHEDRON, mixed, "tri3", flip)
    assert surface.orientation().outward
    assert surface.project([[0.1, 0.1, -0.5], [0.2, 0.2, 0.1]]).gap == pytest.approx([0.5, -0.1])


def test_empty_batches() -> None:
    """No points, no facets: empty results, and `beyond` where there is nothing."""
    assert square().project(np.zeros((0, 3))).gap.shape == (0,)
    nothing = FacetSurface(np.zeros((0, 3)), np.zeros((0, 3), dtype=int), "tri3")
    assert len(nothing) == 0
    assert nothing.project([[0, 0, 0]]).status.tolist() == [2]
