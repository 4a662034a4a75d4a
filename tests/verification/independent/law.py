"""The laws of an interface at one point in NumPy, along a path of given feet and gaps.

Nothing of the core is used. Vectors are those of space; the law is solved in an orthonormal frame
that lies askew to the coordinates and to all axes. Source of the equations: [Konyukhov Schweizerhof
2006] with the signs of docs/theory/errata.md; equation numbers in brackets.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import polar
from scipy.optimize import brentq
from tests.verification.independent.elements import Elements, Pressure
from tests.verification.independent.patch import Patch, Place, cross

Floats = npt.NDArray[np.float64]
OPEN, STICK, SLIP = 0, 1, 2


def about(axis: Floats, angle: float, v: Floats) -> Floats:
    """v turned about a unit vector by an angle [Rodrigues]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(c * v + s * cross(axis, v) + (1.0 - c) * (axis @ v) * axis)


@dataclass(frozen=True, eq=False)
class Marks:
    """Two axes at angles to the part in the tangent plane of a vector in space (58)."""

    vector: Floats
    angles: tuple[float, float]

    @lru_cache(maxsize=1000)  # noqa: B019  (three pairs of axes, which all tests share)
    def at(self, place: Place) -> Floats:
        """The unit axes, (2, 3)."""
        flat = self.vector - self.vector @ place.normal * place.normal
        flat = flat / np.linalg.norm(flat)
        return np.array([about(place.normal, a, flat) for a in self.angles])


def orthotropic(mu: Floats) -> Callable[[Floats, Floats], Floats]:
    """F of the axes, rows of a (2, 2) in the frame (43)."""
    return lambda first, _: np.einsum("a,ai,aj->ij", mu**-2.0, first, first)


def he_curnier(alpha: Floats) -> Callable[[Floats, Floats], Floats]:
    """F = C^-2 with C = alpha_1 I + alpha_2 m (x) m + alpha_3 k (x) k (30)."""

    def tensor(first: Floats, second: Floats) -> Floats:
        m, k = first[0], second[0]
        c = alpha[0] * np.eye(2) + alpha[1] * np.outer(m, m) + alpha[2] * np.outer(k, k)
        return np.asarray(np.linalg.matrix_power(np.linalg.inv(c), 2))

    return tensor


@dataclass(frozen=True)
class Problem:
    """A trial force outside the ellipse, in the frame.

    `relieve(k, lam)` is the force of a slip -lam K T; `stiffness` is -dT/dx of the step.
    """

    friction: Floats
    axes: Floats
    trial: Floats
    stiffness: Floats
    increment: Floats
    pressure: float

    def norm(self, t: Floats) -> float:
        return float(np.sqrt(t @ self.friction @ t))

    def on_ellipse(self, t: Floats) -> Floats:
        return np.asarray(self.pressure / self.norm(t) * t)

    def slip_of(self, change: Floats) -> Floats:
        """The shortest slip that changes the force so."""
        return np.asarray(np.linalg.pinv(self.stiffness, rcond=1e-10) @ change)


@dataclass(frozen=True)
class Slid:
    """Force, what is remembered of it, and slip."""

    force: Floats
    stored: Floats
    slip: Floats


Rule = Callable[[Problem], Slid]


def normality(tensor: Callable[[Problem], Floats]) -> Rule:
    """Slip -lam K T, T = (1 + lam S K)^-1 T_tr, the first lam at which T is on the ellipse."""

    def slide(p: Problem) -> Slid:
        k = tensor(p)
        sk = p.stiffness @ k

        def force(lam: float) -> Floats:
            return np.asarray(np.linalg.solve(np.eye(2) + lam * sk, p.trial))

        def over(lam: float) -> float:
            return p.norm(force(lam)) / p.pressure - 1.0

        lams = np.append(0.0, np.logspace(-9, 9, 181) / np.linalg.norm(sk))
        forces = np.linalg.solve(np.eye(2) + lams[:, None, None] * sk, p.trial[:, None])[..., 0]
        outside = np.einsum("ni,ij,nj->n", forces, p.friction, forces) > p.pressure**2
        if outside.all():  # the strip: no slip brings the force back, and its limit counts
            t = p.on_ellipse(np.trace(sk) * p.trial - sk @ p.trial)
            return Slid(t, t, p.slip_of(t - p.trial))
        first = int(np.argmin(outside))
        lam = brentq(over, lams[first - 1], lams[first], xtol=1e-300, rtol=1e-15)
        t = p.on_ellipse(force(lam))
        return Slid(t, t, -lam * k @ t)

    return slide


def root(m: Floats) -> Floats:
    w, v = np.linalg.eigh(m)
    return np.asarray(v @ np.diag(np.sqrt(w)) @ v.T)


def slip_ellipse(k: tuple[float, float], angle: float) -> Rule:
    """Slip normal to an ellipse turned from the first friction axis [Michalowski Mroz 1978]."""

    def tensor(p: Problem) -> Floats:
        e = p.axes[0]
        side = np.sign(e[0] * p.axes[1, 1] - e[1] * p.axes[1, 0])
        across = side * np.array([-e[1], e[0]])
        first = np.cos(angle) * e + np.sin(angle) * across
        second = np.cos(angle) * across - np.sin(angle) * e
        return np.outer(first, first) / k[0] ** 2 + np.outer(second, second) / k[1] ** 2

    return normality(tensor)


def radial(p: Problem) -> Slid:
    t = p.on_ellipse(p.trial)
    return Slid(t, t, p.slip_of(t - p.trial))


def explicit(history: str) -> Rule:
    """Force (96) with what (114), (112) or (104)-(111) remembers."""

    def slide(p: Problem) -> Slid:
        force = p.on_ellipse(p.stiffness.T @ p.friction @ p.trial)
        stored = force if history == "incremental" else p.on_ellipse(p.trial)
        if history == "kuhn-tucker":
            s = p.stiffness @ p.increment
            quadratic = [s @ p.friction @ s, 2.0 * s @ p.friction @ p.trial]
            roots = np.roots([*quadratic, p.norm(p.trial) ** 2 - p.pressure**2])
            real = [lam.real for lam in roots if abs(lam.imag) < 1e-12 and lam.real > 0.0]
            if real:
                return Slid(force, p.trial + min(real) * s, min(real) * p.increment)
        return Slid(force, stored, p.slip_of(stored - p.trial))

    return slide


#: Rules by name and their parameters.
RULES: dict[str, tuple[dict[str, Any], Rule]] = {
    "maximum-dissipation": ({}, normality(lambda p: p.friction)),
    "linear": ({}, normality(lambda p: root(p.friction))),
    "coaxial": ({}, normality(lambda p: np.eye(2))),
    "slip-ellipse": ({"slip_axes": (1.3, 1.0), "slip_angle": 0.4}, slip_ellipse((1.3, 1.0), 0.4)),
    "radial": ({}, radial),
    **{
        f"explicit {h}": ({"history": h}, explicit(h))
        for h in ("centre", "incremental", "kuhn-tucker")
    },
}


@dataclass(frozen=True)
class History:
    """What a point remembers; forces and slips as vectors of space at its place."""

    xi: Floats
    gap: float
    status: int = OPEN
    pressure: float = 0.0
    stored: Floats = field(default_factory=lambda: np.zeros(3))
    elastic: Floats = field(default_factory=lambda: np.zeros(3))
    dissipation: float = 0.0
    viscous: float = 0.0
    length: float = 0.0
    slave: Floats | None = None


@dataclass(frozen=True)
class Answer:
    """Traction of a step and the slip, vectors of space, with the new history."""

    traction: Floats
    slip: Floats
    energy: float
    history: History


@dataclass(frozen=True)
class Law:
    """An interface.

    Attributes:
        patch: The master.
        evolution: Name of the form.
        pressure: Normal law.
        elements: Adhesion along its axes.
        adhesion, friction, second: Axes.
        limit: F of the axes of friction.
        rule: Sliding rule.
        partial: Whether laws act for that part of a step in which the gap is closed.
    """

    patch: Patch
    evolution: str
    pressure: Pressure
    elements: Elements
    adhesion: Marks
    friction: Marks
    second: Marks
    limit: Callable[[Floats, Floats], Floats]
    rule: Rule
    partial: bool = True

    def step(
        self, old: History, xi: Floats, gap: float, dt: float, slave: Floats | None = None
    ) -> Answer:
        """The step to the foot xi and the gap, with two material tangents of the slave, (2, 3)."""
        here = self.patch.at(xi)
        begins = old.status == OPEN and old.gap > 0.0
        share = gap / (gap - old.gap) if begins and gap < 0.0 else 1.0
        time = share * dt if self.partial else dt  # in contact
        n = self.pressure.at(gap, old.gap, old.pressure, time if self.pressure.w else dt)
        lasting = replace(old, xi=xi, gap=gap, status=OPEN, pressure=0.0)
        zero = np.zeros(3)
        if n == 0.0:
            history = replace(lasting, stored=zero, elastic=zero, slave=None)
            return Answer(zero, zero, 0.0, history)
        t = here.frame(0.6)
        stored, elastic, moved, turned = self._brought(old, here, t, xi, gap)
        if self.evolution == "transport" and slave is not None and old.slave is not None:
            there = self.patch.at(old.xi)
            before = np.array([_turned(v, there, here) for v in old.slave])
            moved = _spun(moved, t, _gradient(before, slave))
        if old.status == OPEN:
            stored, elastic, moved = np.zeros(2), np.zeros(2), share * moved
        lower = self._axes(old, here) @ t.T  # axes in the frame, row by row
        upper = np.linalg.inv(lower).T  # reciprocal axes
        e = self.elements
        a = lower.T @ e.a @ upper
        q = -lower.T @ (e.s + time * e.r) @ lower
        left = e.w * turned + time * a
        if self.evolution == "total":
            stored = -lower.T @ e.s @ lower @ elastic
        right = e.w * stored + q @ moved - time * lower.T @ e.r @ lower @ elastic
        stiffness = -np.linalg.solve(left, q)
        axes = self.friction.at(here) @ t.T
        f = self.limit(axes, self.second.at(here) @ t.T)
        p = Problem(f, axes, np.linalg.solve(left, right), stiffness, moved, n)
        sticks = p.norm(p.trial) <= n * (1.0 + 1e-10)
        r = Slid(p.trial, p.trial, np.zeros(2)) if sticks else self.rule(p)
        kept = elastic + moved - r.slip
        now = self.adhesion.at(here) @ t.T
        stores, lost = self._energies(now, r.stored, kept, moved - r.slip, time)
        history = replace(
            lasting,
            status=STICK if sticks else SLIP,
            pressure=n,
            stored=r.stored @ t,
            slave=slave,
            elastic=kept @ t,
            dissipation=old.dissipation - r.force @ r.slip,
            viscous=old.viscous + lost,
            length=old.length + float(np.linalg.norm(r.slip)),
        )
        return Answer(n * here.normal + r.force @ t, r.slip @ t, stores, history)

    def _brought(
        self, old: History, here: Place, t: Floats, xi: Floats, gap: float
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Force and elastic slip of before, slip of the step, and G of G T = T_n, in the frame."""
        there = self.patch.at(old.xi)
        if self.evolution in ("transport", "backward-euler"):
            chord = here.x - there.x
            way = _arc(chord, there, here) if self.evolution == "transport" else chord
            brought = (t @ _turned(v, there, here) for v in (old.stored, old.elastic))
            return *brought, t @ way, np.eye(2)
        return self._in_coordinates(old, there, here, t, xi, gap)

    def _axes(self, old: History, here: Place) -> Floats:
        """Axes of the tensors of a step: of laws in rates halfway from those of before."""
        now = self.adhesion.at(here)
        if self.evolution != "transport" or old.status == OPEN or self.elements.w == 0.0:
            return now
        there = self.patch.at(old.xi)
        before = np.array([_turned(e, there, here) for e in self.adhesion.at(there)])
        halfway = [a + b if a @ b > 0.0 else a - b for a, b in zip(now, before, strict=True)]
        return np.array([v / np.linalg.norm(v) for v in halfway])

    def _in_coordinates(
        self, old: History, there: Place, here: Place, t: Floats, xi: Floats, gap: float
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Components of force and slip are kept, (13), (14), or change by (8), backward Euler."""
        d = self.patch.difference(xi, old.xi)
        to_frame = here.tangents @ t.T  # rho_i . t_a
        force, slip = there.tangents @ old.stored, there.dual @ old.elastic
        g = np.eye(2)
        if self.evolution == "covariant":
            g = g - np.einsum("kij,j->ik", here.connection, d) + (gap - old.gap) * here.shape
            # T_i x^i does not depend on the basis: x^k changes by g_i^k, to first order, implicitly
            slip = np.linalg.solve(2.0 * np.eye(2) - g.T, slip)
        back = np.linalg.inv(to_frame)
        return back @ force, to_frame.T @ slip, to_frame.T @ d, back @ g @ to_frame

    def _energies(
        self, lower: Floats, force: Floats, slip: Floats, moved: Floats, dt: float
    ) -> tuple[float, float]:
        """Energy of the springs, and what dashpots lose in the step; none is not a number."""
        e = self.elements
        if e.springs is None:
            return np.nan, np.nan
        k, relaxing = e.springs
        x, v = lower @ slip, lower @ moved / dt
        if e.w == 0.0:
            return 0.5 * x @ k @ x, dt * v @ relaxing @ v
        f = -np.linalg.inv(lower).T @ force - k @ x  # what the relaxing springs carry
        stretch = np.linalg.pinv(relaxing) @ f
        return 0.5 * x @ k @ x + 0.5 * f @ stretch, dt * stretch @ e.a @ f


@lru_cache(maxsize=1000)
def _between(there: Place, here: Place) -> tuple[Floats, float]:
    """Axis and angle of the least rotation that takes one normal to the other."""
    axis = cross(there.normal, here.normal)
    sine = float(np.linalg.norm(axis))
    angle = float(np.arctan2(sine, there.normal @ here.normal))
    return (axis / sine, angle) if sine > 0.0 else (here.tangents[0], 0.0)


def _turned(v: Floats, there: Place, here: Place) -> Floats:
    """A vector turned with the normal."""
    return about(*_between(there, here), v)


def _arc(chord: Floats, there: Place, here: Place) -> Floats:
    """The path that a chord spans, along its end, where the normal turns evenly on the way.

    Of the chord what is across the axis of that turn spans an arc: it is longer by
    (h/2)/sin(h/2), and ends at half of the angle h to its chord.
    """
    axis, angle = _between(there, here)
    along = chord @ axis * axis
    longer = 1.0 / np.sinc(0.5 * angle / np.pi)
    return along + longer * about(axis, 0.5 * angle, chord - along)


def _gradient(before: Floats, now: Floats) -> Floats:
    """What takes two tangents, the rows, and their unit normal to those of now."""
    columns = []
    for pair in (before, now):
        area = cross(*pair)
        columns.append(np.column_stack([*pair, area / np.linalg.norm(area)]))
    return np.asarray(columns[1] @ np.linalg.inv(columns[0]))


def _spun(chord: Floats, t: Floats, gradient: Floats) -> Floats:
    """The path that a chord spans where the slave turns evenly about the normal, along its end.

    The turn is the rotation in the part of the slave's gradient that stays in the contact plane.
    """
    rotation, _ = polar(t @ gradient @ t.T)
    spin = float(np.arctan2(rotation[1, 0], rotation[0, 0]))
    c, s = np.cos(0.5 * spin), np.sin(0.5 * spin)
    return np.array([[c, -s], [s, c]]) @ chord / np.sinc(0.5 * spin / np.pi)
