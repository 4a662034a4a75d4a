"""Sliding rules whose tangential forces jump."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.interface.contact_law import AdhesionAndFriction
from anisocontact.interface.python_law import PythonLaw
from anisocontact.laws import EXPLICIT


def jumping_forces(law: AdhesionAndFriction | PythonLaw) -> str:
    """How forces of a law jump, in words; empty if they do not.

    Args:
        law: Adhesion and friction; of one in Python nothing is known.

    Example:
        >>> from anisocontact.laws import Adhesion, Friction
        >>> jumping_forces(AdhesionAndFriction(Adhesion(stiffness=9.0), Friction(coefficients=0.3)))
        ''
    """
    found = _JUMPS.get(law.sliding_rule)
    if found is None or isinstance(law, PythonLaw):
        return ""
    stiffness = np.array(law.adhesion.named[1].get("stiffness", (1.0, 1.0)))
    mu = np.array(law.friction.named[1].get("coefficients", (1.0, 1.0)))
    jumps, text = found
    return text if mu.all() and jumps(law, stiffness, mu) else ""


def _without_steady_slip(law: AdhesionAndFriction, stiffness: Floats, mu: Floats) -> bool:
    """Whether a slip ellipse leaves directions without steady slip; asked of isotropic adhesion."""
    if len(set(stiffness)) > 1:
        return False
    rule = law.friction.rule[1]
    (angle,), axes = rule["slip_angle"], np.array(rule["slip_axes"])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    slope = (turn * axes**-2.0) @ turn.T * mu[::-1, None] ** 2  # F K times the squares of both
    return bool(np.linalg.eigvalsh(slope + slope.T)[0] <= 0.0)


def _turns_at_onset(law: AdhesionAndFriction, stiffness: Floats, mu: Floats) -> bool:
    """Whether the trial force T and B F T, that of `explicit`, have other directions."""
    return bool(np.ptp(stiffness / mu**2) > _SAME * np.max(stiffness / mu**2))


#: Difference of two numbers that are meant to be the same, relative.
_SAME = 1e-6
#: Rules whose forces may jump, whether they do, and what the user is told.
_JUMPS: dict[str, tuple[Callable[[AdhesionAndFriction, Floats, Floats], bool], str]] = {
    "slip-ellipse": (
        _without_steady_slip,
        "slip_axes and slip_angle are so far from the ellipse of friction that slip in some "
        "directions raises the tangential force it should relieve: points stick there and jump, "
        "and increments may not converge, least of all with penalties at slave nodes",
    ),
    EXPLICIT: (
        _turns_at_onset,
        "with sliding_rule = 'explicit' tangential forces turn at once where sliding begins, as "
        "stiffnesses of adhesion are not in proportion to the squares of the coefficients: "
        "increments may have no equilibrium, and then do not converge; with 'maximum-dissipation' "
        "nothing jumps",
    ),
}
