"""Adhesion where the user means none: stiffnesses that the run chooses."""

from __future__ import annotations

from anisocontact.laws.core import Adhesion, Friction

#: The sliding rule whose direction of slip is up to the adhesion.
EXPLICIT = "explicit"


def numerical_adhesion(friction: Friction, stiffness: float) -> Adhesion:
    """Adhesion of a stiffness that is numerical only, for a law of friction.

    The force of `explicit` turns at once where sliding begins, which leaves no equilibrium to be
    found, unless the stiffnesses are in proportion to the squares of the coefficients, along the
    same axes, docs/theory/sliding-rules.md. Their geometric mean is the stiffness that is asked
    for, and the largest elastic slip at the limit of friction is what it would be with that.

    Args:
        friction: The law of friction.
        stiffness: Its size, stress/length.

    Returns:
        The same stiffness all around, but for `explicit` with two coefficients.

    Example:
        >>> from anisocontact.anisotropy import make_directions
        >>> along = make_directions("constant", vector=(1, 0, 0))
        >>> rule = Friction(coefficients=(0.4, 0.2), directions=along, sliding_rule="explicit")
        >>> numerical_adhesion(rule, 100.0).named[1]["stiffness"]
        (200.0, 50.0)
    """
    first, second = friction.named[1].get("coefficients", (1.0, 1.0))
    if friction.rule[0] != EXPLICIT or first == second:
        return Adhesion(stiffness=stiffness)
    return Adhesion(
        stiffness=(stiffness * first / second, stiffness * second / first),
        directions=friction.directions,
        directions_on=friction.directions_on,
    )
