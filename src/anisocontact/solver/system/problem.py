"""Bodies, contacts and loads as one system of equations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from typing import Any, override

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.fenicsx import Mat, Vec
from anisocontact.base.processes import Together
from anisocontact.base.read_only import ReadOnlyDict
from anisocontact.base.renamed import RenamedAttribute
from anisocontact.base.typed import typed
from anisocontact.base.uncopied import Uncopied
from anisocontact.bulk import Material
from anisocontact.contact import Contact
from anisocontact.mesh import Model
from anisocontact.mesh.at_rest import check_at_rest
from anisocontact.solver.system.accepted import AcceptedState
from anisocontact.solver.system.composed import ComposedSystem
from anisocontact.solver.system.configuration import Configuration
from anisocontact.solver.system.contact_work import ContactWork
from anisocontact.solver.system.coupled import CoupledTangent
from anisocontact.solver.system.culprit import Culprit
from anisocontact.solver.system.ends_work import EndsWork
from anisocontact.solver.system.evaluation import Evaluation
from anisocontact.solver.system.force_balance import ForceBalance
from anisocontact.solver.system.interior import PENDING
from anisocontact.solver.system.parts import Connections, make_parts
from anisocontact.solver.system.reduction import Reduction
from anisocontact.solver.system.restart_state import BEGUN, RestartState
from anisocontact.solver.system.rotations import BodyRotation, Rotations
from anisocontact.solver.system.step_begin import begin_step, check_steps, contact_must_hold
from anisocontact.solver.system.tangent import Tangent
from anisocontact.solver.system.whole import Whole
from anisocontact.solver.terms.attached import ElasticSupport, Spring
from anisocontact.solver.terms.cyclic import CyclicSymmetry
from anisocontact.solver.terms.face_on_body import CoupledFace
from anisocontact.solver.terms.persistent import Persistent, under
from anisocontact.solver.terms.step import Step
from anisocontact.solver.terms.tied_faces import Tie


@typed
class Problem(
    ComposedSystem, Uncopied, changing="load_factor dt begun regularised missed reduction"
):
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
        coupled: Facet groups that follow rigid bodies.
        ties: Facet groups that are glued together.
        cyclic: Cut faces of sectors that stand for a whole.

    Attributes:
        rigid: Rigid bodies of the contacts. The unknowns of free ones follow those of the mesh, on
            the last rank.
        layout: Where the unknowns are.
        together: The processes of the run, when one of them fails.
        whole: The bulk with all unknowns.
        reduction: The bulk as it is used now, whole or condensed.
        sides: Finds bodies behind their masters.
        rotations: How far bodies at small strain have turned.
        load_factor: Fraction of the step at which the loads are.
        dt: Time increment to there.
        begun: How many steps have begun.
        regularised: Work of the last accepted increment if viscous regularisation led to it.
        missed: What its ends miss at most of the work in it; infinite where that is not known.
        evaluation: Forces at the state of the last evaluation.

    Raises:
        InputError: A body without material, a material without body, two contacts of one name,
            or one on another model.

    Example:
        >>> from anisocontact.bulk import make_material
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        >>> steel = make_material("linear-elastic", E=210e3, nu=0.3)
        >>> Problem(model, {"block": steel}, []).unknowns
        24
    """

    flowed = RenamedAttribute("regularised")

    def __init__(
        self,
        model: Model,
        materials: Mapping[str, Material],
        contacts: Sequence[Contact] = (),
        attached: Sequence[ElasticSupport | Spring] = (),
        symmetry: Sequence[str] = (),
        stabilised: bool = True,
        coupled: Sequence[CoupledFace] = (),
        ties: Sequence[Tie] = (),
        cyclic: Sequence[CyclicSymmetry] = (),
    ) -> None:
        connections = Connections(attached, symmetry, coupled, ties, cyclic)
        self._parts = parts = make_parts(model, materials, contacts, connections, stabilised)
        self.model, self.materials = model, ReadOnlyDict(materials)
        self.contacts, self.bulk, self.rigid = parts.contacts, parts.bulk, parts.rigid
        self.layout, self.attached, self.sides = parts.layout, parts.attached, parts.sides
        self.supports, self.loads, self.inclined = parts.supports, parts.loads, parts.inclined
        self._aid = self.stabilisation = parts.stabilisation
        self.assembly = assembly = parts.assembly
        self.constraints, self.contact_term = assembly.constraints, assembly.contacts
        self.together = Together(self.comm)
        coupling = parts.attached.coupling or assembly.constraints.ties is not None
        self._tangent = Tangent(assembly, coupling)
        self._bodies = Configuration(parts)
        self.rotations = Rotations(model, materials)
        self.evaluation = Evaluation(assembly, self._bodies)
        self.load_factor, self.dt, self.begun, self.missed = 0.0, 0.0, 0, float("inf")
        self._accepted = AcceptedState(self.layout)
        self._contact_work = ContactWork(parts)
        self.regularised: EndsWork | None = None
        self.whole = Whole(self.evaluation, parts, self._bodies, self._accepted)
        self.reduction: Reduction = self.whole
        self._restart_state = RestartState(assembly.terms, self._accepted, self._bodies)

    @property
    def u(self) -> Any:
        """Displacement, a DOLFINx function; holds the accepted state between increments."""
        self.reduction.recover()
        return self._bodies.u

    @property
    def coupled_tangent(self) -> CoupledTangent | None:
        """Couplings between bodies in the tangent; None where there cannot be any."""
        return self._tangent.coupled

    def new_vector(self) -> Vec:
        """Vector of the unknowns, zero."""
        return self.layout.new_vector()

    def new_tangent(self) -> Mat:
        """Matrix for `tangent`."""
        return self._tangent.new_matrix()

    def predict_contact(self, steps: Sequence[Step]) -> None:
        """Have places in matrices of `new_tangent` for what contact will need.

        Args:
            steps: The steps to come, in order.
        """
        self._tangent.predict_contact(steps)

    def begin(self, step: Step, again: bool = False) -> None:
        """Take over the loads of a step from the accepted state.

        Args:
            step: The step.
            again: Whether it had begun before, in a run that now goes on.

        Raises:
            InputError: See `Supports.begin` and `DeadLoads.begin`; or nodes of the mesh were moved.
        """
        check_at_rest(self.model, "model")
        start = self.u.x.array.copy()
        self.begun += 1
        self._restart_state.begin()
        begin_step(self._parts, step, start, self._accepted.reaction, again)
        self._tangent.begin(step)

    def end_at(self, factor: float) -> None:
        """End the step that has begun at a fraction of it: prescribed values stay as they are.

        Args:
            factor: The fraction, 0 to 1.
        """
        self.supports.stop()
        self.inclined.stop()
        self.assembly.terms.end_at(factor)

    def check(self, steps: Sequence[Step]) -> list[str]:
        """Go through all steps without solving.

        Args:
            steps: The steps, in order.

        Returns:
            What the steps ask for that is doubtful, a line each.

        Raises:
            InputError: A step asks for what is not there, or cannot be.
        """
        doubtful = check_steps(self._parts, steps)
        for step in steps:
            self.attached.check(step)
        self.rigid.check(steps)
        self.check_supported(steps)
        return doubtful

    def check_supported(self, steps: Sequence[Step]) -> bool:
        """Find out whether supports or contacts can hold every body in every step.

        Args:
            steps: The steps.

        Returns:
            Whether contact alone has to hold one of them that has no springs.

        Raises:
            InputError: A body is free to move and in no contact.
        """
        return contact_must_hold(self._parts, steps)

    def set_load_factor(self, factor: float, dt: float) -> None:
        """Bring the loads to a fraction of the step.

        Args:
            factor: Where in the step, 0 to 1.
            dt: Time increment to there.
        """
        self._bodies.forget()
        self.load_factor, self.dt = factor, dt
        self.supports.set_load_factor(factor)
        self.inclined.set_load_factor(factor)
        self.assembly.terms.set_load_factor(factor, dt)
        self._stabilise()

    def evaluate(self, x: Vec) -> Floats:
        """Residual of the unknowns this rank owns; NaN everywhere where a law has no answer.

        Args:
            x: Displacements, and unknowns of rigid bodies, length.

        Returns:
            Residual, force.
        """
        return self.evaluation.evaluate(x).residual

    @override
    def corrected(self, searching: bool) -> AbstractContextManager[bool]:
        in_full_alone = self.contact_term.by_penalties and not (searching and self.mixed_search)
        return self.assembly.bodies.followed(self._bodies.nodal, in_full_alone)

    def tangent(self, x: Vec, out: Mat) -> bool:
        """Write d residual / d x into a matrix of `new_tangent`; whether its pattern has grown.

        Args:
            x: All unknowns, see `evaluate`.
            out: The matrix.

        Returns:
            Whether entries were added to its pattern.
        """
        self.evaluate_at(x)
        return self._tangent.write(out, self.load_factor)

    @property
    @override
    def balance(self) -> ForceBalance:
        return self.evaluation.balance

    @property
    @override
    def nodal(self) -> Floats:
        return self._bodies.nodal

    @override
    def evaluate_at(self, x: Vec) -> None:
        self.evaluation.at(x)

    @override
    def _go_on(self, x: Vec) -> None:
        self._accepted.go_on(x, self.balance.outside)
        self.contact_term.pass_through()

    @override
    def behind_a_master(self, x: Vec) -> Culprit | None:
        known, sides = self.reduction, self.sides
        found = sides.objection(known.nodal(x), known.whole)
        if known.whole or not (found or sides.partly):
            return found
        # where a body is dented, a rigid one that goes with what can be touched lies elsewhere
        return sides.objection(known.displacement(x))

    def turned(self, x: Vec) -> dict[str, BodyRotation]:
        """How far bodies at small strain have turned.

        Args:
            x: All unknowns of a state in equilibrium.

        Returns:
            Turns by name of the body; none where no body is at small strain.
        """
        if not self.rotations:
            return {}
        return self.reduction.turned(self.rotations, x, self.load_factor == 1.0)

    def stabilise_at(self, where: Flags) -> None:
        """Keep bodies in reach by springs at some of the nodes alone.

        Args:
            where: Whether a local node may have springs, (nodes,).
        """
        self.stabilisation.confine(where)
        self._stabilise()

    def _stabilise(self) -> None:
        """Put the springs of stabilisation back to where they start from."""
        self._accepted.begin_way()
        nodal = self._bodies.nodal
        if not self.reduction.whole:
            nodal = self.reduction.nodal(self._accepted.x)
        self._contact_work.begin(nodal, self._accepted.contact)
        if self.stabilisation.watches:
            load = self.loads.force(nodal)
            self.attached.add_force(nodal, load)
            if self.stabilisation.aloft:
                self.rigid.add_face_loads(load)
            self.stabilisation.start(nodal, self.layout.assembled(load).reshape(-1, 3))

    def commit(self, x: Vec) -> None:
        """Accept a state: the history of the contacts advances and energies are summed.

        Args:
            x: All unknowns of a state in equilibrium.
        """
        ends, nodal = self.reduction.commit(x), self.reduction.nodal(x)
        ends += EndsWork.of(*self.assembly.bodies.heating(nodal))
        self.regularised = ends if self.stabilisation.regularisation.active else None
        self.missed = self._contact_work.missed(ends)
        work = ends.mean + self._contact_work.of_overlaps()
        beyond, so_far = self._contact_work.beyond_the_means, self._accepted.work + work
        work += beyond(nodal, self.dt, so_far, ends)
        self._accepted.contact = self._contact_work.forces(nodal)
        self._accepted.work += work + self.assembly.terms.accept(nodal)
        x.copy(self._accepted.x)
        self.rotations.commit()

    def reduce_by(self, reduction: Reduction | None) -> None:
        """Let something else answer for the bulk from the accepted state on.

        Args:
            reduction: What answers; the bulk itself again if None.
        """
        self.whole.take_pending({})
        self.reduction = self.whole if reduction is None else reduction
        if reduction is None:
            self.stabilisation.confine(None)

    def roll_back(self) -> None:
        """Return to the accepted state."""
        self._bodies.take(self._accepted.x)
        self._bodies.forget()
        self.assembly.terms.roll_back()
        self._stabilise()

    def persistent(self) -> Persistent:
        """All that the next increments depend on, of this rank."""
        pending = self.reduction.pending()  # first: it may bring the accepted state up to date
        nodal, common = self._restart_state.persistent()
        nodal["position"] = self.model.positions[: self.layout.owned // 3].copy()
        nodal |= {f"{PENDING}{name}": values for name, values in pending.items()}
        nodal |= self.assembly.bodies.accepted_at_nodes()
        common |= {"rotations": self.rotations.persistent()} | self._tangent.persistent()
        return Persistent(nodal, self.assembly.terms.histories(), common)

    def restore(
        self, kept: Persistent, steps: Sequence[Step], stopped: Mapping[int, float]
    ) -> None:
        """Go on from what `persistent` gave.

        Args:
            kept: The state, of this rank.
            steps: Steps that had been begun, the last one not necessarily done.
            stopped: Fractions at which those that an event ended did, by number.
        """
        for i, step in enumerate(steps[:-1]):
            # What a step prescribes at its end does not depend on where it began.
            self.begin(step, again=True)
            if i in stopped:
                self.end_at(stopped[i])
        self._restart_state.restore(kept, BEGUN)
        for step in steps[-1:]:
            self.begin(step, again=True)
        self._restart_state.restore(kept)
        self._tangent.restore(kept.common)
        self.rotations.restore(kept.common["rotations"])
        self.assembly.terms.take_histories(iter(kept.points), self._bodies.nodal)
        self.assembly.bodies.restore_at_nodes(kept.nodal)
        self.whole.take_pending(under(PENDING, kept.nodal))

    def accepted(self) -> Vec:
        """Copy of the accepted displacements."""
        return self._accepted.x.copy()
