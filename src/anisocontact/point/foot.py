"""Where a point is over a surface: its foot, gap and the derivative of the normal there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.surfaces import PROJECTION_STATUS, Surface

# Of the distance to the foot: a point that is not on the normal of its foot is beyond an edge.
_OFF_NORMAL = 1e-6
# Of the lengths that surface and point are made of: what a closest point is known to, on poles too.
_ROUNDED = 1e-10


@dataclass(frozen=True)
class Foot:
    """Closest point of a surface.

    Args:
        position: rho, (3,) [length].
        basis: rho_i, (2, 3).
        xi: Coordinates, (2,).
        gap: xi^3 [length].
        normal: n, (3,).
        d_normal: dn/dx of the point above it, (3, 3) [1/length].
        reached: Whether the point lies on the normal of the foot.
    """

    position: Floats
    basis: Floats
    xi: Floats
    gap: float
    normal: Floats
    d_normal: Floats
    reached: bool

    @property
    def tangent_plane(self) -> Floats:
        """Projector I - n (x) n, (3, 3)."""
        return np.eye(3) - np.outer(self.normal, self.normal)


def foot(surface: Surface, x: Floats) -> Foot:
    """Foot of the point x [Konyukhov Schweizerhof 2006, eq. (1), (2)].

    dn/dx = -rho_j h^j_i (a_ik - xi^3 h_ik)^-1 rho_k, by Weingarten and the derivative of the
    closest point.
    """
    p = surface.project(x[None])
    nowhere = Foot(x, np.zeros((2, 3)), p.xi[0], 0.0, np.zeros(3), np.zeros((3, 3)), False)
    if p.status[0] == PROJECTION_STATUS.index("failed"):
        return nowhere
    try:
        at = foot_at(surface, p.xi[0], float(p.gap[0]))
    except np.linalg.LinAlgError:  # at a centre of curvature every direction is nearest
        return nowhere
    off = np.linalg.norm(x - at.position - at.gap * at.normal)
    rounded = _ROUNDED * (np.linalg.norm(x) + surface.extent)
    return replace(at, reached=bool(off <= _OFF_NORMAL * np.linalg.norm(x - at.position) + rounded))


def foot_at(surface: Surface, xi: Floats, gap: float) -> Foot:
    """The foot with coordinates `xi`, of the point at distance `gap` above it."""
    jet, g = surface.jet(xi[None]), surface.geometry(xi[None])
    basis = jet.d1[0]
    inverse = np.linalg.inv(g.a_co[0] - gap * g.h_co[0])
    return Foot(
        position=jet.position[0],
        basis=basis,
        xi=np.asarray(xi, dtype=np.float64),
        gap=gap,
        normal=g.normal[0],
        d_normal=-basis.T @ g.h_mixed[0] @ inverse @ basis,
        reached=True,
    )
