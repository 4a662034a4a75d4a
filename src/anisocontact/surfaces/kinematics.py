"""Rates and variations of the coordinates of a slave point on a moving master."""

from __future__ import annotations

from typing import NamedTuple

import numpy.typing as npt

from anisocontact.base.array_types import Floats
from anisocontact.base.arrays import blocks, points
from anisocontact.surfaces.analytic import Surface


class ConvectiveRate(NamedTuple):
    """Rates, or small changes, of the convective coordinates of n points.

    Args:
        xi: d xi^i/dt, (n, 2).
        gap: d xi^3/dt, (n,) [length/time].

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> rate = convective_velocity(plane, [[0.0, 0.0]], [0.0], [[1.0, 2.0, -3.0]])
        >>> rate.xi.tolist(), rate.gap.tolist()
        ([[1.0, 2.0]], [-3.0])
    """

    xi: Floats
    gap: Floats


def convective_velocity(
    surface: Surface,
    xi: npt.ArrayLike,
    gap: npt.ArrayLike,
    v_slave: npt.ArrayLike,
    v_master: npt.ArrayLike = (0.0, 0.0, 0.0),
    *,
    v_master_derivatives: npt.ArrayLike = 0.0,
    exact: bool = True,
) -> ConvectiveRate:
    """Convective velocities of slave points [Konyukhov Schweizerhof 2006, eq. (4), (5)].

    At xi^3 = 0 they are a^ij (v_s - v) . rho_j and (v_s - v) . n. Off the surface the time
    derivative of r_s = rho + n xi^3, projected on rho_j, gives

        (a_ij - xi^3 h_ij) dxi^i/dt = (v_s - v) . rho_j + xi^3 n . v_j

    where v_j are the derivatives of the master's velocity along the coordinates, which turn its
    normal; dxi^3/dt is the same.

    Args:
        surface: The master.
        xi: Coordinates of the closest points, (n, 2).
        gap: xi^3, (n,) or one number [length].
        v_slave: Velocities of the slave points, (n, 3) or one vector [length/time].
        v_master: Velocities of the material points of the master at xi, the same.
        v_master_derivatives: v_j, (n, 2, 3); zero for a master that only translates, omega x rho_j
            for one that rotates.
        exact: Whether the form off the surface is wanted; else that of the paper at xi^3 = 0.

    Returns:
        Rates of the coordinates and of the gap. At a centre of curvature the rate along the
        direction that is not defined there is zero.

    Raises:
        InputError: An array of another shape was given.

    Example:
        >>> from anisocontact.surfaces.analytic import make_surface
        >>> roll = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=1.0)
        >>> start = roll.project([[0.0, 2.0, 0.0]])
        >>> convective_velocity(roll, start.xi, start.gap, (-1, 0, 0)).xi.round(12).tolist()
        [[0.5, 0.0]]
        >>> convective_velocity(roll, start.xi, 0, (-1, 0, 0), exact=False).xi.round(12).tolist()
        [[1.0, 0.0]]
    """
    xi = points(xi, 2, "xi")
    n = len(xi)
    relative = blocks(v_slave, (n, 3), "v_slave") - blocks(v_master, (n, 3), "v_master")
    turn = blocks(v_master_derivatives, (n, 2, 3), "v_master_derivatives").reshape(2 * n, 3)
    offset = blocks(gap, (n,), "gap") if exact else None
    return ConvectiveRate(*surface.core.convective_velocity(xi, offset, relative, turn))


def relative_variation(
    surface: Surface, xi: npt.ArrayLike, d_slave: npt.ArrayLike, d_master: npt.ArrayLike
) -> ConvectiveRate:
    """Variation of the relative displacement [Konyukhov Schweizerhof 2006, eq. (6)].

    Args:
        surface: The master.
        xi: Coordinates of the closest points, (n, 2).
        d_slave: delta r_s, (n, 3) or one vector [length].
        d_master: delta rho at xi, the same.

    Returns:
        delta xi^i and delta xi^3 in delta r_s - delta rho = delta xi^i rho_i + delta xi^3 n.

    Raises:
        InputError: An array of another shape was given.

    Example:
        >>> from anisocontact.surfaces.analytic import make_surface
        >>> plate = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> moved = relative_variation(plate, [[0.0, 0.0]], (0.1, 0, 0.2), (0, 0, 0))
        >>> moved.xi.tolist(), moved.gap.tolist()
        ([[0.1, 0.0]], [0.2])
    """
    return convective_velocity(surface, xi, 0.0, d_slave, d_master, exact=False)
