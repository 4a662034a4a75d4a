"""Axes of the contact planes of slave nodes from material tangents of the master."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from anisocontact import _core
from anisocontact.base.array_types import Floats


@dataclass(frozen=True)
class TurnedTangents:
    """Tangents of the master turned from its normal to that of the contact plane.

    The turn is the least one, e = d - (d . n) / (1 + m . n) (m + n), m the normal of d_1, d_2.

    Attributes:
        tangents: d, (n, 2, 3), length.
        normal: n, (n, 3).
    """

    tangents: Floats
    normal: Floats

    @cached_property
    def own_normal(self) -> Floats:
        """m, (n, 3)."""
        return unit_normal(self.tangents)

    @cached_property
    def cosine(self) -> Floats:
        """M . n, (n,)."""
        return np.asarray(np.einsum("ni,ni->n", self.own_normal, self.normal))

    @cached_property
    def axes(self) -> Floats:
        """e, (n, 2, 3), length."""
        both = self.own_normal + self.normal
        return np.asarray(self.tangents - self._fall[..., None] * both[:, None])

    @property
    def carried(self) -> Floats:
        """The axes in both tangents and their normal, (n, 2, 3): what `CarriedAxes` takes."""
        return in_tangents(self.tangents, self.axes)

    @cached_property
    def _fall(self) -> Floats:
        along = np.einsum("nai,ni->na", self.tangents, self.normal)
        return np.asarray(along * self._share[:, None])

    @cached_property
    def _share(self) -> Floats:
        """1 / (1 + m . n), (n,); zero where both are opposite, which no node in contact has."""
        both = 1.0 + self.cosine
        return np.divide(1.0, both, out=np.zeros_like(both), where=both > 0.0)


@dataclass(frozen=True)
class CarriedAxes:
    """Axes of the contact plane of the accepted increment, carried along with the master.

    e_a = A_ab d_b + B_a m, m the normal of d_1, d_2: what turned since is the angle between the
    normal of these and that of now, however far both are from m.

    Attributes:
        tangents: d, (n, 2, 3), length.
        by_master: A, and B in the last column, (n, 2, 3).
    """

    tangents: Floats
    by_master: Floats

    @cached_property
    def axes(self) -> Floats:
        """e, (n, 2, 3), length."""
        normal = unit_normal(self.tangents)[:, None]
        both = np.concatenate([self.tangents, normal], axis=1)
        return np.asarray(np.einsum("nab,nbi->nai", self.by_master, both, order="C"))


def in_tangents(tangents: Floats, axes: Floats) -> Floats:
    """Vectors e, (n, 2, 3), in two tangents d and their normal, (n, 2, 3), see `CarriedAxes`."""
    both = np.concatenate([dual(tangents), unit_normal(tangents)[:, None]], axis=1)
    return np.asarray(np.einsum("nai,nbi->nab", axes, both, order="C"))


def unit_normal(tangents: Floats) -> Floats:
    """Normal of two tangents, (n, 3)."""
    return _core.unit_normals(np.ascontiguousarray(tangents))


def dual(tangents: Floats) -> Floats:
    """Dual tangents d^a of two tangents, d^a . d_b = delta_ab, in their plane, (n, 2, 3)."""
    first, second = tangents[:, 0], tangents[:, 1]
    a, b, c = (
        np.einsum("ni,ni->n", *pair) for pair in ((first, first), (first, second), (second, second))
    )
    rows = [c[:, None] * first - b[:, None] * second, a[:, None] * second - b[:, None] * first]
    return np.asarray(np.stack(rows, axis=1) / (a * c - b * b)[:, None, None])
