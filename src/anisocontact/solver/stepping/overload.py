"""Loads on a free body that friction cannot hold, told where a run stops.

A body that only contact holds cannot carry more along a flat contact than the friction ellipse
allows: `mu N` in the direction of the load, N what presses it on. There is no equilibrium to be
found, and Newton's method ends in whatever it meets first.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.free_body import FreeBody

#: Sum of the normal forces over the sum of their sizes from which on a contact is flat.
FLAT = 0.99
#: Share of a direction that has to be among the free motions of a body.
FREE = 0.99
#: Load over the limit of friction that is too much: below, something else is the cause.
TOO_MUCH = 1.001
#: Tangential load over the normal one that is none.
NONE = 1e-9


@dataclass(frozen=True)
class _ContactLoad:
    """What contact carries of a body.

    Attributes:
        normal: Direction in which contact pushes the body, (3,).
        force: Normal force, force.
        pairs: Contacts with the share of each in it.
    """

    normal: Floats
    force: float
    pairs: Sequence[tuple[Contact, float]]


def too_much_load(
    problem: Problem, fraction: float, over: float = TOO_MUCH, by: Contact | None = None
) -> str:
    """Which loads on a free body friction cannot hold; empty if there are none, on all ranks.

    Args:
        problem: The problem, in the last accepted state.
        fraction: Fraction of the step whose loads are looked at.
        over: Load over the limit of friction that is too much.
        by: Contact that has to be the only one that holds the body; any if left out.
    """
    if not problem.stabilisation.loose:
        return ""
    problem.loads.set_load_factor(fraction, problem.dt)
    load = problem.loads.force(problem.u.x.array.reshape(-1, 3))
    problem.loads.set_load_factor(problem.load_factor, problem.dt)
    found = list(_found(problem, problem.layout.assembled(load).reshape(-1, 3), over, by))
    return "; ".join(found)


def _found(problem: Problem, load: Floats, over: float, by: Contact | None) -> Iterator[str]:
    for free in problem.stabilisation.loose:
        if by is not None and any(contact is not by for contact in free.contacts):
            continue
        force = problem.comm.allreduce(load[free.body.nodes].sum(axis=0))
        held = _holding(problem, free)
        if held is None:
            continue
        normal = held.normal
        pressed = held.force
        if free.moves_along(normal) > FREE:
            pressed = max(float(-force @ normal), 0.0)
        tangential = force - (force @ normal) * normal
        size = float(np.linalg.norm(tangential))
        if size <= NONE * max(pressed, float(np.linalg.norm(force))):
            continue
        along = tangential / size
        share = sum(part * _limit(problem, contact, along) for contact, part in held.pairs)
        if free.moves_along(along) > FREE and size > over * share * pressed:
            yield (
                f"the loads on body {free.body.name!r} come to {size:.4g} along {_shown(along)}, "
                f"and friction holds {share * pressed:.4g} there at most, {share:.4g} of the "
                f"normal force {pressed:.4g}: load it less, press it more, or hold it by "
                "displacements"
            )


def _holding(problem: Problem, free: FreeBody) -> _ContactLoad | None:
    """Contact of a body in the accepted state; None where it is not flat, or there is none."""
    total, sizes, pairs = np.zeros(3), 0.0, []
    for contact in free.contacts:
        weights = contact.areas * contact.last.pressure
        push = problem.comm.allreduce(weights @ contact.last.normal)
        size = float(problem.comm.allreduce(weights.sum()))
        of_slave = problem.model.body_of(contact.slave) in free.body.parts
        total += push if of_slave else -push
        sizes += size
        pairs.append((contact, size))
    pushed = float(np.linalg.norm(total))
    if not pushed > FLAT * sizes > 0.0:
        return None
    return _ContactLoad(
        total / pushed, pushed, [(contact, size / sizes) for contact, size in pairs]
    )


def _limit(problem: Problem, contact: Contact, along: Floats) -> float:
    """Friction over pressure along a direction, the mean over the normal force of a contact."""
    friction = contact.interface.tangential.friction
    if friction is None:  # a law in Python
        return np.inf
    weights = contact.areas * contact.last.pressure
    each = _coefficient(friction, contact.last.directions_friction, along)
    top, bottom = problem.comm.allreduce(np.array([weights @ each, weights.sum()]))
    return float(top / bottom) if bottom > 0.0 else np.inf


def _coefficient(friction: Friction, axes: Floats, along: Floats) -> Floats:
    """Friction over pressure along a direction at points with these axes, (n,).

    From `d . F d` with F of two coefficients [Konyukhov Schweizerhof 2006, eq. (43)]; of two
    surfaces the most that there is in any direction.
    """
    values = friction.named[1]
    if friction.frictionless:
        return np.zeros(len(axes))
    if "coefficients" not in values:
        first, *others = values["alpha"]
        return np.full(len(axes), first + sum(max(value, 0.0) for value in others))
    first, second = values["coefficients"]
    if first == second and not axes.any():
        return np.full(len(axes), first)
    inside = axes @ along / np.array([first, second])
    sizes = np.linalg.norm(inside, axis=1)
    return np.where(sizes > 0.0, 1.0 / np.maximum(sizes, np.finfo(float).tiny), max(first, second))


def _shown(vector: Floats) -> str:
    return "(" + ", ".join(f"{v + 0.0:g}" for v in vector.round(2)) + ")"
