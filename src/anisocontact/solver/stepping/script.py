"""Contact for a problem that the user has written in UFL."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.blas_threads import one_thread
from anisocontact.base.errors import InputError, ModelWarning, tell_script
from anisocontact.base.fenicsx import Mat, Vec, fem, ufl
from anisocontact.base.limits import Limits
from anisocontact.base.typed import typed
from anisocontact.base.uncopied import Uncopied
from anisocontact.contact import Contact, warn_of
from anisocontact.contact.friction_hints import wrong_derivatives
from anisocontact.contact.hints import warn_of_overlaps
from anisocontact.contact.multiplier_schemes import GRADED, IN_CYCLES, SLENDER, SOFTER
from anisocontact.solver.stepping.compliant_penalties import CompliantPenalties
from anisocontact.solver.stepping.graded_penalties import GradedPenalties
from anisocontact.solver.stepping.increment_control import IncrementControl
from anisocontact.solver.stepping.saved_state import own_file, read_arrays, write_arrays
from anisocontact.solver.stepping.script_parts import moved_bodies, script_unknowns
from anisocontact.solver.stepping.script_state import ScriptState
from anisocontact.solver.stepping.script_system import ScriptSystem
from anisocontact.solver.strategies.database import Database, OptionValue
from anisocontact.solver.strategies.newton import Newton, NewtonResult
from anisocontact.solver.system.force_balance import ForceBalance
from anisocontact.solver.system.parts import suit
from anisocontact.solver.terms.bodies import Bodies
from anisocontact.solver.terms.form import FormBulk

LIMITS = Limits()


@typed
class ContactProblem(Uncopied):
    """Residual form of the user plus contact, solved by PETSc SNES.

    What `dolfinx.fem.petsc.NonlinearProblem` is without contact: the residual is
    `F(u; v) - integral of t . (v_slave - v_master)`. A prescribed unknown has the row
    `s (u - g) = 0`, s the mean diagonal of the tangent.

    Args:
        F: Residual form, linear in its test function, of the function `u`.
        u: The displacement, a DOLFINx function of a vector Lagrange space, or of a mixed space that
            has it as a sub-space; every field then has to be in equilibrium by itself.
        bcs: Dirichlet conditions; their values may change between solutions.
        contacts: Contacts on a `Model.of` the space of `u`, or its displacement. A rigid body that
            carries a surface is where `RigidBody.move` has brought it. Where J depends on `u`
            tractions act on the area of now unless a contact has been made otherwise.
        J: Derivative of F; made by UFL if left out.
        petsc_options_prefix: Prefix of the options in the PETSc database.
        petsc_options: PETSc options without prefix.

    Attributes:
        system: What is solved.
        newton: The solver; its `snes` is to be asked or set as usual.

    Raises:
        InputError: A contact or a condition lives on another space than `u`, a contact is given
            twice, or its rigid body is free.

    See `examples/dolfinx_script/rubber_pad.py` for a whole script.

    Example:
        >>> from anisocontact import Adhesion, Friction, Interface, NormalLaw, make_surface
        >>> from anisocontact.base.fenicsx import fem, ufl
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        >>> u, v = fem.Function(model.space), ufl.TestFunction(model.space)
        >>> hooke = ufl.inner(ufl.sym(ufl.grad(u)), ufl.grad(v)) * ufl.dx  # E = 1, nu = 0
        >>> down = fem.Constant(model.mesh, (0.0, 0.0, -0.01))
        >>> top = fem.dirichletbc(down, model.nodes("bar.top"), model.space)
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> stick, slip = Adhesion(stiffness=(1, 1)), Friction(coefficients=(1, 1))
        >>> floor = Interface(plane, NormalLaw(penalty=99.0), stick, slip)
        >>> contact = Contact(model, "bar.bottom", floor)
        >>> _ = ContactProblem(hooke, u, bcs=[top], contacts=[contact]).solve()
        >>> round(float(contact.resultant()[0][2]), 9)  # two springs in series: 0.01 / (1 + 1/99)
        0.0099
    """

    def __init__(
        self,
        F: ufl.Form,
        u: fem.Function[Any],
        *,
        bcs: Sequence[fem.DirichletBC[Any]] = (),
        contacts: Sequence[Contact] = (),
        J: ufl.Form | None = None,
        petsc_options_prefix: str = "anisocontact_",
        petsc_options: Mapping[str, OptionValue] | None = None,
    ) -> None:
        unknowns = script_unknowns(contacts, u.function_space)
        self._bodies, self._key = moved_bodies(contacts), object()
        self._restored = False
        self.u, self.bcs, self.contacts = u, list(bcs), tuple(contacts)
        form = FormBulk(F, u, J)
        bodies = Bodies(form, unknowns)
        suit(contacts, bodies, [form.finite] * len(contacts))
        warn_of(contacts)
        warn_of_overlaps(contacts)
        self.system = ScriptSystem(u, unknowns, bodies, self.bcs, self.contacts)
        options = {**self.system.fields.options, **(petsc_options or {})}
        terms = self.system.assembly.terms
        self._state = ScriptState(u, unknowns, contacts, self._bodies, terms)
        self._options = Database(petsc_options_prefix, petsc_options or {}, "petsc_options")
        with self._options.blamed(), self._options:
            self.newton = Newton(self.system, petsc_options_prefix, options, lambda *_: None)

    @typed
    def solve(self, dt: float = 1.0) -> int:
        """Bring `u` into equilibrium and accept the history of the contacts.

        Args:
            dt: Time increment > 0, for laws that have a time.

        Returns:
            Number of Newton iterations.

        Raises:
            RuntimeError: No convergence, or a body is behind its master; `u` and the history are as
                before.
            InputError: The time increment is not positive, `u` or a condition has a value that is
                not finite, nodes of the mesh were moved since contacts were made, or nothing holds
                a part of the mesh: no stiffness of the form, no condition and no contact that
                touches.
        """
        if not 0.0 < dt < np.inf:
            raise InputError(f"{dt!r} given, must be > 0", "dt")
        with one_thread():
            iterations = self._solve(dt)
        for said in (*self._options.unread(self.comm), *self.system.sides.fresh()):
            tell_script(str(said), ModelWarning)
        return iterations

    def _solve(self, dt: float) -> int:
        """Newton iterations to the equilibrium, which is accepted."""
        for contact in self.contacts:
            contact.check_at_rest()
        for body in self._bodies:
            body.check_history(self._key, "rigid body")
        system, terms = self.system, self.system.assembly.terms
        system.check_finite()
        terms.set_load_factor(1.0, dt)
        before = self.u.x.array.copy()
        try:
            result = self._try(before)
        except BaseException:  # an interrupt too: the script may go on from what was accepted
            self.u.x.array[:] = before
            terms.roll_back()
            raise
        terms.accept(system.nodal)
        for body in self._bodies:
            body.commit()
            body.history_of = self._key
        return result.iterations

    def _try(self, before: Floats) -> NewtonResult:
        """The equilibrium from a start, which is not accepted yet.

        Raises:
            RuntimeError: There is none, or one with a body behind its master.
        """
        system = self.system
        x = system.new_vector()
        x.array[:] = before[: x.getLocalSize()]
        system.begin(x)
        with self._options.blamed(), self._options:
            result = self._equilibrium(x)
        reason = result.reason
        if not reason:
            system.evaluate(x)
            found = system.sides.objection(system.nodal)
            reason = f"contact {found.contact!r}: {found.why}" if found else ""
        if reason:
            raise RuntimeError("; ".join(filter(None, [reason, wrong_derivatives(self.contacts)])))
        return result

    def _equilibrium(self, x: Vec) -> NewtonResult:
        """Newton's method, and other ways where that fails."""
        start = x.copy()
        result = self.newton.solve(x)
        for solve in self._other_ways():
            if not result.reason:
                break
            start.copy(x)
            self.system.contact_term.roll_back()
            again = solve(x)
            result = replace(again, iterations=result.iterations + again.iterations)
        start.destroy()
        return result

    def _other_ways(self) -> Iterator[Callable[[Vec], NewtonResult]]:
        """Ways to multipliers, and to penalties by multipliers and from soft ones."""

        def by_scheme(name: str, x: Vec) -> NewtonResult:
            self.system.contact_term.take_way(name)
            return self.newton.solve(x)

        schemes = self.system.contact_term.ways
        yield from (
            partial(by_scheme, one)
            for one in (SOFTER, SLENDER, GRADED, IN_CYCLES)
            if one in schemes
        )
        for kind in (CompliantPenalties, GradedPenalties):
            detour = kind(self.contacts, self.newton)
            if detour.contacts:
                yield detour.solve

    @typed
    def solve_steps(
        self,
        prescribe: Callable[[float], object],
        increments: int = 1,
        *,
        duration: float = 1.0,
        limits: Limits = LIMITS,
        callback: Callable[[float, int], object] | None = None,
    ) -> int:
        """Go along a step in increments; one that fails is cut into sub-increments.

        Args:
            prescribe: Sets conditions, loads and rigid bodies for a share of the step, 0 to 1.
            increments: How many; the end of each is met exactly.
            duration: Time the step takes.
            limits: How far increments may be cut.
            callback: Called for each accepted sub-increment: the share of the step that is done,
                its Newton iterations; what it returns, if true, ends the step.

        Returns:
            Newton iterations of the accepted sub-increments.

        Raises:
            RuntimeError: The smallest sub-increment failed; `u`, the history and what is
                prescribed are as after the last accepted one.
            InputError: No increments, a callback that restores a state and does not end the step,
                which cannot go on from there, or as of `solve`.

        Example:
            See `examples/dolfinx_script/rubber_pad.py`.
        """
        if increments < 1:
            raise InputError(f"{increments!r} given, at least 1 needed", "increments")
        control, total = IncrementControl(limits, limits.largest), 0
        while control.increment <= increments:
            before, share = (
                (control.increment - 1 + s) / increments for s in (control.done, control.end)
            )
            prescribe(share)
            try:
                iterations = self.solve(duration * (share - before))
            except RuntimeError:
                if control.cut():
                    continue
                prescribe(before)
                raise
            control.advance(iterations)
            total += iterations
            self._restored = False
            if callback is not None and callback(share, iterations):
                break
            if self._restored and control.increment <= increments:
                text = (
                    "it restored a state, from which the step cannot go on: return True to end it"
                )
                raise InputError(text, "callback")
        return total

    @typed
    def save(self, path: str | Path) -> None:
        """Write what the next steps depend on: `u` with all its fields, histories of the contacts.

        Args:
            path: The file (.npz); each of several processes writes one with its number.

        Raises:
            InputError: It cannot be written.
        """
        write_arrays(own_file(path, self.comm), self._state.arrays())

    @typed
    def restore(self, path: str | Path) -> None:
        """Go on from what `save` has written, with the same mesh, contacts and processes.

        Rigid bodies of contacts are moved to where they were.

        Args:
            path: The file.

        Raises:
            InputError: It cannot be read, or is that of another problem: names what differs.
        """
        file = own_file(path, self.comm)
        kept = read_arrays(file)
        try:
            self._state.take(kept)
        except InputError as error:
            raise InputError(f"'{file}': {error}", "path") from None
        self._restored = True
        for body in self._bodies:
            body.history_of = self._key

    def close(self) -> None:
        """Give back the objects of PETSc."""
        self.newton.close()

    @property
    def comm(self) -> Any:
        """Communicator of the mesh."""
        return self.u.function_space.mesh.comm

    @property
    def balance(self) -> ForceBalance:
        """Forces of the last evaluation."""
        return self.system.balance

    @property
    def nodal(self) -> Floats:
        """Displacement of the local nodes in the last evaluation, (nodes, 3), length."""
        return self.system.nodal

    def new_vector(self) -> Vec:
        """Vector of the unknowns, zero."""
        return self.system.new_vector()

    def new_tangent(self) -> Mat:
        """Matrix for `tangent`."""
        return self.system.new_tangent()

    def evaluate(self, x: Vec) -> Floats:
        """Residual of the unknowns this rank owns; NaN everywhere where a law has no answer.

        Args:
            x: All unknowns, in their units.

        Returns:
            Residual, force for displacements.
        """
        return self.system.evaluate(x)

    def tangent(self, x: Vec, out: Mat) -> bool:
        """Write d residual / d x into a matrix of `new_tangent`.

        Args:
            x: All unknowns, see `evaluate`.
            out: The matrix.

        Returns:
            Whether entries were added to its pattern.
        """
        return self.system.tangent(x, out)
