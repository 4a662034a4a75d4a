"""Blocks between nodes as a sparse matrix, in whatever order a process has them."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.solver.strategies.condensed.touched import _by_rows


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 0, 2, 1), (2, 3, 1, 0)])
def test_blocks_in_any_order(order: tuple[int, ...]) -> None:
    """Requirement: each block where its row and column say. Source: the sum written out, exact.

    On several processes nodes are sorted by their local numbers and come by those of the mesh.
    """
    rows, columns = np.array([0, 0, 1, 3])[[*order]], np.array([1, 2, 0, 3])[[*order]]
    blocks = np.arange(36.0).reshape(4, 9)[[*order]]
    expected = np.zeros((12, 12))
    for row, column, block in zip(rows, columns, blocks, strict=True):
        expected[3 * row : 3 * row + 3, 3 * column : 3 * column + 3] += block.reshape(3, 3)
    found = _by_rows(rows, columns, blocks, 4)
    assert np.array_equal(found.toarray(), expected)
