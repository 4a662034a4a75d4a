"""Where a field has no direction it says so, and the caller names the point.

Source: requirement, an error that names the point and never a silent axis.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions, tensor
from anisocontact.base.errors import InputError
from anisocontact.interface import FAILURE, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface


def plane() -> Any:
    return make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))


def sphere() -> Any:
    return make_surface("sphere", centre=(0, 0, 0), radius=0.8, axis=(0, 0, 1), start=(1, 0, 0))


#: Field, surface, a singular coordinate, and one beside it that is regular.
CASES: dict[str, tuple[str, dict[str, Any], Any, Any, Any]] = {
    "pole": ("polar", {"axis": ((0.5, -2, 0), (0, 0, 1))}, plane, (0.5, -2.0), (0.5001, -2.0)),
    "axis of a thread": (
        "spiral",
        {"axis": ((0.5, -2, 0), (0, 0, 1)), "pitch": 1.0},
        plane,
        (0.5, -2.0),
        (0.5001, -2.0),
    ),
    "along the normal": ("constant", {"vector": (1, 0, 0)}, sphere, (0.0, 0.0), (1e-4, 0.0)),
    "oblique along the normal": (
        "oblique",
        {"vector": (1, 0, 0), "angle_first": 0.0, "angle_second": 1.0},
        sphere,
        (0.0, 0.0),
        (1e-4, 0.0),
    ),
    "projections parallel": (
        "from-vectors",
        {"first": (1, 1, 0), "second": (1, -1, 0)},
        sphere,
        (0.3, 0.0),  # both projections are along the equator
        (0.3, 1e-4),
    ),
    "ring along the normal": (
        "polar",
        {"axis": ((3, 0, 0), (0, 0, 1))},
        sphere,
        (float(np.arccos(0.8 / 3.0)), 0.0),  # the ring meets the sphere at a right angle
        (1.4, 0.1),
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_singular_point(case: str) -> None:
    """Not valid at the point, valid beside it; the error of `tensor` names the point."""
    kind, parameters, make, singular, regular = CASES[case]
    field, surface = make_directions(kind, **parameters), make()
    assert field.axes(surface, [singular, regular])[1].tolist() == [False, True]
    where = f"no direction at {list(singular)}".replace("[", r"\[").replace("]", r"\]")
    with pytest.raises(InputError, match=where):
        tensor(surface, [regular, singular], field, (2.0, 1.0))


def test_interface_reports_the_point() -> None:
    """The point on the pole fails with its state unchanged, the others do not."""
    field = make_directions("polar", axis=((0, 0, 0), (0, 0, 1)))
    interface = Interface(
        plane(),
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(2e3, 5e2), directions=field),
        Friction(coefficients=(0.3, 0.1), directions=field),
    )
    x = np.array([[0.5, 0.0, -1e-3], [0.0, 0.0, -1e-3], [0.0, 0.5, -1e-3]])
    state = interface.initial_state(x)
    r = interface.update(state, x)
    assert r.failed.tolist() == [False, True, False]
    assert "no direction" in FAILURE[r.failure[1]]
    assert np.array_equal(r.state[1], state[1])


def test_second_surface_reports_the_point_too() -> None:
    """The directions of the second surface are asked at the point as those of the first are."""
    m = make_directions("constant", vector=(1, 0, 0))
    k = make_directions("polar", axis=((0, 0, 0), (0, 0, 1)))
    interface = Interface(
        plane(),
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(2e3, 2e3)),
        Friction(model="he-curnier", alpha=(0.2, 0.1, 0.1), directions=m, directions_second=k),
    )
    x = np.array([[0.5, 0.0, -1e-3], [0.0, 0.0, -1e-3]])
    assert interface.update(interface.initial_state(x), x).failed.tolist() == [False, True]
