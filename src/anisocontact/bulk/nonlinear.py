"""Bodies at finite strain: forces and tangent assembled anew at every state."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.compiled_forms import compiled
from anisocontact.base.errors import InputError, within
from anisocontact.base.fenicsx import Mat, Vec, assemble_force, create_force, fem, ufl
from anisocontact.base.form_matrix import FormMatrix
from anisocontact.bulk.cell_energy import CellIntegrals
from anisocontact.bulk.expansion import Heated, ThermalExpansion, without_expansion
from anisocontact.bulk.history import BodyHistory
from anisocontact.bulk.materials import Material, body_measure, small_strain
from anisocontact.bulk.point_law import BodyPoints
from anisocontact.bulk.pressures import CellPressures
from anisocontact.bulk.thermal_work import ThermalWork
from anisocontact.bulk.virtual_work import Forms
from anisocontact.mesh import Model


class NonlinearBulk:
    """Internal forces of bodies of any material, with the exact tangent by UFL.

    Args:
        model: Mesh with its bodies.
        materials: Body name -> material, for each body that has a stiffness; linear ones may be
            among them.

    Raises:
        InputError: A material has no stiffness at rest.

    Attributes:
        histories: What bodies whose material has a history have gone through, by body name.
        heated: Bodies that expand with their temperature, by name.
    """

    def __init__(self, model: Model, materials: Mapping[str, Material]) -> None:
        self._u: Any = fem.Function(model.space)
        v, du = ufl.TestFunction(model.space), ufl.TrialFunction(model.space)
        self._dt: Any = fem.Constant(model.mesh, 0.0)
        # full integration of the stiffness at rest; UFL's own estimate grows with every power of J
        full = 2 * model.order
        given: Mapping[str, Any] = {name: without_expansion(law) for name, law in materials.items()}
        self.heated: dict[str, Heated] = _heated(materials, model)
        dx = body_measure(model)
        self._pressures = CellPressures(model, given, self._u, dx, self.heated)
        self.histories = self._histories(model, given, full)
        self._thermal_work = ThermalWork(model, self.heated, self.histories, full)
        self._points = [b for b in self.histories.values() if isinstance(b, BodyPoints)]
        laws = {**given, **self.histories}
        forms = Forms(model, laws, self.heated, self._u, v, du, dx, full)
        work = forms.work + self._pressures.work(v)
        self._comm = model.mesh.comm
        self._work = compiled(work, self._comm)
        tangent = ufl.derivative(work, self._u, du) + forms.slope
        self._tangent = FormMatrix(compiled(tangent, self._comm))
        self._pressures.add_tangent(self._tangent.matrix)
        self._model, self._energy_form = model, forms.elastic + forms.stored
        self._elastic, self._stored = (
            compiled(form, self._comm) if form else None for form in (forms.elastic, forms.stored)
        )
        self._dissipated = CellIntegrals(forms.dissipated, model) if forms.dissipated else None
        #: Whether `energy` is that of all bodies: every material has one.
        self.stores = forms.told
        self.stiffness = self._tangent.matrix
        self._force = create_force(self._work)
        #: Length whose strain is round-off where nothing moves: F = I + grad(u) is rounded over
        #: the size of a cell.
        self.rest_length = cell_size(model.mesh)
        #: Whether a body is at finite strain.
        self.finite = not all(small_strain(law) for law in materials.values())
        #: Diagonal of the tangent at rest: the scale of forces that displacements of one unit make.
        self.diagonal = self.stiffness.getDiagonal()
        _check_stiff(model, materials, self.diagonal)
        #: The same for surfaces that give way by shear, as of `CellPressures`.
        self.yielding = self._pressures.yielding(self.diagonal)

    @property
    def pressures(self) -> Mapping[str, Any]:
        """As of `CellPressures.of`."""
        return self._pressures.of

    @property
    def hardness(self) -> float:
        """As of `CellPressures`."""
        return self._pressures.hardness

    def _histories(
        self, model: Model, given: Mapping[str, Any], degree: int
    ) -> dict[str, BodyHistory | BodyPoints]:
        """What bodies go through whose material has a history, as laws of points or by UFL."""
        found: dict[str, BodyHistory | BodyPoints] = {}
        for name, law in given.items():
            if hasattr(law, "history"):
                bound = (law, model, name, self._u, self._dt, degree, self.heated.get(name))
                found[name] = (
                    BodyPoints(*bound, self.pressures.get(name))
                    if hasattr(law, "update")
                    else BodyHistory(*bound)
                )
        return found

    def force(self, u: Vec) -> Vec:
        """Internal force.

        Args:
            u: Displacement of the nodes this rank owns, length.

        Returns:
            The force; the vector is overwritten by the next call.
        """
        self._set(u)
        self._pressures.evaluate()
        for body in self._points:
            body.evaluate()
        assemble_force(self._work, self._force)
        return self._force

    def energy(self, u: Vec) -> float:
        """Stored energy of the accepted state.

        Args:
            u: Displacement of the nodes this rank owns, length.

        Returns:
            The energy over all ranks, force times length; 0 where a material has a stress but no
            energy.
        """
        if not self.stores:
            return 0.0
        self._set(u)
        return self._total(self._stored) + self._without_histories()

    def _without_histories(self) -> float:
        """The same but of what materials with a history store, at the displacement of now."""
        of_pressures = float(self._comm.allreduce(self._pressures.energy()))
        return self._total(self._elastic) + of_pressures

    def _total(self, form: Any) -> float:
        """A form of rank 0 over all ranks; 0 where there is none."""
        return 0.0 if form is None else float(self._comm.allreduce(fem.assemble_scalar(form)))

    def heating(self, start: Vec, u: Vec, before: Mapping[str, float]) -> tuple[float, float]:
        """Energy that changes of temperature give to bodies that are held, `int dW/dT dT`.

        The mean of both is exact where W is quadratic in displacements and temperatures, as the
        mean of forces is for their work. Of bodies with a history it is `ThermalWork`'s.

        Args:
            start: Displacement of the nodes this rank owns at the last accepted state, length.
            u: The same of the state of now; the bodies are left in it.
            before: Temperatures at the last accepted state, by body.

        Returns:
            The energy at `start` and at `u` over all ranks, force times length; 0 where a material
            has no energy.
        """
        now = {name: body.temperature for name, body in self.heated.items()}
        if not self.stores or now == before:
            return 0.0, 0.0

        def stored(place: Vec, temperatures: Mapping[str, float]) -> float:
            for name, value in temperatures.items():
                self.heated[name].set_temperature(value)
            self._set(place)
            self._pressures.evaluate()
            return self._without_histories()

        rises = {name: value - before[name] for name, value in now.items()}
        first = stored(start, now) - stored(start, before) + self._thermal_work(rises, trial=False)
        then = -stored(u, before) + stored(u, now)
        for body in self._points:
            body.evaluate()
        return first, then + self._thermal_work(rises, trial=True)

    @cached_property
    def _of_cells(self) -> CellIntegrals:
        return CellIntegrals(self._energy_form, self._model)

    def cell_energies(self, u: Any) -> Floats:
        """Energy that each cell of this rank stores, (cells,); collective.

        Args:
            u: Displacement, a DOLFINx function, of the accepted state.

        Returns:
            Force times length; NaN where a material has a stress but no energy.
        """
        self.set_pressures(u)
        if not self.stores:
            return np.full(_cells(self._model), np.nan)
        return self._of_cells() + self._pressures.cell_energies(_cells(self._model))

    def dissipated(self) -> float:
        """What materials have dissipated until the accepted state, over all ranks."""
        return sum(self.dissipated_by_body().values())

    def dissipated_by_body(self) -> dict[str, float]:
        """What each body with a history has dissipated until the accepted state, over all ranks."""
        if self._dissipated is None:
            return {}
        of_cells = self._dissipated()
        own = [of_cells[body.own_cells].sum() for body in self.histories.values()]
        found = self._comm.allreduce(np.array(own))
        return dict(zip(self.histories, found.tolist(), strict=True))

    def tangent(self, out: Mat, *, again: bool = False, elastic_share: float = 0.0) -> None:
        """Write the tangent of the last `force` into a matrix.

        Args:
            out: A matrix that has room for it.
            again: Whether it is to be what the last call has written instead; with changes of
                volume that are kept apart on one process.
            elastic_share: Of bodies that flow, see `BodyPoints.write_tangent`.
        """
        if again:
            self._tangent.write(out, again=True)
        else:
            for body in self._points:
                body.write_tangent(elastic_share)
            with self._pressures.predicted():
                self._tangent.write(out)
        self._pressures.add_tangent(out, again=again)

    @property
    def volume(self) -> CellPressures | None:
        """Changes of volume that are kept apart; None where there are none."""
        return self._pressures if self._pressures.of else None

    def times(self, x: Vec) -> Vec:
        """The product of what `tangent` has written last with a vector."""
        out = x.duplicate()
        self._tangent.times(x, out)
        self._pressures.add_product(x, out)
        return out

    def follow(self, u: Vec | None, in_full_alone: bool = False) -> bool:
        """Let pressures in tangents follow the corrections from a state on, where volume is kept.

        Args:
            u: Displacement of the nodes this rank owns, length; those of now count again if None.
            in_full_alone: Whether they do so only where corrections are to be taken in full.

        Returns:
            Whether corrections are to be taken in full, as of `CellPressures`.
        """
        followed = self._pressures.followed
        if followed is not None and (self._pressures.in_full or not in_full_alone):
            if u is not None:
                self._set(u)
            followed.follow(u is not None)
        return self._pressures.in_full

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
            self._pressures.evaluate()
        for history in self.histories.values():
            history.commit()

    def set_pressures(self, u: Any) -> None:
        """Bring `pressures` to a displacement, a DOLFINx function; collective."""
        self._u.x.array[:] = u.x.array
        self._pressures.evaluate()

    def _set(self, u: Vec) -> None:
        self._u.x.array[: len(u.array_r)] = u.array_r
        self._u.x.scatter_forward()


def _heated(materials: Mapping[str, Material], model: Model) -> dict[str, Heated]:
    """Bodies that expand with their temperature, by name."""
    found = {}
    for name, law in materials.items():
        if isinstance(law, ThermalExpansion):
            with within(f"material.{name}"):
                found[name] = Heated(law, model)
    return found


def _check_stiff(model: Model, materials: Mapping[str, Material], diagonal: Vec) -> None:
    """Refuse a body that has no stiffness at rest; collective.

    Displacements across the plane, which have none in plane stress, are held there.

    Raises:
        InputError: A node of it can be moved without a force, or by one that pulls back.
    """
    rows, space = diagonal.array_r, model.space
    components = np.arange(space.dofmap.bs if model.idealisation.lateral else 2)
    for name in model.body_names():
        nodes = np.unique(space.dofmap.list[model.cells(name)])
        own = nodes[nodes < space.dofmap.index_map.size_local, None] * space.dofmap.bs
        here = float(rows[own + components].min(initial=np.inf))
        least = min(model.mesh.comm.allgather(here))
        if name in materials and not least > 0.0:
            text = f"no stiffness at rest: that of a node is {least:.3g}, must be > 0"
            raise InputError(text, f"material.{name}")


def _cells(model: Model) -> int:
    topology = model.mesh.topology
    return int(topology.index_map(topology.dim).size_local)


def cell_size(mesh: Any) -> float:
    """Edge of a cube, or of a square, of the mean size of a cell.

    Args:
        mesh: DOLFINx mesh; the call is collective.

    Returns:
        Its length.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        >>> round(cell_size(model.mesh), 12)
        0.5
    """
    comm, cells = mesh.comm, mesh.topology.index_map(mesh.topology.dim)
    one = compiled(fem.Constant(mesh, 1.0) * ufl.dx(domain=mesh), comm)
    volume = comm.allreduce(fem.assemble_scalar(one))
    return float((volume / cells.size_global) ** (1.0 / mesh.topology.dim))
