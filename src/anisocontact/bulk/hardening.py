"""How the yield stress grows with the equivalent plastic strain."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Parameter

_FIRST = Parameter(
    "yield_stress", "scalar", "stress", "first yield stress; or a flow_curve", "positive", False
)
#: What a yield stress is made of in a case file.
HARDENING = (
    _FIRST,
    Parameter(
        "hardening",
        "scalar",
        "stress",
        "linear hardening: growth over plastic strain",
        "non-negative",
        False,
        (0.0,),
    ),
    Parameter(
        "saturation",
        "scalar",
        "stress",
        "growth until it saturates [Voce 1948]",
        "non-negative",
        False,
        (0.0,),
    ),
    Parameter(
        "saturation_rate",
        "scalar",
        "1",
        "how fast it saturates, over plastic strain",
        "non-negative",
        False,
        (0.0,),
    ),
    Parameter(
        "flow_curve",
        "array",
        "1 and stress",
        "pairs of equivalent plastic strain and yield stress, the first at strain 0",
        "non-negative",
        False,
    ),
)


class Hardening(Protocol):
    """Yield stress of the equivalent plastic strain."""

    def at(self, strain: Floats) -> tuple[Floats, Floats]:
        """Yield stress and its slope at plastic strains, both (n,), stress."""
        ...


class Voce:
    """`Y + H p + Q (1 - exp(-b p))`, linear and saturating [Voce 1948].

    Args:
        first: Y, stress.
        linear: H, stress.
        saturation: Q, stress.
        rate: b.
    """

    def __init__(self, first: float, linear: float, saturation: float, rate: float) -> None:
        self._first, self._linear = first, linear
        self._saturation, self._rate = saturation, rate

    def at(self, strain: Floats) -> tuple[Floats, Floats]:
        """As of `Hardening`."""
        left = np.exp(-self._rate * strain)
        stress = self._first + self._linear * strain + self._saturation * (1.0 - left)
        return stress, self._linear + self._saturation * self._rate * left


class FlowCurve:
    """Straight lines between points of a measured curve, and the last stress behind it.

    Args:
        strains: Equivalent plastic strains, rising from 0.
        stresses: Yield stresses there, which do not fall.
    """

    def __init__(self, strains: Floats, stresses: Floats) -> None:
        self._strains, self._stresses = strains, stresses
        self._slopes = np.append(np.diff(stresses) / np.diff(strains), 0.0)

    def at(self, strain: Floats) -> tuple[Floats, Floats]:
        """As of `Hardening`."""
        place = np.searchsorted(self._strains, strain, side="right") - 1
        known = np.isfinite(strain)
        slope = self._slopes[np.where(known, place, 0).clip(0)]
        return np.interp(strain, self._strains, self._stresses), slope


def make_hardening(given: Mapping[str, list[float]], field: str = "") -> Hardening:
    """The yield stress that checked values of `HARDENING` describe.

    Raises:
        InputError: Both a yield stress and a curve, or neither; a curve that cannot be.
    """
    place = f"{field}." if field else ""
    numbers = ("yield_stress", "hardening", "saturation", "saturation_rate")
    curve = np.array(given["flow_curve"])
    if not curve.size:
        if not given["yield_stress"]:
            raise InputError("missing; or a flow_curve", f"{place}yield_stress")
        _check_pair(given, "saturation", "saturation_rate", place)
        return Voce(*(given[name][0] for name in numbers))
    twice = [name for name in numbers if any(given[name])]
    if twice:
        raise InputError("given with flow_curve, one of the two is allowed", f"{place}{twice[0]}")
    if curve.size % 2:
        raise InputError(f"{curve.size} numbers given, pairs needed", f"{place}flow_curve")
    strains, stresses = curve.reshape(-1, 2).T
    if strains[0] != 0.0 or (np.diff(strains) <= 0.0).any():
        text = f"{_first_fall(strains, np.less_equal)} given, strains have to rise from 0"
        raise InputError(text, f"{place}flow_curve")
    if stresses[0] <= 0.0 or (np.diff(stresses) < 0.0).any():
        text = f"{_first_fall(stresses, np.less)} given, stresses have to be > 0 and must not fall"
        raise InputError(text, f"{place}flow_curve")
    return FlowCurve(strains, stresses)


def _first_fall(values: Floats, falls: np.ufunc) -> str:
    """The first value of a column that does not go on as it has to, or the very first."""
    wrong = np.flatnonzero(falls(values[1:], values[:-1]))
    if not len(wrong):
        return f"{values[0]:.6g} first"
    return f"{values[wrong[0] + 1]:.6g} after {values[wrong[0]]:.6g}"


def check_recovery(given: Mapping[str, list[float]], field: str = "") -> None:
    """Refuse a back stress that is forgotten and never grows.

    Raises:
        InputError: It is so.
    """
    if given["recovery"][0] and not given["kinematic"][0]:
        path = f"{field}.recovery" if field else "recovery"
        raise InputError("given without kinematic, it does nothing", path)


def _check_pair(given: Mapping[str, list[float]], one: str, other: str, place: str) -> None:
    """Refuse one of two parameters that do something together alone."""
    for name, missing in ((one, other), (other, one)):
        if given[name][0] and not given[missing][0]:
            raise InputError(f"given without {missing}, it does nothing", f"{place}{name}")
