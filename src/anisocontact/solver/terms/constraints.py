"""All multi-point constraints of a problem: middle nodes, ties, guided nodes, faces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.fenicsx import Mat, Vec
from anisocontact.contact.reachable import NodePairs
from anisocontact.solver.terms.constraint import Constraint
from anisocontact.solver.terms.faces import CoupledFaces
from anisocontact.solver.terms.inclined_supports import InclinedSupports
from anisocontact.solver.terms.tied_faces import TiedFaces


class Constraints:
    """Works the constraints into the equations, one after the other.

    Args:
        like: A vector of the unknowns; those of the mesh come first.
        middles: Middle nodes that follow corners, if there are any.
        ties: Faces that are tied to others, if there are any.
        inclined: Symmetry planes and cylindrical supports, if there are any.
        faces: Faces that follow rigid bodies, if there are any.
    """

    def __init__(
        self,
        like: Vec,
        middles: Constraint | None = None,
        ties: TiedFaces | None = None,
        inclined: InclinedSupports | None = None,
        faces: CoupledFaces | None = None,
    ) -> None:
        self._like, self._middles, self._inclined = like, middles, inclined
        #: Faces that are tied to others; None if there are none.
        self.ties = ties
        self._faces = faces if faces else None

    def __bool__(self) -> bool:
        """Whether there are any beside faces that follow rigid bodies, before a step too."""
        planes = self._inclined is not None and bool(self._inclined.groups)
        return planes or self.ties is not None or self._middles is not None

    @property
    def holding(self) -> Ints:
        """Unknowns of this rank that inclined supports and faces let follow others, local."""
        found = [] if self._inclined is None else [self._inclined.slaves]
        found += [] if self._faces is None else [self._faces.dependents]
        return np.concatenate([np.zeros(0, dtype=np.int64), *found])

    def tied(self, force: Floats) -> Floats:
        """Forces on the mesh, those of nodes that follow other nodes handed to these."""
        for constraint in self._between_nodes():
            force = self._handed(constraint, force)
        return force

    def room(self, pairs: Sequence[NodePairs]) -> list[NodePairs]:
        """Nodes that ties couple, beside `pairs` and those of cells, see `TiedFaces.room`."""
        return [] if self.ties is None else self.ties.room(pairs)

    def links(self) -> Ints:
        """Nodes that ties connect, (k, 2), see `TiedFaces.connected`."""
        return np.zeros((0, 2), dtype=np.int64) if self.ties is None else self.ties.connected()

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
        if self._faces is not None:
            here = np.array(x.array_r[: len(residual)])
            residual[self._faces.dependents] = 0.0
            residual += scale * self._faces.violation(here)
        return residual

    def handed(self, force: Floats) -> Floats:
        """Forces on the mesh as the equations have them, without the violation of constraints."""
        for constraint in self._all():
            force = self._handed(constraint, force)
        if self._faces is not None:
            force[self._faces.dependents] = 0.0
        return force

    def transform(self, matrix: Mat, scale: float) -> None:
        """The same for the tangent, in place."""
        for constraint in self._all():
            constraint.transform(matrix, scale)
        if self._faces is not None:
            self._faces.transform(matrix, scale, self._like)

    def gathering(self) -> scipy.sparse.csr_array | None:
        """R that hands the forces of slaves to their masters; None without constraints.

        The displacements that satisfy the constraints are `R^T v`. On one process.
        """
        product = None
        for constraint in self._all():
            own = constraint.gathering()
            product = own if product is None else own @ product
        return product

    def dependents(self) -> Ints:
        """Unknowns of this rank that follow from others, local numbers."""
        found = [constraint.dependents for constraint in self._all()]
        found += [] if self._faces is None else [self._faces.dependents]
        return np.concatenate([np.zeros(0, dtype=np.int64), *found])

    def involved(self) -> Flags:
        """Unknowns of this rank that follow from others, or others from them."""
        found = np.zeros(self._like.getLocalSize(), dtype=np.bool_)
        for constraint in self._all():
            found |= constraint.involved()
        return found if self._faces is None else found | self._faces.involved(self._like)

    def spread(self, columns: Mat) -> Mat:
        """Displacements in which all that is constrained follows; takes the matrix over."""
        if self._faces is not None:
            columns = self._faces.spread(columns, self._like)
        for constraint in reversed(self._all()):
            columns = constraint.spread(columns)
        return columns

    def _all(self) -> list[Constraint]:
        inclined = self._inclined.constraint if self._inclined else None
        return self._between_nodes() + ([] if inclined is None else [inclined])

    def _between_nodes(self) -> list[Constraint]:
        found = (self._middles, None if self.ties is None else self.ties.constraint)
        return [constraint for constraint in found if constraint is not None]

    def _handed(self, constraint: Constraint, force: Floats) -> Floats:
        vector = self._like.duplicate()
        vector.array[: len(force)] = force
        return np.array(constraint.gather(vector).array_r[: len(force)])
