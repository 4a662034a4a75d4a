"""The balance of energy along a run.

In equilibrium with exact integrals along the path the residual of the balance is zero. What is
left is the error of taking forces at the ends of increments for those on the way, and it says more
of a coarse path than any force does.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.bulk import small_strain
from anisocontact.contact import initial_overlap
from anisocontact.interface import STATUS
from anisocontact.solver.strategies.newton import TOLERANCE
from anisocontact.solver.system.contact_work import BELIEVED
from anisocontact.solver.system.imbalance import Imbalance
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.system.reported import Energies

#: Share of points that begin or end contact or sliding in an increment beyond which they make the
#: residual.
MANY = 0.05


class Cause(StrEnum):
    """What makes a residual."""

    RAN_OFF = "slave points slid off the end of a master"
    JUMPED = "bodies jumped to another equilibrium"
    FLOWED = (
        "materials yielded or crept within increments, which counts with the stress at their ends: "
        "more of them are needed where they do"
    )
    SNAPPED = (
        "more was set free than forces between those at both ends of an increment can work: a body "
        "snapped to another equilibrium as contact began or ended, or more increments are needed "
        "where it does"
    )
    TOUCHED = "contact began or ended within increments, more of them are needed where it does"
    SLID = "sliding began or ended within increments, more of them are needed where it does"
    COARSE = (
        "too few increments, forces at their ends stand for those on the way; or a body snaps "
        "through"
    )
    #: Whatever else happened.
    HEAT_FELL = "a law or material of your own gives a negative dissipation"
    #: Of the first increment.
    OVERLAPPED = "bodies overlapped at the start, what pushes them apart is no work from outside"


#: What laws and materials turn into heat, what materials do last.
DISSIPATED = ("friction", "viscous", "inelastic")
#: Share of the residual of an increment from which on dissipation that falls is what made it. One
#: with the wrong sign leaves twice itself open.
FELL = 0.25
#: Share of the work from which on a contact or material that dissipates less than nothing is told.
GAVE = 1e-6
_ROUND_OFF = 4.0 * float(np.finfo(np.float64).eps)


class EnergyWatch:
    """Follows the balance of energy along a run.

    Args:
        problem: The problem, in any accepted state.

    Attributes:
        pushed_apart: Whether bodies overlapped at the start of the run and the last increment was
            its first: how they moved says nothing of what loads do.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._work = self._external = self._residual = self._regularisation = 0.0
        self._heat = np.zeros(len(DISSIPATED))
        self._counts: Ints = np.zeros((len(problem.contacts), len(STATUS)), dtype=np.int64)
        self._parts = np.zeros(len(Cause))
        self._begun = self._overlap = self.pushed_apart = False
        self._by_contact: dict[str, float] = {}
        self._by_body: dict[str, float] = {}

    def begin(self) -> None:
        """Start from the accepted state, unless a run goes on."""
        self._given()
        if self._begun:
            return
        self._begun = True
        energies = self._problem.energies()
        self._take(energies)
        self._work = abs(self._external)
        self._counts = self._counted()
        self._overlap = any([initial_overlap(c, c.facet_size) for c in self._problem.contacts])

    def accepted(self) -> Energies:
        """Energies of an accepted increment, with what a jump in it has set free.

        Where a jump was regularised that is what the increment has left open, unless forces of
        supports and loads between those of both of its ends can explain it.
        """
        energies, ends = self._problem.energies(), self._problem.regularised
        lost = energies["residual"] - self._residual
        if ends is None or not lost > BELIEVED * ends.missed:
            return energies
        self._problem.stabilisation.released += lost
        energies["regularisation"] += lost
        energies["residual"] = self._residual
        return energies

    def after(self, energies: Mapping[str, float], ran_off: bool) -> Imbalance:
        """The balance after an accepted increment.

        Args:
            energies: See `Problem.energies`.
            ran_off: Whether slave points left the end of a master in it.
        """
        before = self._residual, self._external, self._regularisation, self._heat
        self._take(energies)
        self._work += abs(self._external - before[1])
        left, heat = self._residual - before[0], self._heat - before[3]
        jumped = self._regularisation != before[2]
        cause = self._cause(left, heat, ran_off=ran_off, jumped=jumped)
        self._parts[list(Cause).index(cause)] += left
        self.pushed_apart, self._overlap = self._overlap, False
        share = self._share(energies)
        worst = list(Cause)[int(np.abs(self._parts).argmax())]
        driven, driven_by = self._given()
        cause_told = worst.value if share > 0.0 else ""
        return Imbalance(share, cause_told, driven=driven, driven_by=driven_by)

    def persistent(self) -> Floats:
        """What the next increments depend on."""
        energies = [self._external, self._residual, self._regularisation]
        now = [float(self._begun), self._work, *energies]
        return np.concatenate([now, self._heat, self._parts, self._counts.reshape(-1)])

    def restore(self, kept: Floats) -> None:
        """Go on from what `persistent` gave."""
        begun, self._work, self._external, self._residual, self._regularisation = map(
            float, kept[:5]
        )
        self._begun = bool(begun)
        ends = np.cumsum([len(DISSIPATED), len(Cause)])
        self._heat, self._parts, counted = np.split(kept[5:], ends)
        self._counts = counted.astype(np.int64).reshape(self._counts.shape)

    def _take(self, energies: Mapping[str, float]) -> None:
        self._external, self._residual = energies["external"], energies["residual"]
        self._regularisation = energies["regularisation"]
        self._heat = np.array([energies.get(name, 0.0) for name in DISSIPATED])

    def _cause(self, left: float, heat: Floats, *, ran_off: bool, jumped: bool) -> Cause:
        """What made the residual of an increment.

        Forces at its ends leave at most as much open as plastic flow dissipates, where a load is
        reversed, and half of it where it grows: more than that has another cause, and so may less
        where friction dissipates more.

        Args:
            left: The residual of the increment.
            heat: What was dissipated in it, as `DISSIPATED`.
            ran_off: Whether slave points left the end of a master in it.
            jumped: Whether bodies jumped in it.
        """
        touched, slid = self._changed()
        if -float(heat.sum()) > FELL * abs(left):
            return Cause.HEAT_FELL
        flowed = heat[-1] >= max(abs(left), heat[0]) and heat[-1] > 0.0
        signs = {
            Cause.OVERLAPPED: self._overlap,
            Cause.RAN_OFF: ran_off,
            Cause.JUMPED: jumped,
            Cause.FLOWED: flowed,
            Cause.SNAPPED: touched and left > BELIEVED * self._problem.missed,
            Cause.TOUCHED: touched,
            Cause.SLID: slid,
        }
        return next((cause for cause, applies in signs.items() if applies), Cause.COARSE)

    def _share(self, energies: Mapping[str, float]) -> float:
        residual = abs(self._residual)
        if not (self._problem.bulk.stores and np.isfinite(residual)):
            return 0.0
        told = ("external", "residual")
        held = sum(abs(value) for name, value in energies.items() if name not in told)
        return 0.0 if residual <= self._rounded() else residual / max(self._work, held)

    def _rounded(self) -> float:
        """What floating point and the tolerance of forces leave of energies, over all ranks.

        Positions are known to a share of the size of the mesh. Forces are off by what is left of
        nodes moved alone by that, `K_ii x_i`, and of `Term.lever`; these do work on displacements,
        or where nothing has moved on what positions are off by themselves. At finite strain
        energies of F = I + grad(u) are rounded too, so that what has hardly moved counts by the
        size of its cells; those of small strains are not.

        Forces of contact do work as well on the displacements that Newton's method leaves open, a
        share of `TOLERANCE` of those that they give to nodes moved alone, `f_i / K_ii`. Beside what
        they deform bodies by that is nothing; where loads on the same nodes bear them it is all.
        """
        bulk, assembly = self._problem.bulk, self._problem.assembly
        diagonal, extent = bulk.diagonal.array_r, assembly.layout.unknowns.extent
        moved = np.abs(self._problem.accepted().array_r[: len(diagonal)])
        if not all(map(small_strain, self._problem.materials.values())):
            moved += bulk.rest_length
        moved += _ROUND_OFF * extent
        forces = float(diagonal @ ((extent + moved) * moved))
        held = assembly.terms.lever() * float(np.linalg.norm(moved))
        contact = self._problem.contact_forces[: len(diagonal)]
        stiff = np.where(diagonal > 0.0, diagonal, np.inf)
        open_work = TOLERANCE * float(contact @ (contact / stiff))
        return float(self._problem.comm.allreduce(_ROUND_OFF * (forces + held) + open_work))

    def _changed(self) -> tuple[bool, bool]:
        """Whether many points have begun or ended contact, or sliding, and more than the other.

        Where nothing touched before, or does so now, any number of points is all of the contact.
        """
        before, self._counts = self._counts, self._counted()
        change = np.abs(self._counts - before)
        touched = int(change[:, 0].sum())
        slid = (int(change[:, 1:].sum()) - touched) // 2
        many = MANY * int(before.sum())
        if not (before[:, 1:].any() and self._counts[:, 1:].any()):
            many = 0.0
        return touched > many and touched >= slid, slid > many

    def _given(self) -> tuple[dict[str, float], dict[str, float]]:
        """What contacts and bodies gave since the last call where they should have dissipated.

        Returns:
            Energies over the work done so far, by name; of those that gave some.
        """
        before = self._by_contact, self._by_body
        energies = {contact.name: contact.energies() for contact in self._problem.contacts}
        self._by_contact = {name: e["friction"] + e["viscous"] for name, e in energies.items()}
        self._by_body = self._problem.bulk.dissipated_by_body()
        return self._fallen(before[0], self._by_contact), self._fallen(before[1], self._by_body)

    def _fallen(self, before: Mapping[str, float], now: Mapping[str, float]) -> dict[str, float]:
        """By how much dissipation has fallen, over the work; that of those where it has."""
        given = {name: before.get(name, 0.0) - energy for name, energy in now.items()}
        if not any(energy > GAVE * self._work for energy in given.values()):
            return {}
        least = max(GAVE * self._work, self._rounded())
        return {
            name: energy / max(energy, self._work)
            for name, energy in given.items()
            if energy > least
        }

    def _counted(self) -> Ints:
        counts = [[c.counts()[name] for name in STATUS] for c in self._problem.contacts]
        return np.array(counts, dtype=np.int64).reshape(-1, len(STATUS))
