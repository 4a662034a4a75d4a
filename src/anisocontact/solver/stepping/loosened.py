"""Bodies that friction lets go under loads it still holds: what presses them falls.

A shaft in a hub that relaxes, or a clamp that cools, carries its load until friction is exhausted.
No pressures of now say that it will be, as they would hold the loads of the end of the increment.
"""

from __future__ import annotations

from dataclasses import replace

from anisocontact.solver.stepping.driven import Driven, driven
from anisocontact.solver.stepping.limit_load import limit
from anisocontact.solver.stepping.overload import (
    CURE,
    NEARLY,
    NOTHING,
    TOO_MUCH,
    Overload,
    held_at_most,
)
from anisocontact.solver.stepping.pressed_points import moves, pressed_all_over, slipping
from anisocontact.solver.system.problem import Problem


def loosened(problem: Problem, fraction: float, now: float) -> list[Overload]:
    """Loads that friction hardly holds now, of bodies that flew off in a sub-increment.

    To be asked where an attempt has thrown a body farther than all is long: that says that
    nothing holds it further on, and where the loads do not grow, that less presses it.

    Args:
        problem: The problem, in the last accepted state.
        fraction: Fraction of the step at the end of the increment.
        now: Fraction of the step of the accepted state.
    """
    told = [_loosened(problem, body) for body in driven(problem, fraction, now)]
    certain = not moves(problem)
    return [Overload(text, told=True, certain=certain) for text in told if text]


def _loosened(problem: Problem, body: Driven) -> str:
    """What is said of a body; empty where friction holds it easily, or the loads grow too far."""
    points = pressed_all_over(problem, body)
    if points is None:
        return ""
    then = limit(points, body.motions, body.load)
    if then is None or then.held * TOO_MUCH < 1.0:
        return ""
    found = limit(points, body.motions, body.before)
    if found is None or not NOTHING < found.held * NEARLY < 1.0:
        return ""
    held = held_at_most(replace(body, load=body.before), points, found)
    return f"{held}, with what presses on it now, which falls: {CURE}{slipping(body)}"
