"""Ogden's rubber: powers of the principal stretches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from anisocontact.base import registry
from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Entry, Parameter
from anisocontact.base.sealed import Sealed
from anisocontact.bulk.materials import constant
from anisocontact.bulk.point_law import ElasticVolume, PointResult, PointState
from anisocontact.bulk.rubber import BULK
from anisocontact.bulk.strain import spectral, turned
from anisocontact.bulk.volume import Volume, volume_ratio


class Ogden(Sealed, ElasticVolume):
    """`W = sum_p mu_p/alpha_p (s1^alpha_p + s2^alpha_p + s3^alpha_p - 3) + K/2 (J - 1)^2`.

    The s are the principal stretches over `J^(1/3)` [Ogden 1972]. In the logarithmic strain, whose
    eigenvalues h have `s = exp(h - mean)`, stress and tangent are exact where stretches are the
    same: `(s_a^alpha - s_b^alpha) / (h_a - h_b)` is `s_b^alpha expm1(alpha d)/d`, `d = h_a - h_b`.

    Args:
        mu: A modulus for each term, stress.
        alpha: As many exponents, none of them 0; the shear modulus at rest,
            `sum mu_p alpha_p / 2`, has to be > 0.
        bulk_modulus: K, > 0, stress; its pressure is one of every cell, see `Volume`.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> Ogden(mu=[1.0], alpha=[2.0], bulk_modulus=1e3).young
        2.9990003332222592
    """

    strain = "logarithmic"
    history: Mapping[str, tuple[int, ...]] = MappingProxyType({})
    entry = Entry(
        "ogden",
        "material",
        "rubber by powers of its principal stretches, with a pressure in every cell",
        (
            Parameter("mu", "array", "stress", "modulus of each term"),
            Parameter("alpha", "array", "1", "exponent of each term, none of them 0"),
            BULK,
        ),
    )

    def __init__(
        self,
        *,
        mu: Sequence[float],
        alpha: Sequence[float],
        bulk_modulus: float,
        field: str = "",
    ) -> None:
        given = {"mu": mu, "alpha": alpha, "bulk_modulus": bulk_modulus}
        values = registry.values(self.entry, given, field)
        self._mu, self._alpha = np.array(values["mu"]), np.array(values["alpha"])
        (self.bulk,) = values["bulk_modulus"]
        place = f"{field}.alpha" if field else "alpha"
        if self._mu.shape != self._alpha.shape:
            text = f"{self._alpha.size} exponents given, {self._mu.size} needed, one for each mu"
            raise InputError(text, place)
        if not self._alpha.all():
            raise InputError(f"{alpha!r} given, exponents must not be zero", place)
        shear = 0.5 * float(self._mu @ self._alpha)
        if shear <= 0.0:
            text = f"shear modulus at rest {shear:g}, must be > 0: half the sum of mu times alpha"
            raise InputError(text, f"{field}.mu" if field else "mu")
        self.young = 9.0 * self.bulk * shear / (3.0 * self.bulk + shear)

    def volume(self, u: Any) -> Volume:
        """`J - 1`."""
        return Volume(constant(u, self.bulk), volume_ratio)

    def curvature(self, logs: Floats) -> Floats:
        """As of `stability.Rubber`."""
        powers = np.exp(np.multiply.outer(self._alpha, logs))
        return np.diag((self._mu * self._alpha) @ powers)

    def update(self, state: PointState) -> PointResult:
        """Stress, tangent and energy of the distortion; see `PointLaw`."""
        values, axes = _axes(state.strain)
        distortion = values - values.mean(1, keepdims=True)
        stresses, energy = np.zeros_like(values), np.zeros(len(values))
        normal, shear = np.zeros((2, len(values), 3, 3))
        apart = values[:, :, None] - values[:, None, :]
        same = apart == 0.0
        for mu, alpha in zip(self._mu, self._alpha, strict=True):
            power = np.exp(alpha * distortion)
            off = power - power.mean(1, keepdims=True)
            stresses += mu * off
            energy += mu / alpha * np.expm1(alpha * distortion).sum(1)
            by_itself = power[:, :, None] * (np.eye(3) - 1.0 / 3.0)
            normal += mu * alpha * (by_itself - off[:, None, :] / 3.0)
            quotient = np.where(same, alpha, np.expm1(alpha * apart) / np.where(same, 1.0, apart))
            shear += 0.5 * mu * quotient * power[:, None, :]
        slope = turned(_laid_out(normal, shear), np.swapaxes(axes, -1, -2))
        return PointResult(spectral(stresses, axes), slope, {}, energy, np.zeros(len(values)))


def _laid_out(normal: Floats, shear: Floats) -> Floats:
    """`dT/dE` along the axes of both: T_aa by E_bb, and T_ab by E_ab and E_ba."""
    slope = np.zeros((len(normal), 3, 3, 3, 3))
    a, b = np.indices((3, 3))
    slope[:, a, a, b, b] = normal
    a, b = a[a != b], b[a != b]
    slope[:, a, b, a, b] = slope[:, a, b, b, a] = shear[:, a, b]
    return slope


def _axes(strain: Floats) -> tuple[Floats, Floats]:
    """Eigenvalues and axes of symmetric tensors; NaN of what is not a number."""
    lost = ~np.isfinite(strain).all(axis=(1, 2))
    values, axes = np.linalg.eigh(np.where(lost[:, None, None], 0.0, strain))
    values[lost] = np.nan
    return values, axes
