"""A body that only contact can hold, and whether it does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.contact import Contact
from anisocontact.contact.quadrature import Couplings
from anisocontact.solver.terms.free_modes import ConnectedBody

#: Share of a facet by which a body on springs that touches may move at once.
TOUCHING = 0.01
#: Points in contact that can hold all motions of a body.
ENOUGH = 3
#: Share of what springs carry beyond which loads have to be what they stand against.
DRIVEN = 0.5
#: Resistance of pressures to the motion that they hold least, over that to the one they hold most.
PRESSED = 0.01


@dataclass
class FreeBody:
    """A body with motions that neither supports nor springs hold.

    Attributes:
        body: The body.
        modes: These motions in words.
        contacts: Contacts that can hold it.
        size: How far stabilisation lets it move at once: a facet, length.
        motions: Its motions that no support holds, (k, 6).
        left: Those of them that springs do not hold either, (j, 6).
        springs: Stiffness of springs and elastic supports in them, (k, k), force/length; None for a
            body without, of which no face follows a reference point either.
        least: Stiffness that counts as none, force/length.
        nodes: Nodes of this rank that stabilisation acts on, see `act_on`.
        count: Their number over all ranks.
        stiffness: Of stabilisation at each of them, force/length.
        load: Norm of the sum of all loads on it, force.
        pushed: Loads along the motions of `left`, (j,).
        trusted: Whether contact and springs alone are to hold it in this attempt.
    """

    body: ConnectedBody
    modes: str
    contacts: Sequence[Contact]
    size: float
    motions: Floats
    left: Floats
    springs: Floats | None
    least: float
    nodes: Ints = field(init=False)
    count: int = field(init=False)
    _touchable: Ints = field(init=False)
    stiffness: float = 0.0
    load: float = 0.0
    pushed: Floats = field(default_factory=lambda: np.zeros(0))
    trusted: bool = False

    def __post_init__(self) -> None:
        sides = [self._within(contact.nodes_of_groups[:1]) for contact in self.contacts]
        slave = np.unique(np.concatenate(sides))
        if not self.contacts[0].space.mesh.comm.allreduce(len(slave)):
            sides = [self._within(contact.nodes_of_groups[1:]) for contact in self.contacts]
        self._touchable = np.unique(np.concatenate(sides))
        self.act_on(None)

    def act_on(self, where: Flags | None) -> None:
        """Let stabilisation act where contacts do, on some of the nodes alone, flags of nodes.

        That is on its slave nodes, or on those of masters where it has none: a body so comes to
        rest on the same way whichever unknowns a strategy keeps.
        """
        self.nodes = self._touchable
        if where is not None:  # on one process
            self.nodes = self.nodes[where[self.nodes]]
        self.count = max(self.contacts[0].space.mesh.comm.allreduce(len(self.nodes)), 1)

    def _within(self, groups: Sequence[Locals]) -> Ints:
        """Nodes of groups that are its own and of this rank."""
        return np.intersect1d(np.concatenate([np.zeros(0, np.int32), *groups]), self.body.nodes)

    def may_hold(self) -> bool:
        """Whether contact is likely to hold it without stabilisation, from where it is now.

        Enough points stick, with a known stiffness, or pressures alone hold it, where points just
        touch as well; a body on springs may slide as well.
        """
        if self.sprung:
            return self._count("stick", "slip") >= ENOUGH
        return self.sticks() or self._pressed(at_start=True)

    def holds(self) -> bool:
        """Whether contact holds it in the trial, and springs where it has some."""
        return self._stiff() if self.sprung else self.sticks() or self._pressed()

    @property
    def sprung(self) -> bool:
        """Whether springs, elastic supports or a reference point act on it."""
        return self.springs is not None

    def sticks(self) -> bool:
        """Whether enough points stick in the trial, with a known stiffness, to hold it."""
        return self._count("stick") >= ENOUGH

    def _pressed(self, at_start: bool = False) -> bool:
        """Whether pressures at closed points resist all its motions, of which none is sliding.

        Args:
            at_start: As of `touched`.
        """
        matrix = np.zeros((len(self.left), len(self.left)))
        for contact in self.contacts:
            closed = _closed(contact, at_start)
            normal = contact.trial.normal[closed]
            arms = (contact.points[closed] - self.body.centre) / self.body.size
            along = np.concatenate([normal, np.cross(arms, normal)], axis=1) @ self.left.T
            matrix += along.T @ along
        sizes = np.linalg.eigvalsh(self.contacts[0].space.mesh.comm.allreduce(matrix))
        return bool(sizes[0] > PRESSED * sizes[-1])

    def reach(self, at_start: bool = False) -> float:
        """How far stabilisation lets it move at once, length.

        A facet; one that nothing touches no farther than it takes, or curved cells would be thrown
        into each other, and one on springs neither: beside stiff springs that hold some of its
        motions it would turn in the others.

        Args:
            at_start: As of `touched`.
        """
        if not self.sprung and self.touched(at_start):
            return self.size
        near = [
            np.abs(c.trial.gap[c.master.located(c.state)]).min(initial=np.inf)
            for c in self.contacts
        ]
        least = min(self.contacts[0].space.mesh.comm.allgather(float(min(near))))
        return float(min(max(2.0 * least, TOUCHING * self.size), self.size))

    def carried_by(self, force: Floats, stiffness: float) -> float:
        """How far forces on its nodes carry it along its free motions, length.

        Args:
            force: Of the springs of stabilisation, (nodes, 3).
            stiffness: Of each of these springs, force/length.
        """
        work = self.along_free(force[self.body.nodes])
        return float(np.linalg.norm(work) / (self.count * stiffness))

    def along_free(self, force: Floats) -> Floats:
        """Generalised forces along its free motions of forces on its nodes, (nodes, 3); (j,)."""
        work = np.concatenate([force.sum(axis=0), np.cross(self.body.arms, force).sum(axis=0)])
        return np.asarray(self.left @ self.contacts[0].space.mesh.comm.allreduce(work))

    def against_loads(self, force: Floats) -> bool:
        """Whether springs that carry it stand against the loads on it, and not contact alone.

        Args:
            force: Of the springs of stabilisation, (nodes, 3).
        """
        carried = self.along_free(force[self.body.nodes])
        return bool(-carried @ self.pushed > DRIVEN * (carried @ carried))

    def touched(self, at_start: bool = False) -> bool:
        """Whether one of its contacts is closed in the trial.

        Args:
            at_start: Whether an attempt starts here: points count as well that multipliers are to
                hold in its first correction, since the rounding of their gap has no say.
        """
        closed = any(bool(_closed(contact, at_start).any()) for contact in self.contacts)
        return any(self.contacts[0].space.mesh.comm.allgather(closed))

    def _count(self, *statuses: str) -> int:
        laws = ((c, c.interface.tangential) for c in self.contacts)
        stiff = [c for c, law in laws if not law.in_python and law.holds_all_ways()]
        return sum(c.counts()[status] for c in stiff for status in statuses)

    def _stiff(self) -> bool:
        """Whether contact and springs have stiffness in all motions that no support holds.

        A rank has the couplings of its own slave points alone: on several, points are counted.
        """
        assert self.springs is not None
        if self.contacts[0].space.mesh.comm.size > 1:
            return self.may_hold()
        projected = self.springs.copy()
        for contact in self.contacts:
            for blocks in contact.answer.couplings():
                projected += self.motions @ self._projected(blocks) @ self.motions.T
        sizes = np.linalg.svd(projected, compute_uv=False)
        return bool(sizes.min(initial=np.inf) > self.least)

    def _projected(self, couplings: Couplings) -> Floats:
        """Couplings of nodes in the six rigid motions of the body, other bodies at rest, (6, 6)."""
        rows, columns, blocks = couplings
        count = 1 + max(
            int(self.body.local.max()), int(rows.max(initial=0)), int(columns.max(initial=0))
        )
        fields = np.zeros((6, count + 1, 3))  # the last one stands for no node
        fields[:, self.body.local] = self.body.fields
        here, there = (
            fields[:, nodes].reshape(6, len(nodes), 3 * nodes.shape[1]) for nodes in (rows, columns)
        )
        if blocks.ndim == 5:
            blocks = blocks.transpose(0, 1, 3, 2, 4).reshape(
                len(rows), here.shape[2], there.shape[2]
            )
        return np.asarray(np.einsum("ipr,prc,jpc->ij", here, blocks, there, optimize=True))


def _closed(contact: Contact, at_start: bool) -> Flags:
    """Points of a contact that are closed in the trial, see `FreeBody.touched`, (n,)."""
    closed = contact.trial.status != 0
    if at_start:
        closed |= contact.trials.start["multiplier"] > 0.0
    return np.asarray(closed)
