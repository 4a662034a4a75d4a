"""The adhesion domain: where a point sticks, in the plane of forces and on the tangent plane."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Flags, Floats, Pair
from anisocontact.base.errors import InputError
from anisocontact.base.typed import is_number, typed
from anisocontact.surfaces import points

#: det/trace^2 of a tensor below which it has rank one.
RANK_LIMIT = 1e-12


@dataclass(frozen=True)
class Ellipse:
    """Points x with (x - centre) . M (x - centre) <= 1 for a positive definite M.

    Args:
        semi_axes: The longer and the shorter semi-axis.
        angle: Angle of the longer axis to the first coordinate [rad].
        centre: Centre.

    Example:
        >>> Ellipse((2.0, 1.0), angle=0.0).contains([[1.9, 0.0], [0.0, 1.1]]).tolist()
        [True, False]
    """

    semi_axes: tuple[float, float]
    angle: float
    centre: tuple[float, float] = (0.0, 0.0)

    @property
    def matrix(self) -> Floats:
        """M, (2, 2)."""
        q = rotation(self.angle)
        return q @ np.diag([self.semi_axes[0] ** -2, self.semi_axes[1] ** -2]) @ q.T

    def at(self, centre: Pair) -> Ellipse:
        """The same ellipse about another centre.

        Args:
            centre: The new centre, (2,).

        Returns:
            The ellipse there.
        """
        return replace(self, centre=(float(centre[0]), float(centre[1])))

    def points(self, n: int = 181) -> Floats:
        """Points of the boundary at equal steps of the parameter, closed, (n, 2).

        Args:
            n: Number of points, the first once more at the end.

        Returns:
            The points, (n, 2).
        """
        t = np.linspace(0.0, 2.0 * np.pi, n)
        unit = np.stack([np.cos(t), np.sin(t)], axis=1)
        return np.asarray(self.centre + (unit * self.semi_axes) @ rotation(self.angle).T)

    def contains(self, x: npt.ArrayLike) -> Flags:
        """Whether points (n, 2) are inside or on the boundary, (n,).

        Args:
            x: Points, (n, 2).

        Returns:
            A flag for each, (n,).
        """
        d = points(x, 2) - self.centre
        return np.asarray(np.einsum("ni,ij,nj->n", d, self.matrix, d) <= 1.0)


@dataclass(frozen=True)
class Strip:
    """Points between two parallel lines: what the ellipse becomes where one stiffness is zero.

    Args:
        half_width: Distance of each line from the centre line.
        angle: Angle of the lines to the first coordinate [rad].
        centre: A point of the centre line.

    Example:
        >>> Strip(half_width=2.0, angle=0.0).contains([[9.0, 1.0], [0.0, 3.0]]).tolist()
        [True, False]
    """

    half_width: float
    angle: float
    centre: tuple[float, float] = (0.0, 0.0)

    @property
    def matrix(self) -> Floats:
        """M of (x - centre) . M (x - centre) <= 1, of rank one, (2, 2)."""
        n = rotation(self.angle)[:, 1]
        return np.outer(n, n) / self.half_width**2

    def at(self, centre: Pair) -> Strip:
        """The same strip about another point.

        Args:
            centre: The new point, (2,).

        Returns:
            The strip there.
        """
        return replace(self, centre=(float(centre[0]), float(centre[1])))

    def edges(self, length: float) -> Floats:
        """A piece of the two lines: line, end, coordinate, (2, 2, 2).

        Args:
            length: Length of the piece.

        Returns:
            Ends of both lines: line, end, coordinate, (2, 2, 2).
        """
        along, across = rotation(self.angle).T
        ends = np.array([[-0.5], [0.5]]) * length * along
        offsets = np.array([-1.0, 1.0])[:, None, None] * self.half_width * across
        return np.asarray(self.centre + ends[None] + offsets)

    def contains(self, x: npt.ArrayLike) -> Flags:
        """Whether points (n, 2) are inside or on the boundary, (n,).

        Args:
            x: Points, (n, 2).

        Returns:
            A flag for each, (n,).
        """
        d = (points(x, 2) - self.centre) @ rotation(self.angle)[:, 1]
        return np.asarray(np.abs(d) <= self.half_width)


@typed
def force_domain(coefficients: Pair | float, beta: float, pressure: float) -> Ellipse:
    """Forces of a sticking point, T.FT <= N^2 [Konyukhov Schweizerhof 2006, eq. (115), (119)].

    Args:
        coefficients: mu_1, mu_2 > 0, or one number for both.
        beta: Angle of the first friction axis [rad].
        pressure: N > 0 [stress].

    Returns:
        Ellipse with the semi-axes mu_i N [stress], mu_1 N at the angle beta.

    Raises:
        InputError: A value is not positive.

    Example:
        >>> force_domain((0.5, 0.25), 0.0, 8.0).semi_axes
        (4.0, 2.0)
    """
    m1, m2 = _positive("coefficients", _pair(coefficients))
    (n,) = _positive("pressure", (pressure,))
    if m1 >= m2:
        return Ellipse((m1 * n, m2 * n), _line_angle(beta))
    return Ellipse((m2 * n, m1 * n), _line_angle(beta + 0.5 * math.pi))


@typed
def adhesion_domain(
    stiffness: Pair | float,
    alpha: float,
    coefficients: Pair | float,
    beta: float,
    pressure: float,
) -> Ellipse | Strip:
    """Elastic slips of a sticking point on the tangent plane, dxi.BFB dxi <= N^2, in closed form.

    [Konyukhov Schweizerhof 2006, eq. (116)-(121)]. Axes and inclination printed there, mu_i N/eps_i
    and 2 alpha - beta, hold for alpha = beta alone. In the axes of B, with g = beta - alpha,

        a_11 = eps_1^2 (cos^2 g/mu_1^2 + sin^2 g/mu_2^2),
        a_22 = eps_2^2 (sin^2 g/mu_1^2 + cos^2 g/mu_2^2),
        a_12 = eps_1 eps_2 (1/mu_1^2 - 1/mu_2^2) sin g cos g

    has the eigenvalues w, the semi-axes are N/sqrt(w), and the shorter one is at the angle
    alpha + atan2(2 a_12, a_11 - a_22)/2.

    Args:
        stiffness: eps_1, eps_2 >= 0, one at least > 0, or one number for both [stress/length].
        alpha: Angle of the first axis of the adhesion [rad].
        coefficients: mu_1, mu_2 > 0, or one number for both.
        beta: Angle of the first axis of the friction [rad].
        pressure: N > 0 [stress].

    Returns:
        An ellipse [length]; a strip along the axis of the zero stiffness where there is one.

    Raises:
        InputError: A value out of range.

    Example:
        >>> domain = adhesion_domain((2e3, 1e3), 0.0, (0.3, 0.1), 0.0, 10.0)
        >>> [round(a, 9) for a in domain.semi_axes]
        [0.0015, 0.001]
    """
    e1, e2 = _stiffness(_pair(stiffness))
    m1, m2 = _positive("coefficients", _pair(coefficients))
    (n,) = _positive("pressure", (pressure,))
    c, s = math.cos(beta - alpha), math.sin(beta - alpha)
    f11, f22 = (c / m1) ** 2 + (s / m2) ** 2, (s / m1) ** 2 + (c / m2) ** 2
    a12 = e1 * e2 * (m1**-2 - m2**-2) * s * c
    return _domain(e1 * e1 * f11, a12, e2 * e2 * f22, e1 * e2 / (m1 * m2), n, alpha)


def domain_from_tensors(
    stiffness: npt.ArrayLike, friction: npt.ArrayLike, pressure: float
) -> Ellipse | Strip:
    """The adhesion domain of any S = -B and F: eigenpairs of S^T F S/N^2.

    Args:
        stiffness: S, (2, 2), components in an orthonormal frame; need not be symmetric
            [stress/length].
        friction: F, (2, 2), symmetric and positive definite.
        pressure: N > 0 [stress].

    Returns:
        Ellipse, or strip where S has rank one [length].

    Raises:
        InputError: F is not symmetric positive definite, or S is zero.

    Example:
        >>> domain = domain_from_tensors(np.eye(2) * 2e3, np.eye(2) / 0.01, 10.0)
        >>> [round(a, 9) for a in domain.semi_axes]
        [0.0005, 0.0005]
    """
    s, f = (np.asarray(v, dtype=np.float64) for v in (stiffness, friction))
    (n,) = _positive("pressure", (pressure,))
    for name, m in (("stiffness", s), ("friction", f)):
        if m.shape != (2, 2) or not np.isfinite(m).all():
            raise InputError(f"an array of shape {m.shape} given, (2, 2) needed", field=name)
    symmetric = abs(f[0, 1] - f[1, 0]) <= 1e-12 * np.abs(f).max()
    if not (symmetric and f[0, 0] > 0.0 and np.linalg.det(f) > 0.0):
        raise InputError(f"{f.tolist()} given, symmetric positive definite needed", "friction")
    if not s.any():
        raise InputError("zero given, one direction at least needs a stiffness", "stiffness")
    (a11, a12), (_, a22) = (s.T @ f @ s).tolist()
    det = abs(float(np.linalg.det(s)))
    full = det > RANK_LIMIT * float(np.sum(s * s))
    root = det * math.sqrt(float(np.linalg.det(f))) if full else 0.0
    return _domain(a11, a12, a22, root, n)


def _domain(
    a11: float, a12: float, a22: float, root: float, pressure: float, angle: float = 0.0
) -> Ellipse | Strip:
    """Points x with x.Ax <= N^2.

    Args:
        a11: Component of A in two orthogonal axes.
        a12: Component of A.
        a22: Component of A.
        root: Square root of det A, which keeps the small eigenvalue exact; 0 where A has rank one.
        pressure: N.
        angle: Angle of the first axis to the first coordinate [rad].
    """
    largest = 0.5 * (a11 + a22) + math.hypot(0.5 * (a11 - a22), a12)
    width = pressure / math.sqrt(largest)
    long = _line_angle(angle + 0.5 * math.atan2(2.0 * a12, a11 - a22) + 0.5 * math.pi)
    if root == 0.0:
        return Strip(width, long)
    return Ellipse((pressure * math.sqrt(largest) / root, width), long)


def rotation(angle: float) -> Floats:
    """Rotation of a plane.

    Args:
        angle: Counter-clockwise, radian.

    Returns:
        Its matrix, (2, 2).
    """
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


def _line_angle(angle: float) -> float:
    """The angle of a line, which is that of no direction: in [-pi/2, pi/2)."""
    return (angle + 0.5 * math.pi) % math.pi - 0.5 * math.pi


def _pair(given: Pair | float) -> Pair:
    """One number stands for both axes."""
    return (given, given) if is_number(given) else cast(Pair, given)


def _positive(name: str, values: Pair) -> tuple[float, ...]:
    if not all(math.isfinite(v) and v > 0.0 for v in values):
        raise InputError(f"{values!r} given, must be > 0", field=name)
    return tuple(float(v) for v in values)


def _stiffness(values: Pair) -> tuple[float, float]:
    if not all(math.isfinite(v) and v >= 0.0 for v in values) or not any(values):
        raise InputError(f"{values!r} given, must be >= 0 and not both 0", field="stiffness")
    return float(values[0]), float(values[1])
