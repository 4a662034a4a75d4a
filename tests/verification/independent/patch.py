"""A NURBS patch in NumPy: position, tangents, normal, shape operator and connection at a point."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt
from scipy.optimize import root

Floats = npt.NDArray[np.float64]


def bases(knots: Floats, degree: int, u: float) -> Floats:
    """All basis functions at u and their first two derivatives, (3, n) [de Boor 1972]."""
    n = len(knots) - degree - 1
    last = np.searchsorted(knots, u, side="right") - 1
    span = min(max(int(last), degree), n - 1)
    value = np.zeros((degree + 1, len(knots) - 1))
    value[0, span] = 1.0
    first, second = np.zeros_like(value), np.zeros_like(value)
    for p in range(1, degree + 1):
        for i in range(len(knots) - 1 - p):
            for j, sign in ((i, 1.0), (i + 1, -1.0)):
                length = knots[j + p] - knots[j]
                if length == 0.0:
                    continue
                at = (u - knots[j]) / length if sign > 0.0 else (knots[j + p] - u) / length
                value[p, i] += at * value[p - 1, j]
                first[p, i] += sign * p / length * value[p - 1, j]
                second[p, i] += sign * p / length * first[p - 1, j]
    return np.stack([value[degree, :n], first[degree, :n], second[degree, :n]])


def cross(a: Floats, b: Floats) -> Floats:
    """a x b of two vectors, (3,)."""
    (a1, a2, a3), (b1, b2, b3) = a.tolist(), b.tolist()
    return np.array([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


@dataclass(frozen=True, eq=False)
class Place:
    """The patch at a point.

    Attributes:
        x: Position rho, (3,).
        tangents: rho_i, (2, 3).
        normal: Unit normal along rho_1 x rho_2, (3,).
        normal_rates: n_,i, (2, 3).
        second: rho_ij, (2, 2, 3).
    """

    x: Floats
    tangents: Floats
    normal: Floats
    normal_rates: Floats
    second: Floats

    @cached_property
    def dual(self) -> Floats:
        """rho^i, (2, 3), from rho^i . rho_j = delta_ij."""
        return np.asarray(np.linalg.pinv(self.tangents).T)

    @property
    def shape(self) -> Floats:
        """h_i^k of n_,i = -h_i^k rho_k, first index i [Weingarten]."""
        return -self.normal_rates @ self.dual.T

    @property
    def connection(self) -> Floats:
        """Gamma^k_ij of rho_ij = Gamma^k_ij rho_k + h_ij n, (k, i, j)."""
        return np.asarray(np.einsum("ijc,kc->kij", self.second, self.dual))

    def frame(self, angle: float) -> Floats:
        """Orthonormal t_1, t_2 of the tangent plane, (2, 3); t_1 at an angle to rho_1."""
        e = self.tangents[0] / np.linalg.norm(self.tangents[0])
        f = cross(self.normal, e)
        c, s = np.cos(angle), np.sin(angle)
        return np.array([c * e + s * f, c * f - s * e])


@dataclass(frozen=True, eq=False)
class Patch:
    """A rational patch.

    Attributes:
        degrees: Degrees of the two coordinates.
        knots: Their knots, from 0 to 1.
        points: Control points, (n, m, 3).
        weights: Their weights, (n, m).
        closed: Whether the first coordinate is periodic.
    """

    degrees: tuple[int, int]
    knots: tuple[Floats, Floats]
    points: Floats
    weights: Floats
    closed: bool = False

    @property
    def parameters(self) -> dict[str, object]:
        """What `make_surface("nurbs", ...)` takes."""
        return {
            "degrees": self.degrees,
            "knots_1": self.knots[0].tolist(),
            "knots_2": self.knots[1].tolist(),
            "points": self.points.ravel().tolist(),
            "weights": self.weights.ravel().tolist(),
        }

    def at(self, xi: Floats) -> Place:
        """The patch at xi, (2,)."""
        u = xi[0] % 1.0 if self.closed else xi[0]
        return self._place(float(u), float(xi[1]))

    @lru_cache(maxsize=1000)  # noqa: B019  (two patches, which all tests share)
    def _place(self, u: float, v: float) -> Place:
        n, m = (bases(*a) for a in zip(self.knots, self.degrees, (u, v), strict=True))
        whole = np.concatenate([self.points * self.weights[..., None], self.weights[..., None]], 2)
        jets = np.einsum("ai,bj,ijc->abc", n, m, whole)  # by the orders of the derivatives
        h, w = jets[..., :3], jets[..., 3]
        x = h[0, 0] / w[0, 0]
        r1 = (h[1, 0] - w[1, 0] * x) / w[0, 0]
        r2 = (h[0, 1] - w[0, 1] * x) / w[0, 0]
        r11 = (h[2, 0] - 2.0 * w[1, 0] * r1 - w[2, 0] * x) / w[0, 0]
        r12 = (h[1, 1] - w[1, 0] * r2 - w[0, 1] * r1 - w[1, 1] * x) / w[0, 0]
        r22 = (h[0, 2] - 2.0 * w[0, 1] * r2 - w[0, 2] * x) / w[0, 0]
        area = cross(r1, r2)
        normal = area / np.linalg.norm(area)
        turned = [cross(r11, r2) + cross(r1, r12), cross(r12, r2) + cross(r1, r22)]
        rates = [(v - v @ normal * normal) / np.linalg.norm(area) for v in turned]
        second = np.array([[r11, r12], [r12, r22]])
        return Place(x, np.array([r1, r2]), normal, np.array(rates), second)

    def foot(self, x: Floats, start: Floats) -> tuple[Floats, float]:
        """Coordinates of the foot of x near a start, and the gap."""

        def off(xi: Floats) -> Floats:
            place = self.at(xi)
            return np.asarray(place.tangents @ (x - place.x))

        xi = np.asarray(root(off, start, tol=1e-14).x)
        place = self.at(xi)
        return xi, float((x - place.x) @ place.normal)

    def difference(self, to: Floats, start: Floats) -> Floats:
        """xi of one point less that of another; the shorter way round where it is closed."""
        d = to - start
        if self.closed:
            d[0] -= np.floor(d[0] + 0.5)
        return d


def skew_sheet() -> Patch:
    """A wavy rational sheet whose coordinate lines are oblique and curved."""
    rng = np.random.default_rng(7)
    u, v = np.meshgrid(np.linspace(-1, 1, 5), np.linspace(-1, 1, 5), indexing="ij")
    x = np.stack([u + 0.5 * v, 0.2 * u + 1.1 * v, 0.35 * u * u - 0.3 * u * v + 0.2 * v * v], 2)
    x += 0.06 * rng.normal(size=x.shape)
    knots = np.array([0, 0, 0, 0, 0.5, 1, 1, 1, 1], dtype=float)
    return Patch((3, 3), (knots, knots), x, rng.uniform(0.7, 1.4, (5, 5)))


def skew_tube() -> Patch:
    """A closed tube, wavy along its axis, whose rings lie askew."""
    c = np.array([[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]])
    z = np.linspace(-1.0, 1.0, 4)
    radius = np.array([1.0, 0.8, 1.1, 0.9])
    x = np.empty((9, 4, 3))
    x[..., :2] = c[:, None] * radius[:, None]
    x[..., 2] = z + 0.4 * c[:, None, 0] + 0.2 * c[:, None, 1]
    ring = np.array([0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1])
    line = np.array([0, 0, 0, 0, 1, 1, 1, 1], dtype=float)
    w = np.tile([1.0, np.sqrt(0.5)], 5)[:9]
    return Patch((2, 3), (ring, line), x, np.repeat(w[:, None], 4, axis=1), closed=True)
