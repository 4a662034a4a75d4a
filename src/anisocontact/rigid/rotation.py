"""Finite rotations: the exponential of a rotation vector and its derivative."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats

#: Below this angle the series is exact to the last digit and the closed form is not.
_SMALL = 1e-2


def skew(v: Floats) -> Floats:
    """Matrices of the cross product, `skew(v) @ w = v x w`: (..., 3) -> (..., 3, 3).

    Args:
        v: Vectors v, (..., 3).

    Returns:
        The matrices, (..., 3, 3).

    Example:
        >>> (skew(np.array([0.0, 0.0, 1.0])) @ [1.0, 0.0, 0.0]).tolist()
        [0.0, 1.0, 0.0]
    """
    out = np.zeros((*v.shape, 3))
    out[..., 2, 1], out[..., 0, 2], out[..., 1, 0] = v[..., 0], v[..., 1], v[..., 2]
    return out - out.swapaxes(-1, -2)


def rotation(vector: Floats) -> Floats:
    """Rotation by a vector: its length is the angle [rad], its direction the axis.

    Rodrigues: `R = I + sin(a)/a [v] + (1 - cos(a))/a^2 [v]^2`.

    Args:
        vector: (3,), radian.

    Returns:
        The orthogonal matrix, (3, 3).

    Example:
        >>> (rotation(np.array([0.0, 0.0, np.pi / 2])) @ [1.0, 0.0, 0.0]).round(12).tolist()
        [0.0, 1.0, 0.0]
    """
    first, second, _ = _coefficients(float(np.linalg.norm(vector)))
    v = skew(vector)
    return np.asarray(np.eye(3) + first * v + second * v @ v)


def spin_of(vector: Floats) -> Floats:
    """Small rotation in space that a change of the rotation vector makes: `w = J dv`.

    `J = I + (1 - cos(a))/a^2 [v] + (a - sin(a))/a^3 [v]^2`, so that
    `R(v + dv) = (I + [J dv]) R(v)` to first order.

    Args:
        vector: (3,), radian.

    Returns:
        J, (3, 3).

    Example:
        >>> spin_of(np.zeros(3)).tolist()
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    _, second, third = _coefficients(float(np.linalg.norm(vector)))
    v = skew(vector)
    return np.asarray(np.eye(3) + second * v + third * v @ v)


def rotation_vector(matrix: Floats) -> Floats:
    """Rotation vector of an orthogonal matrix, its angle at most pi: (3, 3) -> (3,), radian.

    Args:
        matrix: A rotation, (3, 3).

    Returns:
        Angle, at most pi, times the unit vector of the axis, (3,) [rad].

    Example:
        >>> rotation_vector(rotation(np.array([0.0, 0.0, 0.5]))).round(12).tolist()
        [0.0, 0.0, 0.5]
    """
    axial = np.array([matrix[2, 1], matrix[0, 2], matrix[1, 0]])
    axial -= np.array([matrix[1, 2], matrix[2, 0], matrix[0, 1]])
    # 2 sin(a) and 2 cos(a)
    twice_sine, twice_cosine = float(np.linalg.norm(axial)), float(np.trace(matrix) - 1.0)
    angle = float(np.arctan2(twice_sine, twice_cosine))
    if twice_cosine > 0.0:
        return axial * (0.5 if twice_sine == 0.0 else angle / twice_sine)
    # Near half a turn the axis is that of the symmetric part, (R + R^T)/2 - cos(a) I.
    symmetric = 0.5 * (matrix + matrix.T) - 0.5 * twice_cosine * np.eye(3)
    column = symmetric[:, np.argmax(np.diag(symmetric))]
    sign = -1.0 if column @ axial < 0.0 else 1.0
    return np.asarray(sign * angle * column / np.linalg.norm(column))


def orthonormal(matrix: Floats) -> Floats:
    """A rotation without the rounding of many products, (3, 3)."""
    return np.asarray(0.5 * matrix @ (3.0 * np.eye(3) - matrix.T @ matrix))


def _coefficients(angle: float) -> tuple[float, float, float]:
    """sin(a)/a, (1 - cos(a))/a^2 and (a - sin(a))/a^3."""
    a2 = angle * angle
    if angle < _SMALL:
        return (
            1.0 - a2 / 6.0 + a2 * a2 / 120.0,
            0.5 - a2 / 24.0 + a2 * a2 / 720.0,
            1.0 / 6.0 - a2 / 120.0 + a2 * a2 / 5040.0,
        )
    sine = np.sin(angle)
    return sine / angle, 2.0 * np.sin(0.5 * angle) ** 2 / a2, (angle - sine) / (angle * a2)
