"""Contact on the displacement of mixed problems, for `test_mixed_spaces`.

Usage: `mpirun -n N python -m tests.verification.mixed_problems FILE` writes the forces of a drag.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.anisotropy import make_directions
from anisocontact.base.fenicsx import MPI, basix, fem, ufl
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.solver import ContactProblem
from anisocontact.surfaces import make_surface

import dolfinx.mesh

SHEAR, BULK = 1.0e6, 3.0e6
HEIGHT = 0.5
#: Pressed by 2 % of the height, then dragged until all of it slides.
PRESS_AND_DRAG = [
    *((0.0, 0.0, -0.0025 * i) for i in (1, 2, 3, 4)),
    *((0.005 * i, 0.0, -0.01) for i in (1, 2, 3, 4)),
]
#: Displacement, and pressure of each kind.
PRESSURES = {"none": None, "linear": ("P", 1), "cells": ("DG", 0)}
PLATE = make_surface("plane", point=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Given:
    """What a script has before contact: a mesh, a space, an unknown and a residual.

    Attributes:
        model: Names on the displacement.
        space: The space of all unknowns.
        displacement: Its displacement.
        w: The unknown.
        form: Residual.
        facets: Facets by "body.group".
    """

    model: Model
    space: Any
    displacement: Any
    w: Any
    form: Any
    facets: dict[str, Any]


def law(penalty: float = 1e9, mu: tuple[float, float] = (0.3, 0.6)) -> ContactLaw:
    """Friction with axes at 30 degrees."""
    axes = make_directions("constant", vector=(1.0, 0.0, 0.0), angle=np.radians(30.0))
    adhesion = Adhesion(stiffness=(2e8, 1e8), directions=axes)
    return ContactLaw(
        NormalLaw(penalty=penalty), adhesion, Friction(coefficients=mu, directions=axes)
    )


def energy(u: Any, p: Any, unit: float = 1.0, bulk: float = BULK) -> Any:
    """Neo-Hooke per volume; with a pressure in its own unit, that of a perturbed Lagrangian.

    Args:
        u: Displacement.
        p: Pressure; None for none.
        unit: What its numbers are multiplied with.
        bulk: Bulk modulus; infinite for incompressible.
    """
    f = ufl.Identity(3) + ufl.grad(u)
    j = ufl.det(f)
    shape = SHEAR / 2.0 * (j ** (-2.0 / 3.0) * ufl.tr(f.T * f) - 3.0)
    if p is None:
        return shape + bulk / 2.0 * (j - 1.0) ** 2
    stored = 0.0 if np.isinf(bulk) else (unit * p) ** 2 / (2.0 * bulk)
    return shape + unit * p * (j - 1.0) - stored


def given(
    mesh: Any,
    facets: dict[str, Any],
    pressure: str,
    order: int,
    unit: float = 1.0,
    bulk: float = BULK,
) -> Given:
    """A body of rubber with displacements of an order, and a pressure of a kind beside them."""
    cell = mesh.basix_cell()
    element = basix.ufl.element("P", cell, order, shape=(3,))
    other = PRESSURES[pressure]
    if other is not None:
        element = basix.ufl.mixed_element([element, basix.ufl.element(other[0], cell, other[1])])
    space = fem.functionspace(mesh, element)
    w, test = fem.Function(space), ufl.TestFunction(space)
    u, p = ufl.split(w) if other else (w, None)
    displacement = space.sub(0) if other else space
    rule = {"quadrature_degree": 2 * order}
    form = ufl.derivative(energy(u, p, unit, bulk) * ufl.dx(metadata=rule), w, test)
    return Given(Model.of(displacement, facets), space, displacement, w, form, facets)


def pad(n: int, pressure: str, order: int, cell: str = "hexahedron", **of_form: float) -> Given:
    """A pad of 1 x 1 x 0.5."""
    kind = getattr(dolfinx.mesh.CellType, cell)
    corners = [[0.0, 0.0, 0.0], [1.0, 1.0, HEIGHT]]
    mesh = dolfinx.mesh.create_box(MPI.COMM_WORLD, corners, [n, n, max(n // 2, 1)], kind)
    facets = {
        "pad.bottom": dolfinx.mesh.locate_entities_boundary(mesh, 2, lambda x: np.isclose(x[2], 0)),
        "pad.top": dolfinx.mesh.locate_entities_boundary(
            mesh, 2, lambda x: np.isclose(x[2], HEIGHT)
        ),
    }
    return given(mesh, facets, pressure, order, **of_form)


def pair(pressure: str, order: int, cell: str = "tetrahedron") -> Given:
    """A block on a base whose mesh does not match, in one mesh."""
    made = build_box(
        {
            "pad": BoxSpec((0.1, 0.1, 0.0), (0.8, 0.8, HEIGHT), (3, 3, 2), cell=cell),
            "base": BoxSpec((0.0, 0.0, -HEIGHT), (1.0, 1.0, HEIGHT), (4, 4, 2), cell=cell),
        }
    )
    names = ("pad.bottom", "pad.top", "base.top", "base.bottom")
    return given(made.mesh, {name: made.facets(name) for name in names}, pressure, order)


class Held:
    """A problem whose bodies are held and led by whole facets.

    Args:
        g: What the script has.
        contacts: Its contacts.
        others: Conditions on other fields.
        options: Of PETSc.
    """

    def __init__(
        self, g: Given, contacts: Sequence[Contact], others: Sequence[Any] = (), **options: Any
    ) -> None:
        self.given, self.contacts = g, list(contacts)
        space = g.displacement
        free = space.collapse()[0] if space.component() else space
        self._value = fem.Function(free)
        bcs = [self._condition(space, free, self._value, "pad.top")]
        if "base.bottom" in g.facets:
            bcs.append(self._condition(space, free, fem.Function(free), "base.bottom"))
        self.problem = ContactProblem(
            g.form, g.w, bcs=[*bcs, *others], contacts=contacts, petsc_options=options
        )

    def _condition(self, space: Any, free: Any, value: Any, group: str) -> Any:
        facets = self.given.facets[group]
        if not space.component():
            return fem.dirichletbc(value, fem.locate_dofs_topological(space, 2, facets))
        dofs = fem.locate_dofs_topological((space, free), 2, facets)
        return fem.dirichletbc(value, dofs, space)

    def lead(self, way: Sequence[float]) -> None:
        """Bring the top to a displacement."""
        self._value.x.array.reshape(-1, 3)[:] = way

    def go(self, ways: Sequence[Sequence[float]]) -> np.ndarray:
        """Force on the first contact after each of the displacements of the top, (n, 3)."""
        forces = []
        for way in ways:
            self.lead(way)
            self.problem.solve()
            forces.append(self.contacts[0].resultant()[0])
        return np.array(forces)


#: Where laws are evaluated that are not told.
POINTS: dict[str, Any] = {"mortar": False}


def on_plate(g: Given, mu: tuple[float, float] = (0.3, 0.6), **options: Any) -> Contact:
    """The pad on a rigid plate."""
    return Contact(g.model, "pad.bottom", PLATE, law(mu=mu), **POINTS | options)


def on_base(g: Given, mu: tuple[float, float] = (0.3, 0.6), **options: Any) -> Contact:
    """The pad on the base."""
    return Contact(g.model, "pad.bottom", "base.top", law(mu=mu), **POINTS | options)


#: Ways to the contact forces.
WAYS: dict[str, dict[str, Any]] = {
    "penalty": {},
    "mortar": {"mortar": True},
    "multipliers": {"mortar": True, "augmentation": Augmentation()},
}


def main() -> None:
    """Forces of a pad of Taylor-Hood elements on a plate, and of a pair, on all processes."""
    found = {}
    for name, options in WAYS.items():
        one, two = pad(2, "linear", 2), pair("cells", 1)
        found[f"plate, {name}"] = Held(one, [on_plate(one, **options)]).go(PRESS_AND_DRAG[1::2])
        found[f"base, {name}"] = Held(two, [on_base(two, **options)]).go(PRESS_AND_DRAG[1::2])
    if MPI.COMM_WORLD.rank == 0:
        np.savez(Path(sys.argv[1]), allow_pickle=False, **found)


if __name__ == "__main__":
    main()
