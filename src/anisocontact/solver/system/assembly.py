"""Terms assembled: the residual, the forces that say whether it is small, the tangent.

Every system of equations is put together here: those of case files, a form of the user's, and,
but for the forces inside the bodies, those of the contact unknowns alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import Vec
from anisocontact.solver.system.fields import Fields
from anisocontact.solver.system.force_balance import ForceBalance, Magnitudes, Reached, closed
from anisocontact.solver.system.layout import Layout
from anisocontact.solver.system.prescribed_reached import prescribed_reached
from anisocontact.solver.terms.bodies import Bodies
from anisocontact.solver.terms.constraints import Constraints
from anisocontact.solver.terms.contacts import Contacts
from anisocontact.solver.terms.rigid import RigidBodies
from anisocontact.solver.terms.term import Term, TermGroup


class PrescribedUnknowns(Protocol):
    """Unknowns with prescribed values; see `Supports` and `Dirichlet`."""

    @property
    def unknowns(self) -> Ints:
        """Their local numbers, of those this rank owns."""
        ...

    def violation(self, x: Vec) -> Floats:
        """How far they are from what is prescribed in a vector of all unknowns, length."""
        ...


@dataclass(frozen=True)
class TrialState:
    """A state of all bodies that is tried.

    Attributes:
        x: All unknowns of this rank, length.
        nodal: Displacement of the local nodes, (nodes, 3), length.
        rigid: Unknowns of rigid bodies, the same on every rank.
    """

    x: Vec
    nodal: Floats
    rigid: Floats


@dataclass(frozen=True)
class ExternalTerms:
    """What acts on the bodies beside their contacts.

    Attributes:
        holders: What holds them, with forces on local nodes as contacts have them.
        loads: Loads, likewise.
        aids: What is there for the solution alone; forces as bodies have them.
    """

    holders: Sequence[Term] = ()
    loads: Sequence[Term] = ()
    aids: Sequence[Term] = ()


class Assembly:
    """One system of terms.

    Args:
        layout: Where the unknowns are.
        bodies: The bodies; forces on nodes this rank owns, complete.
        contacts: The contacts.
        conditions: Unknowns with prescribed values.
        constraints: Unknowns that follow from others.
        rigid: Rigid bodies, with unknowns of their own.
        external: What else acts on the bodies.
        fields: Fields beside the displacement; none if left out.

    Attributes:
        terms: All terms as one.
        acting: All but the bodies.
        reactions: Contacts and holders.
        scale: Force for a unit of length in the rows of prescribed unknowns, force/length.
    """

    def __init__(
        self,
        layout: Layout,
        bodies: Bodies,
        contacts: Contacts,
        conditions: PrescribedUnknowns,
        constraints: Constraints,
        rigid: RigidBodies,
        external: ExternalTerms = ExternalTerms(),
        fields: Fields | None = None,
    ) -> None:
        self.fields = Fields() if fields is None else fields
        self.layout, self.bodies, self.contacts = layout, bodies, contacts
        self.conditions, self.constraints, self.rigid = conditions, constraints, rigid
        holders, loads, aids = external.holders, external.loads, external.aids
        self.reactions = TermGroup([contacts, *holders])
        self.loads, self.aids = TermGroup(loads), TermGroup(aids)
        self.acting = TermGroup([rigid, contacts, *loads, *holders, *aids])
        self.terms = TermGroup([bodies, self.acting])
        self.scale = bodies.scale

    def balance(self, trial: TrialState) -> ForceBalance:
        """Forces at a state to which rigid bodies have been brought; collective."""
        layout, u, x = self.layout, trial.nodal, trial.x
        internal = self.bodies.internal_force(u) + layout.unknowns.own(self.aids.force(u))
        reaction = layout.assembled(self.reactions.force(u))
        given = layout.assembled(self.loads.force(u))
        outside = self.constraints.tied(-(internal + reaction))
        load = self.constraints.tied(given)
        self.rigid.take_faces(layout.unknowns.own_nodal(outside - load))
        residual = self.constraints.reduce(outside - load, x, self.scale)
        rows, off = self.conditions.unknowns, self.conditions.violation(x)
        follow = self.constraints.dependents()
        astray = residual[follow] / self.scale
        residual[rows] = self.scale * off
        self.fields.weigh(residual, rows, off)
        moved = self.fields.of_displacement(rows)
        off, rows = off[np.isin(rows, moved)], moved
        of_bodies = self.rigid.residual(trial.rigid, self.scale)
        held = np.concatenate([rows, self.constraints.holding])
        forces = (given, outside[held], reaction, residual[rows])
        rounded = (self.bodies.stiff(u), np.array([self.terms.lever()]))
        on_nodes, *at_work, stiff, lever = layout.norms(*forces, *rounded)
        at_work += [
            float(np.linalg.norm(self.rigid.spring_forces())),
            float(np.linalg.norm(of_bodies[self.rigid.prescribed()])),
        ]
        load_norm = float(np.hypot(on_nodes, float(np.linalg.norm(self.rigid.loads()))))
        bulk = self.bodies.bulk
        stiff = max(stiff, self.bodies.largest) + self.fields.rounded(x)
        sizes = Magnitudes(load_norm, at_work, stiff, lever, bulk.hardness, bulk.finite)
        return closed(
            np.append(residual, of_bodies) if layout.last_rank else residual,
            sizes,
            layout.comm,
            failed=self.reactions.failed,
            correction=self._multiplier_residual(u) if self.contacts.simultaneous else None,
            forces=(outside, load),
            fields=self.fields.balances(residual, x, sizes),
            reached=self._reached(trial, np.append(rows, follow), np.append(off, astray)),
        )

    def _reached(self, trial: TrialState, rows: Ints, off: Floats) -> Reached:
        """See `prescribed_reached`; displacements `rows` are off by a length each."""
        prescribed = self.rigid.prescribed()
        where = np.append(trial.x.array_r[rows], trial.rigid[prescribed])
        off = np.append(off, where[len(rows) :] - self.rigid.values()[prescribed])
        layout = self.layout
        return prescribed_reached(
            off, where, layout.comm, layout.unknowns.extent, trial.nodal, trial.rigid
        )

    def prescribed_of_bodies(self) -> Ints:
        """Unknowns of rigid bodies on this rank that are prescribed, local numbers."""
        if not self.layout.last_rank:
            return np.zeros(0, dtype=np.int64)
        return self.layout.owned + np.flatnonzero(self.rigid.prescribed())

    def _multiplier_residual(self, u: Floats) -> Floats:
        """`Contacts.multiplier_residual` as the rows of the system have it, force."""
        forces = self.layout.assembled(self.contacts.multiplier_residual(u))
        of_bodies = self.rigid.multiplier_residual(self.layout.unknowns.own_nodal(forces))
        forces = self.constraints.handed(forces)
        forces[self.conditions.unknowns] = 0.0
        return np.append(forces, of_bodies) if self.layout.last_rank else forces
