"""Strains in which laws of points are written, and the stress in space that follows from theirs.

A law gives a stress T conjugate to its strain E and `dT/dE`; the strain gives the first
Piola-Kirchhoff stress `P = T : dE/dH` of the displacement gradient H and `dP/dH`. The logarithmic
strain `E = ln(C)/2` makes of a law at small strain one at finite strain that is objective whatever
its history [Miehe Apel Lambrecht 2002]; its two derivatives are divided differences of the
logarithm [Daleckii Krein 1965], which are exact where principal stretches are the same.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import ufl
from anisocontact.base.registry import Parameter

#: Spread of three arguments over their middle below which a series is the more exact.
_NEAR = 0.05
#: Terms of that series: what is left is below 1e-16.
_TERMS = 13


class Strain(Protocol):
    """A strain of n points, bound to their displacement gradients.

    Attributes:
        small: Whether it takes displacement gradients to be small.
        value: The strain, (n, 3, 3).
    """

    small: bool
    value: Floats

    def __init__(self, gradient: Floats) -> None: ...

    def piola(self, stress: Floats) -> Floats:
        """First Piola-Kirchhoff stress of the conjugate stress, (n, 3, 3)."""
        ...

    def tangent(self, stress: Floats, slope: Floats) -> Floats:
        """dP/dH of the conjugate stress and its derivative by the strain, (n, 3, 3, 3, 3)."""
        ...

    @staticmethod
    def dilatation(gradient: object) -> object:
        """Trace of the strain of a displacement gradient, UFL."""
        ...


class SmallStrain:
    """`E = sym(H)`; its stress is that in space."""

    small = True

    def __init__(self, gradient: Floats) -> None:
        self.value = symmetric(gradient)

    def piola(self, stress: Floats) -> Floats:
        """The stress itself."""
        return stress

    def tangent(self, stress: Floats, slope: Floats) -> Floats:
        """The slope itself: it is symmetric in its last two indices."""
        return slope

    @staticmethod
    def dilatation(gradient: object) -> object:
        """`tr(H)`."""
        return ufl.tr(gradient)


class LogarithmicStrain:
    """`E = ln(C)/2`, `C = (I + H)^T (I + H)`; NaN where a cell is inverted."""

    small = False

    def __init__(self, gradient: Floats) -> None:
        # C - I without the cancellation of 1: small strains are as exact as large ones
        green = symmetric(gradient) + 0.5 * np.swapaxes(gradient, -1, -2) @ gradient
        self._deformation = np.eye(3) + gradient
        values, self._axes = np.linalg.eigh(green)
        with np.errstate(invalid="ignore", divide="ignore"):
            self._logs = np.log1p(2.0 * values)
        self._squares = 1.0 + 2.0 * values
        inside_out = np.linalg.det(self._deformation) <= 0.0
        self._logs[inside_out] = np.nan
        first = self._squares[:, :, None], self._squares[:, None, :]
        self._first = 0.5 * divided_difference(*first)
        self.value = spectral(0.5 * self._logs, self._axes)

    def piola(self, stress: Floats) -> Floats:
        """`F S`, `S = 2 T : dE/dC`."""
        return self._deformation @ self._second_piola(stress)

    def tangent(self, stress: Floats, slope: Floats) -> Floats:
        """`dH S + F dS`, `dS = 2 dE/dC : dT/dE : dE + 2 T : d2E/dC2 : dC`."""
        axes, t = self._axes, np.swapaxes(self._axes, -1, -2) @ stress @ self._axes
        squares = self._squares
        second = 0.5 * second_divided_difference(
            squares[:, :, None, None], squares[:, None, :, None], squares[:, None, None, :]
        )
        n, eye = len(t), np.eye(3)
        # S of C in the axes of C: derivative of its two factors
        inner = turned(slope, axes)
        inner *= 2.0 * self._first[:, :, :, None, None] * self._first[:, None, None, :, :]
        inner += 2.0 * np.einsum("ncab,ncb,da->nabcd", second, t, eye)
        inner += 2.0 * np.einsum("nabd,nad,cb->nabcd", second, t, eye)
        inner = 0.5 * (inner + np.swapaxes(inner, -1, -2))
        by_strain = 2.0 * turned(inner, np.swapaxes(axes, -1, -2))  # dS / d(C/2)
        left = np.einsum("nim,nmjop->nijop", self._deformation, by_strain)
        found = np.einsum("nijop,nkp->nijko", left, self._deformation)
        found += np.einsum("ik,noj->nijko", eye, self._second_piola(stress))
        return np.asarray(found.reshape(n, 3, 3, 3, 3))

    def _second_piola(self, stress: Floats) -> Floats:
        axes = self._axes
        t = np.swapaxes(axes, -1, -2) @ stress @ axes
        return axes @ (2.0 * self._first * t) @ np.swapaxes(axes, -1, -2)

    @staticmethod
    def dilatation(gradient: object) -> object:
        """`ln J`."""
        return ufl.ln(ufl.det(ufl.Identity(3) + gradient))


#: Strains by the word that a law names them with.
STRAINS: Mapping[str, Callable[[Floats], Strain]] = {
    "small": SmallStrain,
    "logarithmic": LogarithmicStrain,
}
#: The parameter of a law that holds in each of them.
STRAIN = Parameter(
    "strain",
    "choice",
    "1",
    "strain the law is written in: small, or logarithmic for bodies that turn or are strained far",
    default=(0.0,),
    choices=tuple(STRAINS),
)


def symmetric(tensor: Floats) -> Floats:
    """Symmetric part of n tensors, (n, 3, 3)."""
    return 0.5 * (tensor + np.swapaxes(tensor, -1, -2))


def spectral(values: Floats, axes: Floats) -> Floats:
    """Tensors of the eigenvalues (n, 3) with the axes as columns, (n, 3, 3)."""
    return (axes * values[:, None, :]) @ np.swapaxes(axes, -1, -2)


def turned(tensor: Floats, axes: Floats) -> Floats:
    """Components of n tensors of fourth order along axes, columns of (n, 3, 3)."""
    both = np.einsum("nia,njb->nijab", axes, axes).reshape(-1, 9, 9)
    found: Floats = np.swapaxes(both, -1, -2) @ tensor.reshape(-1, 9, 9) @ both
    return found.reshape(-1, 3, 3, 3, 3)


def divided_difference(a: Floats, b: Floats) -> Floats:
    """`(ln a - ln b) / (a - b)`, `1/a` where both are the same.

    Example:
        >>> divided_difference(np.array([2.0, 2.0]), np.array([2.0, 1.0])).round(12).tolist()
        [0.5, 0.69314718056]
    """
    away = (a - b) / b
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(away == 0.0, 1.0, np.log1p(away) / np.where(away == 0.0, 1.0, away)) / b


def second_divided_difference(a: Floats, b: Floats, c: Floats) -> Floats:
    """Second divided difference of the logarithm, `-1 / (2 a^2)` where all three are the same.

    Example:
        >>> one = np.ones(1)
        >>> second_divided_difference(one, one, 1.0 + 1e-9 * one).round(6).tolist()
        [-0.5]
    """
    low, middle, high = np.sort(np.stack(np.broadcast_arrays(a, b, c)), axis=0)
    x, y = (low - middle) / middle, (high - middle) / middle
    power, sums = np.ones_like(x), np.ones_like(x)  # x^m and the sum of x^i y^(m-i)
    series = np.zeros_like(x)
    for k in range(2, 2 + _TERMS):
        series += (-1.0) ** (k - 1) / k * sums
        power = power * x
        sums = sums * y + power
    spread = np.where(y - x < _NEAR, 1.0, high - low)
    difference = (divided_difference(high, middle) - divided_difference(middle, low)) / spread
    return np.where(y - x < _NEAR, series / middle**2, difference)
