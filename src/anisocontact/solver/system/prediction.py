"""Couplings that contact will need: those of facets reached by prescribed motions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.load_curve import history_of
from anisocontact.contact import Contact
from anisocontact.contact.reachable import NodePairs
from anisocontact.solver.terms.step import AXES, Step

# Places that are not used cost fill: a margin of a quarter or a longer window make eliminations
# dearer than the symbolic factorisations that they save, see docs/dev/decisions.md.
#: Motion beside the prescribed one, over the size of a slave facet: bodies deform.
MARGIN = 0.1
#: How far ahead facets are looked for, over the size of a slave facet.
FARTHEST = 2.0
#: Increments that points are taken to go on sliding where nothing is prescribed.
MOST_INCREMENTS = 10.0
#: Distance of the places along the way at which they are looked for, likewise.
SPACING = 0.5


class ContactPrediction:
    """Predicts contact along the prescribed motions of all steps.

    Args:
        contacts: Those against facets.
        steps: What will be done.
    """

    def __init__(self, contacts: Sequence[Contact], steps: Sequence[Step]) -> None:
        self._contacts, self._steps = list(contacts), list(steps)
        self._increments = np.array([step.increments for step in steps], dtype=np.float64)
        names = {name for one in contacts for name in one.groups}
        bodies = {name.partition(".")[0] for name in names}
        self._paths = {body: _path(steps, body) for body in bodies}

    def pairs(self, step: Step | None, load_factor: float) -> list[NodePairs]:
        """Nodes that can be coupled from now on.

        Where nothing is prescribed, as under loads and turns, points are taken to go on as they
        have slid in this increment.

        Args:
            step: The step that has been begun last; None before the first.
            load_factor: Fraction of it.
        """
        found = []
        for one in self._contacts:
            way, hops = self.way(one, step, load_factor)
            way = way[:, None]
            if len(way) == 1:
                way, hops = going_on(one)
            found += one.master.reachable(way, MARGIN * one.slave_points.size, hops)
        return found

    def way(self, one: Contact, step: Step | None, load_factor: float) -> tuple[Floats, int]:
        """Displacement of the slave against the master at places along the way, (w, 3), length.

        Args:
            one: The pass.
            step: The step that has been begun last; None before the first.
            load_factor: Fraction of it.

        Returns:
            The places, and how many of them an increment goes at most.
        """
        first = next((i for i, known in enumerate(self._steps) if known is step), 0)
        slave, master = (self._paths[name.partition(".")[0]] for name in one.groups)
        path = slave - master
        ends, jumps = path[first:], np.diff(path[first:], axis=0)
        with np.errstate(over="ignore"):
            sizes = np.linalg.norm(jumps, axis=1) / self._increments[first:]
        if len(jumps):
            ends = np.concatenate([ends[:1] + load_factor * jumps[:1], ends[1:]])
        spacing, farthest = SPACING * one.slave_points.size, FARTHEST * one.slave_points.size
        # what is farther than twice as far from a place within is outside
        way = _sampled(ends - ends[0], spacing, most=int(2.0 * FARTHEST / SPACING) + 1)
        beyond = np.flatnonzero(np.linalg.norm(way, axis=1) > farthest)
        way = way[: beyond[0]] if len(beyond) else way
        hops = np.ceil(min(sizes.max(initial=0.0), farthest) / spacing)
        return way, int(hops)


def going_on(one: Contact) -> tuple[Floats, int]:
    """Where slave points get to that slide on as in this increment, (w, n or 1, 3), length.

    Also how many of these places an increment goes.
    """
    slid = one.master.slid(one.state) / one.slave_points.size
    longest = float(np.linalg.norm(slid, axis=1).max(initial=0.0))
    if not 0.0 < longest < np.inf:
        return np.zeros((1, 1, 3)), 0
    increments = min(FARTHEST / longest, MOST_INCREMENTS)
    count = int(np.ceil(increments * longest / SPACING))
    share = np.linspace(0.0, increments, count + 1)[:, None, None]
    hops = int(np.ceil(min(longest, FARTHEST) / SPACING))
    return share * slid * one.slave_points.size, hops


def _path(steps: Sequence[Step], body: str) -> Floats:
    """Displacement of a body at the beginning and at the ends of the steps, (steps + 1, 3), length.

    Along each axis that of the support that moves farthest.
    """
    groups = {g for step in steps for g in step.displacement if g.partition(".")[0] == body}
    path = np.zeros((len(steps) + 1, 3))
    for group in sorted(groups):
        own = np.zeros_like(path)
        for k, step in enumerate(steps):
            own[k + 1] = own[k]
            for axis, value in step.displacement.get(group, {}).items():
                if value is not None:
                    i = AXES.index(axis)
                    own[k + 1, i] = history_of(value).at(1.0, step.duration, own[k, i])
        farther = np.abs(own).max(axis=0) > np.abs(path).max(axis=0)
        path[:, farther] = own[:, farther]
    return path


def _sampled(ends: Floats, spacing: float, most: int) -> Floats:
    """Places along a polygon, at most `spacing` apart, the first `most` of each side, (w, 3)."""
    places = [ends[:1]]
    for begin, end in pairwise(ends):
        count = np.ceil(math.hypot(*(end - begin)) / spacing)
        share = np.arange(1.0, min(count, most) + 1.0)[:, None] / max(count, 1.0)
        places.append(begin + share * (end - begin))
    return np.concatenate(places)
