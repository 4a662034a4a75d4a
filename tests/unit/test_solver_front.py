"""The front of `condensed`: what it solves is the whole matrix, whatever is eliminated."""

from __future__ import annotations

import numpy as np
import pytest
import scipy

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.solver.strategies.condensed.front import Front

COUNT, SLAVES = 12, 4


@pytest.mark.parametrize("eliminated", [0, 3, COUNT - SLAVES])
def test_solves_with_the_matrix(eliminated: int) -> None:
    """(S + C) u = b by v, u = T v, with no, some and all of the masters eliminated.

    Requirement: 1e-4. Source: T^T (S + C) T v = T^T b; C acts on the relative motion of the slaves
    and on unknowns that stay. Tolerance: single precision, condition number below a hundred.
    """
    rng = np.random.default_rng(3)
    root = rng.normal(size=(COUNT, COUNT))
    summed = np.float32(np.eye(COUNT) + 0.1 * root @ root.T)
    shares = np.zeros((COUNT, COUNT))
    shares[:SLAVES, SLAVES:] = rng.dirichlet(np.ones(COUNT - SLAVES), SLAVES)
    gap = np.eye(COUNT) - shares
    stiff = np.zeros(COUNT)
    stiff[:SLAVES] = 5.0
    contact = gap.T @ np.diag(stiff) @ gap
    stays = np.arange(COUNT) < COUNT - eliminated
    between = scipy.sparse.csr_array(shares.astype(np.float32))

    front = Front(lambda: np.array(summed, order="F"), between, stays)
    solve = front.factor(front.held(scipy.sparse.csr_array(contact), between))
    b = rng.normal(size=COUNT)
    v = solve(np.float32(b + shares.T @ b))
    u = v + shares @ v

    wanted = np.linalg.solve(summed + contact, b)
    np.testing.assert_allclose(u, wanted, atol=1e-4 * np.abs(wanted).max())
