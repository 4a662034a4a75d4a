"""Newton's method on the contact unknowns, as the load steps see it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import PETSc, Vec
from anisocontact.solver.strategies.condensed.condensed import Condensed
from anisocontact.solver.strategies.condensed.system import ContactSystem
from anisocontact.solver.strategies.database import OptionValue
from anisocontact.solver.strategies.newton import Newton, NewtonResult
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.term import SingularError

#: How often an increment may begin anew because a slave point has left the reach.
_MOST_GROWTHS = 6
#: The linear system is solved by `ContactSystem.apply`.
_LINEAR: dict[str, OptionValue] = {"ksp_type": "preonly", "pc_type": "python"}


class CondensedNewton:
    """What `Newton` is for a whole system, with vectors of all unknowns.

    Args:
        condensed: The condensed problem.
        prefix: Prefix of the PETSc options.
        options: PETSc options of SNES without prefix.
        on_iteration: Called with the number of the iteration and the residual.
    """

    def __init__(
        self,
        condensed: Condensed,
        prefix: str,
        options: Mapping[str, OptionValue],
        on_iteration: Callable[[int, float], None],
    ) -> None:
        self._condensed, self._prefix, self._options = condensed, prefix, dict(options)
        self._on_iteration = on_iteration
        self._system: ContactSystem | None = condensed.known
        self._newton: Newton | None = None
        self._size = 0

    @property
    def residual(self) -> Floats:
        """Residual of all unknowns at the last iterate; the interior is in equilibrium."""
        out = np.zeros(self._size)
        if self._newton is not None and self._system is not None:
            out[self._system.places] = self._newton.residual
        return out

    def solve(
        self, x: Vec, full_steps: bool = False, damping: Callable[[], float] | None = None
    ) -> NewtonResult:
        """Correct `x` until it is in equilibrium or no more can be done.

        Args:
            x: Start, overwritten by the last iterate where it is contact or prescribed, length.
            full_steps: Whether to go without line search.
            damping: Asked before every correction what share of it is to be taken, 0 to 1.

        Returns:
            What came of it.
        """
        self._size = x.getLocalSize()
        result = NewtonResult(0, [], "")
        for _ in range(_MOST_GROWTHS):
            known = self._system
            try:
                newton, system = self._prepared()
            except SingularError as error:
                return NewtonResult(0, [], f"{error} (a body without support?)")
            own = system.new_vector()
            if known is None or not np.isin(system.places, known.places).all():
                # what has come into reach just now has no extrapolation
                self._condensed.accepted().copy(x)
                system.contact_term.predict(0.0)
            own.array[:] = x.array_r[system.places]
            result = newton.solve(own, full_steps, damping)
            if not (result.reason and system.outgrown):
                break
            self._condensed.grow()
        x.array[:] = system.all_unknowns(own.array_r)
        return result

    def persistent(self) -> Arrays:
        """What the next increments depend on beside the state of the problem."""
        return self._condensed.persistent()

    def close(self) -> None:
        """Give back PETSc's objects and the factors; the problem is brought up to date."""
        self._condensed.close()
        self._drop()

    def _prepared(self) -> tuple[Newton, ContactSystem]:
        system = self._condensed.prepare()
        if self._newton is None or system is not self._system:
            self._drop()
            self._system = system
            options = self._options | _LINEAR
            self._newton = Newton(system, self._prefix, options, self._on_iteration)
            system.forcing.tolerance = self._newton.snes.getTolerances()[0]
            pc = self._newton.snes.getKSP().getPC()
            pc.setType(PETSc.PC.Type.PYTHON)
            pc.setPythonContext(system)
        return self._newton, system

    def _drop(self) -> None:
        if self._newton is not None:
            self._newton.close()
        self._newton = None
