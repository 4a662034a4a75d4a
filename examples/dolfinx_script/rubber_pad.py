"""A plain DOLFINx script of a rubber pad, and the five lines that put it on a brushed plate.

The pad is pressed by its upper face, then dragged along x; the plate is brushed at 30 degrees, so
the pad is pushed sideways too. Run it with `python rubber_pad.py`.
"""

import anisocontact  # isort: skip  # noqa: F401  (before dolfinx)

import numpy as np
import ufl
from mpi4py import MPI

from anisocontact import (
    Contact,
    ContactProblem,
    Friction,
    Model,
    make_directions,
    make_surface,
)

from dolfinx import fem, mesh


def main() -> np.ndarray:
    """Force on the pad after every increment, (24, 3), N."""
    # The script as it would be without contact: mesh, space, conditions, form.
    corners = [np.array([0.0, 0.0, 0.0]), np.array([0.04, 0.04, 0.01])]
    pad = mesh.create_box(MPI.COMM_WORLD, corners, [8, 8, 3], mesh.CellType.hexahedron)
    V = fem.functionspace(pad, ("Lagrange", 1, (3,)))
    u, v = fem.Function(V), ufl.TestFunction(V)
    top = mesh.locate_entities_boundary(pad, 2, lambda x: np.isclose(x[2], 0.01))
    bottom = mesh.locate_entities_boundary(pad, 2, lambda x: np.isclose(x[2], 0.0))
    moved = fem.Constant(pad, np.zeros(3))
    bcs = [fem.dirichletbc(moved, fem.locate_dofs_topological(V, 2, top), V)]
    shear, bulk = 1.0e6, 5.0e6
    F = ufl.variable(ufl.Identity(3) + ufl.grad(u))
    J = ufl.det(F)
    energy = shear / 2 * (J ** (-2 / 3) * ufl.tr(F.T * F) - 3) + bulk / 2 * (J - 1) ** 2
    residual = ufl.derivative(energy * ufl.dx(metadata={"quadrature_degree": 2}), u, v)

    # What the plate is.
    plate = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    brushed = make_directions("constant", vector=(1, 0, 0), angle=np.radians(30))
    friction = Friction(coefficients=(0.3, 0.6), directions=brushed)

    # Contact, which holds exactly: the names, the contact, the problem.
    model = Model.of(V, {"pad.bottom": bottom})
    contact = Contact(model, "pad.bottom", plate, friction)
    problem = ContactProblem(residual, u, bcs=bcs, contacts=[contact])

    forces = []
    for target in [(0, 0, z) for z in -np.linspace(1e-4, 5e-4, 4)] + [
        (x, 0, -5e-4) for x in np.linspace(1e-3, 2e-2, 20)
    ]:
        moved.value[:] = target
        iterations = problem.solve()
        force, _ = contact.resultant()
        forces.append(force)
        print(f"{1e3 * moved.value} mm  {iterations} iterations  force {force.round(2)} N")
    return np.array(forces)


if __name__ == "__main__":
    main()
