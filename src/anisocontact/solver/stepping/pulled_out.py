"""Loads that pull a body out of what it is wedged in, by more than friction holds there."""

from __future__ import annotations

import numpy as np

from anisocontact.solver.stepping.driven import Driven, driven
from anisocontact.solver.stepping.limit_load import Limit, withdrawal
from anisocontact.solver.stepping.overload import (
    CURE,
    NEARLY,
    NOTHING,
    TOO_MUCH,
    TURNS,
    Overload,
)
from anisocontact.solver.stepping.pressed_points import pressed_all_over, shown, slipping
from anisocontact.solver.stepping.rest_after_sliding import SlidingMotion
from anisocontact.solver.system.problem import Problem


def pulled_out(problem: Problem, fraction: float, now: float) -> list[Overload]:
    """Loads that friction does not hold as they pull bodies away from what presses them.

    They are told, and not taken as the only reason: normal forces are those of now, of bodies that
    deform.

    Args:
        problem: The problem, in the last accepted state.
        fraction: Fraction of the step whose loads are looked at.
        now: Fraction of the step of the accepted state.
    """
    told = [_pulled_out(problem, body) for body in driven(problem, fraction, now)]
    return [Overload(text, told=True, certain=False) for text in told if text]


def _pulled_out(problem: Problem, body: Driven) -> str:
    """What is said of a body; empty where friction holds it, or something may stop it."""
    points = pressed_all_over(problem, body)
    if points is None:
        return ""
    then = withdrawal(points, body.motions, body.load)
    # where normal forces alone drive it, or nothing rubs, it rests as soon as these are less
    if then is None or not NOTHING < then.held * TOO_MUCH < 1.0 or body.load @ then.motion <= 0.0:
        return ""
    accepted = withdrawal(points, body.motions, body.before)
    if accepted is None or not accepted.held * NEARLY < 1.0:
        return ""
    contacts = [contact for contact, _ in body.contacts]
    slide = SlidingMotion(then.motion, body.centre, body.size, body.loads, contacts, 1.0)
    if slide.rests(1.0 - then.held):
        return ""
    return f"{_line(body, then)}; {CURE}{slipping(body)}"


def _line(body: Driven, found: Limit) -> str:
    """What drives a body out, and what friction holds, along the motion that it holds least."""
    shift, turn = np.split(found.motion, 2)
    if np.linalg.norm(turn) <= TURNS * np.linalg.norm(shift):
        size = 1.0 / float(np.linalg.norm(shift))
        what = f"{size:.4g} along {shown(shift * size)}"
    else:
        size = body.size / float(np.linalg.norm(turn))
        what = f"a moment of {size:.4g} about {shown(turn * size / body.size)}"
    return (
        f"the loads on {body.name} pull it out: with the normal forces of now they come to {what}, "
        f"and friction holds {found.held * size:.4g} there at most"
    )
