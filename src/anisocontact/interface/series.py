"""A compliant layer in series with adhesion, by which a solver comes to a stiff one.

Within an increment the trial force of every linear adhesion model is `T_tr = a - B dxi`. With a
layer of the compliance c behind it, `dxi -> dxi + c T`, it is `M (a - B dxi)`, `M = (1 + c B)^-1`:
what is soft stays as it is, what is stiff becomes 1/c.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact import _core
from anisocontact.base.array_types import Floats
from anisocontact.laws import Adhesion


@dataclass(frozen=True)
class SeriesHistory:
    """Force at no slip, `a = keeps T_n - recovers xi_el`, along the axes of an adhesion model.

    Attributes:
        keeps: Share of the force before, (2, 2).
        recovers: Force of the elastic slip before, (2, 2), stress/length.
    """

    keeps: Floats
    recovers: Floats

    @classmethod
    def unchanged(cls) -> SeriesHistory:
        """The force before."""
        return cls(np.eye(2), np.zeros((2, 2)))


def trial_force(adhesion: Adhesion, dt: float) -> tuple[SeriesHistory, Floats]:
    """What the trial force of an adhesion model is made of, by backward Euler.

    Args:
        adhesion: The model.
        dt: Time increment.

    Returns:
        The force a at no slip, and the stiffness B, (2, 2), stress/length: for
        `w dT/dt + A T = -S v - R xi_el` they are `(w + dt A)^-1` times `w T_n - dt R xi_el` and
        `S + dt R` [Konyukhov Schweizerhof 2006, eq. (26)].

    Example:
        >>> maxwell = Adhesion("maxwell", stiffness=(4, 4), relaxation_time=(1, 1))
        >>> trial_force(maxwell, 1.0)[1].tolist()
        [[2.0, 0.0], [0.0, 2.0]]
    """
    w, a, b, c = _core.linear_model(*adhesion.named)
    inverse = np.linalg.inv(w * np.eye(2) + dt * np.asarray(a))
    recovers = inverse @ (-dt * np.asarray(c))
    return SeriesHistory(w * inverse, recovers), inverse @ -np.asarray(b) + recovers


def slip_stiffness(adhesion: Adhesion, dt: float) -> float:
    """Largest stiffness of an adhesion model against slip in an increment, stress/length.

    Args:
        adhesion: The model.
        dt: Time increment.

    Returns:
        The stiffness; 0 where a force can be along the slip, which no layer bears.
    """
    stiffness = trial_force(adhesion, dt)[1]
    least = np.linalg.eigvalsh(stiffness + stiffness.T)[0]
    return float(np.linalg.norm(stiffness, ord=2)) if least >= 0.0 else 0.0


def in_series(adhesion: Adhesion, compliance: float, dt: float) -> tuple[Adhesion, SeriesHistory]:
    """A model with a compliant layer behind it, for one increment of time.

    Args:
        adhesion: The model.
        compliance: Of the layer, length/stress.
        dt: Time increment.

    Returns:
        Elastic adhesion of the stiffness `M B`, and the force `M a` that it has to start from.

    Example:
        >>> stiff = Adhesion(stiffness=(1e6, 1e6))
        >>> round(in_series(stiff, 0.01, 1.0)[0].named[1]["stiffness"][0], 6)
        99.990001
    """
    before, stiffness = trial_force(adhesion, dt)
    share = np.linalg.inv(np.eye(2) + compliance * stiffness)
    softer = share @ stiffness
    start = SeriesHistory(share @ before.keeps, share @ before.recovers)
    model, values = "elastic", {"stiffness": np.diag(softer).tolist()}
    if softer[0, 1] != 0.0 or softer[1, 0] != 0.0:
        model = "general-linear"
        values = {"relaxation": [0.0] * 4, "stiffness_instant": softer.reshape(-1).tolist()}
    made = Adhesion(
        model, directions=adhesion.directions, directions_on=adhesion.directions_on, **values
    )
    return made, start
