"""Bodies that only contact can hold: kept in reach until it does.

Springs of equal stiffness c at the nodes of such a body that can touch pull it to where it was.
Every equilibrium becomes the anchor of the next one, and c fades as soon as the body is touched,
until the springs carry next to nothing: the iteration of the proximal point [Rockafellar 1976]. So
what is accepted is the equilibrium without springs.

A body that sticks where an increment begins needs none as long as contact holds all its motions:
the first attempt goes without, and those with springs follow where it fails.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import override

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import PETSc
from anisocontact.contact import Contact, NotHeldError
from anisocontact.contact.quadrature import Couplings
from anisocontact.mesh import Model
from anisocontact.solver.terms.attachments import Attachments
from anisocontact.solver.terms.body_motion import BodyMotion
from anisocontact.solver.terms.flown_off import flown_off
from anisocontact.solver.terms.free_body import FreeBody
from anisocontact.solver.terms.free_modes import Supported, SupportedFrame
from anisocontact.solver.terms.held_contacts import held_contacts
from anisocontact.solver.terms.lost_work import LostWork
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.term import Term
from anisocontact.solver.terms.trust import Trust
from anisocontact.solver.terms.unsupported_bodies import UnsupportedBodies
from anisocontact.solver.terms.viscous_regularisation import ViscousRegularisation

#: Force of the springs over the forces at work that an accepted state may have.
SHARE = 1e-7
#: What the stiffness is multiplied with from one equilibrium to the next, once touched.
FADE = 0.1
#: What it is multiplied with at most where a body that has come down on some of its points would
#: turn about them too far, and equilibria in an increment after which it fades only.
RAISE, PATIENCE = 10.0, 20
#: Stiffness without loads, and the least one, shares of the mean diagonal of the bulk.
WITHOUT_LOADS, LEAST = 1e-6, 1e-11
#: Force of contact over the stiffness and the size of a facet that is none.
NOTHING = 1e-9
#: Equilibria after which a body counts as one that flies off.
MOST = 60


class Stabilisation(Term):
    """Springs on all bodies that a step leaves without support.

    Args:
        model: Mesh of the bodies.
        contacts: The contacts.
        scale: Mean diagonal of the stiffness of the bulk, force/length.
        attached: Springs and elastic supports; none if left out.
        sprung: Bodies that they act on.
        enabled: Whether bodies may be stabilised; if not they have to touch.
        coupled: Facet groups that move together, a few each.

    Attributes:
        energy: What the springs have taken up and dissipated since the start, force times length.
        released: What jumps have set free since the start that bodies came through by
            `regularisation`, force times length.
        trust: Whether bodies that stick go without springs.
        landed: Whether a body was in the air before the accepted state: how it has moved says
            nothing of the next sub-increment.
        regularisation: What carries the bodies on where their equilibrium is lost.
        notes: What is stabilised since the last `begin`, a line for each body.
    """

    def __init__(
        self,
        model: Model,
        contacts: Sequence[Contact],
        scale: float,
        attached: Attachments | None = None,
        sprung: Iterable[str] = (),
        enabled: bool = True,
        coupled: Sequence[Sequence[str]] = (),
    ) -> None:
        self.enabled = enabled
        self.energy = self.released = 0.0
        self.landed = False
        self.trust = Trust()
        self.notes: list[str] = []
        self.regularisation = ViscousRegularisation(model, scale)
        self._scale = scale
        self._comm, self._contacts = model.mesh.comm, contacts
        self._motion = BodyMotion(contacts, attached, self._comm)
        self._unsupported = UnsupportedBodies(model, contacts, scale, attached, sprung, coupled)
        self._free: list[FreeBody] = []
        self._loose: list[FreeBody] = []
        self._work = LostWork(self._comm)
        self._where: Flags | None = None
        self._anchor: Floats = self._motion.begun
        self._count = 0

    def __bool__(self) -> bool:
        return bool(self._free) or self.regularisation.active

    @property
    def stiffnesses(self) -> tuple[float, ...]:
        """Stiffness at each node of every body that is kept in reach, then of the viscosity."""
        return *(free.stiffness for free in self._free), self.regularisation.stiffness

    @property
    def watches(self) -> bool:
        """Whether there is a body that only contact can hold, with springs or without."""
        return bool(self._loose)

    @property
    def travels(self) -> bool:
        """Whether work is counted on the way on which springs let bodies go.

        It is where loads carry them: what these work there is lost. Bodies that touch, and on which
        springs stand against nothing but contact, slide with what moves them: where to, springs
        only help to find, and so does viscous regularisation.
        """
        return self._work.driven and not self.regularisation.active

    @property
    def loose(self) -> list[FreeBody]:
        """Bodies that only contact can hold, with springs or without."""
        return self._loose

    @property
    def aloft(self) -> bool:
        """Whether a body with springs touches nothing where the sub-increment begins; collective.

        On bodies that touch, springs that stand against loads on reference points are stiffer than
        it takes, and cost corrections.
        """
        return any([not free.touched(at_start=True) for free in self._free])

    @property
    def trusts(self) -> bool:
        """Whether contact alone is to hold a body in this attempt."""
        return any(free.trusted for free in self._free)

    def clear(self) -> None:
        """Nothing is free."""
        self._free, self._loose, self.notes = [], [], []
        self.trust.renew()

    def distrust(self) -> None:
        """Bodies get springs in the next attempts, since one has failed."""
        self.trust.lose(self.trusts)

    @property
    def contact_alone(self) -> bool:
        """Whether contact alone has to hold a body that has no springs."""
        return any(not free.sprung for free in self._loose)

    def find_free(
        self,
        supported: Sequence[Supported],
        step: str,
        load: Floats | None = None,
        now: bool = True,
        frames: Sequence[SupportedFrame] = (),
    ) -> None:
        """Find out what a step leaves free.

        Args:
            supported: Nodes and directions that are held.
            step: Name of the step.
            load: Forces at its end, contributions of this rank to the local nodes, (nodes, 3);
                springs are weighed against them.
            now: Whether the step begins now: what touches is known.
            frames: What is held of faces that follow rigid bodies.

        Raises:
            InputError: A body is free and nothing can hold it.
        """
        self.clear()
        self._motion.held, self._motion.frames = list(supported), list(frames)
        for free in self._unsupported.found(supported, step, load, frames):
            self._add(free, step, now)
        for contact in self._contacts:
            contact.trials.hold_alone(any(free.meets(contact) for free in self._loose))

    def take_notes(self) -> list[str]:
        """`notes`, each of them once."""
        notes, self.notes = self.notes, []
        return notes

    def start(self, u: Floats, load: Floats) -> None:
        """Begin an attempt from the accepted state.

        Args:
            u: Accepted displacement of the local nodes, (nodes, 3), length.
            load: Forces on the nodes this rank owns, (owned, 3).
        """
        self._motion.begun = self._anchor = u.copy()
        self._count = 0
        self._work.start(self._free, u)
        for free in self._loose:
            free.start(u, load, self._where)
        on_held = held_contacts(self._free, at_start=True)
        for free, held in zip(self._free, on_held, strict=True):
            needed = free.stiffness_in_reach(free.pushed, at_start=True)
            if free.touched(at_start=True):
                needed = max(needed, free.stiffness_to_land(free.pushed, held, at_start=True))
            likely = self.trust.held or free.may_hold()
            free.trusted = not self.trust.careful and likely
            free.stiffness = 0.0 if free.trusted else max(needed, WITHOUT_LOADS * self._scale)

    def confine(self, where: Flags | None) -> None:
        """Act on some of the nodes alone from the next `start` on.

        Args:
            where: Those that keep their unknowns, (nodes,); all if None.
        """
        self._where = where

    @override
    def add_force(self, u: Floats, out: Floats) -> None:
        self.regularisation.add_force(u, out)
        for free in self._free:
            nodes = free.nodes
            out[nodes] -= free.stiffness * (u[nodes] - self._anchor[nodes])

    @override
    def blocks(self) -> list[Couplings]:
        found = self.regularisation.blocks()
        for free in self._free:
            nodes = free.nodes.astype(PETSc.IntType)[:, None]
            found.append((nodes, nodes, np.tile(free.stiffness * np.eye(3), (len(nodes), 1, 1))))
        return found

    def improve(self, u: Floats, at_work: float) -> bool:
        """Let the springs go on from an equilibrium.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            at_work: Norm of the forces at work.

        Returns:
            Whether they still carried something, so that equilibrium has to be found again.

        Raises:
            NotHeldError: Nothing holds a body.
        """
        if self.regularisation.improve(u, at_work):
            return True
        if not self._free:
            return False
        force = self.force(u)
        if self._count == 0:  # later springs fade, and any load is most of them
            self._work.look(force)
        carried = np.sqrt(self._comm.allreduce(float((force**2).sum())))
        if carried <= SHARE * at_work:
            return False
        self._count += 1
        if self._count > MOST or self.flown_off(u) is not None:
            lost = [free for free in self._free if not free.touched()] or self._free
            lines = [f"nothing holds body {f.body.name!r}: {f.modes}{f.apart()}" for f in lost]
            raise NotHeldError("; ".join(lines))
        self._anchor = u.copy()
        for free, held in zip(self._free, held_contacts(self._free), strict=True):
            if not free.trusted:
                free.look_around(u, self._where)
                free.stiffness = max(self._next_stiffness(free, held, force), LEAST * self._scale)
        return True

    def come_through(self, u: Floats, force: Floats, softened: bool) -> bool:
        """Count the work on the way to an equilibrium; whether bodies come through it; collective.

        They do not where they have sunk into penalties that are softer than those of the laws, or
        are to be overcome by multipliers.

        Args:
            u: Displacement of the local nodes there, (nodes, 3), length.
            force: Of the springs that led there, (nodes, 3).
            softened: Whether there are such penalties.
        """
        if not self._free or (softened and any([free.touched() for free in self._free])):
            return False
        self._work.count(u, force)
        self._work.go_on(u, force)
        return True

    def _next_stiffness(self, free: FreeBody, held: Sequence[Contact], force: Floats) -> float:
        """Stiffness of the springs of a body for its next equilibrium.

        They fade, but let it go no farther than it may at once: in the air than it may fall, and
        where it has come down on some of its points than the others have to.
        """
        now, carried = free.stiffness, free.carried(force)
        if not free.touched():
            most = max(now, free.stiffness_aloft(carried))  # less and less is clear
            return max(FADE * now, min(free.stiffness_in_reach(carried), most))
        fades = min(FADE * now, free.stiffness_in_reach(free.pushed))
        needed = free.stiffness_to_land(carried, held) if self._count <= PATIENCE else 0.0
        return max(fades, min(needed, RAISE * now))

    def lets_go(self, u: Floats) -> str:
        """Why contact does not hold the free bodies in equilibrium; empty if it does.

        Where contact alone does not, the next attempt has springs.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
        """
        if self.trusts and self.doubtful(u):
            self.distrust()
            return "contact alone does not hold all bodies"
        lost = self.lost(u)
        # a body on springs has been caught where contact and springs have stiffness again
        holding = all([f.holds() for f in self._free]) and not lost
        self.trust.look(holding, all(f.sprung for f in self._free))
        return lost

    def doubtful(self, u: Floats) -> bool:
        """Whether nothing holds a body without springs, or it has moved farther than expected.

        Its motions may then meet no stiffness: springs have to say where it is. What is expected is
        a facet beyond all that prescribed motions can explain: a belt that is pulled over a drum
        goes as far as its end.

        Args:
            u: Displacement of the local nodes in equilibrium, (nodes, 3), length.
        """
        explained = self._motion.prescribed(u) if any(f.trusted for f in self._free) else 0.0
        return any(
            [
                not free.holds() or self._motion.far(free, u, explained)
                for free in self._free
                if free.trusted
            ]
        )

    def lost(self, u: Floats) -> str:
        """Bodies that contact has thrown off, with their free motions in words; empty if none is.

        Without any force a body is in balance wherever it is. That is no state to accept where the
        body has moved by more than a facet beyond all that prescribed motions can explain; nor
        is any where there are no springs, since rounding alone says where the body would be.

        Args:
            u: Displacement of the local nodes in equilibrium, (nodes, 3), length.
        """
        gone = [one for one in self._loose if not self.enabled or self._motion.far(one, u)]
        if self.enabled and gone:
            explained = self._motion.prescribed(u)
            gone = [one for one in gone if self._motion.far(one, u, explained)]
        gone = [g for g in gone if not g.carries(len(u), NOTHING * self._scale * g.size)]
        return "; ".join(f"body {g.body.name!r} has lost all contact: {g.modes}" for g in gone)

    def flown_off(self, u: Floats) -> tuple[FreeBody, float] | None:
        """A body that nothing can stop any more, see `flown_off`; collective.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
        """
        return flown_off(self._loose, self._motion.begun, u)

    @override
    def accept(self, u: Floats) -> float:
        self.energy += self._work.spent
        self._work.spent = 0.0
        self.trust.accept()
        self.landed = self._work.fell
        if self.regularisation.active:
            steps = self.regularisation.steps
            self.notes.append(f"equilibrium was lost: {steps} steps of viscous regularisation")
            self.regularisation.stop()
        return 0.0

    @override
    def energies(self, u: Floats) -> dict[str, float]:
        return {"stabilisation": self.energy, "regularisation": self.released}

    @override
    def persistent(self) -> Arrays:
        numbers = [self.energy, self.released, *self.trust.numbers()]
        return {"stabilisation": np.array(numbers)}

    @override
    def restore(self, kept: Arrays) -> None:
        self.energy, self.released, *trust = kept["stabilisation"].tolist()
        self.trust.restore(trust)

    def _add(self, free: FreeBody, step: str, now: bool) -> None:
        text = f"body {free.body.name!r} is free to move: {free.modes}"
        self._loose.append(free)
        if not self.enabled:
            if now and not free.touched(at_start=True):
                text += "; nothing touches it and stabilisation is off"
                raise InputError(text, f"step {step!r}")
            return
        self._free.append(free)
        self.notes.append(f"{text}; stabilised until contact holds it")
