"""Residual form of a script and contact as one system of equations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, override

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import Mat, Vec, fem
from anisocontact.contact import Contact
from anisocontact.mesh.node_unknowns import NodeUnknowns
from anisocontact.solver.stepping.script_parts import script_assembly
from anisocontact.solver.stepping.unsupported_parts import UnsupportedParts
from anisocontact.solver.system.assembled import AssembledSystem
from anisocontact.solver.system.assembly import TrialState
from anisocontact.solver.system.fields import fields_beside
from anisocontact.solver.system.force_balance import ForceBalance
from anisocontact.solver.system.sides_kept import SidesKept
from anisocontact.solver.system.tangent import Tangent
from anisocontact.solver.terms.bodies import Bodies
from anisocontact.solver.terms.form import Dirichlet


class ScriptSystem(AssembledSystem):
    """What Newton's method solves for a `ContactProblem`, to which it does not refer.

    Args:
        u: The unknown, which holds the state of the last evaluation.
        unknowns: Where the displacement is among the unknowns.
        bodies: The form as a term.
        bcs: Dirichlet conditions.
        contacts: Contacts on the displacement.

    Attributes:
        fields: Fields beside the displacement.
        assembly: The terms put together.
        sides: Finds bodies behind their masters.
    """

    def __init__(
        self,
        u: fem.Function[Any],
        unknowns: NodeUnknowns,
        bodies: Bodies,
        bcs: Sequence[fem.DirichletBC[Any]],
        contacts: Sequence[Contact],
    ) -> None:
        space = u.function_space
        self._u, self._unknowns = u, unknowns
        self._bcs, self._contacts = bcs, contacts
        self.fields = fields_beside(unknowns, space)
        self.assembly = script_assembly(bodies, contacts, Dirichlet(bcs, space), self.fields)
        self.contact_term = self.assembly.contacts
        self._balance = ForceBalance.none(self.assembly.layout.owned)
        self.fields.measure(bodies)
        self._tangent = Tangent(self.assembly)
        self._unsupported = UnsupportedParts(unknowns, contacts, self.assembly)
        self.sides = SidesKept(contacts, self._unsupported.bodies())

    @property
    def comm(self) -> Any:
        """Communicator of the mesh."""
        return self._u.function_space.mesh.comm

    def new_vector(self) -> Vec:
        """Vector of the unknowns, zero."""
        return self.assembly.layout.new_vector()

    def new_tangent(self) -> Mat:
        """Matrix for `tangent`."""
        return self._tangent.new_matrix()

    def evaluate(self, x: Vec) -> Floats:
        """Residual of the unknowns this rank owns.

        Args:
            x: Displacements, length.

        Returns:
            Residual, force; NaN everywhere where a law has no answer.
        """
        self._u.x.array[: x.getLocalSize()] = x.array_r
        self._u.x.scatter_forward()
        self._balance = self.assembly.balance(TrialState(x, self.nodal, np.zeros(0)))
        return self.balance.residual

    def tangent(self, x: Vec, out: Mat) -> bool:
        """Write d residual / d x into a matrix of `new_tangent`; whether its pattern has grown.

        Args:
            x: Displacements, length.
            out: The matrix.

        Returns:
            Whether entries were added to its pattern.
        """
        self.evaluate_at(x)
        return self._tangent.write(out)

    @property
    @override
    def nodal(self) -> Floats:
        return self._unknowns.nodal(self._u.x.array)

    @override
    def evaluate_at(self, x: Vec) -> None:
        if not np.array_equal(self._u.x.array[: x.getLocalSize()], x.array_r):
            self.evaluate(x)

    def begin(self, x: Vec) -> None:
        """Begin a solution: what is at work at its start weighs the fields; collective.

        Args:
            x: The start, length.

        Raises:
            InputError: A part of the mesh can move as a rigid body.
        """
        self._check_supported(x)
        self.fields.measure(self.assembly.bodies)
        self.fields.weigh_by(lambda: self._start(x))

    def _start(self, x: Vec) -> ForceBalance:
        """Balance of the state from which a solution starts, of which nothing stays."""
        self.evaluate(x)
        self.assembly.terms.roll_back()
        return self.balance

    def check_finite(self) -> None:
        """Refuse a start, or a condition, with values that are no numbers; collective.

        Raises:
            InputError: There are some: names of what, and how many.
        """
        x, space = self.new_vector(), self._u.function_space
        given = {"u": self._u.x.array}
        for i, bc in enumerate(self._bcs):
            given[f"bcs[{i}]"] = Dirichlet([bc], space).violation(x)
        x.destroy()
        for name, values in given.items():
            count = self.comm.allreduce(int((~np.isfinite(values)).sum()))
            if count:
                raise InputError(f"{count} values that are not finite given", name)

    def _check_supported(self, x: Vec) -> None:
        """Refuse a part of the mesh that can move as a rigid body."""
        if not self._unsupported.untouched():
            return
        self.evaluate(x)  # rigid bodies may have been moved since
        free = self._unsupported.untouched()
        self.assembly.terms.roll_back()
        self._unsupported.check(free, "contacts" if self._contacts else "bcs")
