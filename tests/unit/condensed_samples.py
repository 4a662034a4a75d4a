"""Matrices and bodies that tests of condensed contact share."""

from __future__ import annotations

import numpy as np
import scipy.sparse

from anisocontact.solver.strategies.condensed.parts import Condensation


def matrix_of(n: int, seed: int = 0) -> scipy.sparse.csr_array:
    """Symmetric, positive definite, sparse."""
    rng = np.random.default_rng(seed)
    half = scipy.sparse.random_array((n, n), density=0.1, rng=rng)
    return (half + half.T + 8.0 * scipy.sparse.eye_array(n)).tocsr()


def condensation() -> Condensation:
    """Two parts: one with contact, prescribed and interior unknowns, one all border."""
    matrix = scipy.sparse.block_diag([matrix_of(30), matrix_of(2, 1)], format="csr")
    touched, prescribed = np.zeros(32, dtype=bool), np.zeros(32, dtype=bool)
    touched[[4, 9, 17, 30, 31]] = True
    prescribed[[9, 20, 21]] = True
    return Condensation(
        scipy.sparse.csr_array(matrix), np.repeat([0, 1], [30, 2]), touched, prescribed
    )
