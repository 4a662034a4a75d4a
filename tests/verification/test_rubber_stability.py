"""Rubbers that are stable at some stretches alone: what is said of them, and where."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import ThermalExpansion, make_material
from anisocontact.bulk.stability import stable_range, unstable_rubbers

TRELOAR = {"mu": (0.63, 0.0012, -0.01), "alpha": (1.3, 5.0, -2.0)}


def _mooney(x: Any) -> float:
    return float(0.3 * (np.exp(2 * x).sum() - 3) - 0.1 * (np.exp(-2 * x).sum() - 3))


def _yeoh(x: Any) -> float:
    over = np.exp(2 * x).sum() - 3
    return float(0.5 * over - 0.1 * over**2 + 0.01 * over**3)


def _ogden(x: Any) -> float:
    terms = zip(TRELOAR["mu"], TRELOAR["alpha"], strict=True)
    return float(sum(m / a * (np.exp(a * x).sum() - 3) for m, a in terms))


MADE = {
    "mooney-rivlin": ({"C10": 0.3, "C01": -0.1}, _mooney),
    "yeoh": ({"C10": 0.5, "C20": -0.1, "C30": 0.01}, _yeoh),
    "ogden": (TRELOAR, _ogden),
}


@pytest.mark.parametrize("name", MADE)
def test_curvature_is_that_of_the_energy(name: str) -> None:
    """Requirement: second derivatives by the logarithmic stretches, which keep the volume.

    Source: central differences of the energy, written once more by the stretches; 1e-6, their
    rounding at a step of 1e-4.
    """
    given, energy = MADE[name]
    rubber: Any = make_material(name, **given, bulk_modulus=100.0)
    logs, h, eye = np.array([0.4, -0.1, -0.3]), 1e-4, np.eye(3)
    steps = [(i, j, s, t) for i in range(3) for j in range(3) for s in (1, -1) for t in (1, -1)]
    found = np.zeros((3, 3))
    for i, j, s, t in steps:
        found[i, j] += s * t * energy(logs + h * (s * eye[i] + t * eye[j])) / (4.0 * h * h)
    np.testing.assert_allclose(rubber.curvature(logs), found, atol=1e-6 * np.abs(found).max())


def test_mooney_rivlin_loses_its_shape_at_the_root() -> None:
    """Requirement: with `C01 < 0` a bar in tension may flatten beyond `s^2 = - C10 / C01`.

    Source: both stretches across have the curvature `4 (C10/s + C01 s)`, zero there. Tolerance: a
    step of the search, `4^(1/200) - 1`.
    """
    rubber: Any = make_material("mooney-rivlin", C10=1.0, C01=-0.5, bulk_modulus=100.0)
    _, most = stable_range(rubber, "tension or compression")
    assert np.sqrt(2.0) / 4.0**0.005 < most <= np.sqrt(2.0)


def test_what_is_said() -> None:
    """A body of such a rubber is named, heated or not; stable ones are not."""
    soft = make_material("mooney-rivlin", C10=1.0, C01=-0.5, bulk_modulus=100.0)
    good = make_material("mooney-rivlin", C10=1.0, C01=0.5, bulk_modulus=100.0)
    treloar = make_material("ogden", **TRELOAR, bulk_modulus=100.0)
    steel = make_material("linear-elastic", E=1.0, nu=0.3)
    bodies = {"a": soft, "b": good, "c": treloar, "d": steel, "e": ThermalExpansion(soft, 1e-4)}
    said = unstable_rubbers(bodies)
    assert [line.partition(":")[0] for line in said] == ["body 'a'", "body 'e'"]
    assert "tension or compression below 0.70 and beyond 1.41" in said[0]
