"""Plasticity with a quadratic yield condition: von Mises (J2) and Hill.

`sqrt(x : M : x) <= Y(p)` of the stress less the back stress, `x = dev(T) - b`; M is constant along
the axes of the material and knows no pressure. The flow is associated, `d(e_p) = dp N`,
`N = M x / Y`, hardening isotropic in p and kinematic, `d(b) = 2/3 C d(e_p) - c b dp`
[Armstrong Frederick 1966; Prager 1955 where c = 0]. Backward Euler leaves one equation for dp at
each point, because M is diagonal in a basis of five tensors that does not change
[Simo Hughes 1998, ch. 3.3].
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.read_only import ReadOnlyDict
from anisocontact.base.registry import Entry, Parameter
from anisocontact.bulk.axes import AROUND, SECOND, MaterialAxes, check_axes, first_axis
from anisocontact.bulk.hardening import HARDENING, check_recovery, make_hardening
from anisocontact.bulk.materials import Isotropic
from anisocontact.bulk.point_law import ElasticVolume, PointResult, PointState
from anisocontact.bulk.strain import STRAIN, STRAINS

#: Name of the equivalent plastic strain p among what points remember.
PLASTIC_STRAIN = "equivalent_plastic_strain"
#: Share of the yield stress by which a trial stress has to be beyond it.
_BEYOND = 1e-12
#: Share of the yield stress to which the condition is met, and the most iterations for it.
_MET, _MOST = 1e-14, 60
#: Orthonormal basis of symmetric tensors: 11, 22, 33, 12, 13, 23, (6, 9).
_BASIS: Floats = np.zeros((6, 9))
_BASIS[(0, 1, 2), (0, 4, 8)] = 1.0
_BASIS[(3, 4, 5), (1, 2, 5)] = _BASIS[(3, 4, 5), (3, 6, 7)] = np.sqrt(0.5)

_ELASTIC = (
    Parameter("E", "scalar", "stress", "Young's modulus", "positive"),
    Parameter("nu", "scalar", "1", "Poisson's ratio, between -1 and 0.5"),
)
_KINEMATIC = (
    Parameter(
        "kinematic",
        "scalar",
        "stress",
        "modulus C of kinematic hardening, d(back stress) over d(plastic strain) of a bar",
        "non-negative",
        False,
        (0.0,),
    ),
    Parameter(
        "recovery",
        "scalar",
        "1",
        "rate c at which the back stress is forgotten; it saturates at C/c",
        "non-negative",
        False,
        (0.0,),
    ),
    STRAIN,
)


class Plastic(ElasticVolume, Isotropic):
    """Isotropic elasticity and von Mises plasticity (J2), isotropic and kinematic hardening.

    Args:
        E: Young's modulus, > 0, stress.
        nu: Poisson's ratio, -1 < nu < 0.5.
        yield_stress: First yield stress Y, stress.
        hardening: Linear hardening H, stress.
        saturation: Q of Voce's `Q (1 - exp(-b p))`, stress.
        saturation_rate: b.
        flow_curve: Pairs of plastic strain and yield stress, instead of the four.
        kinematic: C of the back stress, stress.
        recovery: c of the back stress; Prager's linear hardening if 0.
        strain: "small", or "logarithmic" for bodies that turn or are strained far.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> steel = Plastic(E=210e3, nu=0.3, yield_stress=235.0, hardening=1e3)
        >>> steel.strain
        'small'
    """

    history: Mapping[str, tuple[int, ...]] = ReadOnlyDict(
        {"plastic_strain": (3, 3), "back_stress": (3, 3), PLASTIC_STRAIN: ()}
    )
    entry = Entry(
        "plastic",
        "material",
        "von Mises (J2) plasticity of metals, isotropic and kinematic hardening",
        (*_ELASTIC, *HARDENING, *_KINEMATIC),
    )

    def __init__(self, *, E: float, nu: float, field: str = "", **others: Any) -> None:
        super().__init__(E=E, nu=nu, field=field, **others)
        given = self._given
        self.bulk = self.bulk_modulus
        self.strain = tuple(STRAINS)[int(given["strain"][0])]
        self._yield = make_hardening(given, field)
        check_recovery(given, field)
        (self._prager,), (self._recovery,) = given["kinematic"], given["recovery"]
        # without the change of volume, which does nothing
        weights, vectors = np.linalg.eigh(self._condition(field))
        if weights[1] <= 1e-9 * weights[-1]:
            text = "no yield surface: it is open along a stress, see the equations of the material"
            raise InputError(text, field or self.entry.name)
        self._weights = weights[1:]
        self._tensors = (vectors[:, 1:].T @ _BASIS).reshape(5, 3, 3)

    @property
    def elastic_tangent(self) -> Floats:
        """Derivative of the stress by the strain without flow, (3, 3, 3, 3), stress."""
        basis = self._tensors.reshape(5, 9)
        return (2.0 * self.shear * (basis.T @ basis)).reshape(3, 3, 3, 3)

    def _condition(self, field: str) -> Floats:
        """M along the axes of the material in the basis of this file, (6, 6)."""
        found = np.diag([1.5] * 6)
        found[:3, :3] -= 0.5
        return found

    def _basis(self, places: Floats) -> Floats:
        """Deviators in which M is diagonal, (n or 1, 5, 9)."""
        return self._tensors.reshape(1, 5, 9)

    def update(self, state: PointState) -> PointResult:
        """Stress, tangent, plastic strains and energies; see `PointLaw`."""
        n, g = len(state.strain), 2.0 * self.shear
        basis = self._basis(state.place)
        strain, plastic, back = (
            (basis @ t.reshape(n, 9, 1))[..., 0]
            for t in (state.strain, state.before["plastic_strain"], state.before["back_stress"])
        )
        p = state.before[PLASTIC_STRAIN]
        trial = g * (strain - plastic)
        size = np.sqrt(((trial - back) ** 2 * self._weights).sum(1))
        flows = np.flatnonzero(size > self._yield.at(p)[0] * (1.0 + _BEYOND))
        flow = self._flow(trial[flows], back[flows], p[flows])
        added, new_back, new_p = np.zeros_like(trial), back.copy(), p.copy()
        added[flows], new_back[flows] = flow.added, flow.back
        new_p[flows] += flow.multiplier
        tangent = np.broadcast_to(g * np.eye(5), (n, 5, 5)).copy()
        tangent[flows] = flow.tangent
        stress = trial - g * added
        kinematic = 0.75 / self._prager if self._prager else 0.0
        held = kinematic * ((new_back**2).sum(1) - (back**2).sum(1))
        after = {
            "plastic_strain": _tensor(plastic + added, basis),
            "back_stress": _tensor(new_back, basis),
            PLASTIC_STRAIN: new_p,
        }
        return PointResult(
            stress=_tensor(stress, basis),
            tangent=(np.swapaxes(basis, 1, 2) @ tangent @ basis).reshape(n, 3, 3, 3, 3),
            after=after,
            stored=(stress**2).sum(1) / (2.0 * g) + kinematic * (new_back**2).sum(1),
            dissipated=(stress * added).sum(1) - held,
        )

    def _flow(self, trial: Floats, back: Floats, p: Floats) -> _PlasticFlow:
        """Plastic flow of points that are beyond the yield condition."""
        low = np.zeros(len(p))
        sizes = [np.sqrt((v**2 * self._weights).sum(1)) for v in (trial, back)]
        high = (sizes[0] + sizes[1]) / (2.0 * self.shear * self._weights[0])
        multiplier = low.copy()
        for _ in range(_MOST):
            now = self._returned(trial, back, p, multiplier)
            # nearly linear in the multiplier, and rising
            off = now.limit / now.size - 1.0
            if (np.abs(off) <= _MET).all():
                break
            slope = now.limit_slope / now.size - now.limit * now.size_slope / now.size**2
            low, high = np.where(off < 0.0, multiplier, low), np.where(off < 0.0, high, multiplier)
            newton = multiplier - off / slope
            inside = (newton >= low) & (newton <= high)
            multiplier = np.where(inside, newton, 0.5 * (low + high))
        return self._answer(now, trial, back, multiplier)

    def _returned(self, trial: Floats, back: Floats, p: Floats, multiplier: Floats) -> _Returned:
        """Stress less back stress at trial multipliers, with derivatives by them."""
        limit, limit_slope = self._yield.at(p + multiplier)
        kept = 1.0 / (1.0 + self._recovery * multiplier)
        kept_slope = -self._recovery * kept**2
        resists = 2.0 * self.shear + 2.0 / 3.0 * self._prager * kept
        over = multiplier * resists / limit
        over_slope = (
            resists + multiplier * 2.0 / 3.0 * self._prager * kept_slope - over * limit_slope
        ) / limit
        shrunk = 1.0 + over[:, None] * self._weights
        offset = (trial - kept[:, None] * back) / shrunk
        along = self._weights * offset
        offset_slope = -(kept_slope[:, None] * back + over_slope[:, None] * along) / shrunk
        size = np.sqrt((along * offset).sum(1))
        size_slope = (along * offset_slope).sum(1) / size
        return _Returned(limit, limit_slope, kept, shrunk, along, offset_slope, size, size_slope)

    def _answer(
        self, at: _Returned, trial: Floats, back: Floats, multiplier: Floats
    ) -> _PlasticFlow:
        g = 2.0 * self.shear
        share = multiplier / at.limit
        share_slope = (1.0 - share * at.limit_slope) / at.limit
        added = share[:, None] * at.along
        new_back = at.kept[:, None] * (back + 2.0 / 3.0 * self._prager * added)
        # the condition ties the multiplier to the trial stress
        by_trial = at.along / at.size[:, None] / at.shrunk
        by_trial /= (at.limit_slope - at.size_slope)[:, None]
        moved = share_slope[:, None] * at.along + share[:, None] * self._weights * at.offset_slope
        direct = 1.0 - g * share[:, None] * self._weights / at.shrunk
        tangent = g * (direct[:, :, None] * np.eye(5) - g * moved[:, :, None] * by_trial[:, None])
        return _PlasticFlow(multiplier, added, new_back, tangent)


class Hill(Plastic):
    """Plasticity of a rolled sheet: Hill's yield condition of 1948, isotropic elasticity.

    `F (s22 - s33)^2 + G (s33 - s11)^2 + H (s11 - s22)^2 + 2 L s23^2 + 2 M s13^2 + 2 N s12^2 = Y^2`
    along the axes of the material. All else is as of `Plastic`.

    Args:
        ratios: R11, R22, R33, R12, R13, R23: yield stress of each component over Y, of shears
            over `Y / sqrt(3)`.
        lankford: Instead of them r0, r45, r90 of a sheet whose first axis is that of rolling: ratio
            of the plastic strain across the width to that of the thickness; Y is along the first.
        first: First axis; (1, 0, 0) if left out.
        second: Second axis, made orthogonal to the first; (0, 1, 0) if left out.
        around: A point and a direction: axes outwards from this line, around it and along it,
            instead of `first` and `second`.
        field: Where the material was written, for messages.
        **others: As of `Plastic`.

    Raises:
        InputError: A value is out of range, or the yield surface is open.

    Example:
        >>> sheet = Hill(E=210e3, nu=0.3, yield_stress=180.0, lankford=[1.8, 1.2, 2.1])
        >>> sheet.entry.name
        'hill'
    """

    entry = Entry(
        "hill",
        "material",
        "Hill (1948) plasticity of rolled sheet, along axes of the body",
        (
            *_ELASTIC,
            *HARDENING,
            *_KINEMATIC,
            Parameter(
                "ratios",
                "array",
                "1",
                "R11, R22, R33, R12, R13, R23: yield stresses over the first; or lankford",
                "positive",
                False,
            ),
            Parameter(
                "lankford", "array", "1", "r0, r45, r90 of a rolled sheet", "positive", False
            ),
            first_axis("first", "first axis, that of rolling"),
            SECOND,
            AROUND,
        ),
    )

    def __init__(self, *, E: float, nu: float, field: str = "", **others: Any) -> None:
        super().__init__(E=E, nu=nu, field=field, **others)
        given = self._given
        check_axes(self.entry.parameters, others, field)
        self._axes = MaterialAxes(given["first"], given["second"], given["around"], field)

    def _condition(self, field: str) -> Floats:
        ratios, lankford = self._given["ratios"], self._given["lankford"]
        place = f"{field}." if field else ""
        if bool(ratios) == bool(lankford):
            raise InputError("either ratios or lankford is needed", f"{place}ratios")
        for name, numbers, count in (("ratios", ratios, 6), ("lankford", lankford, 3)):
            if numbers and len(numbers) != count:
                text = f"{len(numbers)} numbers given, {count} needed"
                raise InputError(text, f"{place}{name}")
        f, g, h, *shears = _of_lankford(*lankford) if lankford else _of_ratios(ratios)
        found = np.diag([g + h, f + h, f + g, *shears])
        found[0, 1] = found[1, 0] = -h
        found[0, 2] = found[2, 0] = -g
        found[1, 2] = found[2, 1] = -f
        return found

    def _basis(self, places: Floats) -> Floats:
        axes = self._axes.at(places)[:, None]
        turned = axes @ self._tensors @ np.swapaxes(axes, -1, -2)
        return np.asarray(turned.reshape(-1, 5, 9))


def _of_ratios(ratios: Sequence[float]) -> tuple[float, ...]:
    """F, G, H, N, M, L of yield stresses over the first."""
    a, b, c = (1.0 / r**2 for r in ratios[:3])
    n, m, k = (1.5 / r**2 for r in ratios[3:])
    return 0.5 * (b + c - a), 0.5 * (c + a - b), 0.5 * (a + b - c), n, m, k


def _of_lankford(r0: float, r45: float, r90: float) -> tuple[float, ...]:
    """F, G, H, N, M, L of the strain ratios of a sheet; shear through it is that of von Mises."""
    f, g, h = r0 / (r90 * (1.0 + r0)), 1.0 / (1.0 + r0), r0 / (1.0 + r0)
    return f, g, h, (f + g) * (r45 + 0.5), 1.5, 1.5


def _tensor(components: Floats, basis: Floats) -> Floats:
    """Tensors of components in a basis of deviators, (n, 3, 3)."""
    return np.asarray((components[:, None] @ basis).reshape(-1, 3, 3))


@dataclass(frozen=True)
class _Returned:
    """Points at a trial multiplier: yield stress, what is left of the back stress, M x, its size.

    Those that end with `slope` are derivatives by the multiplier.
    """

    limit: Floats
    limit_slope: Floats
    kept: Floats
    shrunk: Floats
    along: Floats
    offset_slope: Floats
    size: Floats
    size_slope: Floats


@dataclass(frozen=True)
class _PlasticFlow:
    """Multiplier, plastic strain that it adds, new back stress and tangent of points that flow."""

    multiplier: Floats
    added: Floats
    back: Floats
    tangent: Floats
