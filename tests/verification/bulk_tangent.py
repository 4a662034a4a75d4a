"""How fast central differences of the forces inside bodies come to their tangent."""

from __future__ import annotations

from typing import Any

import numpy as np

#: Shares of a direction by which displacements go to either side.
STEPS = (2e-3, 1e-3)


def ratio_of_errors(bulk: Any, x: Any, direction: np.ndarray) -> float:
    """Error of central differences of the force over that at half the step: 4 for the tangent.

    Args:
        bulk: Bodies.
        x: Displacement, a vector of PETSc.
        direction: Direction of the differences, (unknowns,).
    """
    bulk.force(x)
    matrix, way, product = bulk.stiffness.duplicate(), x.duplicate(), x.duplicate()
    bulk.tangent(matrix)
    way.array[:] = direction
    matrix.mult(way, product)
    errors = []
    for h in STEPS:
        ends = []
        for sign in (1.0, -1.0):
            moved = x.copy()
            moved.axpy(sign * h, way)
            ends.append(bulk.force(moved).array_r.copy())
        errors.append(np.linalg.norm((ends[0] - ends[1]) / (2 * h) - product.array_r))
    return float(errors[0] / errors[1])
