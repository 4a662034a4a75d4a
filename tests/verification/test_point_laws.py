"""Laws of points: their strains, stresses and tangents, without a mesh."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import PointResult, PointState, make_material
from anisocontact.bulk.strain import STRAINS, LogarithmicStrain, second_difference
from anisocontact.surfaces import Floats

RUBBER = {"mu": [0.63, 0.0012, -0.01], "alpha": [1.3, 5.0, -2.0], "bulk_modulus": 10.0}
#: Displacement gradients: none, a dilatation, two principal stretches the same or nearly so.
EQUAL = {
    "rest": np.zeros((3, 3)),
    "dilatation": 0.2 * np.eye(3),
    "uniaxial": np.diag([0.5, -0.1, -0.1]),
    "nearly": np.diag([0.5, -0.1, -0.1 + 1e-9]),
}


def _rotation(rng: np.random.Generator) -> Floats:
    found, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return np.asarray(found * np.linalg.det(found))


def _gradients(rng: np.random.Generator) -> Floats:
    """Displacement gradients of moderate size, and those of `EQUAL` turned."""
    turned = [_rotation(rng) @ (g + np.eye(3)) @ _rotation(rng) for g in EQUAL.values()]
    return np.concatenate([0.2 * rng.normal(size=(5, 3, 3)), np.stack(turned) - np.eye(3)])


def _at(law: Any, gradient: Floats, before: Any = None, dt: float = 0.0) -> PointResult:
    """A law at displacement gradients, from rest if not told otherwise."""
    n = len(gradient)
    none = {name: np.zeros((n, *shape)) for name, shape in law.history.items()}
    strain = STRAINS[law.strain](gradient)
    state = PointState(strain.value, none if before is None else before, dt, np.zeros((n, 3)))
    found: PointResult = law.update(state)
    return found


def _piola(law: Any, gradient: Floats, before: Any = None, dt: float = 0.0) -> Floats:
    return STRAINS[law.strain](gradient).piola(_at(law, gradient, before, dt).stress)


def _slope(law: Any, gradient: Floats, before: Any = None, dt: float = 0.0) -> Floats:
    found = _at(law, gradient, before, dt)
    return STRAINS[law.strain](gradient).tangent(found.stress, found.tangent)


def _orders(law: Any, gradient: Floats, before: Any = None, dt: float = 0.0) -> Floats:
    """Error of central differences at a step over that at half of it, of each point."""
    direction = np.random.default_rng(5).normal(size=(3, 3))
    exact = np.einsum("nijkl,kl->nij", _slope(law, gradient, before, dt), direction)
    errors = []
    for h in (4e-3, 2e-3):
        ends = [_piola(law, gradient + s * h * direction, before, dt) for s in (1.0, -1.0)]
        errors.append(np.linalg.norm((ends[0] - ends[1]) / (2 * h) - exact, axis=(1, 2)))
    return np.asarray(errors[0] / errors[1])


def test_logarithmic_strain() -> None:
    """`ln(C)/2` as of SciPy's matrix logarithm, to rounding; of small gradients to rounding of
    their own size, 1e-14 of it."""
    gradient = _gradients(np.random.default_rng(1))
    for h, e in zip(gradient, LogarithmicStrain(gradient).value, strict=True):
        f = np.eye(3) + h
        np.testing.assert_allclose(e, 0.5 * scipy.linalg.logm(f.T @ f).real, atol=1e-13)
    tiny = 1e-9 * np.diag([1.0, -2.0, 0.5])
    np.testing.assert_allclose(LogarithmicStrain(tiny[None]).value[0], tiny, atol=1e-17)


def test_second_difference_of_the_logarithm() -> None:
    """Its two branches meet: at a spread of 5 % difference and series agree to 1e-12, what
    cancellation leaves of 16 digits; three equal arguments give half of the second derivative."""
    a, b = np.array([2.0]), np.array([2.03])
    inside, outside = (
        second_difference(a, b, np.array([2.0 + 0.05 * 2.03 + s])) for s in (-1e-13, 1e-13)
    )
    np.testing.assert_allclose(inside, outside, rtol=1e-12)
    np.testing.assert_allclose(second_difference(a, a, a), -0.125, rtol=1e-15)


def test_ogden_tangent_by_order() -> None:
    """Requirement: the tangent is exact at any stretches, also where they are the same.

    Source: central differences, a quarter of the error at half the step. Tolerance: their next
    order, 3.8 to 4.2.
    """
    ratio = _orders(make_material("ogden", **RUBBER), _gradients(np.random.default_rng(2)))
    assert ((ratio > 3.8) & (ratio < 4.2)).all(), ratio


def test_ogden_with_two_is_neo_hookean() -> None:
    """One term with alpha = 2 is `mu/2 (I1 - 3)`: stress and tangent of uniform stretches, all
    the same, are those of its formula, to rounding."""
    law = make_material("ogden", mu=[0.8], alpha=[2.0], bulk_modulus=10.0)
    gradient = _gradients(np.random.default_rng(3))
    f = np.eye(3) + gradient
    j, first = np.linalg.det(f), np.einsum("nij,nij->n", f, f)
    inverse = np.swapaxes(np.linalg.inv(f), 1, 2)
    shape = 0.8 * j ** (-2 / 3)
    expected = shape[:, None, None] * (f - first[:, None, None] / 3 * inverse)
    np.testing.assert_allclose(_piola(law, gradient), expected, atol=1e-13)


def test_ogden_is_objective() -> None:
    """A rotation after the deformation turns the stress with it, to rounding."""
    law, rng = make_material("ogden", **RUBBER), np.random.default_rng(4)
    gradient, q = _gradients(rng), _rotation(rng)
    after = q @ (np.eye(3) + gradient) - np.eye(3)
    np.testing.assert_allclose(_piola(law, after), q @ _piola(law, gradient), atol=1e-13)
