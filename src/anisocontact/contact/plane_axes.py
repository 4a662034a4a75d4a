"""Axes of the contact planes of slave nodes from material tangents of the master."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Turned:
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
        """The axes in both tangents and their normal, (n, 2, 3): what `Carried` takes."""
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
class Carried:
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
        return np.asarray(self.by_master @ np.concatenate([self.tangents, normal], axis=1))

    def pulled_back(self, by_nodes: Floats, which: Ints) -> Floats:
        """Derivatives by the plane that d span, at its place, from those by the plane of e.

        Args:
            by_nodes: Rows of some numbers, by the nodes of `ContactPlanes.nodes`, (p, r, 27).
            which: Slave nodes, (p,).

        Returns:
            The same, the last three nodes being the place, and it with d_1 and d_2 added.
        """
        by = by_nodes.reshape(*by_nodes.shape[:2], 9, 3).copy()
        tangents, by_axes = self.tangents[which], by[:, :, 7:]
        found = self.by_master[which].swapaxes(1, 2)[:, None] @ by_axes
        by_d = found[:, :, :2] + by_tangents(tangents, found[:, :, 2])
        by[:, :, 6] += (by_axes - by_d).sum(axis=2)
        by[:, :, 7:] = by_d
        return by.reshape(by_nodes.shape)


def in_tangents(tangents: Floats, axes: Floats) -> Floats:
    """Vectors e, (n, 2, 3), in two tangents d and their normal, (n, 2, 3), see `Carried`."""
    d, e = tangents, axes
    along = np.linalg.solve(d @ d.swapaxes(1, 2), d @ e.swapaxes(1, 2)).swapaxes(1, 2)
    return np.concatenate([along, e @ unit_normal(d)[..., None]], axis=2)


def unit_normal(tangents: Floats) -> Floats:
    """Normal of two tangents, (n, 3)."""
    cross = np.cross(tangents[:, 0], tangents[:, 1])
    return np.asarray(cross / np.linalg.norm(cross, axis=1)[:, None])


def by_tangents(tangents: Floats, by_normal: Floats) -> Floats:
    """Derivatives by two tangents from those by their normal, dm = - d^a (m . dd_a).

    Args:
        tangents: d, (n, 2, 3), length.
        by_normal: Rows of some numbers, (n, r, 3).

    Returns:
        By d, (n, r, 2, 3).
    """
    dual = np.linalg.solve(tangents @ tangents.swapaxes(1, 2), tangents)
    stretch = by_normal @ dual.swapaxes(1, 2)
    return np.asarray(-stretch[..., None] * unit_normal(tangents)[:, None, None])
