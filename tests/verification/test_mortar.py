"""Mortar contact: the law at slave nodes, with dual functions over the overlaps of the facets."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

Floats = npt.NDArray[np.float64]

YOUNG, PRESSURE, PENALTY = 1000.0, 10.0, 4e4
CELLS = ("hexahedron", "tetrahedron")


def _blocks(cell: str, order: int, overhang: float = 0.0) -> Model:
    width = 1.0 + overhang
    upper = BoxSpec((0, 0, 0), (1, 1, 0.5), (4, 4, 2), cell=cell, order=order)
    lower = BoxSpec((0, 0, -0.5), (width, width, 0.5), (3, 3, 2), cell=cell, order=order)
    return build_box({"upper": upper, "lower": lower})


def _distort(model: Model, share: float) -> None:
    """Move the nodes where the bodies meet at random, inside of the border."""
    x = model.mesh.geometry.x
    inner = (np.abs(x[:, 2]) < 1e-9) & np.all(np.abs(x[:, :2] - 0.5) < 0.499, axis=1)
    x[inner, :2] += np.random.default_rng(3).uniform(-share, share, (inner.sum(), 2)) / 4.0


def _law() -> ContactLaw:
    adhesion, friction = Adhesion(stiffness=(1e3, 1e3)), Friction(coefficients=(0.3, 0.3))
    return ContactLaw(NormalLaw(penalty=PENALTY), adhesion, friction)


def _pressed(model: Model, augmented: bool) -> tuple[Contact, Floats, float]:
    """Uniform compression; the contact, the displacement and the overlap of a penalty."""
    augmentation = Augmentation(tangential=False) if augmented else None
    contact = Contact(
        model,
        "upper.bottom",
        "lower.top",
        _law(),
        mortar=True,
        current_area=False,
        augmentation=augmentation,
    )
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    problem = Problem(model, {"upper": elastic, "lower": elastic}, [contact])
    held: dict[str, Any] = {f"{body}.left": {"x": 0.0} for body in ("upper", "lower")}
    held |= {f"{body}.front": {"y": 0.0} for body in ("upper", "lower")}
    overlap = 0.0 if augmented else PRESSURE / PENALTY
    held |= {"lower.bottom": {"z": 0.0}, "upper.top": {"z": -(PRESSURE / YOUNG + overlap)}}
    for _ in Solver(problem, [Step("press", 1, held)]).run():
        pass
    return contact, problem.u.x.array.reshape(-1, 3), overlap


def _patch_errors(model: Model, augmented: bool) -> tuple[float, float]:
    contact, u, overlap = _pressed(model, augmented)
    at = model.space.tabulate_dof_coordinates()
    exact = 1e-2 * (np.array([0.3, 0.3, -1.0]) * (at + np.array([0.0, 0.0, 0.5])))
    exact[np.unique(model.space.dofmap.list[model.cells("upper")]), 2] -= overlap
    pressure = float(np.abs(contact.last.pressure / PRESSURE - 1.0).max())
    return pressure, float(np.abs(u - exact).max() / np.abs(exact).max())


@pytest.mark.parametrize("augmented", [False, True], ids=["penalty", "multipliers"])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("cell", CELLS)
def test_patch(cell: str, order: int, augmented: bool) -> None:
    """Uniform compression across meshes that do not match: 1e-8 at every node.

    Source: uniform stress. The dual functions of a facet sum to one, and products with the shape
    functions of the master are polynomials on triangles and parallelograms, which the rule
    integrates; what is left is Newton's tolerance times the condition of the system.
    """
    assert max(_patch_errors(_blocks(cell, order), augmented)) < 1e-8


@pytest.mark.parametrize("augmented", [False, True], ids=["penalty", "multipliers"])
@pytest.mark.parametrize(("cell", "order"), [("hexahedron", 1), ("tetrahedron", 1), ("tetrahedron", 2)])
def test_patch_of_distorted_facets(cell: str, order: int, augmented: bool) -> None:
    """The same with nodes moved by a quarter of a facet: 1e-5, on triangles Newton's tolerance.

    On quadrilaterals that are no parallelograms shape functions are no polynomials of the position.
    """
    model = _blocks(cell, order)
    _distort(model, 0.25)
    assert max(_patch_errors(model, augmented)) < (1e-5 if cell == "hexahedron" else 1e-7)
