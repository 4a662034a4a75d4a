"""A step of the Krylov method: what an earlier factor gives, and its product with the tangent."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from anisocontact.solver.strategies.condensed.dense import ContactTangent
from anisocontact.solver.strategies.condensed.front import Front, Reals, difference
from anisocontact.solver.strategies.condensed.updated import UpdatedFactor

KrylovStep = Callable[[Reals], tuple[Reals, Reals]]


def step_of_changes(front: Front, factor: UpdatedFactor, tangent: ContactTangent) -> KrylovStep:
    """On all unknowns, where nothing is eliminated, (c,).

    With the factor of `M = S' + K` of an earlier K the product is `A M^-1 v = v + (C - K) M^-1 v`.
    """
    change = difference(front.own(tangent.summed), factor.held)
    change.eliminate_zeros()

    def step(v: Reals) -> tuple[Reals, Reals]:
        direction = factor(v)
        return direction, v + change @ direction

    return step


def step_against_masters(
    front: Front, factor: UpdatedFactor, tangent: ContactTangent
) -> KrylovStep:
    """On all unknowns, where slave nodes move on over their masters, (c,).

    With the factor of M = T^-T (S' + K) T^-1, S' = T^T S T, of an earlier P and K, and with E
    the change of P since, a solution is `x = (1 + E) M^-1 (1 + E)^T v`, and
    `A x = (1 + E)^T v - T^-T K T^-1 M^-1 (1 + E)^T v + C x + S E M^-1 (1 + E)^T v`: of products
    with S there is at most that with E.
    """
    shares, contact = front.shares, tangent.summed
    drift = (front.shares_with(tangent.shares) - shares).tocsr()
    back, drift_back = shares.T.tocsr(), drift.T.tocsr()

    def step(v: Reals) -> tuple[Reals, Reals]:
        turned = v + drift_back @ v
        own = front.solution(factor, turned + back @ turned)
        held, more = np.zeros_like(v), drift @ own
        held[front.unknowns] = factor.held @ own[front.unknowns]
        x = own + shares @ own + more
        product = turned - held + back @ held + contact @ x + tangent.bodies_times(more)
        return x, product

    return step
