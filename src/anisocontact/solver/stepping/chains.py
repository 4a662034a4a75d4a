"""Bodies that loads drive through each other: what friction has to hold of them as one.

A load on the uppermost of three blocks has to be held between the lower ones, too, on which it does
not act. Bodies that contacts join are looked at as one rigid body, all of them, and those on either
side of each contact that is all between them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
import scipy

from anisocontact.base.array_types import Floats
from anisocontact.base.arrays import connected
from anisocontact.contact import Contact
from anisocontact.solver.stepping.driven import Driven, wrench


def chains(bodies: Sequence[Driven]) -> Iterator[Driven]:
    """Several bodies as one, of each set that loads may drive along contacts of no more of them.

    Args:
        bodies: Bodies that only contact holds.

    Yields:
        Each set of two or more that has motions of its own, small ones first.
    """
    found: set[tuple[int, ...]] = set()
    between = contacts_between(bodies)
    for left_out in (None, *between):
        pairs = [pair for contact, pair in between.items() if contact is not left_out]
        label = connected(len(bodies), np.array(pairs, dtype=np.int64).reshape(-1, 2))
        for one in np.unique(label):
            found.add(tuple(np.flatnonzero(label == one).tolist()))
    for members in sorted(found, key=lambda one: (len(one), one)):
        if len(members) > 1:
            whole = _joined([bodies[i] for i in members])
            if len(whole.motions) and whole.contacts:
                yield whole


def contacts_between(bodies: Sequence[Driven]) -> dict[Contact, tuple[int, int]]:
    """Contacts of two of the bodies, with their places."""
    places: dict[Contact, list[int]] = {}
    for i, body in enumerate(bodies):
        for contact, _ in body.contacts:
            places.setdefault(contact, []).append(i)
    return {contact: (at[0], at[1]) for contact, at in places.items() if len(at) == 2}


def _joined(bodies: Sequence[Driven]) -> Driven:
    inner = contacts_between(bodies)
    centre = np.mean([body.centre for body in bodies], axis=0)
    size = max(float(np.linalg.norm(body.centre - centre)) + body.size for body in bodies)
    loads, before = (
        np.sum([_about(centre, b, sums) for b, sums in zip(bodies, each, strict=True)], axis=0)
        for each in ([b.loads for b in bodies], [b.loads_before for b in bodies])
    )
    return Driven(
        [name for body in bodies for name in body.names],
        [pair for body in bodies for pair in body.contacts if pair[0] not in inner],
        centre,
        size,
        _common(_moved(body, centre, size) for body in bodies),
        wrench(loads, size),
        wrench(before, size),
        loads,
        before,
    )


def _about(centre: Floats, body: Driven, sums: Floats) -> Floats:
    """Sums of loads as of `Driven.loads`, about another centre."""
    out = sums.copy()
    out[:, :3] += np.outer(sums[:, 3], body.centre - centre)
    return out


def _moved(body: Driven, centre: Floats, size: float) -> Floats:
    """Motions of a body as those about another centre and with another size, orthonormal."""
    spin = body.motions[:, 3:] / body.size
    shift = body.motions[:, :3] + np.cross(spin, centre - body.centre)
    return np.asarray(np.linalg.qr(np.hstack([shift, spin * size]).T)[0].T)


def _common(every: Iterable[Floats]) -> Floats:
    """Motions that are among those of each, orthonormal, (k, 6)."""
    held = np.concatenate([np.eye(6) - motions.T @ motions for motions in every])
    return np.asarray(scipy.linalg.null_space(held, rcond=1e-6).T)
