"""Block on plane in a plain DOLFINx script: `python -m finite_strain.penalty_script plane n BY`.

Contact is a form of its own, so that its time can be told from that of the material. The elastic
slip at the 2 x 2 points of a face is kept as a discontinuous trilinear function, whose values at
the four corners of the face give those at the points. `mumps` solves, or `pardiso`.
"""

from __future__ import annotations

import anisocontact  # isort: skip  # noqa: F401  (before dolfinx)

import sys
import time
from collections.abc import Callable
from typing import Any

import basix
import numpy as np
import ufl
from mpi4py import MPI

from finite_strain.problem import FRICTION, PENALTY, POISSON, YOUNG, Clock, path, show

from dolfinx import fem, mesh
from dolfinx.fem import petsc
from petsc4py import PETSc

#: The solution of a system with the matrix of now.
type Solve = Callable[[np.ndarray], np.ndarray]
TOLERANCE, ITERATIONS, HALVINGS, TINY = 1e-8, 40, 6, 1e-30


class History:
    """Elastic slip at the points of quadrature, two components."""

    def __init__(self, grid: mesh.Mesh, facets: np.ndarray, slip: Any, space: Any) -> None:
        self.values = fem.Function(space)
        grid.topology.create_connectivity(2, 3)
        cells = grid.topology.connectivity(2, 3)
        self._cells = np.array([cells.links(f)[0] for f in facets], dtype=np.int32)
        plane, _ = basix.make_quadrature(basix.CellType.quadrilateral, 2)
        points = np.column_stack([plane, np.zeros(len(plane))])
        corners = space.element.basix_element.tabulate(0, points)[0, :, :4, 0]
        self._to_corners = np.linalg.inv(corners)
        self._slip = fem.Expression(slip(self.values), points)
        self._mesh, self._dofs = grid, space.dofmap.list[self._cells][:, :4]

    def advance(self) -> None:
        """Take the elastic slip of now as the history."""
        found = self._slip.eval(self._mesh, self._cells).reshape(len(self._cells), 4, 2)
        self.values.x.array.reshape(-1, 2)[self._dofs] = np.einsum(
            "cp,mpi->mci", self._to_corners, found
        )


class Block:
    """Forms, supports and history."""

    def __init__(self, n: int) -> None:
        corners = [np.array([0.0, 0.0, 0.0]), np.array([1.0, 1.0, 0.5])]
        grid = mesh.create_box(MPI.COMM_WORLD, corners, [n, n, n // 2], mesh.CellType.hexahedron)
        space = fem.functionspace(grid, ("Lagrange", 1, (3,)))
        self.u, self.before = fem.Function(space), fem.Function(space)
        top = mesh.locate_entities_boundary(grid, 2, lambda x: np.isclose(x[2], 0.5))
        bottom = mesh.locate_entities_boundary(grid, 2, lambda x: np.isclose(x[2], 0.0))
        self.top = fem.locate_dofs_topological(space, 2, top)
        self.moved = fem.Constant(grid, np.zeros(3))
        self.held = fem.dirichletbc(self.moved, self.top, space)
        slips = fem.functionspace(grid, ("DQ", 1, (2,)))
        self.history = History(grid, bottom, self._slip, slips)
        v, du = ufl.TestFunction(space), ufl.TrialFunction(space)
        tags = mesh.meshtags(grid, 2, bottom, np.full(len(bottom), 1, dtype=np.int32))
        ds = ufl.Measure("ds", domain=grid, subdomain_data=tags, metadata={"quadrature_degree": 2})
        works = (self._material(v), self._contact(v) * ds(1))
        self.works = [fem.form(work) for work in works]
        self.tangents = [fem.form(ufl.derivative(work, self.u, du)) for work in works]

    def _material(self, v: Any) -> Any:
        gradient = ufl.variable(ufl.Identity(3) + ufl.grad(self.u))
        shear = YOUNG / 2 / (1 + POISSON)
        lame = 2 * shear * POISSON / (1 - 2 * POISSON)
        log_j = ufl.ln(ufl.det(gradient))
        energy = shear / 2 * (ufl.tr(gradient.T * gradient) - 3 - 2 * log_j) + lame / 2 * log_j**2
        return ufl.derivative(energy * ufl.dx(metadata={"quadrature_degree": 2}), self.u, v)

    def _pressure(self) -> Any:
        gap = (ufl.SpatialCoordinate(self.u.function_space.mesh) + self.u)[2]
        return ufl.conditional(gap < 0, -PENALTY * gap, 0.0)

    def _slip(self, history: Any) -> Any:
        """Elastic slip of now: Coulomb's law by return mapping."""
        trial = history + ufl.as_vector([self.u[i] - self.before[i] for i in range(2)])
        size = ufl.sqrt(ufl.inner(trial, trial) + TINY)
        limit = FRICTION * self._pressure() / PENALTY
        return ufl.conditional(size <= limit, trial, limit / size * trial)

    def _contact(self, v: Any) -> Any:
        slip = self._slip(self.history.values)
        gradient = ufl.Identity(3) + ufl.grad(self.u)
        normal = ufl.FacetNormal(self.u.function_space.mesh)
        area = ufl.det(gradient) * ufl.sqrt(ufl.inner(*[ufl.inv(gradient).T * normal] * 2))
        return area * (PENALTY * (slip[0] * v[0] + slip[1] * v[1]) - self._pressure() * v[2])


def by_mumps(matrix: PETSc.Mat) -> Solve:
    """A factor by MUMPS, whose analysis is kept."""
    solver = PETSc.KSP().create(MPI.COMM_WORLD)
    solver.setOperators(matrix)
    solver.setType("preonly")
    solver.getPC().setType("lu")
    solver.getPC().setFactorSolverType("mumps")

    def solve(force: np.ndarray) -> np.ndarray:
        right, step = matrix.createVecLeft(), matrix.createVecRight()
        right.array[:] = force
        solver.solve(right, step)
        return step.array.copy()

    return solve


def by_pardiso(matrix: PETSc.Mat) -> Solve:
    """A factor by Pardiso, whose analysis is kept."""
    import pypardiso
    import scipy

    solver, analysed = pypardiso.PyPardisoSolver(), False

    def solve(force: np.ndarray) -> np.ndarray:
        nonlocal analysed
        rows, columns, values = matrix.getValuesCSR()
        csr = scipy.sparse.csr_matrix((values, columns, rows))
        if not analysed:
            solver._check_A(csr)
            solver.set_phase(11)
            solver._call_pardiso(csr, np.zeros_like(force))
            analysed = True
        solver.set_phase(23)
        found: np.ndarray = solver._call_pardiso(csr, force)
        return found

    return solve


class Newton:
    """Newton's method with a direct solver; every part of it is timed."""

    def __init__(self, block: Block, solver: Callable[[PETSc.Mat], Solve]) -> None:
        self.block, self.clock = block, Clock()
        self.matrix = petsc.create_matrix(block.tangents[0])
        self.force = self.matrix.createVecLeft()
        self.solver = solver(self.matrix)
        #: Unknowns of the top, (nodes, 3).
        self.rows = 3 * block.top[:, None] + np.arange(3)

    def residual(self) -> None:
        """Forces on the nodes."""
        self.force.set(0.0)
        for name, work in zip(("assembly", "contact"), self.block.works, strict=True):
            with self.clock.phase(name):
                petsc.assemble_vector(self.force, work)

    def tangent(self) -> None:
        """Matrix with unit rows of the supports."""
        self.matrix.zeroEntries()
        for name, tangent in zip(("assembly", "contact"), self.block.tangents, strict=True):
            with self.clock.phase(name):
                petsc.assemble_matrix(self.matrix, tangent)
                self.matrix.assemble()

    def balance(self) -> tuple[float, np.ndarray, np.ndarray]:
        """Norm of the residual over the forces at work, residual and force on the top."""
        self.residual()
        force, rows = self.force.array.copy(), self.rows
        at_top = force[rows]
        force[rows] = self.block.u.x.array[rows] - self.block.moved.value
        far = PENALTY * np.abs(force[rows]).max()
        free = np.delete(force, rows.ravel())
        size = (np.linalg.norm(free) + far) / max(np.linalg.norm(at_top), TINY)
        return size, force, at_top.sum(axis=0)

    def solve(self) -> tuple[int, np.ndarray]:
        """Balance; iterations and force on the top."""
        norm, force, total = self.balance()
        for iteration in range(ITERATIONS):
            if norm < TOLERANCE:
                return iteration, total
            self.tangent()
            with self.clock.phase("assembly"):
                self.matrix.zeroRows(self.rows.ravel().astype(PETSc.IntType), 1.0)
            with self.clock.phase("linear"):
                step = self.solver(force)
            before, start = norm, self.block.u.x.array.copy()
            for halving in range(HALVINGS):
                self.block.u.x.array[:] = start - 0.5**halving * step
                norm, force, total = self.balance()
                if norm < before:
                    break
        raise SystemExit("no balance")


def main(n: int, by: str) -> None:
    """Solve and print."""
    block = Block(n)
    newton = Newton(block, {"mumps": by_mumps, "pardiso": by_pardiso}[by])
    iterations, forces = 0, []
    start = time.perf_counter()
    for number, (x, z) in enumerate(path()):
        last = block.u.x.array.copy()
        # the increment goes on as the last one did
        if number > 0:
            block.u.x.array[:] += last - block.before.x.array
        block.before.x.array[:] = last
        block.moved.value[:] = x, 0.0, z
        spent, force = newton.solve()
        with newton.clock.phase("contact"):
            block.history.advance()
        iterations += spent
        forces.append((force[0], -force[2]))
    solving = time.perf_counter() - start
    show(newton.clock, solving, iterations, forces, len(block.u.x.array), iterations)


if __name__ == "__main__":
    main(int(sys.argv[2]), sys.argv[3])
