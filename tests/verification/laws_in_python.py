"""Tangential laws in Python that the tests of meshed masters share."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from anisocontact.interface import LawKinematics, LawResult, LawState

Floats = np.ndarray


@dataclass(frozen=True)
class RadialReturn:
    """Orthotropic adhesion and friction, the sliding rule "radial" of the core.

    Its own variable is the sum of the pressures of all increments.
    """

    stiffness: tuple[float, float]
    coefficients: tuple[float, float]
    internal: int = 1

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        """T_tr = T - B d, back along itself onto T . F T = N^2."""
        n, pressure = len(kinematics.pressure), kinematics.pressure
        b, f = np.diag(self.stiffness), np.diag(1.0 / np.square(self.coefficients))
        trial = state.traction - kinematics.increment @ b
        size = np.sqrt(np.einsum("ni,ij,nj->n", trial, f, trial))
        slides = size > pressure
        safe = np.where(slides, size, 1.0)[:, None]
        scale = np.where(slides, pressure / safe[:, 0], 1.0)[:, None]
        away = np.einsum("ni,nj->nij", trial / safe, trial @ f / safe)
        d_trial = scale[..., None] * (np.eye(2) - slides[:, None, None] * away)
        traction = scale * trial
        slip = slides[:, None] * (traction - trial) / self.stiffness
        return LawResult(
            traction=traction,
            slip=slip,
            d_increment=-d_trial @ b,
            d_pressure=slides[:, None] * trial / safe,
            d_traction=d_trial,
            d_elastic=np.zeros((n, 2, 2)),
            internal=state.internal + pressure[:, None],
            dissipation=-np.einsum("ni,ni->n", traction, slip),
            energy=0.5 * np.einsum("ni,ni->n", traction, traction / self.stiffness),
        )


@dataclass(frozen=True)
class Skew:
    """A linear law whose blocks are full and not symmetric: whatever it sees has a slope.

    `T = A T_0 + B d / dt + C e + c N`, with A, B, C and c of no symmetry.
    """

    stiffness: float
    internal: int = 0

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        """The force and its constant slopes; it never slides."""
        k, n = self.stiffness, len(kinematics.pressure)
        a = np.array([[0.8, 0.3], [-0.2, 0.7]])
        b = -k / kinematics.dt * np.array([[1.0, 0.4], [-0.5, 0.6]])
        c = k * np.array([[-0.3, 0.2], [0.1, -0.4]])
        by_pressure = np.array([0.2, -0.1])
        traction = state.traction @ a.T + kinematics.increment @ b.T + state.elastic @ c.T
        traction += kinematics.pressure[:, None] * by_pressure
        none = np.zeros(n)
        return LawResult(
            traction=traction,
            slip=np.zeros((n, 2)),
            d_increment=np.tile(b, (n, 1, 1)),
            d_pressure=np.tile(by_pressure, (n, 1)),
            d_traction=np.tile(a, (n, 1, 1)),
            d_elastic=np.tile(c, (n, 1, 1)),
            internal=state.internal,
            dissipation=none,
            energy=none,
            stored=0.5 * traction,
        )


@dataclass(frozen=True)
class Spoiled:
    """A law one array of which is wrong."""

    law: RadialReturn
    name: str
    wrong: object
    internal: int = 1

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        """What the law says, with the array spoiled."""
        found = self.law.update(state, kinematics)
        return replace(found, **{self.name: self.wrong(getattr(found, self.name))})


class Creeping:
    """Force that is proportional to the slip velocity and no more than a share of the pressure."""

    internal = 0

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        n, dt = len(kinematics.pressure), kinematics.dt
        velocity = kinematics.increment / dt
        limit = 0.3 * kinematics.pressure
        size = np.sqrt((velocity**2).sum(axis=1) + 1e-6)
        unit = velocity / size[:, None]
        d_unit = (np.eye(2) - unit[:, :, None] * unit[:, None, :]) / size[:, None, None]
        traction = -limit[:, None] * unit
        return LawResult(
            traction=traction,
            slip=kinematics.increment,
            d_increment=-limit[:, None, None] * d_unit / dt,
            d_pressure=-0.3 * unit,
            d_traction=np.zeros((n, 2, 2)),
            d_elastic=np.zeros((n, 2, 2)),
            internal=np.zeros((n, 0)),
            dissipation=-np.einsum("ni,ni->n", traction, kinematics.increment),
            energy=np.zeros(n),
        )
