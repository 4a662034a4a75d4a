"""Block on plane in FElupe with Pardiso: `python -m blocks.felupe_block plane n`.

Contact at the nodes with a rigid plane, penalty and regularised friction; the nodes' penalty is
that of the problem times the area of a facet. FElupe has no contact between two meshes.
"""

from __future__ import annotations

import sys

import felupe
import numpy as np
import pypardiso

from blocks.code import show
from blocks.problem import FRICTION, PENALTY, POISSON, YOUNG, path


def block(n: int) -> tuple[felupe.FieldContainer, np.ndarray]:
    """Displacements of the block and of one more point, which holds the plane; nodes of the top."""
    mesh = felupe.Cube(a=(0, 0, 0), b=(1, 1, 0.5), n=(n + 1, n + 1, n // 2 + 1))
    mesh = felupe.Mesh(np.vstack([mesh.points, [0.5, 0.5, 0.0]]), mesh.cells, mesh.cell_type)
    mesh.points_without_cells = np.array([], dtype=int)
    field = felupe.FieldContainer([felupe.Field(felupe.RegionHexahedron(mesh), dim=3)])
    return field, np.abs(mesh.points[:, 2] - 0.5) < 1e-12


def supports(field: felupe.FieldContainer, top: np.ndarray) -> tuple[dict, dict]:
    """The held nodes and how they move."""
    only = {"x": (0, 1, 1), "y": (1, 0, 1), "z": (1, 1, 0)}
    held = {axis: felupe.Boundary(field[0], mask=top, skip=skip) for axis, skip in only.items()}
    held["plane"] = felupe.Boundary(field[0], mask=np.arange(len(top)) == len(top) - 1)
    steps = np.array(path())
    along = {"x": steps[:, 0], "y": 0.0 * steps[:, 0], "z": steps[:, 1]}
    return held, {held[axis]: values for axis, values in along.items()}


def main(n: int) -> None:
    """Solve and print."""
    field, top = block(n)
    points = field[0].region.mesh.points
    held, ramp = supports(field, top)
    contact = felupe.ContactRigidPlane(
        field,
        points=np.flatnonzero(np.abs(points[:-1, 2]) < 1e-12),
        centerpoint=len(points) - 1,
        normal=[0, 0, 1],
        friction=FRICTION,
        multiplier=PENALTY / n**2,
        multiplier_tangential=PENALTY / n**2,
    )
    solid = felupe.SolidBody(felupe.LinearElastic(E=YOUNG, nu=POISSON), field)
    step = felupe.Step([solid, contact], ramp=ramp, boundaries=held)

    def report(_: int, __: int, state: felupe.tools.NewtonResult) -> None:
        force = state.fun.toarray() if hasattr(state.fun, "toarray") else np.asarray(state.fun)
        total = force.ravel()[: points.size].reshape(-1, 3)[top].sum(axis=0)
        show(total[0], -total[2], state.iterations)

    job = felupe.Job([step], callback=report)
    job.evaluate(verbose=0, solver=lambda a, b: pypardiso.spsolve(a.tocsr(), b), tol=1e-6)


if __name__ == "__main__":
    main(int(sys.argv[2]))
