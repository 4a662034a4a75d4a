"""What the laws of a contact store and dissipate."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact.history import Slid, Snapshot, dissipated, mean_pressures
from anisocontact.contact.trials import Trials
from anisocontact.interface import State

#: Fields of a point's state that are energies per area, by their name in the balance: what is
#: stored, and what is dissipated, which grows by increments on the area of each.
STORED = {"adhesion": "energy_adhesion", "normal": "energy_normal"}
DISSIPATED = {"friction": "dissipation", "viscous": "dissipation_viscous"}


class ContactEnergies:
    """Energies of the slave points, which grow with accepted increments.

    Args:
        trials: What trials start from; the elastic slip of multipliers does no work.
        points: Number of slave points of this rank.
        comm: Communicator of the contact.

    Attributes:
        dissipated: Since the start at each point, by friction and by viscosity, (n, 2), energy.
    """

    def __init__(self, trials: Trials, points: int, comm: Any) -> None:
        self._trials, self._comm = trials, comm
        self.dissipated: Floats = np.zeros((points, len(DISSIPATED)))
        self._way: list[Slid] = []

    def begin(self) -> None:
        """Forget the states that bodies have come through."""
        self._way = []

    def pass_through(self, state: State) -> None:
        """Remember a state that bodies which springs let go have come through."""
        self._way.append(Slid.of(state))

    def commit(self, before: Snapshot, state: State, end: Snapshot) -> None:
        """Write to the points of the next accepted increment what friction has dissipated.

        Args:
            before: The points in the accepted increment.
            state: Their state there.
            end: The points in the next one, whose state is changed.
        """
        now, mean = end.response.state, self._mean_force(before, state, end)
        now["dissipation"] = dissipated(state, self._way, now, mean)
        for i, name in enumerate(DISSIPATED.values()):
            self.dissipated[:, i] += end.areas * (now[name] - state[name])

    def taken_up(self, before: Snapshot, state: State, trial: Snapshot) -> float:
        """What is stored and dissipated from the accepted increment to a trial, of this rank.

        Args:
            before: The points in the accepted increment.
            state: Their state there.
            trial: The points in the trial.

        Returns:
            Energy; friction has the mean of the pressures of both ends at each point.
        """
        now, areas = trial.response.state, trial.areas
        mean = mean_pressures(state, now)
        gained = dissipated(state, self._way, now, mean) - state["dissipation"]
        gained += now["dissipation_viscous"] - state["dissipation_viscous"]
        stored = [name for name in STORED if self._trials.does_work or name != "adhesion"]
        held = [areas @ now[STORED[n]] - before.areas @ state[STORED[n]] for n in stored]
        return float(areas @ gained + sum(held))

    def totals(self, state: State, areas: Floats) -> dict[str, float]:
        """Stored and dissipated energy of the accepted increment, over all ranks.

        Args:
            state: State of the points.
            areas: Area of each, (n,), length^2.

        Returns:
            "adhesion" (elastic, tangential), "normal" (of the normal law), "friction" and
            "viscous" (dissipated since the start), force times length.
        """
        stored = [areas @ state[name] for name in STORED.values()]
        local = np.array([*stored, *self.dissipated.sum(axis=0)])
        values = self._comm.allreduce(local).tolist()
        return dict(zip((*STORED, *DISSIPATED), values, strict=True))

    def _mean_force(self, before: Snapshot, state: State, end: Snapshot) -> float:
        """Mean of the forces that press in two states over that of the end, over all ranks.

        That of the contact, not of each point: as it moves on, points that it leaves have no slip
        in the end to be counted with half of their pressure, as those are that it comes to.
        """
        # before the first increment the state has none, whatever rounding makes of a gap of zero
        there = (before.areas, state), (end.areas, end.response.state)
        pressed = [np.sum(areas * at["pressure"]) for areas, at in there]
        first, last = self._comm.allreduce(np.array(pressed)).tolist()
        return 0.5 * (1.0 + first / last) if last > 0.0 else 1.0
