"""The tangent of a system: its terms and constraints in one matrix."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.contact.reachable import NodePairs
from anisocontact.solver.system.assembly import Assembly
from anisocontact.solver.system.coupled import CoupledTangent
from anisocontact.solver.system.prediction import ContactPrediction
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.step import Step


class Tangent:
    """Derivative of the residual at the state of the last evaluation.

    Args:
        assembly: The terms.
        coupling: Whether terms other than contacts couple nodes of different cells.

    Attributes:
        coupled: Couplings between bodies, of nodes and of rigid bodies; None where there cannot be
            any.
    """

    def __init__(self, assembly: Assembly, coupling: bool = False) -> None:
        self._assembly = assembly
        self._comm = assembly.layout.comm
        self._stiffness = assembly.bodies.bulk.stiffness
        self._meshed = assembly.contacts.meshed
        extra = assembly.rigid.size // 3
        self.coupled = (
            CoupledTangent(self._stiffness, assembly.layout.unknowns, extra)
            if self._meshed or extra or coupling
            else None
        )
        self._prediction: ContactPrediction | None = None
        self._step: Step | None = None
        self._load_factor = 0.0
        self._restored = False

    def predict_contact(self, steps: Sequence[Step]) -> None:
        """Have places in the pattern for what contact will need in these steps."""
        if self._meshed:
            self._prediction = ContactPrediction(self._meshed, steps)

    def begin(self, step: Step) -> None:
        """Take it that a step begins."""
        self._step, self._load_factor = step, 0.0

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
        matrix = self._stiffness.duplicate()
        matrix.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        return matrix

    def write(self, out: Mat, load_factor: float = 0.0) -> bool:
        """Write the tangent at a fraction of the step into a matrix of `new_matrix`.

        Returns:
            Whether its pattern has grown.
        """
        assembly, self._load_factor = self._assembly, load_factor
        grown = False
        if self.coupled is not None:
            couplings = assembly.rigid.body_couplings(self.coupled.first_extra)
            couplings += assembly.terms.couplings()
            if assembly.rigid.faces:
                for one in assembly.rigid.faces.handed_rows(self.coupled.first_extra):
                    couplings = one.couplings(couplings)
                couplings += assembly.rigid.faces.room(couplings, self.coupled.first_extra)
            pairs = [(rows, columns) for rows, columns, _ in couplings]
            couplings += [(*one, _nothing(one)) for one in assembly.constraints.room(pairs)]
            grown = self.coupled.make_room(out, couplings, self._foreseen)
        assembly.terms.add_tangent(out)
        out.assemble()
        if self.coupled is not None:
            self.coupled.add(out)
        assembly.constraints.transform(out, assembly.scale)
        rows = np.concatenate([assembly.conditions.unknowns, assembly.prescribed_of_bodies()])
        assembly.fields.prescribe(out, rows, assembly.scale)
        return grown

    def _foreseen(self) -> Sequence[NodePairs]:
        prediction = self._prediction
        found = [] if prediction is None else prediction.pairs(self._step, self._load_factor)
        found = [*found, *self._assembly.constraints.room(found)]
        faces = self._assembly.rigid.faces
        if faces and self.coupled is not None:
            for one in faces.handed_rows(self.coupled.first_extra):
                found = one.pairs(found)
            couplings = [(*one, _nothing(one)) for one in found]
            room = faces.room(couplings, self.coupled.first_extra)
            found += [(rows, columns) for rows, columns, _ in room]
        return found


def _nothing(pairs: NodePairs) -> Floats:
    """Blocks of zeros between single nodes."""
    return np.zeros((len(pairs[0]), 3, 3))
