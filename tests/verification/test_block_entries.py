"""Where blocks of pairs of nodes go in a matrix of unknowns."""

from __future__ import annotations

import numpy as np
import scipy

from anisocontact.solver.strategies.condensed.assembly_map import AssemblyMap


def test_couplings_are_summed_as_by_scipy() -> None:
    """Blocks that overlap, in any order of nodes and unknowns, make the matrix of their entries.

    Requirement: the sum of couplings is that of their entries one by one, by SciPy; unknowns that
    have no number and nodes that are none are left out, and columns ascend. Rounding: few terms.
    """
    random = np.random.default_rng(3)
    nodes, size = 9, 20
    number = np.full(3 * nodes, -1)
    number[random.permutation(3 * nodes)[:size]] = random.permutation(size)
    couplings = []
    for p, r, c in ((5, 2, 3), (4, 1, 4), (6, 1, 1)):
        rows, columns = (random.integers(-1, nodes, (p, k)) for k in (r, c))
        couplings.append((rows, columns, random.normal(size=(p, r, c, 3, 3))))
    places = AssemblyMap(number)
    found = places.total(couplings, size)
    entries = np.append(number, [-1] * 3).reshape(-1, 3)
    expected = np.zeros((size, size))
    for rows, columns, values in couplings:
        for p, a, b, i, j in np.ndindex(values.shape):
            row, column = entries[rows[p, a], i], entries[columns[p, b], j]
            if row >= 0 and column >= 0:
                expected[row, column] += values[p, a, b, i, j]
    assert np.abs(found.toarray() - expected).max() < 1e-13
    assert found.has_canonical_format
    scipy.sparse.csr_array(found).check_format(full_check=True)
    # the same nodes again, other values
    twice = places.total(
        [(rows, columns, 2.0 * values) for rows, columns, values in couplings], size
    )
    assert np.abs(twice.toarray() - 2.0 * expected).max() < 1e-13
