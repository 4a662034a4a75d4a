"""Bodies at finite strain: forces and tangent assembled anew at every state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from anisocontact.base.fenicsx import (
    Mat,
    PETSc,
    Vec,
    assemble_force,
    assemble_into,
    compiled,
    create_force,
    create_stiffness,
    fem,
    ufl,
)
from anisocontact.bulk.history import BodyHistory
from anisocontact.bulk.materials import Density, Material, body_measure
from anisocontact.mesh import Model


class NonlinearBulk:
    """Internal forces of bodies of any material, with the exact tangent by UFL.

    Args:
        model: Mesh with its bodies.
        materials: Body name -> material, one for each body; linear ones may be among them.

    Attributes:
        histories: What bodies whose material has a history have gone through, by body name.
    """

    def __init__(self, model: Model, materials: Mapping[str, Material]) -> None:
        self._u: Any = fem.Function(model.space)
        v, du = ufl.TestFunction(model.space), ufl.TrialFunction(model.space)
        self._dt: Any = fem.Constant(model.mesh, 0.0)
        # full integration of the stiffness at rest; UFL's own estimate grows with every power of J
        full = 2 * model.order
        given: Mapping[str, Any] = materials
        self.histories = {
            name: BodyHistory(law, model, name, self._u, self._dt, full)
            for name, law in given.items()
            if hasattr(law, "history")
        }
        work, energy = _forms(model, {**given, **self.histories}, self._u, v, full)
        self._comm = model.mesh.comm
        self._work = compiled(work, self._comm)
        self._tangent = compiled(ufl.derivative(work, self._u, du), self._comm)
        self._energy = None if energy is None else compiled(energy, self._comm)
        #: Whether `energy` is that of all bodies: every material has one.
        self.stores = energy is not None
        self.stiffness = create_stiffness(self._tangent)
        self._force = create_force(self._work)
        #: Length whose strain is round-off where nothing moves: F = I + grad(u) is rounded over
        #: the size of a cell.
        self.rest_length = _cell_size(model)
        #: Diagonal of the tangent at rest: the scale of forces that displacements of one unit make.
        self.diagonal = self.stiffness.getDiagonal()

    def force(self, u: Vec) -> Vec:
        """Internal force.

        Args:
            u: Displacement of the nodes this rank owns, length.

        Returns:
            The force; the vector is overwritten by the next call.
        """
        self._set(u)
        assemble_force(self._work, self._force)
        return self._force

    def energy(self, u: Vec) -> float:
        """Elastic energy.

        Args:
            u: Displacement of the nodes this rank owns, length.

        Returns:
            The energy over all ranks, force times length; 0 where a material has a stress but no
            energy.
        """
        if self._energy is None:
            return 0.0
        self._set(u)
        return float(self._comm.allreduce(fem.assemble_scalar(self._energy)))

    def tangent(self, out: Mat) -> None:
        """Write the tangent of the last `force` or `energy` into a matrix.

        Args:
            out: A matrix that has room for it.
        """
        out.zeroEntries()
        assemble_into(out, self._tangent)
        out.assemble(PETSc.Mat.AssemblyType.FINAL)

    def set_time(self, dt: float) -> None:
        """Take over the time increment of the next states."""
        self._dt.value = dt

    def commit(self, u: Vec) -> None:
        """Accept a state: histories advance.

        Args:
            u: Displacement of the nodes this rank owns, length.
        """
        if self.histories:
            self._set(u)
        for history in self.histories.values():
            history.commit()

    def _set(self, u: Vec) -> None:
        self._u.x.array[: len(u.array_r)] = u.array_r
        self._u.x.scatter_forward()


def _cell_size(model: Model) -> float:
    """Cube root of the mean volume of a cell."""
    comm, cells = model.mesh.comm, model.mesh.topology.index_map(3)
    one = compiled(fem.Constant(model.mesh, 1.0) * ufl.dx(domain=model.mesh), comm)
    volume = comm.allreduce(fem.assemble_scalar(one))
    return float(np.cbrt(volume / cells.size_global))


def _forms(
    model: Model, laws: Mapping[str, Any], u: Any, v: Any, full: int
) -> tuple[Any, Any | None]:
    """Virtual work of the stresses and, where every material has one, the energy."""
    dx = body_measure(model)
    work, energy = 0, 0
    complete = all(law.linear or hasattr(law, "energy") for law in laws.values())
    for i, name in enumerate(model.body_names()):
        material = laws[name]
        if material.linear:
            half = 0.5 * ufl.inner(material.stress(u), ufl.sym(ufl.grad(u)))
            terms: Sequence[Density] = [(half, None)]
        elif hasattr(material, "energy"):
            terms = material.energy(u)
        else:
            work += ufl.inner(material.piola(u), ufl.grad(v)) * dx(i, degree=full)
            continue
        for density, degree in terms:
            part = density * dx(i, degree=full if degree is None else degree)
            energy += part
            work += ufl.derivative(part, u, v)
    return work, energy if complete else None
