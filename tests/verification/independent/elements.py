"""Springs and dashpots of adhesion and pressure at one point, in NumPy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Elements:
    """w dT/dt + A T = -S v - R x by components along the axes, T = t_a e_a, x_a = e_a . x (26).

    Attributes:
        w: 1, or 0 where the force follows at once.
        a, s, r: Components of A, S, R, (2, 2).
        springs: Stiffness at rest and of what relaxes, (2, 2) each; None where there is no energy.
    """

    w: float
    a: Floats
    s: Floats
    r: Floats
    springs: tuple[Floats, Floats] | None


def elastic(k: Floats) -> Elements:
    zero = np.zeros((2, 2))
    return Elements(1.0, zero, np.diag(k), zero, (zero, np.diag(k)))


def maxwell(k: Floats, tau: Floats) -> Elements:
    zero = np.zeros((2, 2))
    return Elements(1.0, np.diag(1.0 / tau), np.diag(k), zero, (zero, np.diag(k)))


def kelvin_voigt(k: Floats, eta: Floats) -> Elements:
    return Elements(0.0, np.eye(2), np.diag(eta), np.diag(k), (np.diag(k), np.diag(eta)))


def solid(k: Floats, k1: Floats, tau: Floats) -> Elements:
    springs = np.diag(k), np.diag(k1)
    return Elements(1.0, np.diag(1.0 / tau), np.diag(k + k1), np.diag(k / tau), springs)


@dataclass(frozen=True)
class Pressure:
    """w dN/dt + a N = -b dg/dt - c g while the gap is closed (27)."""

    w: float
    a: float
    b: float
    c: float

    def at(self, gap: float, before: float, pressure: float, dt: float) -> float:
        if gap >= 0.0:
            return 0.0
        closed = gap - min(before, 0.0)
        n = (self.w * pressure - self.b * closed - dt * self.c * gap) / (self.w + dt * self.a)
        return max(n, 0.0)
