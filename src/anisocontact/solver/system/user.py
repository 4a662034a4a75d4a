"""Contact for a problem that the user has written in UFL."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import (
    Mat,
    PETSc,
    Vec,
    assemble_force,
    assemble_into,
    compiled,
    create_force,
    create_stiffness,
    prescribe,
    prescribed_rows,
    ufl,
)
from anisocontact.contact import AnyContact, warn_of
from anisocontact.solver.stepping.newton import Newton, OptionValue
from anisocontact.solver.stepping.sides_kept import SidesKept
from anisocontact.solver.system.balance import ROUND_OFF
from anisocontact.solver.system.coupled import CoupledTangent
from anisocontact.solver.system.following import Following
from anisocontact.solver.terms.loose import Part, loose_motions, parts

Floats = npt.NDArray[np.float64]

#: Gap over the facet size up to which a point counts as touching: rounding of a mesh.
NEAR = 1e-6


class ContactProblem(Following):
    """Residual form of the user plus contact, solved by PETSc SNES.

    What `dolfinx.fem.petsc.NonlinearProblem` is without contact: the residual is
    `F(u; v) - integral of t . (v_slave - v_master)`. A prescribed unknown has the row
    `s (u - g) = 0`, s the mean diagonal of the tangent.

    Args:
        F: Residual form, linear in its test function, of the function `u`.
        u: The displacement, a DOLFINx function of a vector Lagrange space.
        bcs: Dirichlet conditions; their values may change between solutions.
        contacts: Contacts on a `Model.of` the space of `u`. A rigid body that carries a surface is
            where `RigidBody.move` has brought it. Where J depends on `u` tractions act on the area
            of now unless a contact was told otherwise.
        J: Derivative of F; made by UFL if left out.
        petsc_options_prefix: Prefix of the options in the PETSc database.
        petsc_options: PETSc options without prefix.

    Attributes:
        newton: The solver; its `snes` is to be asked or set as usual.
        force_scale: Norm of the forces at work in the last evaluation: of contacts, supports, or
            supports still to be moved.
        round_off: Residual that floating point leaves in the last evaluation.

    Raises:
        InputError: A contact lives on another space than `u`, or its rigid body is free.

    See `examples/dolfinx_script/rubber_pad.py` for a whole script.
    """

    def __init__(
        self,
        F: Any,
        u: Any,
        *,
        bcs: Sequence[Any] = (),
        contacts: Sequence[AnyContact] = (),
        J: Any = None,
        petsc_options_prefix: str = "anisocontact_",
        petsc_options: Mapping[str, OptionValue] | None = None,
    ) -> None:
        space = u.function_space
        for contact in contacts:
            if contact.space != space:
                raise InputError(
                    f"contact {contact.name!r} lives on another space than u", "contacts"
                )
        self._bodies = [c.body for c in contacts if c.body is not None]
        for body in self._bodies:
            if body.free:
                raise InputError(
                    f"rigid body {body.name!r} is free; a script can only move it", "contacts"
                )
        warn_of(contacts)
        self.u, self.bcs, self.contacts = u, list(bcs), list(contacts)
        self._sides = SidesKept(contacts)
        self.force_scale = self.round_off = 0.0
        trial = ufl.TrialFunction(space)
        tangent = ufl.derivative(F, u, trial) if J is None else J
        self._residual = compiled(F, space.mesh.comm)
        self._tangent = compiled(tangent, space.mesh.comm)
        self._matrix = create_stiffness(self._tangent)
        self._diagonal = self._matrix.getDiagonal()
        self._support_scale = self._diagonal.sum() / self._diagonal.getSize()
        finite = u in ufl.algorithms.expand_derivatives(tangent).coefficients()
        for contact in contacts:
            contact.suit_strain(finite)
            contact.suit(np.array(self._diagonal.array_r).reshape(-1, 3))
        meshed = any(c.meshed for c in contacts)
        self._coupled = CoupledTangent(self._matrix, space) if meshed else None
        self._dt = 1.0
        self._parts = parts(space)
        self._force = create_force(self._residual)
        self._ghosted = u.x.petsc_vec.duplicate()
        self.newton = Newton(self, petsc_options_prefix, petsc_options or {}, lambda *_: None)

    def solve(self, dt: float = 1.0) -> int:
        """Bring `u` into equilibrium and accept the history of the contacts.

        Args:
            dt: Time increment > 0, for laws that have a time.

        Returns:
            Number of Newton iterations.

        Raises:
            RuntimeError: No convergence, or a body is behind its master; `u` and the history are as
                before.
            InputError: The time increment is not positive, or nothing holds a part of the mesh: no
                stiffness of the form, no condition and no contact that touches.
        """
        if not 0.0 < dt < np.inf:
            raise InputError(f"{dt!r} given, must be > 0", "dt")
        self._dt = dt
        before = self.u.x.array.copy()
        x = self.new_vector()
        x.array[:] = before[: self._owned]
        self._check_held(x)
        result = self.newton.solve(x)
        reason = result.reason
        if not reason:
            self.evaluate(x)
            found = self._sides.objection(self.u.x.array.reshape(-1, 3))
            reason = f"contact {found.contact!r}: {found.why}" if found else ""
        if reason:
            self.u.x.array[:] = before
            for contact in self.contacts:
                contact.roll_back()
            raise RuntimeError(reason)
        for part in (*self.contacts, *self._bodies):
            part.commit()
        return result.iterations

    def close(self) -> None:
        """Give back the objects of PETSc."""
        self.newton.close()

    @property
    def comm(self) -> Any:
        """Communicator of the mesh."""
        return self.u.function_space.mesh.comm

    @property
    def _owned(self) -> int:
        return int(3 * self.u.function_space.dofmap.index_map.size_local)

    def new_vector(self) -> Vec:
        """Vector of the unknowns, zero."""
        return self._matrix.createVecRight()

    def new_tangent(self) -> Mat:
        """Matrix for `tangent`."""
        matrix = self._coupled.new_matrix() if self._coupled else self._matrix.duplicate()
        matrix.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        return matrix

    def evaluate(self, x: Vec) -> Floats:
        """Residual of the unknowns this rank owns.

        Args:
            x: Displacements, length.

        Returns:
            Residual, force; NaN everywhere where a law has no answer.
        """
        self.u.x.array[: self._owned] = x.array_r
        self.u.x.scatter_forward()
        nodal = self.u.x.array.reshape(-1, 3)
        failed = [bool(c.update(nodal, self._dt).failed.any()) for c in self.contacts]
        contact_force = self._assembled([contact.add_force for contact in self.contacts])
        assemble_force(self._residual, self._force)
        outside: Floats = self._force.array_r - contact_force
        prescribe(self._force, self.bcs, x)
        rows = prescribed_rows(self.bcs)
        residual: Floats = outside.copy()
        residual[rows] = self._support_scale * self._force.array_r[rows]
        at_work = (outside[rows], contact_force, residual[rows])
        self.force_scale = max(map(self._norm, at_work))
        levers = np.array([contact.lever() for contact in self.contacts])
        stiff = self._norm(self._diagonal.array_r * x.array_r) + self._norm(levers)
        self.round_off = ROUND_OFF * stiff
        if self.comm.allreduce(any(failed)):
            residual[:] = np.nan
        self.norm_as_they_are = self._norm(residual)
        if self.follows:
            lag = self._assembled([contact.add_lag for contact in self.contacts])
            lag[rows] = 0.0
            residual -= lag
        return residual

    def tangent(self, x: Vec, out: Mat) -> bool:
        """Write d residual / d x into a matrix of `new_tangent`; whether its pattern has grown.

        Args:
            x: Displacements.
            out: The matrix.

        Returns:
            Whether entries were added to its pattern.
        """
        grown = False
        if not np.array_equal(self.u.x.array[: self._owned], x.array_r):
            self.evaluate(x)
        if self._coupled:
            meshed = [p for c in self.contacts if c.meshed for p in c.passes]
            grown = self._coupled.make_room(out, [k for c in meshed for k in c.couplings()], list)
        out.zeroEntries()
        assemble_into(out, self._tangent)
        analytic: list[Any] = [c for c in self.contacts if not c.meshed]
        for contact in analytic:
            contact.add_tangent(out)
        out.assemble()
        if self._coupled:
            self._coupled.add(out)
        out.zeroRowsLocal(prescribed_rows(self.bcs), self._support_scale)
        return grown

    def improve(self, x: Vec) -> bool:
        """Better multipliers of the contacts from equilibrium.

        Args:
            x: Displacements in equilibrium, length.

        Returns:
            Whether any changed.

        Raises:
            NotHeldError: They do not converge.
        """
        if not np.array_equal(self.u.x.array[: self._owned], x.array_r):
            self.evaluate(x)
        return any([contact.improve() for contact in self.contacts])

    def soften(self) -> bool:
        """After a solution that failed: softer penalties of augmented contacts; whether any."""
        return any([contact.soften() for contact in self.contacts])

    def _check_held(self, x: Vec) -> None:
        """Refuse a part of the mesh that can move as a rigid body."""
        if not self._untouched():
            return
        self.evaluate(x)  # rigid bodies may have been moved since
        free = self._untouched()
        for contact in self.contacts:
            contact.roll_back()
        if not free:
            return
        self._matrix.zeroEntries()
        assemble_into(self._matrix, self._tangent)
        self._matrix.assemble()
        rows = np.asarray(prescribed_rows(self.bcs), dtype=np.int64)
        for part in free:
            motions = loose_motions(part, self._matrix, self._support_scale, rows, self.comm)
            if motions:
                at = ", ".join(f"{v:.4g}" for v in part.middle)
                raise InputError(
                    f"nothing holds the body around ({at}): {motions}; no condition does, and no "
                    "contact touches it: let it touch at the start, or lead it there with "
                    "conditions",
                    "contacts" if self.contacts else "bcs",
                )

    def _any(self, here: npt.NDArray[np.bool_]) -> bool:
        return bool(self.comm.allreduce(int(here.any())))

    def _untouched(self) -> list[Part]:
        """Parts of the mesh that no contact which touches somewhere acts on, now."""
        nodes = [np.zeros(0, dtype=np.int32)]
        passes: list[Any] = [one for contact in self.contacts for one in contact.parts]
        for one in passes:
            now = one.current.response
            near = one.located(now.state) & (now.gap <= NEAR * one.facet_size)
            if self._any(near):
                nodes.append(one.couplable())
        touched = np.concatenate(nodes)
        return [part for part in self._parts if not self._any(np.isin(part.nodes, touched))]

    def _assembled(self, parts: Sequence[Callable[[Floats], None]]) -> Floats:
        """Sum of what the parts add to the nodes, at the unknowns this rank owns."""
        with self._ghosted.localForm() as form:
            nodal = np.zeros(len(form.array_r))
            for add in parts:
                add(nodal.reshape(-1, 3))
            form.array[:] = nodal
        self._ghosted.ghostUpdate(PETSc.InsertMode.ADD_VALUES, PETSc.ScatterMode.REVERSE)
        return np.array(self._ghosted.array_r)

    def _norm(self, owned: Floats) -> float:
        return float(np.sqrt(self.comm.allreduce(float(owned @ owned))))
