"""Slave points at one state, and what slip has come to on the way there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.statuses import OPEN
from anisocontact.interface import Response, State


@dataclass(frozen=True)
class Snapshot:
    """Slave points at one state.

    Attributes:
        points: Where they are, (n, 3), length.
        areas: Area of each, (n,), length^2.
        response: What the interface answers.
    """

    points: Floats
    areas: Floats
    response: Response

    @property
    def forces(self) -> Floats:
        """Force on the slave at each point, (n, 3)."""
        return self.areas[:, None] * self.response.traction

    @property
    def turned_forces(self) -> Floats:
        """Sums of the tangential forces of this rank, and of these times turns cubed, (2,).

        Force, and force times radian^3; points that are open have no force.
        """
        size = self.areas * np.linalg.norm(self.response.traction_t, axis=1)
        return np.array([size.sum(), np.sum(size * self.response.state["turn"] ** 3)])

    def wrench(self, about: Floats, traction: Floats | None = None) -> Floats:
        """Force and moment about a point on the slave over the points of this rank, (6,).

        Args:
            about: Point of the moment, (3,), length.
            traction: On the slave, (n, 3), stress; that of the response if not given.
        """
        forces = self.forces if traction is None else self.areas[:, None] * traction
        moments = np.cross(self.points - about, forces)
        return np.concatenate([forces.sum(axis=0), moments.sum(axis=0)])


@dataclass(frozen=True)
class Slid:
    """What slip has come to at slave points since the start.

    Attributes:
        way: Length of the sliding path, (n,), length.
        work: What friction has dissipated, (n,), energy/area.
        touching: Where there is contact, (n,).
    """

    way: Floats
    work: Floats
    touching: Flags

    @classmethod
    def of(cls, state: State) -> Slid:
        """That of a state."""
        touching = state["status"] != OPEN
        return cls(state["slip_accumulated"].copy(), state["dissipation"].copy(), touching)


def dissipated(state: State, way: Sequence[Slid], end: State, mean: Floats | float) -> Floats:
    """What friction has dissipated since the start, with the force that it has on the way, (n,).

    The law takes the slip from the accepted state at once, `D = -T . s` with the force of the end.
    In equilibrium the force that presses grows with the slip, and friction with it: its mean is
    right to second order; of a law in Python whose friction does not grow with the pressure, to
    first order. Where springs let bodies go the way there is taken piece by piece, by the sum of
    the means; while a point that touches has not slipped its force at yield is taken for that of
    the next state, and one that is open has none.

    Args:
        state: The accepted state.
        way: What slip had come to where springs let bodies go, empty in equilibrium.
        end: The state where the way ends.
        mean: Mean of what presses in both states over that of the end, see `mean_pressures`; in
            equilibrium.
    """
    if not way:
        gained = end["dissipation"] - state["dissipation"]
        return np.asarray(state["dissipation"] + mean * gained)
    before, total = Slid.of(state), state["dissipation"].copy()
    slid, force = np.zeros_like(total), np.zeros_like(total)
    for now in (*way, Slid.of(end)):
        length, work = now.way - before.way, now.work - before.work
        at_yield = np.divide(work, length, out=force.copy(), where=length > 0.0)
        first = np.where(slid > 0.0, force, np.where(before.touching, at_yield, 0.0))
        total += np.where(now.touching, 0.5 * (first + at_yield) * (length - slid), 0.0)
        before, slid, force = replace(before, touching=now.touching), length, at_yield
    return np.asarray(total)


def mean_pressures(state: State, end: State) -> Floats:
    """Mean of the pressures of two states over that of the end, (n,); 1/2 where it has none."""
    pressure = np.where(end["pressure"] > 0.0, end["pressure"], np.inf)
    return np.asarray(0.5 * (1.0 + state["pressure"] / pressure))
