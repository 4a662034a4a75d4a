"""A body that only contact can hold, and whether it does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.base.statuses import STICK
from anisocontact.contact import Contact
from anisocontact.contact.quadrature import Couplings
from anisocontact.solver.terms.clearance import accepted_gap, clearance, least_gap
from anisocontact.solver.terms.free_modes import ConnectedBody, sides_of
from anisocontact.solver.terms.rigid_prediction import RigidPrediction

#: Share of a facet by which a body on springs that touches may move at once.
TOUCHING = 0.01
#: Share of the gap that springs let a body close at once, so that it is closed.
OVERSHOOT = 2.0
#: Share of what is clear around a body that is far from all that it may touch, by which it may move
#: at once: two such bodies may come towards each other.
CLEAR = 0.4
#: Points in contact that can hold all motions of a body.
ENOUGH = 3
#: Share of what springs carry beyond which loads have to be what they stand against.
DRIVEN = 0.5
#: Share of the loads on a body beyond which contact counts as what carries them.
CARRIED = 0.5
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
        touchable: Those that it may act on.
        sides: Of each of its contacts 1 where it is the slave, -1 where it is the master, 0 where
            it is both.
        stiffness: Of stabilisation at each of them, force/length.
        force: Sum of all loads on it, (3,), force.
        pushed: Loads along the motions of `left`, (j,).
        trusted: Whether contact and springs alone are to hold it in this attempt.
        clear: Distance up to which it meets nothing, see `clearance`, length.
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
    sides: list[float] = field(init=False)
    touchable: Ints = field(init=False)
    stiffness: float = 0.0
    force: Floats = field(default_factory=lambda: np.zeros(3))
    pushed: Floats = field(default_factory=lambda: np.zeros(0))
    trusted: bool = False
    clear: float = 0.0
    _prediction: RigidPrediction = field(init=False)

    def __post_init__(self) -> None:
        own = [self._within(contact.nodes_of_groups[:1]) for contact in self.contacts]
        slave = np.unique(np.concatenate(own))
        if not self.contacts[0].space.mesh.comm.allreduce(len(slave)):
            own = [self._within(contact.nodes_of_groups[1:]) for contact in self.contacts]
        self.touchable = np.unique(np.concatenate(own))
        (of,) = sides_of([self.body], self.contacts)
        self.sides = [float(one[0]) - float(any(one[1:])) for one in of]
        self.act_on(None)

    def start(self, u: Floats, load: Floats, where: Flags | None) -> None:
        """Begin an attempt from the accepted state.

        Args:
            u: Accepted displacement of the local nodes, (nodes, 3), length.
            load: Forces on the nodes this rank owns, (owned, 3).
            where: As of `act_on`.
        """
        space = self.contacts[0].space
        self.act_on(where)
        self.clear = 0.0  # the way of the first equilibrium counts with half of the loads
        self.force = space.mesh.comm.allreduce(load[self.body.nodes].sum(axis=0))
        self.pushed = self.along_free(load[self.body.nodes])
        x, nodes = space.tabulate_dof_coordinates()[self.nodes], self.nodes
        self._prediction = RigidPrediction(
            self.body, self.left, nodes, x, u[nodes], space.mesh.comm
        )

    def act_on(self, where: Flags | None) -> None:
        """Let stabilisation act where contacts do, on some of the nodes alone, flags of nodes.

        That is on its slave nodes, or on those of masters where it has none: a body so comes to
        rest on the same way whichever unknowns a strategy keeps.
        """
        self.nodes = self.touchable
        if where is not None:  # on one process
            self.nodes = self.nodes[where[self.nodes]]

    def look_around(self, u: Floats, where: Flags | None) -> None:
        """Find out what is clear around it; nothing counts as clear where some nodes are not known.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            where: As of `act_on`.
        """
        self.clear = 0.0
        if where is None:
            self.clear = clearance(self.body.nodes, self.contacts, self.sides, u)

    def _within(self, groups: Sequence[Locals]) -> Ints:
        """Nodes of groups that are its own and of this rank."""
        return np.intersect1d(np.concatenate([np.zeros(0, np.int32), *groups]), self.body.nodes)

    def meets(self, contact: Contact) -> bool:
        """Whether a contact is one of its own."""
        return any(contact is one for one in self.contacts)

    def apart(self) -> str:
        """How far it is from what it may touch in the accepted state, in words; collective.

        Nothing where it touches, or where no point of it or of its slaves has a master to meet.
        """
        nearest = min(accepted_gap(contact) for contact in self.contacts)
        if not 0.0 < nearest < np.inf:
            return ""
        return (
            f"; it is {nearest:.3g} from what it may touch, bring it there by a displacement first"
        )

    def may_hold(self) -> bool:
        """Whether contact is likely to hold it without stabilisation, from where it is now.

        Enough points stick, with a known stiffness, or pressures hold it with the few that stick,
        where points just touch as well; a body on springs may slide as well.
        """
        if self.sprung:
            return self._count("stick", "slip") >= ENOUGH
        return self.sticks() or self._resisted(at_start=True)

    def holds(self) -> bool:
        """Whether contact holds it in the trial, and springs where it has some.

        Points that slide in many directions do, as friction has stiffness across that of each.
        """
        counted = not self.sprung and (self.sticks() or self._resisted())
        return counted or self._stiff()

    @property
    def sprung(self) -> bool:
        """Whether springs, elastic supports or a reference point act on it."""
        return self.springs is not None

    def sticks(self) -> bool:
        """Whether enough points stick in the trial, with a known stiffness, to hold it."""
        return self._count("stick") >= ENOUGH

    def _resisted(self, at_start: bool = False) -> bool:
        """Whether closed points resist all its motions: pressures, of which none is sliding.

        Points that stick resist all ways, however few they are: a sheet that warms on a floor
        slides everywhere but at one point, which holds it along the floor.

        Args:
            at_start: As of `touched`.
        """
        resisted = np.zeros((2, len(self.left), len(self.left)))
        for contact in self.contacts:
            closed = closed_points(contact, at_start)
            resisted[0] += self._resistance(contact, closed, contact.trial.normal[:, None])
            if _sticks_all_ways(contact):
                stuck = contact.trial.status == STICK
                resisted[1] += self._resistance(contact, stuck, np.eye(3)[None])
        resisted = self.contacts[0].space.mesh.comm.allreduce(resisted)
        # a single point counts as much as all that press
        largest = np.linalg.eigvalsh(resisted)[:, -1]
        sizes = np.linalg.eigvalsh(
            (resisted[largest > 0.0] / largest[largest > 0.0, None, None]).sum(axis=0)
        )
        return bool(sizes[0] > PRESSED * sizes[-1])

    def _resistance(self, contact: Contact, points: Flags, ways: Floats) -> Floats:
        """Resistance of some points to the motions of `left` along directions of theirs, (j, j).

        Args:
            contact: One of its contacts.
            points: The points, (n,).
            ways: Directions of each point, or the same of all, (n, k, 3) or (1, k, 3).
        """
        at = np.broadcast_to(ways, (len(points), *ways.shape[1:]))[points]
        arms = (contact.points[points] - self.body.centre) / self.body.size
        turns = np.cross(arms[:, None], at)
        along = np.concatenate([at, turns], axis=2).reshape(-1, 6) @ self.left.T
        return np.asarray(along.T @ along)

    def reach(self, at_start: bool = False) -> float:
        """How far stabilisation lets it move at once, length.

        A facet; one that nothing touches no farther than it takes, or curved cells would be thrown
        into each other, and one on springs neither: beside stiff springs that hold some of its
        motions it would turn in the others. Farther where more is clear.

        Args:
            at_start: As of `touched`.
        """
        if not self.sprung and self.touched(at_start):
            return self.size
        least = min(least_gap(contact) for contact in self.contacts)
        return min(max(OVERSHOOT * least, TOUCHING * self.size), self._farthest)

    @property
    def _farthest(self) -> float:
        """How far it may move at once in the air, length."""
        return max(CLEAR * self.clear, self.size)

    def stiffness_in_reach(self, push: Floats, at_start: bool = False) -> float:
        """Stiffness of its springs at which forces carry it as far as `reach`, force/length.

        Turns count with the ways of the nodes that have springs.

        Args:
            push: Generalised forces along its free motions, (j,).
            at_start: As of `touched`.
        """
        return self._way(push) / self.reach(at_start)

    def stiffness_aloft(self, push: Floats) -> float:
        """The same for what is clear around it in the air, however near it is."""
        return self._way(push) / self._farthest

    def _way(self, push: Floats) -> float:
        return self._prediction.way(self._prediction.motion(push))

    def stiffness_to_land(
        self, push: Floats, supports: Sequence[Contact], at_start: bool = False
    ) -> float:
        """Stiffness of its springs at which it lands where forces turn it, force/length.

        Where closed points leave motions, as a corner does that a tall body stands on, forces carry
        it along these: no farther than open points come down by twice their gap.

        Args:
            push: Generalised forces along its free motions, (j,).
            supports: Contacts with what is held.
            at_start: As of `touched`.
        """
        comm = self.contacts[0].space.mesh.comm
        resisted, down, gaps = np.zeros((len(push), len(push))), [], []
        for contact, side in zip(self.contacts, self.sides, strict=True):
            normal = side * contact.trial.normal
            along = np.einsum("nai,na->ni", self._prediction.at(contact.current.points), normal)
            closed, gap = closed_points(contact, at_start), contact.trial.gap
            if any(contact is one for one in supports):
                resisted += along[closed].T @ along[closed]
            above = ~closed & contact.located() & (gap > 0.0)
            down.append(-along[above])
            gaps.append(np.maximum(gap[above], TOUCHING * self.size))
        turned = self._prediction.motion(push, comm.allreduce(resisted))
        rates = np.concatenate(down) @ turned / (OVERSHOOT * np.concatenate(gaps))
        return float(max(comm.allgather(float(rates.max(initial=0.0)))))

    def carried(self, force: Floats) -> Floats:
        """Generalised forces that its springs leave to others where they let go, (j,).

        Args:
            force: Of the springs of stabilisation, (nodes, 3).
        """
        return -self._prediction.along(force[self.nodes])

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
        closed = any(bool(closed_points(contact, at_start).any()) for contact in self.contacts)
        return any(self.contacts[0].space.mesh.comm.allgather(closed))

    def carries(self, count: int, nothing: float) -> bool:
        """Whether contact carries loads on it in the trial, or more than round-off; collective.

        Args:
            count: Number of the local nodes.
            nothing: Force up to which it is round-off.
        """
        force = np.zeros((count, 3))
        for contact in self.contacts:
            contact.add_force(force)
        squared = float((force[self.body.nodes] ** 2).sum())
        carried = np.sqrt(self.contacts[0].space.mesh.comm.allreduce(squared))
        load = float(np.linalg.norm(self.force))
        return bool((load > 0.0 and carried > CARRIED * load) or carried > nothing)

    def _count(self, *statuses: str) -> int:
        stiff = [contact for contact in self.contacts if _sticks_all_ways(contact)]
        return sum(c.counts()[status] for c in stiff for status in statuses)

    def _stiff(self) -> bool:
        """Whether contact and springs have stiffness in all motions that no support holds.

        A rank has the couplings of its own slave points alone: on several, points are counted.
        """
        if self.contacts[0].space.mesh.comm.size > 1:
            return self.sprung and self.may_hold()
        size = len(self.motions)
        projected = np.zeros((size, size)) if self.springs is None else self.springs.copy()
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


def _sticks_all_ways(contact: Contact) -> bool:
    """Whether points of a contact that stick have a known stiffness along both axes."""
    law = contact.interface.tangential
    return not law.in_python and law.holds_all_ways()


def closed_points(contact: Contact, at_start: bool = False) -> Flags:
    """Points of a contact that are closed in the trial, see `FreeBody.touched`, (n,)."""
    closed = contact.trial.status != 0
    if at_start:
        closed |= contact.trials.start["multiplier"] > 0.0
    return np.asarray(closed)
