"""The sliding rules by themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.base import registry
from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed
from anisocontact.surfaces import threads_of


@dataclass(frozen=True, eq=False)
class Slide:
    """Forces of a batch of n points.

    Args:
        traction: T_i, (n, 2) [stress].
        stored: Elastic force the next trial starts from, (n, 2) [stress].
        slip: Sliding increment, (n, 2) [length]; zero where the point sticks.
        d_trial: dT_i/dT_tr,j, (n, 2, 2); empty where it was not asked for.
        d_pressure: dT_i/dN, (n, 2); empty where it was not asked for.
        slides: Whether the trial force was outside the ellipse, (n,).
        converged: Whether the rule found its force, (n,).

    Example:
        >>> stiffness, friction = 10.0 * np.eye(2)[None], np.eye(2)[None] / 0.3**2
        >>> found = slide(stiffness, friction, [[-1.0, 0.0]], [2.0])
        >>> bool(found.slides[0]), found.traction.round(9).tolist()
        (True, [[-0.6, 0.0]])
    """

    traction: Floats
    stored: Floats
    slip: Floats
    d_trial: Floats
    d_pressure: Floats
    slides: Flags
    converged: Flags


@typed
def slide(
    stiffness: npt.ArrayLike,
    friction: npt.ArrayLike,
    trial: npt.ArrayLike,
    pressure: npt.ArrayLike,
    sliding_rule: str = "maximum-dissipation",
    *,
    metric: npt.ArrayLike | None = None,
    axes: npt.ArrayLike | None = None,
    increment: npt.ArrayLike | None = None,
    tangent: bool = True,
    threads: int | None = None,
    **parameters: object,
) -> Slide:
    """The sliding rule by itself: trial force to force, with the consistent tangent.

    Components are those of any basis rho_1, rho_2 of the tangent plane; without a metric the basis
    is orthonormal, without axes its first vector lies along the first friction axis.

    Args:
        stiffness: S_ij = -b_ij, (n, 2, 2) [stress/length].
        friction: f^ij of the yield ellipse T.FT = N^2, (n, 2, 2).
        trial: T_tr,i, (n, 2) [stress].
        pressure: N > 0, (n,) [stress].
        sliding_rule: Name in `registry.sliding_rules()`.
        metric: a_ij, (n, 2, 2); the unit matrix if left out.
        axes: Components e_a^i of the unit vectors along the two friction axes, row a, (n, 2, 2).
        increment: Increment of displacement dxi^i that led to the trial force, (n, 2) [length]; if
            left out, the one that leads there from no force.
        tangent: Whether the tangent is wanted.
        threads: Number of threads; all processors if left out.
        **parameters: Parameters of the rule.

    Returns:
        Force, slip and tangent of every point.

    Raises:
        InputError: Unknown rule or parameter, or arrays that do not fit.

    Example:
        >>> s = slide(np.eye(2)[None], np.eye(2)[None] / 0.09, [[1.0, 0.0]], [1.0])
        >>> s.traction.round(12).tolist()
        [[0.3, 0.0]]
    """
    rule = registry.entry(registry.sliding_rules(), sliding_rule, "sliding_rule")
    core = _core.SlidingRule(sliding_rule, registry.values(rule, parameters))
    n = np.size(pressure)
    return Slide(
        **core.slide(
            _checked(stiffness, "stiffness", (n, 2, 2)),
            _checked(friction, "friction", (n, 2, 2)),
            _checked(trial, "trial", (n, 2)),
            _checked(pressure, "pressure", (n,)),
            None if metric is None else _checked(metric, "metric", (n, 2, 2)),
            None if axes is None else _checked(axes, "axes", (n, 2, 2)),
            None if increment is None else _checked(increment, "increment", (n, 2)),
            tangent,
            threads_of(threads),
        )
    )


def _checked(given: npt.ArrayLike, name: str, shape: tuple[int, ...]) -> Floats:
    a = np.ascontiguousarray(given, dtype=np.float64)
    if a.shape != shape:
        raise InputError(f"an array of shape {a.shape} given, {shape} needed", field=name)
    return a
