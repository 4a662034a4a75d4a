"""Loads that no forces balance where bodies touch before anything presses.

A ladder that stands too flat, or an arch whose blocks rub too little: whatever pressed where they
touch, friction could not hold them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import scipy

from anisocontact.base.arrays import connected
from anisocontact.contact import Contact
from anisocontact.solver.stepping.chains import contacts_between
from anisocontact.solver.stepping.driven import Driven, deformable
from anisocontact.solver.stepping.limit_load import PressedPoints
from anisocontact.solver.stepping.overload import TOO_MUCH, WITHOUT, Overload
from anisocontact.solver.stepping.pressed_points import moves, pressed_points, touching_points
from anisocontact.solver.stepping.static_limit import (
    NO_FRICTION,
    StaticBalance,
    friction_needed,
    mechanism,
    works,
)
from anisocontact.solver.system.problem import Problem

#: Velocity over the largest one from which on a body is part of a mechanism.
MOVES = 1e-6
#: Names of bodies that are told, of more of them.
NAMED = 2


def unbalanced(problem: Problem, fraction: float, now: float) -> list[Overload]:
    """As of `too_much_load`, of deformable bodies that touch and that nothing presses yet.

    No forces at all at the points where they touch are in balance with their loads, be it of one
    body or of all that contacts join.
    """
    found: list[Overload] = []
    told: frozenset[str] = frozenset()
    for bodies in _groups(list(deformable(problem, fraction, now))):
        parts = frozenset(name for body in bodies for name in body.names)
        if told & parts or not _at_rest(problem, bodies):
            continue
        balance = _balance(problem, bodies)
        needed = friction_needed(balance)
        if TOO_MUCH < needed < NO_FRICTION:  # what nothing could hold flies off, and that is told
            told |= parts
            cure = WITHOUT if len(bodies) == 1 else WITHOUT.replace("it", "them")
            text = f"{_line(bodies, balance)}: it would take {needed:.3g} times the friction"
            found.append(Overload(f"{text}; {cure}", True, not moves(problem)))
    return found


def _groups(bodies: Sequence[Driven]) -> Iterator[Sequence[Driven]]:
    """Each body, then those that contacts join."""
    yield from ([body] for body in bodies)
    pairs = np.array(list(contacts_between(bodies).values()), dtype=np.int64).reshape(-1, 2)
    label = connected(len(bodies), pairs)
    for one in np.unique(label):
        group = [body for body, own in zip(bodies, label, strict=True) if own == one]
        if len(group) > 1:
            yield group


def _at_rest(problem: Problem, bodies: Sequence[Driven]) -> bool:
    """Whether all of their contacts touch and none presses."""
    for body in bodies:
        points = touching_points(problem, body)
        known = body.contacts and all(contact in points for contact, _ in body.contacts)
        if not known or any(not len(one.force) for one in points.values()):
            return False
        if pressed_points(problem, body)[1]:
            return False
    return True


def _balance(problem: Problem, bodies: Sequence[Driven]) -> StaticBalance:
    """Equations of all bodies; those of a contact of two share its forces."""
    touching = [touching_points(problem, body) for body in bodies]
    contacts = list(dict.fromkeys(contact for points in touching for contact in points))
    rows = [
        [_works(body, points.get(contact), contact) for contact in contacts]
        for body, points in zip(bodies, touching, strict=True)
    ]
    normal, friction = (
        scipy.sparse.block_array(
            [[None if both is None else both[kind] for both in row] for row in rows]
        ).tocsr()
        for kind in (0, 1)
    )
    loads = np.concatenate([body.motions @ body.load for body in bodies])
    size = float(np.linalg.norm([np.linalg.norm(body.load) for body in bodies]))
    return StaticBalance(normal, friction, loads, size)


def _works(
    body: Driven, points: PressedPoints | None, contact: Contact
) -> tuple[scipy.sparse.csr_array, scipy.sparse.csr_array] | None:
    if points is None:
        return None
    return works(points, body.motions, dict(body.contacts)[contact])


def _line(bodies: Sequence[Driven], balance: StaticBalance) -> str:
    """Which bodies nothing holds: those that move in the mechanism."""
    if len(bodies) == 1:
        return f"no forces where {bodies[0].name} touches balance the loads on it"
    ends = np.cumsum([len(body.motions) for body in bodies])[:-1]
    speeds = [np.linalg.norm(v) for v in np.split(mechanism(balance), ends)]
    fast = MOVES * max(speeds)
    names = [b.name for b, speed in zip(bodies, speeds, strict=True) if speed >= fast]
    others = len(names) - NAMED
    listed = (
        f"{', '.join(names[:NAMED])} and {others} others" if others > 1 else " and ".join(names)
    )
    return f"no forces where {listed} touch balance the loads on them"
