"""Matrices of forms that several processes share, for `test_matrices_on_ranks`.

Usage: `mpirun -n N python -m tests.unit.matrices_on_ranks`

Rank 0 prints one number a line, each the largest over all ranks.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.compiled_forms import compiled
from anisocontact.base.fenicsx import (
    MPI,
    PETSc,
    assemble_into,
    create_form_matrix,
    fem,
    ufl,
)
from anisocontact.base.form_matrix import FormMatrix
from anisocontact.base.form_rows import create_stiffness
from anisocontact.base.places_in_matrix import PlacesInMatrix
from anisocontact.mesh import BoxSpec, build_box

COMM = MPI.COMM_WORLD
#: Unknowns of the last rank behind those of the nodes.
MORE = 6


def summed_by_petsc(form: Any) -> Any:
    """The matrix as PETSc sums it up cell by cell."""
    matrix = create_form_matrix(form)
    assemble_into(matrix, form)
    matrix.assemble()
    return matrix


def difference(one: Any, other: Any) -> float:
    """Largest difference of entries over the largest one."""
    beyond = one.copy()
    beyond.axpy(-1.0, other, structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    largest = [matrix.norm(PETSc.NormType.NORM_INFINITY) for matrix in (beyond, other)]
    return float(largest[0] / largest[1])


def with_room(matrix: Any, more: int) -> Any:
    """Zeros in its places and beside them, further rows and columns on the last rank."""
    (own, total), _ = matrix.getSizes()
    last = COMM.rank == COMM.size - 1
    side = (own + more * last, total + more)
    out = PETSc.Mat().createAIJ((side, side), comm=COMM)
    out.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    first = matrix.getOwnershipRange()[0]
    for row in range(first, first + own):
        columns, _ = matrix.getRow(row)
        # some rows with more entries, on any rank, than the matrix has there
        beside = [] if row % 3 else np.arange(0, total + more, 7)
        wide = np.union1d(columns, beside).astype(PETSc.IntType)
        out.setValues([row], wide, np.zeros(len(wide)))
    out.assemble()
    return out


def missing(matrix: Any) -> bool:
    """Whether nothing is written where the first rank alone lacks places."""
    lacking = PETSc.Mat().createAIJ(matrix.getSizes(), comm=COMM)
    lacking.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    first, last = matrix.getOwnershipRange()
    for row in range(first, last):
        columns = matrix.getRow(row)[0] if COMM.rank else np.array([row], dtype=PETSc.IntType)
        lacking.setValues([row], columns, np.zeros(len(columns)))
    lacking.assemble()
    places = PlacesInMatrix(matrix)
    refused = not any([places.copy(lacking), places.add(lacking)])
    return refused and lacking.norm() == 0.0


def main() -> None:
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 2, 3), (4, 3, 5))})
    u, v = ufl.TrialFunction(model.space), ufl.TestFunction(model.space)
    w: Any = fem.Function(model.space)
    energy = (1.0 + w[0]) * ufl.inner(ufl.grad(u), ufl.sym(ufl.grad(v))) * ufl.dx
    form = compiled(energy, model.mesh.comm)
    found = [difference(create_stiffness(form), summed_by_petsc(form))]
    written = FormMatrix(form)
    for more in (0, MORE):
        out = with_room(written.matrix, more)
        for shift in (0.3, 0.7):
            w.x.array[:] = np.sin(shift + model.space.tabulate_dof_coordinates()[:, 0].repeat(3))
            by_petsc = summed_by_petsc(form)
            written.write(out)
            inner = PETSc.IS().createStride(
                by_petsc.getLocalSize()[0], by_petsc.getOwnershipRange()[0], 1, COMM
            )
            found.append(difference(out.createSubMatrix(inner, inner), by_petsc))
            found.append(abs(out.norm() / by_petsc.norm() - 1.0))
            places = PlacesInMatrix(by_petsc)
            found.append(0.0 if all([places.add(out), places.add(out)]) else 1.0)
            by_petsc.scale(3.0)
            found.append(difference(out.createSubMatrix(inner, inner), by_petsc))
    found.append(0.0 if COMM.size == 1 or missing(written.matrix) else 1.0)
    every = COMM.gather(found)
    if every is not None:
        print(*np.max(every, axis=0).tolist())


if __name__ == "__main__":
    main()
