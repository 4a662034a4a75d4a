"""Angles of the rotations in gradients of displacements."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats


def polar_angle(gradient: Floats) -> float:
    """Angle of the rotation R of `1 + grad(u) = R U`, radian.

    Args:
        gradient: Gradient of a displacement, (3, 3).

    Example:
        >>> turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        >>> round(float(np.degrees(polar_angle(1.2 * turn - np.eye(3)))), 9)
        90.0
    """
    left, _, right = np.linalg.svd(np.eye(3) + gradient)
    return float(turn_angles((left @ right - np.eye(3))[None])[0])


def turn_angles(gradients: Floats) -> Floats:
    """Angles of rotations; with strain those whose plane and stretch across are those of R.

    Args:
        gradients: Gradients of displacements, (n, 3, 3).

    Returns:
        `atan2(|axial vector of F|, (tr F - 1) / 2)`, exact for rotations and for plane strain,
        (n,), radian.
    """
    i, j = np.array([2, 0, 1]), np.array([1, 2, 0])
    axial = 0.5 * (gradients[:, i, j] - gradients[:, j, i])
    trace = np.trace(gradients, axis1=1, axis2=2)
    return np.asarray(np.arctan2(np.linalg.norm(axial, axis=1), 1.0 + 0.5 * trace))
