"""What ParaView is shown: the bodies and the slave points."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.array_types import Floats, Locals
from anisocontact.base.compiled_forms import compiled_expression
from anisocontact.base.fenicsx import dolfinx, fem, scalar_element, ufl
from anisocontact.bulk import PLASTIC_STRAIN, cauchy_stress, without_expansion
from anisocontact.bulk.cell_energy import volumes
from anisocontact.contact import Contact
from anisocontact.results.dataset import DataSet, polygons, vertices
from anisocontact.results.quantities import CELL, NODE, POINT, arrays
from anisocontact.results.slave_points import SlavePoints
from anisocontact.results.stress_invariants import principal, von_mises
from anisocontact.solver import Problem

#: Rows and columns of the stress components, in the order VTK has them.
_SYMMETRIC = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


class BodyGrid:
    """Displacement and stress of all bodies as a grid of VTK.

    Args:
        problem: The problem.
        chosen: Quantities to write; all if not given.
    """

    def __init__(self, problem: Problem, chosen: Collection[str] = ()) -> None:
        self.problem, self._chosen = problem, chosen
        model = problem.model
        discontinuous = fem.functionspace(
            model.mesh, ("Discontinuous Lagrange", model.order, (len(_SYMMETRIC),))
        )
        self._stress = fem.Function(discontinuous)
        self._expressions = [
            (_stress_at(problem, body, discontinuous), model.cells(body))
            for body in model.body_names()
            if body in problem.deformable and body not in problem.bulk.histories
        ]
        self._histories = [
            (history, _from_points(discontinuous, history.points))
            for history in problem.bulk.histories.values()
        ]
        continuous = fem.functionspace(model.mesh, ("Lagrange", model.order, (len(_SYMMETRIC),)))
        self._mean = fem.Function(continuous)
        self._to_nodes = self._scatter()
        ones: Floats = np.ones(self._stress.x.array.shape)
        self._share = 1.0 / self._summed(ones).clip(1.0)
        cells, kinds, self._points = dolfinx.plot.vtk_mesh(model.space)
        rows = cells.reshape(len(kinds), 1 + model.space.dofmap.dof_layout.num_dofs)
        if model.idealisation.dim == 3:
            rows = _turned_outwards(rows, self._points)
        nodes = rows[:, 1:]
        ends = np.arange(len(kinds) + 1, dtype=np.int32) * np.int32(nodes.shape[1])
        self._cells = {
            "connectivity": nodes.astype(np.int32).reshape(-1),
            "offsets": ends,
            "types": kinds.astype(np.uint8),
        }
        self.numbers = self._body_numbers(len(kinds))

    def now(self, trial: bool = False) -> BodiesNow:
        """The accepted state, or that of the last trial, as quantities are made of it."""
        return BodiesNow(self, trial)

    def grid(self) -> DataSet:
        """The accepted state of the cells of this rank."""
        now = [self.now()]
        cells = {"Cells": self._cells}
        at_nodes, at_cells = (arrays(at, now, self._chosen) for at in (NODE, CELL))
        return DataSet("UnstructuredGrid", self._points, cells, at_nodes, at_cells)

    def stress(self, trial: bool = False) -> Floats:
        """Stress at the nodes, XX YY ZZ XY YZ XZ, (nodes, 6); collective.

        Args:
            trial: Whether the state is the last trial; else the accepted one.
        """
        self.problem.bulk.set_pressures(self.problem.u)
        for expression, cells in self._expressions:
            self._stress.interpolate(expression, cells0=cells)
        values = self._stress.x.array.reshape(-1, len(_SYMMETRIC))
        for history, spread in self._histories:
            cells, at_points = history.stress(trial)
            components = np.stack([at_points[..., i, j] for i, j in _SYMMETRIC], axis=-1)
            values[self._stress.function_space.dofmap.list[cells]] = spread @ components
        stress = self._summed(np.asarray(self._stress.x.array, dtype=np.float64)) * self._share
        return stress.reshape(-1, len(_SYMMETRIC))

    def extremes(self) -> dict[str, dict[str, float]]:
        """Largest equivalent, largest and least principal stress of each body; collective."""
        now, model, found = self.now(), self.problem.model, {}
        columns = np.column_stack([von_mises(now.stress), principal(now.stress)[:, [0, 2]]])
        for name in model.body_names():
            nodes = np.unique(model.space.dofmap.list[model.cells(name)])
            # of nodes that have a stress, see `principal`
            own = np.fmax.reduce(columns[nodes] * (1.0, 1.0, -1.0), axis=0, initial=-np.inf)
            largest = np.max(model.mesh.comm.allgather(own), axis=0)
            found[name] = {
                "von_mises": float(largest[0]),
                "largest_principal": float(largest[1]),
                "least_principal": -float(largest[2]),
            }
        return found

    def _summed(self, at_cells: Floats) -> Floats:
        """Sum over the cells at each node of values at the nodes of each cell."""
        self._mean.x.array[:] = (self._to_nodes @ at_cells.reshape(-1, len(_SYMMETRIC))).ravel()
        self._mean.x.scatter_reverse(dolfinx.la.InsertMode.add)
        self._mean.x.scatter_forward()
        return np.array(self._mean.x.array, dtype=np.float64)

    def _scatter(self) -> scipy.sparse.csr_array:
        """Ones from the nodes of each cell of this rank to its nodes in the mesh."""
        of_cells = self._stress.function_space.dofmap
        of_mesh = self._mean.function_space.dofmap
        topology = self.problem.model.mesh.topology
        owned = topology.index_map(topology.dim).size_local
        places = of_mesh.list[:owned].ravel(), of_cells.list[:owned].ravel()
        maps = (one.index_map for one in (of_mesh, of_cells))
        shape = tuple(one.size_local + one.num_ghosts for one in maps)
        return scipy.sparse.coo_array((np.ones(len(places[0])), places), shape).tocsr()

    def _body_numbers(self, count: int) -> Locals:
        numbers = np.zeros(count, dtype=np.int32)
        for i, body in enumerate(self.problem.model.body_names()):
            cells = self.problem.model.cells(body)
            numbers[cells[cells < count]] = i
        return numbers


class BodiesNow:
    """The accepted state of all bodies, or a trial, as quantities are made of it.

    Args:
        bodies: The bodies.
        trial: Whether it is the last trial.
    """

    def __init__(self, bodies: BodyGrid, trial: bool = False) -> None:
        self._bodies, self.problem, self._trial = bodies, bodies.problem, trial

    @property
    def displacement(self) -> Floats:
        """At the nodes, (nodes, 3), length."""
        return np.array(self.problem.u.x.array.reshape(-1, 3))

    @cached_property
    def stress(self) -> Floats:
        """At the nodes, (nodes, 6), stress."""
        return self._bodies.stress(self._trial)

    @property
    def numbers(self) -> Locals:
        """Number of the body of each cell, (cells,)."""
        return self._bodies.numbers

    @property
    def energy_density(self) -> Floats:
        """Elastic energy per volume of each cell, stress, (cells,); collective."""
        problem = self.problem
        return problem.bulk.cell_energies(problem.u) / volumes(problem.model)

    @property
    def plastic_strain(self) -> Floats:
        """Mean equivalent plastic strain of each cell, (cells,)."""
        found: Floats = np.zeros(len(self.numbers))
        for history in self.problem.bulk.histories.values():
            if PLASTIC_STRAIN in history.variables:
                cells, means = history.means(PLASTIC_STRAIN)
                here = cells < len(found)
                found[cells[here]] = means[here]
        return found


def slave_points(contacts: Iterable[Contact], chosen: Collection[str] = ()) -> DataSet | None:
    """The slave points of this rank of all contacts where they are now; None without a contact.

    Between slave nodes there are facets, so that what is known at nodes is a field on them.

    Args:
        contacts: The contacts.
        chosen: Quantities to write; all if not given.
    """
    parts = [SlavePoints(number, contact) for number, contact in enumerate(contacts)]
    if not parts:
        return None
    points = np.concatenate([part.contact.points for part in parts])
    slaves = [part.contact.slave_points for part in parts]
    starts = np.cumsum([0, *(len(one.facet) for one in slaves)])
    loose = np.repeat([not one.at_nodes for one in slaves], np.diff(starts))
    pieces = (one.polygons + start for one, start in zip(slaves, starts, strict=False))
    cells = vertices(np.flatnonzero(loose)) | polygons(*pieces)
    return DataSet("PolyData", points, cells, arrays(POINT, parts, chosen))


def _stress_at(problem: Problem, body: str, space: Any) -> Any:
    ideal, u = problem.bulk.heated.get(body, problem.model.idealisation), problem.u
    pressure = problem.bulk.pressures.get(body)
    stress = ideal.at_nodes(
        cauchy_stress(without_expansion(problem.materials[body]), u, pressure), u
    )
    components = ufl.as_vector([stress[i, j] for i, j in _SYMMETRIC])
    points = space.element.interpolation_points
    return compiled_expression(components, points, problem.model.mesh.comm)


def _from_points(space: Any, points: Floats) -> Floats:
    """Values at the nodes of a cell by those at points in it, least squares, (nodes, points)."""
    return np.asarray(np.linalg.pinv(scalar_element(space).tabulate(0, points)[0, :, :, 0]))


#: Nodes of a tetrahedron of VTK with four or ten of them, seen in a mirror.
_MIRRORED = {4: (0, 2, 1, 3), 10: (0, 2, 1, 3, 6, 5, 4, 7, 9, 8)}


def _turned_outwards(rows: npt.NDArray[Any], points: Floats) -> npt.NDArray[Any]:
    """Cells of VTK, (cells, 1 + nodes), with tetrahedra of positive volume.

    DOLFINx orders the nodes of a tetrahedron by their numbers, whatever volume that gives.
    """
    mirrored = _MIRRORED.get(rows.shape[1] - 1)
    if mirrored is None:
        return rows
    corners = points[rows[:, 1:5]]
    inside_out = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0.0
    turned = rows.copy()
    turned[inside_out, 1:] = rows[inside_out][:, 1:][:, mirrored]
    return turned
