"""Work of contact within an increment, where the mean of both ends does not tell it.

The trapezoidal rule takes forces for linear along the way. A contact that closes, or a point that
begins to slip, has a kink in it: the mean of both ends then counts a force on a way on which there
was none. Here contact is asked on the straight way between the ends, from the accepted state on,
and the rule is refined until it no longer changes; no state does.

Where supports and prescribed motions alone drive the bodies the difference is work of these.
Loads and springs work what they work, whatever contact does on the way.

Multipliers and meshed masters do not answer on the way as if nothing had been after it. There, and
under loads that stay as they are, work goes into contact that its laws take up: they store it, or
dissipate it with the mean of the pressures of both ends. They are believed as far as forces of
supports and loads between those of both ends can have done that work: what is beyond it would be
the energy of a jump.

Bodies that overlap without pressing have been pushed together by nobody. As they are pushed apart
the overlap works like an interference that grows from nothing, with the mean of the pressures.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.fenicsx import MPI
from anisocontact.base.statuses import OPEN
from anisocontact.contact import Contact
from anisocontact.solver.system.ends_work import EndsWork
from anisocontact.solver.system.imbalance import LARGE
from anisocontact.solver.system.parts import ProblemParts

#: Share of the touching points that have to begin or end contact or slip.
CHANGED = 0.05
#: Cosine of the angle of friction before and after from which on it has been reversed; share of the
#: pressures below which it is none, but what equilibrium leaves.
BACK, NONE = -0.5, 1e-6
#: What the laws have to add to the mean of both ends, over the work so far: what would warn.
COARSE = LARGE
#: Share of the work so far by which a point may change the rule, and points at which it ends.
FINE, MOST = 1e-3, 32
#: Share of the pressure that points may lose which open: half of what friction does there is missed
#: by the laws, which have no pressure at the end.
LOST = 2.0 * LARGE
#: Times what the mean of both ends can miss of forces between them, up to which laws are believed:
#: half of it is the tangential force, with pressures that change meanwhile as much again.
BELIEVED = 2.0
_AT_ONCE = 1e-9
#: Overlap over the size of what a point stands for that is none, but rounding of positions.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class _WayPoint:
    """A state on the way: nodes (nodes, 3) and rigid bodies (bodies, 6), length and radian."""

    nodal: Floats
    rigid: Floats

    def towards(self, other: _WayPoint, share: float) -> _WayPoint:
        """The state at a share of the straight way to another one."""
        return _WayPoint(
            (1.0 - share) * self.nodal + share * other.nodal,
            (1.0 - share) * self.rigid + share * other.rigid,
        )


class ContactWork:
    """What contact works along the way from the accepted state to the next.

    Args:
        parts: Parts of the problem; nothing is added where a contact cannot be asked again.
    """

    def __init__(self, parts: ProblemParts) -> None:
        self._parts, self._contacts, self._rigid = parts, parts.contacts, parts.rigid
        self._comm: Any = parts.layout.comm

    def begin(self, nodal: Floats, force: Floats) -> None:
        """Start from the accepted state.

        Args:
            nodal: Displacement of the local nodes there, (nodes, 3), length.
            force: What `forces` were there.
        """
        accepted = [body.accepted.values for body in self._rigid.bodies]
        self._start = _WayPoint(nodal.copy(), np.reshape(accepted, (-1, 6)))
        self._force = force

    def forces(self, nodal: Floats) -> Floats:
        """Forces of the contacts in the trial on the unknowns this rank owns; collective.

        Args:
            nodal: Displacement of the local nodes there, (nodes, 3), length.
        """
        local = np.zeros_like(nodal)
        for contact in self._contacts:
            contact.add_force(local)
        return self._parts.layout.assembled(local)

    def of_overlaps(self) -> float:
        """Work of overlaps that nothing has pressed together before, as the trial parts them.

        As if they had grown from nothing on the way: linear bodies are exact, force times length.
        """
        return 0.5 * float(self._comm.allreduce(sum(map(_parting, self._contacts))))

    def beyond_the_means(self, nodal: Floats, dt: float, work: float, ends: EndsWork) -> float:
        """Work that the means of the ends have missed on the way to a state in equilibrium.

        Args:
            nodal: Displacement of the local nodes there, (nodes, 3), length.
            dt: Time increment.
            work: Work from outside so far, force times length.
            ends: That of the way, by its ends.

        Returns:
            The part of supports and prescribed motions, force times length.
        """
        if not self._kinks():
            return 0.0
        prescribed = self._prescribed_alone(nodal)
        if not (prescribed and all(contact.retraceable for contact in self._contacts)):
            return self._by_the_laws(nodal, work, prescribed, ends)
        end = self._here(nodal)
        along, mean = self._piece(self._start, end, dt, work)
        self._evaluate(end, dt)
        missed = float((along - mean).sum())
        return missed if np.isfinite(missed) else 0.0

    def missed(self, ends: EndsWork) -> float:
        """Work that the means of the ends have missed at most, force times length.

        Args:
            ends: Work of supports and loads, by its ends; that on rigid bodies is added.

        Returns:
            Infinite with springs whose anchors move.
        """
        most = self._comm.allreduce(self._of_rigid().missed)
        return np.inf if self._parts.attached else float(ends.missed + most)

    def _prescribed_alone(self, nodal: Floats) -> bool:
        """Whether supports and prescribed motions alone drive the bodies."""
        parts = self._parts
        held = not (parts.stabilisation.watches or parts.rigid.free or parts.attached)
        loaded = held and bool(parts.loads.force(nodal).any())
        return held and not self._comm.allreduce(loaded, MPI.LOR)

    def _by_the_laws(self, nodal: Floats, work: float, prescribed: bool, ends: EndsWork) -> float:
        """As `beyond_the_means`, by what the laws store and dissipate on a way in equilibrium.

        The mean of both ends stays where something else than motion drives the bodies, where they
        may have leapt, where the difference would be no warning, and where it is more than forces
        of supports and loads between those of both ends can explain: laws that count wrongly, and
        jumps, are then told.
        """
        if not (prescribed or self._led()) or self._leapt(prescribed):
            return 0.0
        way = (nodal - self._start.nodal).reshape(-1)[: len(self._force)]
        rigid = self._of_rigid()
        local = float(sum(contact.taken_up() for contact in self._contacts)) - rigid.mean
        local -= EndsWork.between(-self._force, -self.forces(nodal), way).mean
        sums = np.array([local, rigid.missed])
        missed, most = self._comm.allreduce(sums).tolist()
        missed -= self.of_overlaps()
        counts = COARSE * abs(work) < abs(missed) < BELIEVED * (ends.missed + most)
        return missed if counts and np.isfinite(missed) else 0.0

    def _led(self) -> bool:
        """Whether prescribed motions or temperatures drive the bodies, under loads that stay."""
        parts = self._parts
        held = not (parts.attached or any(parts.stabilisation.stiffnesses))
        local = np.array([not parts.supports.rest, not parts.loads.rest], dtype=np.int64)
        moving, changing = self._comm.allreduce(local).tolist()
        moves = moving > 0 or not parts.rigid.rest or parts.assembly.bodies.heats
        return bool(held and moves and changing == 0 and parts.rigid.loads_rest)

    def _leapt(self, prescribed: bool) -> bool:
        """Whether loads landed bodies, or pressure was lost where motion has lifted nothing."""
        local = np.array([_pressures(contact) for contact in self._contacts])
        before, lost, after = np.reshape(self._comm.allreduce(local), (-1, 3)).T
        landed = not prescribed and bool(np.any((before == 0.0) & (after > 0.0)))
        return landed or bool(lost.sum() > LOST * before.sum())

    def _of_rigid(self) -> EndsWork:
        """Work on rigid bodies, of this rank."""
        found = EndsWork(0.0, 0.0)
        for body in self._rigid.bodies:
            way = body.trial.values - body.accepted.values
            before = body.reference + body.accepted.translation
            for one in self._rigid.contacts[body]:
                start, end = one.accepted.wrench(before), one.current.wrench(body.position)
                found += EndsWork.between(start, end, way)
        return found

    def _piece(
        self, start: _WayPoint, end: _WayPoint, dt: float, work: float
    ) -> tuple[Floats, Floats]:
        """Work on nodes and on rigid bodies along a piece, as fine as needed, and by the mean."""
        powers = {share: self._power(start, end, share, dt) for share in (0.0, 0.5, 1.0)}
        means = 0.5 * (powers[0.0] + powers[1.0])
        rest = abs(work - means.sum())
        while len(powers) < MOST:
            _, found = _rule(powers, rest)
            if not found:
                break
            powers |= {share: self._power(start, end, share, dt) for share in found}
        return _rule(powers, rest)[0], means

    def _power(self, start: _WayPoint, end: _WayPoint, share: float, dt: float) -> Floats:
        """Force from outside at a share of a piece times its way, on nodes and on rigid bodies."""
        self._evaluate(start.towards(end, share), max(share, _AT_ONCE) * dt)
        forces = np.zeros_like(start.nodal)
        local = np.zeros(2)
        for contact in self._contacts:
            contact.add_force(forces)
        local[0] = -float((forces * (end.nodal - start.nodal)).sum())
        for body, way in zip(self._rigid.bodies, end.rigid - start.rigid, strict=True):
            for one in self._rigid.contacts[body]:
                local[1] += float(one.current.wrench(body.position) @ way)
        return np.asarray(self._comm.allreduce(local))

    def _evaluate(self, place: _WayPoint, dt: float) -> None:
        """Let the contacts answer from the accepted state."""
        for body, values in zip(self._rigid.bodies, place.rigid, strict=True):
            body.place(values)
        for contact in self._contacts:
            contact.update(place.nodal, dt)

    def _here(self, nodal: Floats) -> _WayPoint:
        values = [body.trial.values for body in self._rigid.bodies]
        return _WayPoint(nodal.copy(), np.reshape(values, (-1, 6)))

    def _kinks(self) -> bool:
        """Whether enough points begin, end or reverse contact or slip."""
        changed = touching = 0
        for contact in self._contacts:
            before, now = contact.state["status"], contact.trial.state["status"]
            changed += int(np.count_nonzero((before != now) | _reversed(contact)))
            touching += int(np.count_nonzero(now != OPEN))
        changed, touching = self._comm.allreduce(np.array([changed, touching]))
        return bool(changed > CHANGED * touching)


def _reversed(contact: Contact) -> Flags:
    """Points whose friction has turned round within an increment, (n,)."""
    sides, sizes, pressures = [], [], []
    for response in (contact.last, contact.trial):
        along = np.einsum("nd,nd->n", response.traction, response.normal)
        sides.append(response.traction - along[:, None] * response.normal)
        sizes.append(np.linalg.norm(sides[-1], axis=1))
        pressures.append(np.abs(along))
    there = np.minimum(*sizes) > NONE * np.maximum(*pressures)
    turned = np.einsum("nd,nd->n", *sides) < BACK * sizes[0] * sizes[1]
    return np.asarray(there & turned)


def _pressures(contact: Contact) -> tuple[float, float, float]:
    """Forces of pressure before and after an increment that motion drives, on this rank.

    Returns:
        Their sum before, that of points which have lost it and did not just open in front of their
        master, their sum after, force.
    """
    before, now = contact.state, contact.trial.state
    force = contact.areas * before["pressure"]
    lost = (now["pressure"] <= 0.0) & ~contact.master.located(now)
    return float(force.sum()), float(force[lost].sum()), float(contact.areas @ now["pressure"])


def _parting(contact: Contact) -> float:
    """Pressure of the trial on overlaps that had none before, on this rank, force times length."""
    before, now = contact.state, contact.trial.state
    below = (before["pressure"] <= 0.0) & contact.master.located(before)
    below &= before["gap"] < -_ROUNDING * np.sqrt(contact.areas)
    return float((contact.areas * now["pressure"])[below] @ -before["gap"][below])


def _rule(powers: dict[float, Floats], rest: float) -> tuple[Floats, list[float]]:
    """Trapezoidal rule for powers at shares of a piece, and where it has to be finer.

    Args:
        powers: Powers on nodes and on rigid bodies by share, (2,) each.
        rest: Work beside these.

    Returns:
        The work, and middles of the parts beside points that change it by more than they may.
    """
    shares = np.array(sorted(powers))
    values = np.array([powers[share] for share in shares])
    work = np.asarray(np.trapezoid(values, shares, axis=0))
    total, parts = values.sum(axis=1), np.diff(shares)
    line = (total[:-2] * parts[1:] + total[2:] * parts[:-1]) / (parts[1:] + parts[:-1])
    changes = 0.5 * np.abs(total[1:-1] - line) * (shares[2:] - shares[:-2])
    coarse = np.flatnonzero(changes > FINE * (rest + abs(work.sum())))
    beside = np.unique(np.concatenate([coarse, coarse + 1]))
    return work, (0.5 * (shares[beside] + shares[beside + 1])).tolist()
