"""Bodies whose stiffness does not change: assembled once for a whole run."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any

from anisocontact.base.array_types import Floats
from anisocontact.base.compiled_forms import compiled
from anisocontact.base.fenicsx import Mat, Vec, fem, ufl
from anisocontact.base.form_matrix import add_matrix
from anisocontact.base.form_rows import create_stiffness
from anisocontact.base.places_in_matrix import PlacesInMatrix
from anisocontact.bulk.at_points import AtPoints
from anisocontact.bulk.cell_energy import CellIntegrals
from anisocontact.bulk.expansion import Heated
from anisocontact.bulk.materials import Material, body_measure, linear_parts
from anisocontact.bulk.pressures import CellPressures
from anisocontact.mesh import Model


class LinearBulk:
    """Stiffness of all bodies, `K u` and `u.K u / 2`.

    Args:
        model: Mesh with its bodies.
        materials: Body name -> linear material, for each body that has a stiffness.

    Example:
        >>> import numpy as np
        >>> from anisocontact.bulk import make_material
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        >>> bulk = LinearBulk(model, {"block": make_material("linear-elastic", E=1.0, nu=0.0)})
        >>> u = bulk.stiffness.createVecRight()
        >>> u.array[:] = 1.0
        >>> bool(np.abs(bulk.force(u).array_r).max() < 1e-14)  # all nodes moved by the same
        True
    """

    #: Length whose strain is round-off where nothing moves: none, `K 0` is exactly zero.
    rest_length = 0.0
    #: Whether a body is at finite strain.
    finite = False
    #: Whether `energy` is that of all bodies.
    stores = True
    #: Linear materials have no history.
    histories: Mapping[str, AtPoints] = MappingProxyType({})

    #: They do not expand: a body that does is no linear one.
    heated: Mapping[str, Heated] = MappingProxyType({})

    def __init__(self, model: Model, materials: Mapping[str, Material]) -> None:
        dx = body_measure(model)
        self._model, self._bilinear = model, _bilinear_form(model, materials, dx)
        form = compiled(self._bilinear, model.mesh.comm)
        self.stiffness = create_stiffness(form)
        self._places = PlacesInMatrix(self.stiffness)
        self._u: Any = fem.Function(model.space)
        self._pressures = CellPressures(model, materials, self._u, dx)
        self._pressures.add_tangent(self.stiffness)
        #: As of `CellPressures`.
        self.pressures = self._pressures.of
        self._force = self.stiffness.createVecLeft()
        #: Diagonal of K: the scale of forces that displacements of one unit make.
        self.diagonal = self.stiffness.getDiagonal()
        #: The same for surfaces that give way by shear, as of `CellPressures`.
        self.yielding = self._pressures.yielding(self.diagonal)
        #: As of `CellPressures`.
        self.hardness = self._pressures.hardness

    def force(self, u: Vec) -> Vec:
        """Internal force `K u`.

        Args:
            u: Displacement of the nodes this rank owns, length.

        Returns:
            The force; the vector is overwritten by the next call.
        """
        self.stiffness.mult(u, self._force)
        return self._force

    def follow(self, u: Vec | None, in_full_alone: bool = False) -> bool:
        """Nothing follows: pressures are linear in the displacement."""
        return False

    def energy(self, u: Vec) -> float:
        """Elastic energy `u.K u / 2`.

        Args:
            u: Displacement of the nodes this rank owns, length.

        Returns:
            The energy over all ranks, force times length.
        """
        return 0.5 * float(u.dot(self.force(u)))

    @cached_property
    def _of_cells(self) -> CellIntegrals:
        once = ufl.action(self._bilinear, self._u)
        return CellIntegrals(ufl.action(0.5 * once, self._u), self._model)

    def cell_energies(self, u: Any) -> Floats:
        """Energy that each cell of this rank stores, force times length, (cells,); collective.

        Args:
            u: Displacement, a DOLFINx function.
        """
        self.set_pressures(u)
        found = self._of_cells()
        return found + self._pressures.cell_energies(len(found))

    def set_pressures(self, u: Any) -> None:
        """Bring `pressures` to a displacement, a DOLFINx function; collective."""
        self._u.x.array[:] = u.x.array
        self._pressures.evaluate()

    def dissipated_by_body(self) -> dict[str, float]:
        """No body has a history."""
        return {}

    def dissipated(self) -> float:
        """Linear materials dissipate nothing."""
        return 0.0

    def heating(self, start: Vec, u: Vec, before: Mapping[str, float]) -> tuple[float, float]:
        """Nothing: bodies that expand with their temperature are no linear ones."""
        return 0.0, 0.0

    def set_time(self, dt: float) -> None:
        """Take over a time increment, which changes nothing."""

    def commit(self, u: Vec) -> None:
        """Accept a state, which changes nothing."""

    def tangent(self, out: Mat, *, again: bool = False, elastic_share: float = 0.0) -> None:
        """Write the stiffness into a matrix.

        Args:
            out: A matrix that has room for it and may have more unknowns.
            again: Whether it may be what the last call has written: it is always that.
            elastic_share: Of bodies that flow, which these do not.
        """
        out.zeroEntries()
        if not self._places.copy(out):
            add_matrix(out, self.stiffness)
        out.assemble()

    @property
    def volume(self) -> CellPressures | None:
        """Changes of volume that are kept apart; None where there are none."""
        return self._pressures if self._pressures.of else None

    def times(self, x: Vec) -> Vec:
        """The product of the stiffness with a vector."""
        out = x.duplicate()
        self.stiffness.mult(x, out)
        return out


def _bilinear_form(model: Model, materials: Mapping[str, Material], dx: Any) -> Any:
    u, v = ufl.TrialFunction(model.space), ufl.TestFunction(model.space)
    ideal = model.idealisation
    if model.mesh.topology.cell_name() in ("hexahedron", "quadrilateral") or ideal.turn.any():
        # full integration; UFL's own estimate counts the bending of the cell's sides, three times
        # the points
        dx = dx(metadata={"quadrature_degree": 2 * model.order})
    law: Mapping[str, Any] = materials
    weight, strain = ideal.weight(model.mesh), ufl.sym(ideal.gradient(v))
    return sum(
        weight * ufl.inner(ideal.stress(stress, u), strain) * dx(i, degree=degree)
        for i, name in enumerate(model.body_names())
        if name in law
        for stress, degree in linear_parts(law[name], u)
    )
