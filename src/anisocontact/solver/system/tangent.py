"""The tangent of a problem: bodies, contacts and constraints in one matrix."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.contact.reachable import NodePairs
from anisocontact.solver.stepping.steps import Step
from anisocontact.solver.system.ahead import Ahead
from anisocontact.solver.system.coupled import CoupledTangent
from anisocontact.solver.system.parts import Parts
from anisocontact.solver.system.persistent import Arrays


class Tangent:
    """Derivative of the residual at the state of the last evaluation.

    Args:
        parts: Parts of the problem.
        space: Vector space of the displacement.

    Attributes:
        coupled: Couplings between bodies, of nodes and of rigid bodies; None where there cannot be
            any.
    """

    def __init__(self, parts: Parts, space: Any) -> None:
        self._parts = parts
        self._comm = space.mesh.comm
        contacts = parts.contacts
        self._analytic: list[Any] = [p for c in contacts if not c.meshed for p in c.passes]
        self._meshed: list[Any] = [p for c in contacts if c.meshed for p in c.passes]
        extra = parts.rigid.size // 3
        self.coupled = (
            CoupledTangent(parts.bulk.stiffness, space, extra)
            if self._meshed or extra or parts.attached.coupling
            else None
        )
        self._ahead: Ahead | None = None
        self._step: Step | None = None
        self._level = 0.0
        self._restored = False

    def look_ahead(self, steps: Sequence[Step]) -> None:
        """Have places in the pattern for what contact will need in these steps."""
        if self._meshed:
            self._ahead = Ahead(self._meshed, steps)

    def begin(self, step: Step) -> None:
        """Take it that a step begins."""
        self._step, self._level = step, 0.0

    def persistent(self) -> Arrays:
        """Couplings that have a place, on one process: numbers of nodes are those of it."""
        if self.coupled is None or self._comm.size > 1:
            return {}
        return {"couplings": self.coupled.pattern}

    def restore(self, kept: Arrays) -> None:
        """Go on from what `persistent` gave, among other things."""
        if self.coupled is not None and self._comm.size == 1 and "couplings" in kept:
            self.coupled.pattern = kept["couplings"]
            self._restored = True

    def new_matrix(self) -> Mat:
        """Matrix for `write`."""
        if self.coupled is not None:
            # a run that goes on has the pattern that it had
            return self.coupled.new_matrix([] if self._restored else self._foreseen())
        matrix = self._parts.bulk.stiffness.duplicate()
        matrix.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        return matrix

    def write(self, out: Mat, level: float) -> bool:
        """Write the tangent at a fraction of the step into a matrix of `new_matrix`.

        Returns:
            Whether its pattern has grown.
        """
        parts, self._level = self._parts, level
        grown = False
        if self.coupled is not None:
            couplings = [k for c in self._meshed for k in c.couplings()]
            couplings += parts.rigid.couplings(self.coupled.first_extra)
            couplings += parts.attached.couplings()
            grown = self.coupled.make_room(out, couplings, self._foreseen)
        parts.bulk.tangent(out)
        for contact in self._analytic:
            contact.add_tangent(out)
        parts.loads.add_tangent(out)
        parts.attached.add_tangent(out)
        parts.stabilisation.add_tangent(out)
        out.assemble()
        if self.coupled is not None:
            self.coupled.add(out)
        parts.constraints.transform(out, parts.support_scale)
        rows = np.concatenate([parts.supports.unknowns, led_unknowns(parts)])
        first, _ = out.getOwnershipRange()
        out.zeroRows((first + rows).astype(PETSc.IntType), parts.support_scale)
        return grown

    def _foreseen(self) -> Sequence[NodePairs]:
        return [] if self._ahead is None else self._ahead.pairs(self._step, self._level)


def led_unknowns(parts: Parts) -> npt.NDArray[np.int64]:
    """Unknowns of rigid bodies on this rank that are prescribed, local numbers."""
    if not parts.layout.last_rank:
        return np.zeros(0, dtype=np.int64)
    return parts.layout.owned + np.flatnonzero(parts.rigid.held())
