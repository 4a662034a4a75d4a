"""Slave points that have come to lie inside their master without force."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from anisocontact.contact.side_of_master import Seen, SideOfMaster

type Floats = np.ndarray[Any, np.dtype[np.float64]]
type Flags = np.ndarray[Any, np.dtype[np.bool_]]

X = np.linspace(-4.0, 4.0, 33)
MIDDLE = np.isclose(X, 0.0)


def _roller(x: Floats, _: object = None) -> Seen:
    """A roller of unit radius at the origin."""
    far = np.linalg.norm(x, axis=1)
    return Seen(np.ones(len(x), dtype=bool), far - 1.0, x / far[:, None])


def _line(height: float) -> Floats:
    return np.column_stack([X, np.full(len(X), height), np.zeros(len(X))])


def _leaf(before: float, touched: Flags, idle: bool = False) -> SideOfMaster:
    """A leaf whose lower face sank to 0.6 above the axis of a roller, or below if it is idle."""
    none = np.zeros(len(X), dtype=bool)
    side = SideOfMaster(
        before=_line(before),
        now=_line(-0.6 if idle else 0.6),
        outward=np.tile([0.0, -1.0, 0.0], (len(X), 1)),
        touched=touched,
        closed=none,
        located=none,
        had=none if idle else ~none,
        normal=np.full((len(X), 3), np.nan),
        areas=np.ones(len(X)),
        size=0.25,
        reach=1.0,
        look=_roller,
        comm=MPI.COMM_SELF,
        idle=none,
    )
    seen = _roller(side.now)
    return side.with_behind(seen.gap <= 0.0, seen.normal, side.areas) if idle else side


@pytest.mark.parametrize("idle", [False, True], ids=["lost", "pressed from behind"])
def test_a_leaf_that_touched_a_roller_and_lies_in_it(idle: bool) -> None:
    """It touched by one of its 33 points, and five are now deeper than a quarter of a facet.

    Requirement: these are told though they are few of the leaf's. Source: the gap is the distance
    from the axis less 1, by geometry; at x = 0 it is -0.4, and |x| = 0.5 is the last with a gap
    below -0.0625, of -0.219, since that of 0.75 is -0.0395. Tolerance: round-off.
    """
    which, depth = _leaf(1.0, MIDDLE, idle).inside()
    assert X[which].tolist() == [-0.5, -0.25, 0.0, 0.25, 0.5]
    assert depth.max() == pytest.approx(0.4, rel=1e-12)
    assert depth.min() == pytest.approx(1.0 - np.hypot(0.5, 0.6), rel=1e-12)


@pytest.mark.parametrize(
    ("before", "touched"),
    [(1.0, MIDDLE & False), (0.6, MIDDLE), (1.0, MIDDLE | True)],
    ids=["it did not touch", "it was there before", "hardly more than an edge"],
)
def test_what_may_lie_in_a_roller(before: float, touched: Flags) -> None:
    """Requirement: bodies that came another way, or lay there, and a few points at an edge.

    Of 33 points in contact a tenth are 3.3; of the five that lie deep all but three are left out.
    """
    side = _leaf(before, touched)
    if touched.all():
        side.now[X < 0.0, 1] = 1.0
    which, depth = side.inside()
    assert len(which) == len(depth) == 0
