"""Which side of a fold is the slave."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.contact.self_contact import with_sides

NONE = np.zeros((0, 2), dtype=np.int64)


def _sides(count: int, pairs: list[tuple[int, int]], beside=NONE, known=None) -> list[int]:
    side = np.zeros(count, dtype=np.int8)
    for facet, own in (known or {}).items():
        side[facet] = own
    first, second = np.array(pairs).T
    beside = np.array(beside, dtype=np.int64)
    return with_sides(side, beside, first, second, np.ones(len(pairs))).tolist()


@pytest.mark.parametrize(
    ("coarse", "fine"), [((0, 1), (2, 3, 4)), ((3, 4), (0, 1, 2)), ((0, 3), (1, 2, 4))]
)
def test_the_finer_side_is_the_slave(coarse: tuple[int, ...], fine: tuple[int, ...]) -> None:
    """Two facets that face three: these are the slave, whatever the numbers of the facets are."""
    (a, b), (p, q, r) = coarse, fine
    found = _sides(5, [(a, p), (a, q), (b, q), (b, r)])
    assert [found[k] for k in fine] == [1, 1, 1]
    assert [found[k] for k in coarse] == [-1, -1]


@pytest.mark.parametrize("opposite", [((0, 1), (2, 3)), ((0, 3), (2, 1)), ((1, 0), (3, 2))])
def test_a_side_is_whole_where_meshes_match(opposite: tuple[tuple[int, int], ...]) -> None:
    """Facets that face one each, in as many parts: those beside each other have the same side."""
    (a, p), (b, q) = opposite
    found = _sides(4, list(opposite), beside=[(a, b), (p, q)])
    assert found[a] == found[b] == -found[p] == -found[q]
    known = _sides(4, list(opposite), beside=[(a, b), (p, q)], known={a: -1, p: 1})
    assert (known[b], known[q]) == (-1, 1)


def test_new_facets_take_the_side_that_those_they_face_leave() -> None:
    """A facet that is faced for the first time, by masters, is a slave of the same fold."""
    assert _sides(4, [(0, 1), (2, 1), (2, 3)], known={0: 1, 1: -1}) == [1, -1, 1, -1]


@pytest.mark.parametrize("shift", range(8))
def test_a_round_end_of_a_fold_is_where_sides_meet(shift: int) -> None:
    """Eight facets around the end of a fold, each facing the fourth from it: two sides of four.

    What the facets beside each other at the end face is not beside each other.
    """
    around = np.roll(np.arange(8), shift)
    pairs = [(int(around[k]), int(around[k + 4])) for k in range(4)]
    beside = np.stack([around[:-1], around[1:]], axis=1)
    found = np.array(_sides(8, pairs, beside))[around]
    assert abs(found[:4].sum()) == 4
    assert found[:4].tolist() == (-found[4:]).tolist()
