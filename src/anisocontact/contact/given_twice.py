"""Contacts that say twice what meets what: their forces would act twice, or share themselves."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.contact.contact import Contact
from anisocontact.surfaces import Surface

#: Difference of closest points that are the same, over distances from the origin.
SAME = 1e-12


def check_given_once(contacts: Sequence[Contact], field: str) -> None:
    """Refuse facets that meet each other in two contacts, whichever is the slave; collective.

    Args:
        contacts: The contacts of a problem.
        field: Where they were given.

    Raises:
        InputError: Names the contacts and how many facets they share.
    """
    for first, second in combinations(contacts, 2):
        count, swapped = shared(first, second), swapped_facets(first, second)
        if count or swapped:
            what = (
                f"{count} of its facets meet the same master in contact {first.name!r}"
                if count
                else f"{swapped} of its facets are the master of what its master is the slave in, "
                f"contact {first.name!r}; take one side as the slave"
            )
            raise InputError(f"contact {second.name!r} is given twice: {what}", field)


def shared(one: Contact, two: Contact) -> int:
    """Facets, over all ranks, that meet the same master in two contacts; collective.

    Facets of a master are the same by their numbers, surfaces where all slave points have the same
    closest points on them.
    """
    if one.meshed != two.meshed or one.body is not two.body:
        return 0
    pairs = zip(one.groups, two.groups, strict=True)
    count = min([_common(one, two, *pair) for pair in pairs])
    return count if count and (one.meshed or _same_surface(one, two)) else 0


def swapped_facets(one: Contact, two: Contact) -> int:
    """Facets, over all ranks, of the slave of `two` that meet, as a master, its own; collective.

    Both contacts would press them apart: pressures are shared at random, and friction pulls.
    """
    if not (one.of_two_groups and two.of_two_groups):
        return 0
    pairs = zip(one.groups, reversed(two.groups), strict=True)
    masters, slaves = [_common(one, two, *pair) for pair in pairs]
    return slaves if masters else 0


def _common(one: Contact, two: Contact, group: str, other: str) -> int:
    """Facets of a group of one contact that are in a group of the other; collective."""
    mine, others = one.model.owned_facets(group), two.model.owned_facets(other)
    here = len(np.intersect1d(mine, others)) if one.model.mesh is two.model.mesh else 0
    return int(one.model.mesh.comm.allreduce(here))


def _same_surface(one: Contact, two: Contact) -> bool:
    """Whether slave points of both have the same closest points; collective."""
    x = np.concatenate([contact.slave_points.quadrature.reference for contact in (one, two)])
    far = np.abs(x).max(initial=0.0) + one.facet_size
    apart = np.abs(_closest(one.surface(), x) - _closest(two.surface(), x))
    differs = int(not (apart <= SAME * far).all())
    return not one.model.mesh.comm.allreduce(differs)


def _closest(surface: Surface, x: Floats) -> Floats:
    """Closest points, and gaps, (n, 4), length."""
    found = surface.project(x, derivatives=False)
    return np.column_stack([surface.position(found.xi), found.gap])
