"""What nodes of a slave edge of which hardly anything is covered give to the others.

As those of facets (cpp/include/anisocontact/mortar/hand_over.hpp):

    psi_i' = (1 - lambda_i) psi_i + q_i sum_j lambda_j psi_j ,
    int psi_i' N_j = delta_ij D_i' - E_ij ,
    E_ij = q_i (delta_ij sum_k lambda_k D_k - lambda_j D_j) .
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats

#: Shares of its weight that are covered, over the largest, below which a node gives all of its
#: weights away and above which it keeps them, as there.
GIVEN, KEPT = 0.2, 0.3


@dataclass(frozen=True)
class HandOver:
    """Shares that nodes give and get, and their derivatives.

    Attributes:
        gives: lambda, (f, k).
        gets: q, (f, k).
        d_gives: (f, k, columns).
        d_gets: (f, k, columns).
    """

    gives: Floats
    gets: Floats
    d_gives: Floats
    d_gets: Floats

    @classmethod
    def of(cls, area: Floats, d_area: Floats, whole: Floats) -> HandOver:
        """Those of edges.

        Args:
            area: D, (f, k).
            d_area: (f, k, columns).
            whole: Weights of an edge all of which is covered, (k,).
        """
        share, d_share = area / whole, d_area / whole[:, None]
        most = share.argmax(axis=1)[:, None]
        covered = np.take_along_axis(share, most, axis=1)
        covered = np.where(covered > 0.0, covered, 1.0)
        share = share / covered
        d_share = d_share - share[..., None] * np.take_along_axis(d_share, most[..., None], axis=1)
        t = np.clip((KEPT - share) / (KEPT - GIVEN), 0.0, 1.0)
        gives = t * t * (3.0 - 2.0 * t)
        d_gives = (-6.0 * t * (1.0 - t) / ((KEPT - GIVEN) * covered))[..., None] * d_share
        rest = ((1.0 - gives) @ whole)[:, None]
        rest[rest == 0.0] = 1.0  # edges of which nothing is covered
        gets = (1.0 - gives) * whole / rest
        d_keeps = -whole[:, None] * d_gives
        d_gets = d_keeps - gets[..., None] * d_keeps.sum(axis=1, keepdims=True)
        return cls(gives, gets, d_gives, d_gets / rest[..., None])

    def moved(self, x: Floats, dx: Floats) -> tuple[Floats, Floats]:
        """(1 - lambda_i) x_i + q_i sum_j lambda_j x_j, x of (f, k, c), and its derivative."""
        gives, gets = self.gives, self.gets
        total = np.einsum("fj,fjc->fc", gives, x)
        d_total = np.einsum("fjv,fjc->fcv", self.d_gives, x) + np.einsum("fj,fjcv->fcv", gives, dx)
        slope = (1.0 - gives)[..., None, None] * dx
        slope += gets[..., None, None] * d_total[:, None]
        slope += self.d_gets[:, :, None] * total[:, None, :, None]
        slope -= self.d_gives[:, :, None] * x[..., None]
        return (1.0 - gives)[..., None] * x + gets[..., None] * total[:, None], slope

    def own(self, area: Floats, d_area: Floats, points: Floats) -> tuple[Floats, Floats]:
        """E of the nodes of the edges, (f, k, k), and its derivative.

        Args:
            area: D, (f, k).
            d_area: (f, k, columns).
            points: Shares of the nodes of an edge in its slave points, (k, k).
        """
        given = self.gives * area
        d_given = self.d_gives * area[..., None] + self.gives[..., None] * d_area
        rest = given.sum(axis=1)[:, None, None] * points - (given @ points)[:, None]
        d_rest = points[..., None] * d_given.sum(axis=1)[:, None, None]
        d_rest = d_rest - np.einsum("fjv,jn->fnv", d_given, points)[:, None]
        slope = self.gets[..., None, None] * d_rest + self.d_gets[:, :, None] * rest[..., None]
        return self.gets[..., None] * rest, slope
