"""Loads on a free body that friction cannot hold, said where a sub-increment fails.

A body that only contact holds cannot carry more along it than friction allows: `mu N` in the
direction of the load on a flat contact, N what presses it on, and on others the limit load of
limit analysis. There is no equilibrium to be found beyond, and Newton's method ends in whatever it
meets first.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from anisocontact.base.array_types import Floats
from anisocontact.contact import Contact
from anisocontact.solver.stepping.chains import chains
from anisocontact.solver.stepping.driven import Driven, deformable, driven
from anisocontact.solver.stepping.limit_load import (
    Limit,
    PressedPoints,
    limit,
)
from anisocontact.solver.stepping.pressed_points import moves, pressed_points, shown, slipping
from anisocontact.solver.stepping.rest_after_sliding import SlidingMotion
from anisocontact.solver.system.problem import Problem

#: Sum of the normal forces over the sum of their sizes from which on a contact is flat.
FLAT = 0.99
#: Share of a direction that has to be among the free motions of a body.
FREE = 0.99
#: Load over the limit of friction that is too much. Below, something else may be the cause, for
#: normals turn a little while bodies deform.
TOO_MUCH = 1.005
#: The same where sliding is waited for: closer to the limit corrections are lost in the last stick.
AT_LIMIT = 0.9999
#: Share of what friction can hold that the accepted loads have to have reached where the loads do
#: not say what presses a body on, which changes along an increment, or loads of later ones count.
NEARLY = 0.97
#: Load over the limit of friction that is told with a failure even where pressures that move within
#: the contact could change the limit: by less than that.
FAR = 3.0
#: Cuts of an increment beyond which friction that hardly holds the loads counts as exhausted, and
#: from which on no more are made where nothing could hold a body where it touches.
MANY = 2
#: Smallest sub-increment, share of an increment, that is halved where friction would not hold its
#: loads with the pressures of now, and the loads of now are far below: where the loads say how much
#: presses, and where it may come to press more.
CLOSER, LESS_SURE = 0.05, 0.25
#: Share of a motion that is a turn from which on a moment is told.
TURNS = 0.1
#: Share of the loads that friction holds which is no friction at all.
NOTHING = 1e-9
#: What can be done about it, and where there is no friction.
CURE = "load it less, press it more, or lead it by displacements"
WITHOUT = "hold it, or lead it by displacements"


@dataclass(frozen=True)
class Overload:
    """Loads that friction does not hold.

    Attributes:
        text: Which, in a line.
        told: Whether there is evidence enough to say so.
        certain: Whether nothing that presses the body otherwise by then can make it hold: a contact
            that is open yet, or prescribed motion.
        further: Whether it is not told as the body rests further on, see `SlidingMotion`.
        pressed: Whether the loads themselves say what presses the body on.
        far: Whether it is worth a word where an increment fails, as they are so far beyond that
            what presses elsewhere would not do, and the body does not rest further on.
    """

    text: str
    told: bool
    certain: bool
    further: bool = False
    pressed: bool = False
    far: bool = False


def too_much_load(
    problem: Problem,
    fraction: float,
    now: float,
    over: float = TOO_MUCH,
    by: Contact | None = None,
) -> list[Overload]:
    """Loads on bodies that friction cannot hold, on all ranks.

    Args:
        problem: The problem, in the last accepted state.
        fraction: Fraction of the step whose loads are looked at.
        now: Fraction of the step of the accepted state.
        over: Load over the limit of friction that is too much.
        by: Contact that has to be the only one that holds the body, which may rest further on, or
            has not come near the limit; any if left out, and none of these.
    """
    found = _found(problem, driven(problem, fraction, now), over, by=by)
    return [one for one in found if one.told or by is not None]


def exhausted(problem: Problem, now: float) -> list[Overload]:
    """As of `too_much_load` at the end of the step, of bodies that friction hardly holds now."""
    found = _found(problem, driven(problem, 1.0, now), soon=True)
    return [one for one in found if one.told]


def far_beyond(problem: Problem, fraction: float, now: float) -> list[Overload]:
    """As of `too_much_load`, of loads without evidence enough but for their size."""
    return [one for one in _found(problem, driven(problem, fraction, now)) if one.far]


def past_holding(problem: Problem, fraction: float, now: float, cuts: int) -> list[Overload]:
    """Loads on deformable bodies that are the reason to try everything in a sub-increment.

    Rigid surfaces are left out: sub-increments in which nothing holds these end soon.

    Args:
        problem: The problem, in the last accepted state.
        fraction: Fraction of the step at which the sub-increment ends.
        now: Fraction of the step of the accepted state.
        cuts: Cuts of this increment so far.
    """
    if not cuts:
        return []
    found = _found(problem, deformable(problem, fraction, now))
    found = [one for one in found if one.told or one.further or one.pressed]
    if cuts > MANY:
        found += _found(problem, deformable(problem, 1.0, now), soon=True)
    return found


def least_halved(found: Sequence[Overload]) -> float:
    """Smallest size that is halved to come closer to a limit of friction, share of an increment.

    Args:
        found: Loads that friction does not hold at the end of the sub-increment.
    """
    return CLOSER if any(one.pressed for one in found) else LESS_SURE


def reason_of(attempt: str, conclusive: bool, found: Sequence[Overload]) -> str:
    """What is told of a step that stops: loads alone where nothing else can be the reason.

    Args:
        attempt: Why the last attempt failed.
        conclusive: Whether that needs no overload to happen, such as inverted cells.
        found: Loads that friction does not hold.
    """
    texts = [one.text for one in found]
    if any(one.certain for one in found):
        return "; ".join([*texts, attempt] if conclusive else texts)
    return "; ".join([attempt, *texts])


def _found(
    problem: Problem,
    bodies: Iterable[Driven],
    over: float = TOO_MUCH,
    soon: bool = False,
    by: Contact | None = None,
) -> list[Overload]:
    """Of bodies and of their chains, but for those around a body that is told already."""
    single = list(bodies)
    found: list[Overload] = []
    told: list[frozenset[str]] = []
    for body in [*single, *chains(single)]:
        elsewhere = by is not None and any(contact is not by for contact, _ in body.contacts)
        if elsewhere or any(parts <= body.parts for parts in told):
            continue
        one = _overload(problem, body, over, soon)
        if one is not None:
            found.append(one)
            told += [body.parts] if one.told else []
    return found


def _overload(problem: Problem, body: Driven, over: float, soon: bool) -> Overload | None:
    """Whether friction does not hold a body; None where it may.

    Args:
        problem: The problem.
        body: The body.
        over: Load over the limit of friction that is too much.
        soon: Whether the loads are those of later increments.
    """
    points, touched, opened = pressed_points(problem, body)
    by_load = None if points is None else _pressed_by_load(body, points)
    if points is None or not (touched or by_load):
        return None
    then = by_load or _pressed_on(body, points)
    found = limit(then, body.motions, body.load)
    if found is None or not found.held * over < 1.0:
        return None
    rubs = found.held > NOTHING
    if body.rigid and not rubs:  # which of its components are free is told elsewhere
        return None
    now = limit(points, body.motions, body.before) if touched else None
    near = now is not None and now.held * NEARLY < 1.0
    if soon and not near:
        return None
    # the load says how much presses a body, and not where: enough for translations
    shifted = None if soon or by_load is None else limit(by_load, _shifts(body), body.load)
    exact = shifted is not None and shifted.held * over < 1.0
    certain = not opened and (exact or (near and not moves(problem)))
    when = " at the end of the step" if soon else ""
    least = "" if certain else ", with what presses on it now"
    slips = slipping(body) if touched else ""
    cure = CURE if rubs else WITHOUT
    text = f"{held_at_most(body, then, found, when)}{least}: {cure}{slips}"
    told, grown = near or certain, float(then.force.sum() / points.force.sum())
    contacts = [contact for contact, _ in body.contacts]
    slide = SlidingMotion(found.motion, body.centre, body.size, body.loads, contacts, grown)
    pressed = by_load is not None
    far = pressed and found.held * FAR < 1.0
    rests = (told or far) and slide.rests(1.0 - found.held)
    good, further = not rests, told and rests
    return Overload(text, told and good, certain and good, further, pressed, far and good)


def _shifts(body: Driven) -> Floats:
    """Those of its motions that are translations, orthonormal, (j, 6)."""
    mixed = scipy.linalg.null_space(body.motions[:, 3:].T)
    return np.asarray(mixed.T @ body.motions)


def _pressed_by_load(body: Driven, points: PressedPoints) -> PressedPoints | None:
    """The points with the forces that the loads press with; None where these do not say it."""
    total = points.force @ points.normal
    pushed, sizes = float(np.linalg.norm(total)), float(points.force.sum())
    normal = total / max(pushed, np.finfo(float).tiny)
    free = float(np.linalg.norm(body.motions[:, :3] @ normal))
    pressed = -float(body.load[:3] @ normal)
    if not (pushed > FLAT * sizes and free > FREE and pressed > 0.0):
        return None
    return replace(points, force=points.force * (pressed / sizes))


def _pressed_on(body: Driven, points: PressedPoints) -> PressedPoints:
    """The points with larger forces where the loads come to press more along these, all in all.

    That they press less is not taken for granted where normals differ: what is held at most is.
    """
    total = points.force @ points.normal
    before, then = float(body.before[:3] @ total), float(body.load[:3] @ total)
    grown = then / before if before < 0.0 and then < before else 1.0
    return replace(points, force=points.force * grown)


def held_at_most(body: Driven, points: PressedPoints, found: Limit, when: str = "") -> str:
    """What the loads come to, and what friction holds, along the motion that it holds least.

    Args:
        body: The body.
        points: Where it is pressed on.
        found: The motion.
        when: When the loads are these; with a blank before it, empty for now.
    """
    shift, turn = np.split(found.motion, 2)
    pressed, share = float(points.force.sum()), ""
    if np.linalg.norm(turn) <= TURNS * np.linalg.norm(shift):
        normal = points.force @ points.normal
        normal /= np.linalg.norm(normal) or 1.0
        free = np.linalg.pinv(body.motions[:, :3]) @ body.motions[:, :3]
        force = free @ body.load[:3]
        force = force - (force @ normal) * normal
        size = float(np.linalg.norm(force))
        what = f"{size:.4g} along {shown(force / size)}"
        share = f", {found.held * size / pressed:.4g} of the normal force {pressed:.4g}"
    else:
        spin = turn / body.size
        size = 1.0 / float(np.linalg.norm(spin))
        through = body.centre + np.cross(spin, shift) / (spin @ spin)
        what = f"a moment of {size:.4g} about {shown(spin * size)} through {shown(through)}"
    return (
        f"the loads on {body.name} come to {what}{when}, and friction holds "
        f"{found.held * size:.4g} there at most{share}"
    )
