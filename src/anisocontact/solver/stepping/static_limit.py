"""What any forces where bodies touch can balance: limit analysis of an assemblage of blocks.

Normal forces and friction at the points where bodies touch are unknowns of a linear program
[Livesley 1978]. Where it has no solution there is no equilibrium that touches at these points
alone, whatever the bodies deform and slide like.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from anisocontact.base.array_types import Floats
from anisocontact.solver.stepping.limit_load import (
    CORNERS,
    FEW,
    NONE,
    PressedPoints,
    friction_polygons,
)

#: Times the friction beyond which none would do, and how exactly the number is found.
NO_FRICTION, EXACT = 1e3, 1e-3
#: Forces out of balance, of the loads, that are none.
BALANCED = 1e-6


@dataclass(frozen=True)
class StaticBalance:
    """Equations of equilibrium of bodies that touch, one for each motion that only contact holds.

    With normal forces N >= 0 and shares R >= 0 of friction at the corners of the polygons around
    the friction ellipses they are `normal N + friction R + load = 0`, and `sum R <= N` of a point.

    Attributes:
        normal: Work of normal forces of one on the motions, (k, n).
        friction: The same of friction at the corners, those of a point in turn, (k, n * CORNERS).
        load: The same of the loads, (k,).
        size: Of the loads, those that supports carry as well.
    """

    normal: scipy.sparse.csr_array
    friction: scipy.sparse.csr_array
    load: Floats
    size: float

    @classmethod
    def of_body(cls, points: PressedPoints, motions: Floats, load: Floats) -> StaticBalance:
        """Of one body.

        Args:
            points: Where it touches; normal forces of these do not count.
            motions: Motions that nothing but contact holds, orthonormal, (k, 6).
            load: Force, and moment about the centre over the size, (6,).
        """
        return cls(*works(points, motions), motions @ load, float(np.linalg.norm(load)))

    @property
    def points(self) -> int:
        """Number of points."""
        return int(self.normal.shape[1])


def works(
    points: PressedPoints, motions: Floats, side: float = 1.0
) -> tuple[scipy.sparse.csr_array, scipy.sparse.csr_array]:
    """`StaticBalance.normal` and `friction` of one body at points.

    Args:
        points: Where it touches.
        motions: Motions that nothing but contact holds, orthonormal, (k, 6).
        side: 1 where friction acts on the body, -1 where on what it touches.
    """
    along = points.velocities(motions)
    normal = np.einsum("ni,nik->kn", points.normal, along)
    friction = side * np.einsum("njc,nck->knj", friction_polygons(points), along)
    return (
        scipy.sparse.csr_array(normal),
        scipy.sparse.csr_array(friction.reshape(len(motions), -1)),
    )


def friction_needed(balance: StaticBalance) -> float:
    """How many times the friction it takes for any forces at points to balance loads.

    What is out of balance at least falls with friction. Bisection finds its root, between numbers
    that Newton's method narrows down: multipliers of the friction limits give the slope.

    Returns:
        At least 1; infinite where no friction would do; 1 with more points than can be looked at.
    """
    if balance.points > FEW or np.linalg.norm(balance.load) <= NONE * balance.size:
        return 1.0
    low, high, times, root = 1.0, float("inf"), 1.0, 1.0
    while high > (1.0 + EXACT) * low:
        rest, slope = _out_of_balance(balance, times)
        if rest <= BALANCED:
            high = times
        elif times >= NO_FRICTION or not slope < 0.0:
            return float("inf")
        else:
            low, root = times, times - rest / slope
        # a root of Newton's method that is balanced is tried to be the least one at once
        closer = high / (1.0 + 0.9 * EXACT) if root == high else 0.5 * (low + high)
        times = min(root, NO_FRICTION, closer)
    return high


def mechanism(balance: StaticBalance) -> Floats:
    """Shares of the motions in the mechanism that friction lets go first, (k,).

    They are the multipliers of the equations of equilibrium where the share of the loads that is
    balanced is made as large as can be.
    """
    count, load = balance.points, balance.load
    equations = [balance.normal, balance.friction, scipy.sparse.csr_array(load[:, None])]
    free = np.zeros(count * (1 + CORNERS) + 1)
    free[-1] = -1.0
    found = scipy.optimize.linprog(
        free,
        A_ub=scipy.sparse.hstack([_cones(count, 1.0), scipy.sparse.csr_array((count, 1))]),
        b_ub=np.zeros(count),
        A_eq=scipy.sparse.hstack(equations) / np.linalg.norm(load),
        b_eq=np.zeros(len(load)),
        bounds=[(0.0, None)] * (len(free) - 1) + [(0.0, 1.0)],
    )
    return np.zeros(len(load)) if not found.success else np.asarray(found.eqlin.marginals)


def _cones(count: int, times: float) -> scipy.sparse.csr_array:
    """`sum R - times N` of each point."""
    sums = scipy.sparse.kron(scipy.sparse.eye(count), np.ones((1, CORNERS)))
    return scipy.sparse.csr_array(scipy.sparse.hstack([-times * scipy.sparse.eye(count), sums]))


def _out_of_balance(balance: StaticBalance, times: float) -> tuple[float, float]:
    """Least sum of forces out of balance over the loads, and its slope along `times`."""
    count, rows = balance.points, len(balance.load)
    rest = scipy.sparse.eye(rows)
    cones = _cones(count, times)
    found = scipy.optimize.linprog(
        np.concatenate([np.zeros(count * (1 + CORNERS)), np.ones(2 * rows)]),
        A_ub=scipy.sparse.hstack([cones, scipy.sparse.csr_array((count, 2 * rows))]).tocsr(),
        b_ub=np.zeros(count),
        A_eq=scipy.sparse.hstack([balance.normal, balance.friction, rest, -rest]).tocsr(),
        b_eq=-balance.load / np.linalg.norm(balance.load),
    )
    if not found.success:
        return 0.0, 0.0
    return float(found.fun), float(found.ineqlin.marginals @ found.x[:count])
