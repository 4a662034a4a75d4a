"""Bodies, contacts and loads as one system of equations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.fenicsx import Mat, Vec
from anisocontact.base.processes import Together
from anisocontact.bulk import LinearBulk, Material
from anisocontact.contact import AnyContact
from anisocontact.mesh import Model
from anisocontact.solver.stepping.rotations import Rotations, Turned
from anisocontact.solver.stepping.steps import Culprit, LostError, Step
from anisocontact.solver.system.accepted import AcceptedState
from anisocontact.solver.system.balance import Balance, balance
from anisocontact.solver.system.configuration import Configuration
from anisocontact.solver.system.contact_work import ContactWork
from anisocontact.solver.system.following import Following
from anisocontact.solver.system.interior import PENDING, Interior
from anisocontact.solver.system.memory import BEGUN, Memory, persistent_points, restore_points
from anisocontact.solver.system.outcome import energies, reactions
from anisocontact.solver.system.parts import make_parts
from anisocontact.solver.system.persistent import Persistent, under
from anisocontact.solver.system.reduction import Reduction
from anisocontact.solver.system.step_begin import begin_step, contact_must_hold
from anisocontact.solver.system.tangent import Tangent, led_unknowns
from anisocontact.solver.terms.attached import ElasticSupport, Spring
from anisocontact.solver.terms.flow import pass_through

Floats = npt.NDArray[np.float64]


class Problem(Following):
    """Equilibrium `K u - contact - loads = 0` with prescribed displacements.

    A prescribed unknown has the row `s (u - g) = 0`, `s` the mean diagonal of K, and its column
    stays: the first Newton correction then carries the increment of the supports into the bodies
    with the tangent of the last accepted state.

    Args:
        model: Mesh with named bodies and facets.
        materials: Body name -> material, one for each body.
        contacts: Contacts on the same model.
        attached: Elastic supports and springs that hold the bodies for the whole run.
        symmetry: Flat facet groups whose nodes stay in their plane.
        stabilised: Whether bodies that only contact can hold are kept in reach, see
            `Stabilisation`.

    Attributes:
        rigid: Rigid bodies of the contacts. The unknowns of free ones follow those of the mesh, on
            the last rank.
        layout: Where the unknowns are.
        together: The processes of the run, when one of them fails.
        reduction: Who answers for the bulk; None where every state is one of all unknowns.
        rotations: How far bodies at small strain have turned.
        force_scale: Norm of the forces at work in the last evaluation: of supports, contacts,
            loads or supports still to be moved, the largest.
        round_off: Residual that floating point leaves in the last evaluation, force; never more
            than a small share of the loads, which a body that flies off would not balance.

    Raises:
        InputError: A body without material, a material without body, or two contacts of one name.

    Example:
        >>> from anisocontact.bulk import make_material
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        >>> steel = make_material("linear-elastic", E=210e3, nu=0.3)
        >>> Problem(model, {"block": steel}, []).unknowns
        24
    """

    def __init__(
        self,
        model: Model,
        materials: Mapping[str, Material],
        contacts: Sequence[AnyContact] = (),
        attached: Sequence[ElasticSupport | Spring] = (),
        symmetry: Sequence[str] = (),
        stabilised: bool = True,
    ) -> None:
        self._parts = parts = make_parts(model, materials, contacts, attached, symmetry, stabilised)
        self.model = model
        self.materials = dict(materials)
        self.contacts, self.bulk, self.rigid = parts.contacts, parts.bulk, parts.rigid
        self.layout, self.attached = parts.layout, parts.attached
        self.supports, self.loads = parts.supports, parts.loads
        self.constraints, self.stabilisation = parts.constraints, parts.stabilisation
        self._comm = model.mesh.comm
        self.together = Together(self._comm)
        self._tangent = Tangent(parts, model.space)
        self._bodies = Configuration(parts, model, materials)
        self.reduction: Reduction | None = None
        self.rotations = Rotations(model, materials)
        self.force_scale = 0.0
        self.round_off = 0.0
        self._balance = Balance.none(self._owned)
        self._level = 0.0
        self._dt = 0.0
        self._accepted = AcceptedState(self.layout)
        self._contact_work = ContactWork(parts)
        self._memory = Memory(parts, self._accepted, self._bodies)

    @property
    def u(self) -> Any:
        """Displacement, a DOLFINx function; holds the accepted state between increments."""
        if self.reduction is not None:
            self.reduction.recover()
        return self._bodies.u

    @property
    def level(self) -> float:
        """Load factor: fraction of the step at which the loads are."""
        return self._level

    @property
    def dt(self) -> float:
        """Time increment."""
        return self._dt

    def dead_load(self) -> Floats:
        """Loads on the unknowns this rank owns where they do not depend on the state, force."""
        return self.layout.assembled(self.loads.force(self._bodies.nodal))

    @property
    def outside(self) -> Floats:
        """All forces but those of contact on the unknowns this rank owns, accepted state."""
        return self._accepted.outside

    @property
    def unknowns(self) -> int:
        """Number of unknowns over all ranks."""
        return int(self._accepted.x.getSize())

    @property
    def comm(self) -> Any:
        """Communicator of the mesh."""
        return self._comm

    @property
    def support_scale(self) -> float:
        """Force for a unit of length in the rows of given unknowns, force/length."""
        return float(self._parts.support_scale)

    @property
    def bulk_state(self) -> tuple[float, ...] | None:
        """What the tangent without contact depends on; None where it is on every state."""
        return self.stabilisation.stiffnesses if isinstance(self.bulk, LinearBulk) else None

    def given(self) -> npt.NDArray[np.int64]:
        """Unknowns whose row says what they are, prescribed or constrained: local numbers."""
        led = led_unknowns(self._parts)
        found = [self.supports.unknowns, self.constraints.followers(), led]
        return np.unique(np.concatenate(found)).astype(np.int64)

    @property
    def holding(self) -> list[str]:
        """Names in `reactions` of what holds the bodies for the whole run."""
        return [*self.constraints.planes.groups, *self.attached.names]

    @property
    def _owned(self) -> int:
        return self.layout.owned

    def new_vector(self) -> Vec:
        """Vector of the unknowns, zero."""
        return self.layout.new_vector()

    def new_tangent(self) -> Mat:
        """Matrix for `tangent`."""
        return self._tangent.new_matrix()

    def look_ahead(self, steps: Sequence[Step]) -> None:
        """Have places in matrices of `new_tangent` for what contact will need in these steps."""
        self._tangent.look_ahead(steps)

    def begin(self, step: Step, again: bool = False) -> None:
        """Take over the loads of a step from the accepted state.

        Args:
            step: The step.
            again: Whether it had begun before, in a run that now goes on.

        Raises:
            InputError: See `Supports.begin` and `DeadLoads.begin`.
        """
        start = self.u.x.array.copy()
        self._memory.begin()
        begin_step(self._parts, step, start, self._accepted.reaction, again)
        self._tangent.begin(step)

    def check_held(self, steps: Sequence[Step]) -> bool:
        """Find out whether supports or contacts can hold every body in every step.

        Args:
            steps: The steps.

        Returns:
            Whether contact alone has to hold one of them that has no springs.

        Raises:
            InputError: A body is free to move and in no contact.
        """
        size = len(self.u.x.array)
        return contact_must_hold(self._parts, self.model, self.materials, steps, size)

    def set_level(self, fraction: float, dt: float) -> None:
        """Bring the loads to a fraction of the step.

        Args:
            fraction: Where in the step, 0 to 1.
            dt: Time increment to there.
        """
        self._bodies.forget()
        self._level = fraction
        self._dt = dt
        self.bulk.set_time(dt)
        self.rigid.set_level(fraction)
        self.loads.set_level(fraction)
        self.attached.set_level(fraction)
        self._stabilise()

    def evaluate(self, x: Vec) -> Floats:
        """Residual of the unknowns this rank owns; NaN everywhere where a law has no answer.

        Args:
            x: Displacements, and unknowns of rigid bodies, length.

        Returns:
            Residual, force.
        """
        place = self._bodies.take(x)
        self._balance = found = balance(self._parts, place, self._level, self._dt)
        self.force_scale, self.round_off = found.force_scale, found.round_off
        self.norm_as_they_are = found.norm
        return found.residual

    def tangent(self, x: Vec, out: Mat) -> bool:
        """Write d residual / d x into a matrix of `new_tangent`; whether its pattern has grown.

        Args:
            x: All unknowns, see `evaluate`.
            out: The matrix.

        Returns:
            Whether entries were added to its pattern.
        """
        self._evaluate_at(x)
        return self._tangent.write(out, self._level)

    def _evaluate_at(self, x: Vec) -> None:
        """Evaluate a state, unless it is that of the last evaluation."""
        if not self._bodies.is_at(x):
            self.evaluate(x)

    def improve(self, x: Vec) -> bool:
        """Better multipliers of contacts, weaker springs of stabilisation; whether any changed.

        Raises:
            NotHeldError: They do not converge.
            LostError: A body flows to where it cannot be.
        """
        self._evaluate_at(x)
        flows = self.stabilisation.flow.flows
        wrong = self.behind_a_master(x) if flows else None
        if wrong is not None:
            raise LostError(wrong)
        moved = self.stabilisation.improve(self._bodies.nodal, self.force_scale)
        if moved and (flows or self.stabilisation.untouched()):
            self._accepted.go_on(x, self._balance.outside)
            self.pass_through(self._bodies.nodal)
        if moved and flows:
            return True
        return any([contact.improve() for contact in self.contacts]) or moved

    def pass_through(self, nodal: Floats) -> None:
        """Remember a state on the way to the next accepted one, (nodes, 3), length."""
        self._contact_work.pass_through(nodal)
        pass_through(self.contacts)

    def contact_lets_go(self, x: Vec) -> str:
        """Why contact does not hold the free bodies in equilibrium; empty if it does."""
        if not self.stabilisation.watches:
            return ""
        return self.stabilisation.lets_go(self._nodal_at(x))

    def behind_a_master(self, x: Vec) -> Culprit | None:
        """A body that is behind its master in equilibrium; None if all are where they may be."""
        return self._parts.sides.objection(self._nodal_at(x), self.reduction is None)

    def _nodal_at(self, x: Vec) -> Floats:
        """Displacement of the local nodes, true for all that can be touched, (nodes, 3), length."""
        if self.reduction is not None:
            return self.layout.split(x)[0]
        self._evaluate_at(x)
        return self._bodies.nodal

    def turned(self, x: Vec) -> dict[str, Turned]:
        """How far bodies at small strain have turned in a state in equilibrium, by name."""
        if not self.rotations:
            return {}
        if self.reduction is not None:
            return self.rotations.reduced(self.reduction, x, self._level == 1.0)
        self._evaluate_at(x)
        return self.rotations.at(self._bodies.nodal)

    def soften(self) -> bool:
        """After a solution that failed: softer penalties of augmented contacts; whether any.

        Bodies that flow take a shorter step instead.
        """
        if self.stabilisation.flow.flows:
            return self.stabilisation.flow.soften()
        return any([contact.soften() for contact in self.contacts])

    def flow(self) -> None:
        """Let the bodies flow to the next equilibrium in this attempt, see `Flow`."""
        self.stabilisation.flow.start(self._bodies.nodal)

    def stabilise_at(self, where: npt.NDArray[np.bool_]) -> None:
        """Keep bodies in reach by springs at these of the nodes alone, (nodes,)."""
        self.stabilisation.confine(where)
        self._stabilise()

    def _stabilise(self) -> None:
        """Put the springs of stabilisation back to where they start from."""
        self._accepted.begin_way()
        condensed = self.reduction is not None
        nodal = self.layout.split(self._accepted.x)[0] if condensed else self._bodies.nodal
        self._contact_work.begin(nodal)
        if self.stabilisation.watches:
            load = self.loads.force(nodal)
            self.attached.add_force(nodal, load.reshape(-1, 3))
            self.stabilisation.start(nodal, self.layout.assembled(load).reshape(-1, 3))

    def commit(self, x: Vec) -> None:
        """Accept a state: the history of the contacts advances and energies are summed.

        Args:
            x: All unknowns of a state in equilibrium.
        """
        work = self.reduction.commit(x) if self.reduction is not None else self._commit_bulk(x)
        nodal = self._bodies.nodal if self.reduction is None else self.layout.split(x)[0]
        work += self._contact_work.beyond_the_means(nodal, self._dt, self._accepted.work + work)
        self._accepted.work += work + self.rigid.commit()
        x.copy(self._accepted.x)
        for contact in self.contacts:
            contact.commit()
        self.stabilisation.commit()
        self.rotations.commit()

    def complete(self, u: Floats, contact_force: Floats, load: Floats) -> None:
        """Bring the accepted state of all unknowns up to date.

        Args:
            u: Displacements this rank owns, length.
            contact_force: Forces of contact on them, force.
            load: Loads on them, force.
        """
        self._accepted.x.array[: self._owned] = u
        place = self._bodies.take(self._accepted.x)
        outside = self.bulk.force(place.owned).array_r - contact_force
        self._accepted.take(self.constraints.tied(outside), self.constraints.tied(load))

    def roll_back(self) -> None:
        """Return to the accepted state."""
        self._bodies.take(self._accepted.x)
        self._bodies.forget()
        self.rigid.roll_back()
        for contact in self.contacts:
            contact.roll_back()
        self._stabilise()

    def failed_points(self) -> Floats:
        """Positions at which a law had no answer in the last evaluation, over all ranks, (n, 3)."""
        local = [contact.failed_points() for contact in self.contacts]
        everywhere = self._comm.allgather(np.concatenate([np.zeros((0, 3)), *local]))
        return np.concatenate(everywhere)

    def persistent(self) -> Persistent:
        """All that the next increments depend on, of this rank."""
        nodal, common = self._memory.persistent()
        if self.reduction is not None:
            nodal |= {f"{PENDING}{name}": v for name, v in self.reduction.pending().items()}
        points = persistent_points(self.contacts, self.bulk.histories)
        common |= {"rotations": self.rotations.persistent()} | self._tangent.persistent()
        return Persistent(nodal, points, common)

    def restore(self, kept: Persistent, steps: Sequence[Step]) -> None:
        """Go on from what `persistent` gave.

        Args:
            kept: The state, of this rank.
            steps: Steps that had been begun, the last one not necessarily done.
        """
        for step in steps[:-1]:
            # What a step prescribes at its end does not depend on where it began.
            self.begin(step, again=True)
        self._memory.restore(kept, BEGUN)
        for step in steps[-1:]:
            self.begin(step, again=True)
        self._memory.restore(kept)
        self._tangent.restore(kept.common)
        self.rotations.restore(kept.common["rotations"])
        restore_points(self.contacts, self.bulk.histories, kept.points, self._bodies.nodal)
        pending = under(PENDING, kept.nodal)
        self.reduction = Interior(self, pending) if pending else None

    def inverted_cells(self) -> Floats:
        """Middles of the cells of this rank that the last evaluation turned inside out, (n, 3)."""
        return self._bodies.inverted()

    def accepted(self) -> Vec:
        """Copy of the accepted displacements."""
        return self._accepted.x.copy()

    def reactions(self) -> dict[str, Floats]:
        """Force of the supports of each facet group on the bodies, and of springs, (3,), force.

        Unknowns on an edge that several groups prescribe count for the first of them.
        """
        if self.reduction is not None:
            if not self.constraints.planes:
                return self.reduction.reactions()
            self.reduction.recover()  # forces of the planes need all displacements on them
        return reactions(self._parts, self._accepted.reaction, self._bodies.nodal)

    def mean_displacement(self, group: str, weights: Floats) -> Floats:
        """Mean displacement of a facet group in the accepted state, (3,), length.

        Args:
            group: Its name.
            weights: Share of each local node in the mean, (nodes,).
        """
        if self.reduction is not None:
            return self.reduction.mean(group, weights)
        return np.asarray(self._comm.allreduce(weights @ self._bodies.nodal))

    def energies(self) -> dict[str, float]:
        """Energies of the accepted state, force times length.

        Returns:
            "external" work of supports and loads since the start (trapezoidal rule), stored
            "elastic" (bodies), "adhesion" and "normal" (penalty) energy, energy dissipated by
            "friction" and "viscous" laws, energy of "stabilisation", what jumps have set free and
            the "flow" to the next equilibrium has dissipated and, where there are any, energy of
            "springs" and elastic supports and of the "transfer" of two half passes, and "residual",
            what is left of "external" less all others: first order in the size of the increments.
        """
        if self.reduction is not None:
            elastic = self.reduction.elastic()
        else:
            elastic = self._bodies.elastic(self._accepted.x)
        return energies(self._parts, elastic, self._accepted.work, self._bodies.nodal)

    def stiffness_energy(self) -> float:
        """Energy of all nodes held but one, `sum of K_ii u_i^2`: the scale of what is rounded."""
        owned = self._accepted.displacement
        return float(self._comm.allreduce(float(self.bulk.diagonal.array_r @ owned**2)))

    def _commit_bulk(self, x: Vec) -> float:
        self._evaluate_at(x)
        self._accepted.go_on(x, self._balance.outside)
        self._accepted.take(self._balance.outside, self._balance.load)
        self._bodies.commit()
        return self._accepted.way_work + self.attached.commit(self._bodies.nodal)
