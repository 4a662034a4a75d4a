"""Contacts that say twice what meets what: their forces would act twice, or share themselves."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
import scipy

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI
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
    if len(contacts) < 2:
        return
    common = _CommonFacets(contacts)
    met = _same_master(contacts, common)
    for pair in combinations(range(len(contacts)), 2):
        first, second = (contacts[number] for number in pair)
        count, swapped = met.get(pair, 0), _swapped(first, second, common)
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
    return _same_master((one, two), _CommonFacets((one, two))).get((0, 1), 0)


class _CommonFacets:
    """How many facets any two groups of contacts have in common, over all ranks.

    Args:
        contacts: The contacts; the call is collective.
    """

    def __init__(self, contacts: Sequence[Contact]) -> None:
        named = {(id(c.model), group): c.model for c in contacts for group in c.groups}
        self._rows = {key: row for row, key in enumerate(named)}
        meshes = {id(model.mesh): model.mesh for model in named.values()}
        # facets of several meshes, one after the other
        sizes = [m.topology.index_map(m.topology.dim - 1).size_local for m in meshes.values()]
        starts = dict(zip(meshes, np.cumsum([0, *sizes]), strict=False))
        facets = [
            starts[id(model.mesh)] + np.unique(model.owned_facets(group)).astype(np.int64)
            for (_, group), model in named.items()
        ]
        columns = np.concatenate([np.zeros(0, np.int64), *facets])
        rows = np.repeat(np.arange(len(facets)), [len(one) for one in facets])
        there = scipy.sparse.csr_array(
            (np.ones(len(rows), np.int64), (rows, columns)), (len(facets), sum(sizes))
        )
        self._counts = (there @ there.T).toarray()
        self._counts = contacts[0].model.mesh.comm.allreduce(self._counts)

    def of(self, one: Contact, group: str, two: Contact, other: str) -> int:
        """Facets of a group of one contact that are in a group of another."""
        rows = self._rows[id(one.model), group], self._rows[id(two.model), other]
        return int(self._counts[rows])


def _same_master(contacts: Sequence[Contact], common: _CommonFacets) -> dict[tuple[int, int], int]:
    """Facets, over all ranks, that meet the same master in two contacts, by their numbers."""
    pairs = combinations(range(len(contacts)), 2)
    counts = {(i, k): _on_groups(contacts[i], contacts[k], common) for i, k in pairs}
    met = {pair: count for pair, count in counts.items() if count}
    surfaces = [pair for pair in met if not contacts[pair[0]].meshed]
    if not surfaces:
        return met
    # each surface once, as many of them may meet one slave
    feet = {number: _Feet(contacts[number]) for number in {n for pair in surfaces for n in pair}}
    same = np.array([feet[i].same(feet[k]) for i, k in surfaces])
    contacts[0].model.mesh.comm.Allreduce(MPI.IN_PLACE, same, MPI.LAND)
    others = {pair for pair, one in zip(surfaces, same, strict=True) if not one}
    return {pair: count for pair, count in met.items() if pair not in others}


def _on_groups(one: Contact, two: Contact, common: _CommonFacets) -> int:
    """Facets of the slaves of both whose masters have some in common, or are both surfaces."""
    if one.meshed != two.meshed or one.body is not two.body:
        return 0
    pairs = zip(one.groups, two.groups, strict=True)
    slaves, *masters = [common.of(one, group, two, other) for group, other in pairs]
    return slaves if all(masters) else 0


def _swapped(one: Contact, two: Contact, common: _CommonFacets) -> int:
    """Facets of the slave of `two` that meet, as a master, its own.

    Both contacts would press them apart: pressures are shared at random, and friction pulls.
    """
    if not (one.of_two_groups and two.of_two_groups):
        return 0
    pairs = zip(one.groups, reversed(two.groups), strict=True)
    masters, slaves = [common.of(one, group, two, other) for group, other in pairs]
    return slaves if masters else 0


class _Feet:
    """Closest points of the slave points of a contact on its surface."""

    def __init__(self, contact: Contact) -> None:
        self._surface, self._size = contact.surface(), contact.facet_size
        self._x = contact.slave_points.quadrature.reference
        self._closest = _closest(self._surface, self._x)

    def same(self, other: _Feet) -> bool:
        """Whether the slave points of both, on this rank, have the same ones on both surfaces."""
        far = np.abs(np.concatenate([self._x, other._x])).max(initial=0.0) + self._size
        mine, theirs = self._closest, other._closest
        if not np.array_equal(self._x, other._x):
            mine = np.concatenate([mine, _closest(self._surface, other._x)])
            theirs = np.concatenate([_closest(other._surface, self._x), theirs])
        return bool((np.abs(mine - theirs) <= SAME * far).all())


def _closest(surface: Surface, x: Floats) -> Floats:
    """Closest points, and gaps, (n, 4), length."""
    found = surface.project(x, derivatives=False)
    return np.column_stack([surface.position(found.xi), found.gap])
