"""The physical tensor does not depend on the coordinates of the surface.

Requirement: the spatial tensor and the answer of an interface are the same in any
parametrisation, 1e-10; components follow the rule of transformation. Source: covariance
[Konyukhov Schweizerhof 2006, eq. (55), (57)].
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions, tensor
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

LIMIT = 1e-10
VALUES = (4.0, 1.0)

#: The same surface with two sets of coordinates.
PAIRS: dict[str, tuple[Any, Any]] = {
    "plane": (
        ("plane", {"point": (0, 0, 0), "normal": (0, 1, 2), "tangent": (1, 0, 0)}),
        ("plane", {"point": (3, -2, 1), "normal": (0, 1, 2), "tangent": (1, 2, 5)}),
    ),
    "cylinder": (
        ("cylinder", {"point": (0, 0, 0), "axis": (0, 0, 1), "radius": 0.8, "start": (1, 0, 0)}),
        ("cylinder", {"point": (0, 0, 5), "axis": (0, 0, -1), "radius": 0.8, "start": (1, 2, 0)}),
    ),
    "sphere": (
        ("sphere", {"centre": (0, 0, 0), "radius": 0.8, "axis": (0, 0, 1), "start": (1, 0, 0)}),
        ("sphere", {"centre": (0, 0, 0), "radius": 0.8, "axis": (1, 1, 0), "start": (0, 0, 1)}),
    ),
}

#: Fields that are given in space; coordinate lines and grids belong to their coordinates.
FIELDS: dict[str, dict[str, Any]] = {
    "constant": {"vector": (1.0, 0.3, 0.2), "angle": 0.4},
    "oblique": {"vector": (1.0, 0.3, 0.2), "angle_first": 0.2, "angle_second": 1.3},
    "polar": {"axis": ((9, 7, -8), (0.2, -0.5, 1.0)), "angle": 0.3},
    "spiral": {"axis": ((9, 7, -8), (0.2, -0.5, 1.0)), "pitch": 20.0},
    "from-vectors": {"first": (1.0, 0.3, 0.2), "second": (-0.2, 1.0, 0.5)},
}


def surfaces_and_points(name: str) -> tuple[Any, Any, Any]:
    """Both surfaces and random points near them."""
    a, b = (make_surface(shape, **parameters) for shape, parameters in PAIRS[name])
    xi = np.random.default_rng(2).uniform(-1.2, 1.2, (300, 2))
    return a, b, a.position(xi)


def scattered(x: Any) -> dict[str, Any]:
    """A table of directions at points of the surface."""
    return {"points": x, "vectors": np.cross((0.2, -0.5, 1.0), x - (9, 7, -8)), "radius": 1.0}


@pytest.mark.parametrize("kind", [*FIELDS, "tabulated-points"])
@pytest.mark.parametrize("name", PAIRS)
def test_spatial_tensor(name: str, kind: str) -> None:
    """Tolerance: the requirement; points where a direction is within 1e-3 of the normal lose
    three digits and are left out."""
    a, b, x = surfaces_and_points(name)
    field = make_directions(kind, **(FIELDS[kind] if kind in FIELDS else scattered(x)))
    xi, eta = a.project(x).xi, b.project(x).xi
    valid = field.axes(a, xi)[1]
    xi, eta = xi[valid], eta[valid]
    first, second = (tensor(s, c, field, VALUES, "spatial") for s, c in ((a, xi), (b, eta)))
    assert len(xi) > 250
    assert np.abs(first - second).max() < LIMIT * max(VALUES)


@pytest.mark.parametrize("placement", ["co", "contra", "mixed"])
def test_components_in_another_basis(placement: str) -> None:
    """A'_ij = J^k_i J^l_j A_kl and its counterparts for g_i = J^k_i rho_k, by tensor algebra."""
    surface = make_surface("sphere", centre=(0, 0, 0), radius=0.8)
    xi = np.random.default_rng(2).uniform(-1.2, 1.2, (300, 2))
    field = make_directions("constant", vector=(1.0, 0.3, 0.2))
    j = np.array([[1.3, -0.4], [0.7, 2.1]])
    basis = np.einsum("ik,nkc->nic", j, surface.jet(xi).d1)
    new = tensor(surface, xi, field, VALUES, placement, basis=basis)
    old = tensor(surface, xi, field, VALUES, placement)
    inverse = np.linalg.inv(j)
    expected = {
        "co": j @ old @ j.T,
        "contra": inverse.T @ old @ inverse,
        "mixed": inverse.T @ old @ j.T,
    }[placement]
    scale = np.abs(expected).max(axis=(1, 2))
    assert np.all(np.abs(new - expected).max(axis=(1, 2)) < LIMIT * scale)


@pytest.mark.parametrize("model", ["orthotropic", "he-curnier"])
@pytest.mark.parametrize("name", PAIRS)
def test_answer_of_an_interface(name: str, model: str) -> None:
    """Traction and tangent of sliding points are the same in both coordinates.

    Tolerance: 1e-10 of the largest entry, the requirement.
    """
    results = []
    for surface in surfaces_and_points(name)[:2]:
        second = make_directions("constant", vector=(0.1, 1.0, -0.4))
        friction: dict[str, Any] = {
            "orthotropic": {"coefficients": (0.3, 0.1)},
            "he-curnier": {"alpha": (0.3, -0.1, 0.15), "directions_second": second},
        }[model]
        field = make_directions("polar", **FIELDS["polar"])
        interface = Interface(
            surface,
            NormalLaw(penalty=1e3),
            Adhesion(stiffness=(2e3, 5e2), directions=field),
            Friction(model=model, directions=field, **friction),
        )
        a, _, x = surfaces_and_points(name)
        normal = a.geometry(a.project(x).xi).normal
        state = interface.initial_state(x - 1e-3 * normal)
        slip = np.array([2e-3, 1e-3, -1e-3])
        slip = slip - (normal @ slip)[:, None] * normal
        r = interface.update(state, x - 1.1e-3 * normal + slip)
        assert not r.failed.any() and (r.status == 2).mean() > 0.9
        results.append(r)
    for quantity in ("traction", "tangent"):
        first, second = (getattr(r, quantity) for r in results)
        assert np.abs(first - second).max() < LIMIT * np.abs(first).max()
