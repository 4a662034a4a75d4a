"""Multipliers in scripts are found in the other ways of case files where the usual one fails."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.anisotropy import make_directions
from anisocontact.base.array_types import Floats
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Model
from anisocontact.solver import ContactProblem
from anisocontact.surfaces import make_surface

SIDES = np.array([0.04, 0.04, 0.01])


def forces(multipliers: str) -> Floats:
    """Force on a coarse pad of tetrahedra, pressed twice and dragged, (3, 3)."""
    from mpi4py import MPI

    from anisocontact.base.fenicsx import fem, ufl

    from dolfinx import mesh

    box = mesh.create_box(
        MPI.COMM_WORLD, [np.zeros(3), SIDES], [4, 4, 2], mesh.CellType.tetrahedron
    )
    space = fem.functionspace(box, ("Lagrange", 1, (3,)))
    top, bottom = (
        mesh.locate_entities_boundary(box, 2, lambda x, z=z: np.isclose(x[2], z))
        for z in (SIDES[2], 0.0)
    )
    u, v = fem.Function(space), ufl.TestFunction(space)
    stress = make_material("linear-elastic", E=2.81e6, nu=0.406).stress(u)
    moved = fem.Constant(box, np.zeros(3))
    held = fem.dirichletbc(moved, fem.locate_dofs_topological(space, 2, top), space)
    directions = make_directions("constant", vector=(1, 0, 0), angle=np.radians(30))
    law = ContactLaw(
        NormalLaw(penalty=1e10),
        Adhesion(stiffness=(4e9, 1e9), directions=directions),
        Friction(coefficients=(0.3, 0.6), directions=directions),
    )
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    augmentation = Augmentation(multipliers=multipliers)
    model = Model.of(space, {"pad.bottom": bottom})
    contact = Contact(model, "pad.bottom", plane, law, augmentation=augmentation)
    form = ufl.inner(stress, ufl.grad(v)) * ufl.dx
    problem = ContactProblem(form, u, bcs=[held], contacts=[contact])
    found = []
    for place in ((0, 0, -2.5e-4), (0, 0, -5e-4), (2e-3, 6e-4, -5e-4)):
        moved.value[:] = place
        problem.solve()
        found.append(contact.resultant()[0])
    problem.close()
    return np.array(found)


def test_a_coarse_pad_is_pressed() -> None:
    """Friction 0.3 and 0.6 under a corner of the pad turns to and fro between corrections.

    Requirement: no error, and the forces of multipliers found in cycles, to 1e-4 of the largest.
    Source: a contact without penetration has one equilibrium, however it is found. The usual way
    alone stopped with `corrections of the multipliers gain nothing`.
    """
    usual, cycles = forces("newton"), forces("uzawa")
    assert usual == pytest.approx(cycles, abs=1e-4 * np.abs(cycles).max())
    assert usual[-1, 2] > 0.0 > usual[-1, 0]
