"""Laws of points: their strains, stresses and tangents, without a mesh."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
import scipy.linalg

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.bulk import PointResult, PointState, make_material
from anisocontact.bulk.strain import STRAINS, LogarithmicStrain, second_divided_difference
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
        second_divided_difference(a, b, np.array([2.0 + 0.05 * 2.03 + s])) for s in (-1e-13, 1e-13)
    )
    np.testing.assert_allclose(inside, outside, rtol=1e-12)
    np.testing.assert_allclose(second_divided_difference(a, a, a), -0.125, rtol=1e-15)


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


def _path(law: Any, strains: Floats, dt: float) -> tuple[Floats, Floats, Floats]:
    """Stress, and energies stored and dissipated since the start, after each strain of a path."""
    before = {name: np.zeros((1, *shape)) for name, shape in law.history.items()}
    found, lost = [], 0.0
    for strain in strains:
        result = law.update(PointState(strain[None], before, dt, np.zeros((1, 3))))
        before = dict(result.after)
        lost += float(result.dissipated[0])
        found.append((result.stress[0], float(result.stored[0]), lost))
    stress, stored, dissipated = zip(*found, strict=True)
    return np.array(stress), np.array(stored), np.array(dissipated)


POLYMER = {"E": 3.0, "nu": 0.3, "g": [0.3, 0.2], "tau": [0.5, 4.0], "k": [0.1, 0.05]}
SHEAR = 3.0 / 2.6


def _shear(gamma: Floats) -> Floats:
    """Strains of simple shears."""
    half = 0.5 * np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    return gamma[:, None, None] * half


def _modulus(times: Floats) -> Floats:
    """Relaxation modulus of shear."""
    decay = np.exp(-times[:, None] / np.array(POLYMER["tau"]))
    return np.asarray(SHEAR * (1.0 - (1.0 - decay) @ np.array(POLYMER["g"])))


def test_prony_relaxes() -> None:
    """Requirement: after a shear in no time the stress is `G(t) gamma`, whatever the increments.

    Source: definition of the series. Tolerance: rounding, the recurrence is exact.
    """
    law = make_material("viscoelastic", **POLYMER)
    for dt in (0.01, 1.0, 10.0):
        before = {name: np.zeros((1, *shape)) for name, shape in law.history.items()}
        strain = _shear(np.full(1, 0.02))
        result = law.update(PointState(strain, before, 0.0, np.zeros((1, 3))))
        assert result.stress[0, 0, 1] == pytest.approx(0.02 * SHEAR, rel=1e-14)
        assert result.dissipated[0] == pytest.approx(0.0, abs=1e-18)
        for m in range(1, 6):
            result = law.update(PointState(strain, result.after, dt, np.zeros((1, 3))))
            expected = 0.02 * _modulus(np.array([m * dt]))[0]
            assert result.stress[0, 0, 1] == pytest.approx(expected, rel=1e-13)


def test_prony_ramp() -> None:
    """A ramp of any increments: `sum_i G_i tau_i rate (1 - exp(-t/tau_i))`, to rounding, and a
    dilatation with its own shares."""
    law = make_material("viscoelastic", **POLYMER)
    rest = 1.0 - sum(POLYMER["g"])
    for n in (1, 7):
        t = np.linspace(0.0, 2.0, n + 1)[1:]
        stress, stored, lost = _path(law, _shear(0.01 * t), 2.0 / n)
        expected = rest * SHEAR * 0.01 * t
        for share, tau in zip(POLYMER["g"], POLYMER["tau"], strict=True):
            expected = expected + share * SHEAR * tau * 0.01 * -np.expm1(-t / tau)
        np.testing.assert_allclose(stress[:, 0, 1], expected, rtol=1e-13)
        # work of a ramp, the integral of the stress over the strain
        work = 0.5 * rest * SHEAR * 0.01**2 * 4.0
        for share, tau in zip(POLYMER["g"], POLYMER["tau"], strict=True):
            work += share * SHEAR * tau * 0.01**2 * (2.0 + tau * np.expm1(-2.0 / tau))
        assert stored[-1] + lost[-1] == pytest.approx(work, rel=1e-13)
        pressure, *_ = _path(law, (0.01 * t)[:, None, None] * np.eye(3) / 3.0, 2.0 / n)
        bulk = 3.0 / 1.2
        expected = np.zeros(n)
        for share, tau in zip(POLYMER["k"], POLYMER["tau"], strict=True):
            expected = expected + share * bulk * tau * 0.01 * -np.expm1(-t / tau)
        np.testing.assert_allclose(pressure[:, 0, 0], expected, rtol=1e-13)


def test_prony_cycles_by_order() -> None:
    """Requirement: order two in time where the strain is not linear in it.

    Source: storage and loss modulus of the series, `G' + i G'' = G_rest + sum_i G_i iw tau_i /
    (1 + iw tau_i)`, after the start has decayed; a quarter of the error at half the increment.
    Energy: what is dissipated in a cycle is `pi G'' gamma^2`, and never negative; its errors are
    even powers of the increment, of which two are extrapolated away. Tolerance: 1e-8.
    """
    law = make_material("viscoelastic", **{**POLYMER, "tau": [0.1, 0.5]})
    iw, errors = 2.0j * np.pi, []
    tau = np.array([0.1, 0.5])
    modulus = SHEAR * (0.5 + np.sum(np.array(POLYMER["g"]) * iw * tau / (1.0 + iw * tau)))
    cycles = []
    for n in (40, 80, 160):
        t = np.arange(1, 20 * n + 1) / n
        stress, _, lost = _path(law, _shear(0.01 * np.sin(2 * np.pi * t)), 1.0 / n)
        expected = 0.01 * np.imag(modulus * np.exp(iw * t[-n:]))
        errors.append(np.abs(stress[-n:, 0, 1] - expected).max())
        assert np.diff(lost).min() > 0.0
        cycles.append(lost[-1] - lost[-1 - n])
    assert 3.8 < errors[0] / errors[1] < 4.2
    first = [(4.0 * fine - coarse) / 3.0 for coarse, fine in itertools.pairwise(cycles)]
    extrapolated = (16.0 * first[1] - first[0]) / 15.0
    assert extrapolated == pytest.approx(np.pi * modulus.imag * 1e-4, rel=1e-8)


def test_prony_creeps() -> None:
    """Creep of one element beside a spring under a constant shear stress in 50, 100 increments.

    Source: `gamma = s/G_rest (1 - g exp(-t/tau_c))`, `tau_c = tau G/G_rest`, at once `s/G`.
    Tolerance: order two, a quarter of the error at half the increment; 1e-8 of the strain by
    Richardson's extrapolation of the two.
    """
    law = make_material("viscoelastic", E=3.0, nu=0.3, g=[0.6], tau=[1.0])
    ends = []
    for n in (50, 100):
        before = {name: np.zeros((1, *shape)) for name, shape in law.history.items()}
        for dt in [0.0] + [2.0 / n] * n:
            zero = law.update(PointState(np.zeros((1, 3, 3)), before, dt, np.zeros((1, 3))))
            gamma = (0.01 - zero.stress[0, 0, 1]) / zero.tangent[0, 0, 1, 0, 1]
            strain = _shear(np.array([gamma]))
            before = law.update(PointState(strain, before, dt, np.zeros((1, 3)))).after
        ends.append(gamma)
    exact = 0.01 / (0.4 * SHEAR) * (1.0 - 0.6 * np.exp(-2.0 * 0.4))
    assert 3.9 < (ends[0] - exact) / (ends[1] - exact) < 4.1
    assert (4.0 * ends[1] - ends[0]) / 3.0 == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize("strain", STRAINS)
def test_prony_tangent_by_order(strain: str) -> None:
    """At any state and increment, in either strain; at small strain the law is linear and central
    differences are exact to rounding, 1e-9."""
    law, rng = make_material("viscoelastic", **POLYMER, strain=strain), np.random.default_rng(6)
    gradient = _gradients(rng)
    n = len(gradient)
    before = {
        "strain": 0.1 * _symmetric(rng.normal(size=(n, 3, 3))),
        "elastic_strain": 0.1 * _symmetric(rng.normal(size=(n, 2, 3, 3))),
    }
    if strain == "logarithmic":
        ratio = _orders(law, gradient, before, 0.3)
        assert ((ratio > 3.7) & (ratio < 4.3)).all(), ratio
        return
    direction, h = _symmetric(rng.normal(size=(3, 3))), 1e-2
    ends = [_piola(law, gradient + s * h * direction, before, 0.3) for s in (1.0, -1.0)]
    exact = np.einsum("nijkl,kl->nij", _slope(law, gradient, before, 0.3), direction)
    np.testing.assert_allclose((ends[0] - ends[1]) / (2 * h), exact, atol=1e-9)


def _symmetric(tensor: Floats) -> Floats:
    return 0.5 * (tensor + np.swapaxes(tensor, -1, -2))


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"g": [0.3]}, "g: 1 shares given, 2 needed"),
        ({"g": [0.6, 0.4]}, "g: their sum is 1, must be < 1"),
        ({"tau": [1.0, 0.0]}, "tau: .* must be > 0"),
        ({"strain": "true"}, "strain: 'true' given, allowed: small, logarithmic"),
    ],
)
def test_prony_refuses(wrong: dict[str, Any], said: str) -> None:
    """What no series can be is one line."""
    with pytest.raises(InputError, match=said):
        make_material("viscoelastic", **{**POLYMER, **wrong})
