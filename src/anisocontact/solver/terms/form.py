"""Bodies and conditions of a script: a form in UFL, Dirichlet conditions of DOLFINx."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.compiled_forms import compiled
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import (
    Mat,
    Vec,
    assemble_force,
    create_force,
    prescribe,
    prescribed_rows,
    prescribes_in,
    ufl,
)
from anisocontact.base.form_matrix import FormMatrix
from anisocontact.bulk import AtPoints, Heated


class FormBulk:
    """Internal forces by a residual form of the user's, as of `NonlinearBulk`.

    Args:
        F: Residual form, linear in its test function, of the function `u`.
        u: The displacement; forces are those at its values.
        J: Derivative of F; made by UFL if left out.

    Raises:
        InputError: F is no residual of `u`, or J no derivative of one.

    Attributes:
        finite: Whether J depends on `u`.
    """

    rest_length = 0.0
    stores = False
    #: What a form remembers is the user's.
    histories: Mapping[str, AtPoints] = MappingProxyType({})
    #: Nor is its temperature known.
    heated: Mapping[str, Heated] = MappingProxyType({})
    #: Pressures are among the unknowns of the form.
    pressures: Mapping[str, Any] = MappingProxyType({})
    #: No volume is kept by pressures that are not.
    hardness, volume = 0.0, None

    def __init__(self, F: Any, u: Any, J: Any = None) -> None:
        space = u.function_space
        _check_form("F", F, u, ("test function",))
        if J is not None:
            _check_form("J", J, u, ("test function", "trial function"))
        tangent = ufl.derivative(F, u, ufl.TrialFunction(space)) if J is None else J
        self._residual = compiled(F, space.mesh.comm)
        self._tangent = FormMatrix(compiled(tangent, space.mesh.comm))
        self.finite = u in ufl.algorithms.expand_derivatives(tangent).coefficients()
        self.stiffness = self._tangent.matrix
        self.diagonal = self.yielding = self.stiffness.getDiagonal()
        self._force = create_force(self._residual)

    def force(self, u: Vec) -> Vec:
        """Internal force at the values of the function."""
        assemble_force(self._residual, self._force)
        return self._force

    def follow(self, u: Vec | None, in_full_alone: bool = False) -> bool:
        """Nothing follows: pressures are among the unknowns."""
        return False

    def energy(self, u: Vec) -> float:
        """Unknown: a form has none."""
        return 0.0

    def set_pressures(self, u: Any) -> None:
        """Nothing: the form has its own."""

    def dissipated(self) -> float:
        """Unknown as well."""
        return 0.0

    def heating(self, start: Vec, u: Vec, before: Mapping[str, float]) -> tuple[float, float]:
        """Nothing: temperatures are those of the form."""
        return 0.0, 0.0

    def set_time(self, dt: float) -> None:
        """Nothing: the form has its own time."""

    def commit(self, u: Vec) -> None:
        """Nothing: what the form remembers is the user's."""

    def tangent(self, out: Mat, *, again: bool = False, elastic_share: float = 0.0) -> None:
        """Write the derivative at the values of the function, or what was written last.

        A form has no other tangent, whatever the share of the elastic one is to be.
        """
        self._tangent.write(out, again=again)

    def times(self, x: Vec) -> Vec:
        """The product of what `tangent` has written last with a vector, on one process."""
        out = x.duplicate()
        self._tangent.times(x, out)
        return out


class Dirichlet:
    """Dirichlet conditions as the system takes them; see `PrescribedUnknowns`.

    Args:
        bcs: The conditions; their values may change.
        space: Space of the unknowns.

    Raises:
        InputError: A condition lives on another space, whose numbers mean other unknowns.
    """

    def __init__(self, bcs: Sequence[Any], space: Any) -> None:
        for i, bc in enumerate(bcs):
            if not prescribes_in(bc, space):
                raise InputError("is defined on another space than u", f"bcs[{i}]")
        self._bcs = bcs

    @property
    def unknowns(self) -> Ints:
        """Unknowns this rank owns that are prescribed, local numbers."""
        return prescribed_rows(self._bcs).astype(np.int64)

    def violation(self, x: Vec) -> Floats:
        """How far these are from what is prescribed, length."""
        off = x.duplicate()
        prescribe(off, self._bcs, x)
        found = np.array(off.array_r[self.unknowns])
        off.destroy()
        return found


def _check_form(name: str, form: Any, u: Any, needed: Sequence[str]) -> None:
    """Refuse a form that has other arguments than a residual of u, or its derivative.

    Raises:
        InputError: It has.
    """
    arguments, own = form.arguments(), u.function_space
    if len(arguments) != len(needed):
        text = f"a form with {len(arguments)} arguments given, one with a {' and a '.join(needed)}"
        raise InputError(f"{text} needed", name)
    for argument, what in zip(arguments, needed, strict=True):
        space = argument.ufl_function_space()
        if (space.ufl_element(), space.ufl_domain()) != (own.ufl_element(), own.ufl_domain()):
            raise InputError(f"its {what} is of another space than u", name)
    if name == "F" and u not in form.coefficients():
        raise InputError("does not depend on u: the residual at the function u needed", name)
