"""Linear viscoelasticity by a Prony series: Maxwell elements beside a spring."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.read_only import read_only
from anisocontact.base.registry import Entry, Parameter
from anisocontact.bulk.materials import Isotropic
from anisocontact.bulk.point_law import ElasticVolume, PointResult, PointState
from anisocontact.bulk.strain import STRAIN, STRAINS

#: The unit of symmetric tensors of fourth order, and its part in the trace.
_EYE = np.eye(3)
_TRACE = np.einsum("ij,kl->ijkl", _EYE, _EYE) / 3.0
_SYMMETRIC = 0.5 * (np.einsum("ik,jl->ijkl", _EYE, _EYE) + np.einsum("il,jk->ijkl", _EYE, _EYE))


class Viscoelastic(ElasticVolume, Isotropic):
    """`G(t) = G (1 - sum_i g_i (1 - exp(-t/tau_i)))`, and K(t) with k_i: generalised Maxwell.

    `sigma = sigma_rest + sum_i C_i q_i` with the strain q_i of the spring of each Maxwell element,
    `dq_i/dt = de/dt - q_i/tau_i`. The recurrence of an increment h, in which the strain is linear
    in time, is exact: `q_i -> exp(-x) q_i + (1 - exp(-x))/x (e - e_before)`, `x = h/tau_i`
    [Taylor Pister Goudreau 1970].

    Args:
        E: Young's modulus of what happens at once, > 0, stress.
        nu: Poisson's ratio of what happens at once, -1 < nu < 0.5.
        g: Share of the shear modulus that relaxes with each time; their sum is < 1.
        tau: Relaxation times, > 0, time.
        k: Share of the bulk modulus that does, as many or none; their sum is < 1.
        strain: "small", or "logarithmic" for bodies that turn or are strained far.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> polymer = Viscoelastic(E=3e3, nu=0.35, g=[0.4, 0.2], tau=[1.0, 10.0])
        >>> polymer.young
        3000.0
    """

    history: Mapping[str, tuple[int, ...]]
    entry = Entry(
        "viscoelastic",
        "material",
        "Prony series (generalised Maxwell) of shear and bulk modulus: polymers, bitumen, tissue",
        (
            Parameter(
                "E", "scalar", "stress", "Young's modulus of what happens at once", "positive"
            ),
            Parameter("nu", "scalar", "1", "Poisson's ratio of what happens at once"),
            Parameter("g", "array", "1", "shares of the shear modulus that relax", "non-negative"),
            Parameter("tau", "array", "time", "their relaxation times", "positive"),
            Parameter(
                "k",
                "array",
                "1",
                "shares of the bulk modulus that relax with these times; none if left out",
                "non-negative",
                required=False,
            ),
            STRAIN,
        ),
    )

    def __init__(
        self,
        *,
        E: float,
        nu: float,
        g: Sequence[float],
        tau: Sequence[float],
        k: Sequence[float] | None = None,
        strain: str = "small",
        field: str = "",
    ) -> None:
        super().__init__(E=E, nu=nu, g=g, tau=tau, k=k, strain=strain, field=field)
        self._tau = np.array(self._given["tau"])
        if not self._tau.size:
            place = f"{field}.tau" if field else "tau"
            raise InputError("[] given, one relaxation time or more is needed", place)
        no_shares = [0.0] * self._tau.size
        shares = (
            self._shares("g", self._given["g"], field),
            self._shares("k", self._given["k"] or no_shares, field),
        )
        self._branches = [
            2.0 * self.shear * in_shear * (_SYMMETRIC - _TRACE)
            + 3.0 * self.bulk_modulus * in_volume * _TRACE
            for in_shear, in_volume in zip(*shares, strict=True)
        ]
        rest = 1.0 - np.sum(shares, axis=1)
        self._long = 2.0 * self.shear * rest[0] * (_SYMMETRIC - _TRACE)
        self.bulk = float(self.bulk_modulus * rest[1])
        self.strain = tuple(STRAINS)[int(self._given["strain"][0])]
        self.history = read_only({"strain": (3, 3), "elastic_strain": (self._tau.size, 3, 3)})

    def _shares(self, name: str, given: Sequence[float], field: str) -> Floats:
        shares = np.array(given)
        place = f"{field}.{name}" if field else name
        if shares.size != self._tau.size:
            raise InputError(
                f"{shares.size} shares given, {self._tau.size} needed, one for each tau", place
            )
        if shares.sum() >= 1.0:
            raise InputError(f"their sum is {shares.sum():g}, must be < 1", place)
        return shares

    def update(self, state: PointState) -> PointResult:
        """Stress, tangent and energies; see `PointLaw`."""
        now, added = state.strain, state.strain - state.before["strain"]
        kept, taken, lost = _coefficients(state.dt / self._tau)
        stress = _applied(self._long, now)
        stored, dissipated = 0.5 * _inner(stress, now), np.zeros(len(now))
        tangent, springs = self._long.copy(), []
        for i, stiffness in enumerate(self._branches):
            before = state.before["elastic_strain"][:, i]
            springs.append(kept[i] * before + taken[i] * added)
            of_branch = _applied(stiffness, springs[-1])
            stress, tangent = stress + of_branch, tangent + taken[i] * stiffness
            stored += 0.5 * _inner(of_branch, springs[-1])
            by_before, by_added = _applied(stiffness, before), _applied(stiffness, added)
            for weight, pair in zip(
                lost[:, i],
                ((by_before, before), (by_before, added), (by_added, added)),
                strict=True,
            ):
                dissipated += weight * _inner(*pair)
        after = {"strain": now, "elastic_strain": np.stack(springs, axis=1)}
        slope = np.broadcast_to(tangent, (len(now), 3, 3, 3, 3))
        return PointResult(stress, slope, after, stored, dissipated)


def _coefficients(x: Floats) -> tuple[Floats, Floats, Floats]:
    """Of increments over relaxation times: what springs keep and take, and what they dissipate.

    Returns:
        `exp(-x)` and `(1 - exp(-x))/x`, (n,); weights of the squares of the strain of before, of
        its product with the strain that is added, and of the square of that, (3, n).
    """
    some = np.where(x == 0.0, 1.0, x)
    kept, taken = np.exp(-x), np.where(x == 0.0, 1.0, -np.expm1(-x) / some)
    # (1 - taken)/x, by its series where the difference cancels
    series = sum((-x) ** m / float(np.prod(np.arange(1, m + 3))) for m in range(10))
    left = np.where(x < 0.1, series, (1.0 - taken) / some)
    lost = np.stack([0.5 * (1.0 - kept**2), taken * (1.0 - kept), left - 0.5 * taken**2])
    return kept, taken, lost


def _applied(stiffness: Floats, strain: Floats) -> Floats:
    """Stress of strains, (n, 3, 3)."""
    return np.asarray((strain.reshape(-1, 9) @ stiffness.reshape(9, 9)).reshape(-1, 3, 3))


def _inner(a: Any, b: Any) -> Floats:
    return np.asarray(np.einsum("nij,nij->n", a, b))
