"""All multi-point constraints of a problem: ties of middle nodes, then symmetry planes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.fenicsx import Mat, Vec
from anisocontact.solver.terms.constraint import Constraint
from anisocontact.solver.terms.symmetry import SymmetryPlanes

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


class Constraints:
    """Works the constraints into the equations, one after the other.

    Args:
        like: A vector of the unknowns; those of the mesh come first.
        ties: Ties of middle nodes, if there are any.
        planes: Symmetry planes, if there are any.
    """

    def __init__(
        self, like: Vec, ties: Constraint | None = None, planes: SymmetryPlanes | None = None
    ) -> None:
        self._like, self._ties, self._planes = like, ties, planes

    @property
    def on_planes(self) -> Ints:
        """Unknowns of this rank that follow from others on symmetry planes, local numbers."""
        return np.zeros(0, dtype=np.int64) if self._planes is None else self._planes.slaves

    def tied(self, force: Floats) -> Floats:
        """Forces on the mesh, those of tied nodes handed to the corners they follow."""
        return force if self._ties is None else self._handed(self._ties, force)

    def reduce(self, residual: Floats, x: Vec, scale: float) -> Floats:
        """Residual of the mesh with the constraints worked in, of the unknowns of this rank.

        Args:
            residual: Without them, force.
            x: All unknowns.
            scale: Force for a violation of one unit of length.
        """
        for constraint in self._all():
            violation = constraint.violation(x).array_r[: len(residual)]
            residual = self._handed(constraint, residual) + scale * violation
        return residual

    def handed(self, force: Floats) -> Floats:
        """Forces on the mesh as the equations have them, without the violation of constraints."""
        for constraint in self._all():
            force = self._handed(constraint, force)
        return force

    def transform(self, matrix: Mat, scale: float) -> None:
        """The same for the tangent, in place."""
        for constraint in self._all():
            constraint.transform(matrix, scale)

    def gathering(self) -> scipy.sparse.csr_array | None:
        """R that hands the forces of slaves to their masters; None without constraints.

        The displacements that satisfy the constraints are `R^T v`. On one process.
        """
        product = None
        for constraint in self._all():
            own = constraint.gathering()
            product = own if product is None else own @ product
        return product

    def followers(self) -> Ints:
        """Unknowns of this rank that follow from others, local numbers."""
        return np.concatenate([np.zeros(0, dtype=np.int64), *(c.followers for c in self._all())])

    def involved(self) -> npt.NDArray[np.bool_]:
        """Unknowns of this rank that follow from others, or others from them."""
        found = np.zeros(self._like.getLocalSize(), dtype=np.bool_)
        for constraint in self._all():
            found |= constraint.involved()
        return found

    def spread(self, columns: Mat) -> Mat:
        """Displacements in which all that is constrained follows; takes the matrix over."""
        for constraint in reversed(self._all()):
            columns = constraint.spread(columns)
        return columns

    def _all(self) -> list[Constraint]:
        found = (self._ties, self._planes.constraint if self._planes else None)
        return [constraint for constraint in found if constraint is not None]

    def _handed(self, constraint: Constraint, force: Floats) -> Floats:
        vector = self._like.duplicate()
        vector.array[: len(force)] = force
        return np.array(constraint.gather(vector).array_r[: len(force)])
