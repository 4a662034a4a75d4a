"""Rubbers by the invariants of the distortion: Mooney-Rivlin and Yeoh.

`I1 = J^(-2/3) tr C` and `I2 = J^(-4/3) (tr(C)^2 - tr(C^2)) / 2` of `C = F^T F` are those of the
deformation without its change of volume, which has an energy of its own [Holzapfel 2000, ch. 6.4].
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

import numpy as np

from anisocontact.base import registry
from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import ufl
from anisocontact.base.registry import Entry, Parameter
from anisocontact.base.sealed import Sealed
from anisocontact.bulk.hyperelastic import Hyperelastic
from anisocontact.bulk.materials import Density, constant
from anisocontact.bulk.volume import Volume, volume_ratio

BULK = Parameter(
    "bulk_modulus", "scalar", "stress", "bulk modulus K of the energy K/2 (J - 1)^2", "positive"
)


class _Rubber(Sealed, Hyperelastic):
    """A rubber by constants of its distortional energy and its bulk modulus."""

    entry: Entry

    def __init__(self, *, field: str = "", **parameters: float) -> None:
        given = registry.values(self.entry, parameters, field)
        self._values = [v for (v,) in given.values()]
        shear, bulk = self._shear_at_rest(), self._values[-1]
        if shear <= 0.0:
            text = f"shear modulus at rest {shear:g}, must be > 0: {self._said}"
            raise InputError(text, field=f"{field}.C10" if field else "C10")
        self.young = 9.0 * bulk * shear / (3.0 * bulk + shear)

    #: The shear modulus at rest as a formula, for messages.
    _said = "2 C10"

    def _shear_at_rest(self) -> float:
        return 2.0 * self._values[0]

    def _terms(self, u: Any, gradient: Any) -> list[Density]:
        constants = [constant(u, v) for v in self._values[:-1]]
        j, c = ufl.det(gradient), gradient.T * gradient
        trace = ufl.tr(c)
        first = j ** (-2.0 / 3.0) * trace
        second = 0.5 * j ** (-4.0 / 3.0) * (trace**2 - ufl.inner(c, c))
        return [(self._distortion(constants, first, second), None)]

    def volume(self, u: Any) -> Volume:
        """`J - 1`."""
        return Volume(constant(u, self._values[-1]), volume_ratio)

    @abstractmethod
    def _distortion(self, constants: list[Any], first: Any, second: Any) -> Any:
        """Distortional energy of the constants and the two invariants, UFL."""


class MooneyRivlin(_Rubber):
    """`W = C10 (I1 - 3) + C01 (I2 - 3) + K/2 (J - 1)^2` [Mooney 1940; Rivlin 1948].

    Args:
        C10: Constant of the first invariant, stress.
        C01: Constant of the second invariant, stress; the shear modulus at rest, 2 (C10 + C01),
            has to be > 0.
        bulk_modulus: K, > 0, stress; its pressure is one of every cell, see `Volume`.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> MooneyRivlin(C10=0.3, C01=0.2, bulk_modulus=1e3).young
        2.9990003332222592
    """

    _said = "2 (C10 + C01)"
    entry = Entry(
        "mooney-rivlin",
        "material",
        "rubber by the two invariants of its distortion, with a pressure in every cell",
        (
            Parameter("C10", "scalar", "stress", "constant of the first invariant"),
            Parameter("C01", "scalar", "stress", "constant of the second invariant"),
            BULK,
        ),
    )

    def _shear_at_rest(self) -> float:
        return 2.0 * (self._values[0] + self._values[1])

    def curvature(self, logs: Floats) -> Floats:
        """As of `stability.Rubber`."""
        c10, c01, _ = self._values
        return np.diag(4.0 * (c10 * np.exp(2.0 * logs) + c01 * np.exp(-2.0 * logs)))

    def _distortion(self, constants: list[Any], first: Any, second: Any) -> Any:
        c10, c01 = constants
        return c10 * (first - 3.0) + c01 * (second - 3.0)


class Yeoh(_Rubber):
    """`W = sum_k Ck0 (I1 - 3)^k + K/2 (J - 1)^2`, k = 1 to 3 [Yeoh 1993].

    Args:
        C10: Half of the shear modulus at rest, > 0, stress.
        C20: Constant of the square, stress.
        C30: Constant of the cube, stress.
        bulk_modulus: K, > 0, stress; its pressure is one of every cell, see `Volume`.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> Yeoh(C10=0.5, C20=-0.01, C30=1e-3, bulk_modulus=1e3).linear
        False
    """

    entry = Entry(
        "yeoh",
        "material",
        "rubber by powers of the first invariant, with a pressure in every cell",
        (
            Parameter("C10", "scalar", "stress", "half of the shear modulus at rest"),
            Parameter("C20", "scalar", "stress", "constant of the square"),
            Parameter("C30", "scalar", "stress", "constant of the cube"),
            BULK,
        ),
    )

    def curvature(self, logs: Floats) -> Floats:
        """As of `stability.Rubber`."""
        squares = np.exp(2.0 * logs)
        c10, c20, c30, _ = self._values
        over = squares.sum() - 3.0
        slope, bend = c10 + 2.0 * c20 * over + 3.0 * c30 * over**2, 2.0 * c20 + 6.0 * c30 * over
        return np.asarray(4.0 * (slope * np.diag(squares) + bend * np.outer(squares, squares)))

    def _distortion(self, constants: list[Any], first: Any, second: Any) -> Any:
        return sum(c * (first - 3.0) ** k for k, c in enumerate(constants, 1))
