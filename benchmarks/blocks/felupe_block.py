"""FElupe with Pardiso, block on plane only; its Python needs felupe and pypardiso.

    python felupe_block.py n

prints tangential and normal force after each increment.
"""

from __future__ import annotations

import sys

import numpy as np


def main(n: int) -> None:
    """Solve and print."""
    import felupe
    import pypardiso
    from problem import ALONG, DOWN, FRICTION, PENALTY, POISSON, YOUNG, path

    mesh = felupe.Cube(a=(0, 0, 0), b=(1, 1, 0.5), n=(n + 1, n + 1, n // 2 + 1))
    # the rigid plane is held by one more point
    points = np.vstack([mesh.points, [0.5, 0.5, 0.0]])
    mesh = felupe.Mesh(points, mesh.cells, mesh.cell_type)
    mesh.points_without_cells = np.array([], dtype=int)
    field = felupe.FieldContainer([felupe.Field(felupe.RegionHexahedron(mesh), dim=3)])
    solid = felupe.SolidBody(felupe.LinearElastic(E=YOUNG, nu=POISSON), field)
    last = len(points) - 1
    bottom = np.flatnonzero(np.abs(points[:-1, 2]) < 1e-12)
    top = np.abs(points[:, 2] - 0.5) < 1e-12
    contact = felupe.ContactRigidPlane(
        field,
        points=bottom,
        centerpoint=last,
        normal=[0, 0, 1],
        friction=FRICTION,
        multiplier=PENALTY / n**2,
        multiplier_tangential=PENALTY / n**2,
    )
    only = {"x": (0, 1, 1), "y": (1, 0, 1), "z": (1, 1, 0)}
    held = {axis: felupe.Boundary(field[0], mask=top, skip=skip) for axis, skip in only.items()}
    held["plane"] = felupe.Boundary(field[0], mask=np.arange(len(points)) == last)
    steps = np.array(path())
    along = {"x": steps[:, 0], "y": 0.0 * steps[:, 0], "z": steps[:, 1]}
    ramp = {held[axis]: values for axis, values in along.items()}
    step = felupe.Step([solid, contact], ramp=ramp, boundaries=held)
    assert steps[-1].tolist() == [ALONG, -DOWN]

    def show(_: int, __: int, state: object) -> None:
        force = state.fun  # type: ignore[attr-defined]
        force = force.toarray() if hasattr(force, "toarray") else np.asarray(force)
        total = force.ravel()[: 3 * len(points)].reshape(-1, 3)[top].sum(axis=0)
        print("force", total[0], -total[2], flush=True)

    job = felupe.Job([step], callback=show)
    job.evaluate(verbose=0, solver=lambda a, b: pypardiso.spsolve(a.tocsr(), b), tol=1e-6)


if __name__ == "__main__":
    main(int(sys.argv[1]))
