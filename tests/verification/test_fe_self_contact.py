"""A body that folds onto itself: a closing hairpin against its symmetric half on a rigid plane."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Model
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

GAP, THICKNESS, LEG, WIDTH = 0.4, 0.3, 3.0, 0.6
ALONG, AROUND, ACROSS, THROUGH = 20, 8, 2, 2
HELD = 4  # cells at the end of a leg whose outer side is moved
PENALTY = 2e4
LAWS: dict[str, Any] = {
    "adhesion": Adhesion(stiffness=(1e4, 1e4)),
    "friction": Friction(coefficients=(1e-9, 1e-9)),
}


def hairpin(half: bool) -> Model:
    """A strip bent to a U that opens towards +x, or its upper half: a leg and half of the bend."""
    legs = np.concatenate(
        [np.linspace(LEG, 0.0, ALONG + 1)[:-1], np.linspace(0.0, -np.pi, AROUND + 1)]
    )
    if half:
        legs = legs[: ALONG + AROUND // 2 + 1]
    else:
        legs = np.concatenate([legs, -np.pi - np.linspace(0.0, LEG, ALONG + 1)[1:]])
    depth = np.linspace(0.5 * GAP, 0.5 * GAP + THICKNESS, THROUGH + 1)
    s, y, r = np.meshgrid(legs, np.linspace(0.0, WIDTH, ACROSS + 1), depth, indexing="ij")
    turn = np.clip(-s, 0.0, np.pi)
    x = np.where(s > 0.0, s, np.where(s < -np.pi, -np.pi - s, -r * np.sin(turn)))
    points = np.stack([x, y, r * np.cos(turn)], axis=-1).reshape(-1, 3)
    shape = s.shape
    number = np.arange(s.size).reshape(shape)
    near, far = slice(None, -1), slice(1, None)
    cells = np.stack(
        [
            number[i, j, k].reshape(-1)
            for k in (near, far)
            for j in (far, near)
            for i in (near, far)
        ],
        axis=1,
    )
    place = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, 3)
    sides = cells[:, CELL_FACETS["hexahedron"]].reshape(-1, 4)
    at = place[sides]
    outer = np.all(at[..., 2] == THROUGH, axis=1)
    facets = {
        "pin.inner": sides[np.all(at[..., 2] == 0, axis=1)],
        "pin.upper": sides[outer & np.all(at[..., 0] <= HELD, axis=1)],
    }
    last = shape[0] - 1
    if half:
        facets["pin.cut"] = sides[np.all(at[..., 0] == last, axis=1)]
    else:
        facets["pin.lower"] = sides[outer & np.all(at[..., 0] >= last - HELD, axis=1)]
    bodies = {"pin": np.arange(len(cells))}
    return Model.from_arrays(MeshArrays("hexahedron", 1, points, cells, bodies, facets, 1))


def folding(model: Model, law: ContactLaw, **options: Any) -> Contact:
    """Contact of the inner side of the pin with itself."""
    return Contact(model, "pin.inner", "pin.inner", law, self_contact=True, **options)


def _close(model: Model, contact: Any, material: str, depth: float) -> list[np.ndarray]:
    """Force on the upper end after each increment of the ends moving together by twice `depth`."""
    problem = Problem(model, {"pin": make_material(material, E=1000.0, nu=0.3)}, [contact])
    ends = {"pin.upper": {"x": 0.0, "y": 0.0, "z": -depth}}
    if "pin.lower" in model.facet_names():
        ends["pin.lower"] = {"x": 0.0, "y": 0.0, "z": depth}
    else:
        ends["pin.cut"] = {"z": 0.0}
    solver = Solver(problem, [Step("close", 5, ends)], options={"snes_rtol": 1e-10})
    return [accepted.reactions["pin.upper"] for accepted in solver.run()]


@pytest.mark.parametrize("material", ["linear-elastic", "neo-hookean"])
def test_hairpin_against_its_half(material: str) -> None:
    """The force that closes a hairpin is that of its half on a rigid plane.

    Requirement: every side of the fold carries half of the contact. Source: symmetry; where the
    sides overlap by g each half lies g/2 deep in the plane of symmetry, so that twice the penalty
    there gives the same pressure. Without friction, as only the half slides. Tolerance 5e-6: the
    sides are tilted by some 1e-3 where they meet, and the distance to the other side and to the
    plane differ by the square of that; 6e-7 measured.
    """
    finite = material != "linear-elastic"
    depth = 0.5 * GAP + 2e-3
    whole = hairpin(half=False)
    law = ContactLaw(NormalLaw(penalty=PENALTY), **LAWS)
    folded = folding(whole, law, apart=0.3, current_area=finite)
    forces = _close(whole, folded, material, depth)
    upper = hairpin(half=True)
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    interface = Interface(plane, NormalLaw(penalty=2.0 * PENALTY), **LAWS)
    rigid = Contact(upper, "pin.inner", interface, current_area=finite)
    expected = _close(upper, rigid, material, depth)
    scale = abs(expected[-1][2])
    assert scale > 3.0 * abs(expected[-2][2])  # the sides meet in the last increment
    assert folded.counts()["open"] < len(folded.points)
    assert np.abs(np.array(forces) - np.array(expected)).max() < 5e-6 * scale


def test_what_is_near_from_the_beginning_does_not_meet() -> None:
    """Sides of a gap narrower than `apart` pass through each other; with less they meet."""
    model = hairpin(half=False)
    law = ContactLaw(NormalLaw(penalty=PENALTY), **LAWS)
    forces = {
        apart: _close(model, folding(model, law, apart=apart), "linear-elastic", 0.205)
        for apart in (0.3, 0.5)
    }
    assert abs(forces[0.3][-1][2]) > 10.0 * abs(forces[0.5][-1][2])


def test_mistakes_are_said() -> None:
    """A group against itself needs to say so; the distance has to be positive."""
    model = hairpin(half=False)
    law = ContactLaw(NormalLaw(penalty=PENALTY), **LAWS)
    with pytest.raises(InputError, match=r"master: .*share 96 facets"):
        Contact(model, "pin.inner", "pin.inner", law=law)
    with pytest.raises(InputError, match=r"apart: -1.0 given, must be > 0"):
        folding(model, law, apart=-1.0)
