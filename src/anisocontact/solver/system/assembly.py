"""Terms assembled: the residual, the forces that say whether it is small, the tangent.

Every system of equations is put together here: those of case files, a form of the user's, and,
but for the forces inside the bodies, those of the contact unknowns alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from anisocontact.base.fenicsx import Vec
from anisocontact.solver.system.layout import Layout
from anisocontact.solver.terms.bodies import Bodies
from anisocontact.solver.terms.constraints import Constraints
from anisocontact.solver.terms.contacts import Contacts
from anisocontact.solver.terms.rigid import RigidBodies
from anisocontact.solver.terms.term import Term, TermGroup

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

#: Share of `|diag(K) u|` and of `Term.lever` that is round-off of the forces.
ROUND_OFF = 16.0 * float(np.finfo(np.float64).eps)
#: Share of the loads that may be left out of balance as round-off.
LOAD_SHARE = 1e-6


class Prescribed(Protocol):
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
class ForceBalance:
    """Forces at a state, of the unknowns this rank owns.

    Attributes:
        residual: Residual, with the forces that a correction takes beyond those of the state; NaN
            everywhere where a law has no answer.
        norm: Norm of the residual without them over all ranks; 0 where no multipliers follow.
        force_scale: Norm of the forces at work: of loads, contacts, supports or supports still to
            be moved, the largest.
        round_off: Residual that floating point leaves, force; never more than a small share of the
            loads, which a body that flies off would not balance.
        outside: All forces but those of contact.
        load: Of these, the loads.
    """

    residual: Floats
    norm: float
    force_scale: float
    round_off: float
    outside: Floats
    load: Floats

    @classmethod
    def none(cls, owned: int) -> ForceBalance:
        """No forces at all."""
        return cls(np.zeros(owned), 0.0, 0.0, 0.0, np.zeros(owned), np.zeros(owned))


@dataclass(frozen=True)
class Magnitudes:
    """How large forces are, norms over all ranks.

    Attributes:
        load: Of the loads.
        at_work: Of whatever else is at work.
        stiff: Of the forces that are rounded: of nodes moved alone, and levers of the terms.
    """

    load: float
    at_work: Sequence[float]
    stiff: float


class Assembly:
    """One system of terms.

    Args:
        layout: Where the unknowns are.
        bodies: The bodies; forces on nodes this rank owns, complete.
        contacts: The contacts.
        conditions: Unknowns with prescribed values.
        constraints: Unknowns that follow from others.
        rigid: Rigid bodies, with unknowns of their own.
        holders: What else holds the bodies, with forces on local nodes as contacts have them.
        loads: Loads, likewise.
        aids: What is there for the solution alone; forces as bodies have them.

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
        conditions: Prescribed,
        constraints: Constraints,
        rigid: RigidBodies,
        holders: Sequence[Term] = (),
        loads: Sequence[Term] = (),
        aids: Sequence[Term] = (),
    ) -> None:
        self.layout, self.bodies, self.contacts = layout, bodies, contacts
        self.conditions, self.constraints, self.rigid = conditions, constraints, rigid
        self.reactions = TermGroup([contacts, *holders])
        self.loads, self.aids = TermGroup(loads), TermGroup(aids)
        self.acting = TermGroup([rigid, contacts, *loads, *holders, *aids])
        self.terms = TermGroup([bodies, self.acting])
        self.scale = bodies.scale

    def balance(self, trial: TrialState) -> ForceBalance:
        """Forces at a state to which rigid bodies have been brought; collective."""
        layout, u, owned = self.layout, trial.nodal, self.layout.owned
        inner = self.bodies.force(u)
        self.aids.add_force(u, inner)
        reaction = layout.assembled(self.reactions.force(u).reshape(-1))
        given = layout.assembled(self.loads.force(u).reshape(-1))
        outside = self.constraints.tied(-(inner.reshape(-1)[:owned] + reaction))
        load = self.constraints.tied(given)
        self.rigid.take_faces(outside - load)
        residual = self.constraints.reduce(outside - load, trial.x, self.scale)
        rows = self.conditions.unknowns
        residual[rows] = self.scale * self.conditions.violation(trial.x)
        of_bodies = self.rigid.residual(trial.rigid, self.scale)
        held = np.concatenate([rows, self.constraints.holding])
        stiff = (self.bodies.stiff(u), np.array([self.terms.lever()]))
        on_nodes, *norms = layout.norms(given, outside[held], reaction, residual[rows], *stiff)
        at_work = [
            *norms[:3],
            float(np.linalg.norm(self.rigid.spring_forces())),
            float(np.linalg.norm(of_bodies[self.rigid.prescribed()])),
        ]
        load_norm = float(np.hypot(on_nodes, float(np.linalg.norm(self.rigid.loads()))))
        return closed(
            np.append(residual, of_bodies) if layout.last_rank else residual,
            Magnitudes(load_norm, at_work, sum(norms[3:])),
            layout.comm,
            failed=self.reactions.failed,
            correction=self._multiplier_residual(u) if self.contacts.follows else None,
            forces=(outside, load),
        )

    def prescribed_of_bodies(self) -> Ints:
        """Unknowns of rigid bodies on this rank that are prescribed, local numbers."""
        if not self.layout.last_rank:
            return np.zeros(0, dtype=np.int64)
        return self.layout.owned + np.flatnonzero(self.rigid.prescribed())

    def _multiplier_residual(self, u: Floats) -> Floats:
        """`Contacts.multiplier_residual` as the rows of the system have it, force."""
        forces = self.layout.assembled(self.contacts.multiplier_residual(u).reshape(-1))
        of_bodies = self.rigid.multiplier_residual(forces)
        forces = self.constraints.handed(forces)
        forces[self.conditions.unknowns] = 0.0
        return np.append(forces, of_bodies) if self.layout.last_rank else forces


def closed(
    residual: Floats,
    sizes: Magnitudes,
    comm: Any,
    *,
    failed: bool,
    correction: Floats | None,
    forces: tuple[Floats, Floats] | None = None,
) -> ForceBalance:
    """A balance of forces from its residual; collective.

    Args:
        residual: Of the unknowns of this rank, force; overwritten.
        sizes: How large the forces are.
        comm: Communicator.
        failed: Whether there is no answer on this rank.
        correction: Forces that a correction takes beyond those of the state; None where no
            multipliers follow.
        forces: See `ForceBalance.outside` and `ForceBalance.load`; none if left out.
    """
    round_off = ROUND_OFF * sizes.stiff
    if sizes.load > 0.0:
        round_off = min(round_off, LOAD_SHARE * sizes.load)
    if comm.allreduce(failed):
        residual[:] = np.nan
    norm = 0.0
    if correction is not None:
        norm = float(np.sqrt(comm.allreduce(float(residual @ residual))))
        residual = residual - correction
    outside, load = forces or (np.zeros(0), np.zeros(0))
    return ForceBalance(residual, norm, max(sizes.load, *sizes.at_work), round_off, outside, load)
