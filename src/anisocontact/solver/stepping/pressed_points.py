"""Where contact presses on a body that loads drive, and what is said of it."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.solver.stepping.driven import Driven
from anisocontact.solver.stepping.limit_load import PressedPoints
from anisocontact.solver.system.problem import Problem

#: Share of the loads that presses a body and is what rounding of its place makes of a touch.
ROUNDED = 1e-9
#: Gap of a round body a facet away from where it touches, over the height of the arcs.
ONE_AWAY = 4.0


def pressed_points(problem: Problem, body: Driven) -> tuple[PressedPoints | None, bool, bool]:
    """Where contact presses on a body, on all ranks; where it touches before anything presses.

    Returns:
        The points, with their areas for forces before anything presses; None where the law is one
        in Python. Whether something presses. Whether some of its contacts do not.
    """
    found = []
    for contact, side in body.contacts:
        rows = _rows(problem, body, contact, side, contact.meeting())
        if rows is None:
            return None, False, False
        found.append(rows)
    if not found:
        return None, False, False
    arms, normal, force, area, rubs = (
        np.concatenate(column) for column in zip(*found, strict=True)
    )
    touched = bool(force.sum() > ROUNDED * np.linalg.norm(body.load))
    weight = force if touched else area
    closed = weight > 0.0
    if not closed.any():
        return None, False, False
    which = 2 if touched else 3
    opened = not all(part[which].any() for part in found)
    kept = PressedPoints(arms[closed], normal[closed], weight[closed], rubs[closed])
    return kept, touched, opened


def pressed_all_over(problem: Problem, body: Driven) -> PressedPoints | None:
    """Where contact presses on a body, if all of its contacts do; see `pressed_points`."""
    points, touched, opened = pressed_points(problem, body)
    return points if touched and not opened else None


def touching_points(problem: Problem, body: Driven) -> dict[Contact, PressedPoints]:
    """Where a body touches, pressed or not, with areas for forces, of each contact; on all ranks.

    Those of a contact of two bodies are in the same order for both. A contact with a law in Python
    is left out. Round bodies of flat facets that are apart by less than the arcs over these count
    as touching, see `_below_arcs`.
    """
    found = {}
    for contact, side in body.contacts:
        rows = _rows(problem, body, contact, side, _below_arcs(problem, contact))
        if rows is not None:
            arms, normal, _, area, rubs = (column[rows[3] > 0.0] for column in rows)
            found[contact] = PressedPoints(arms, normal, area, rubs)
    return found


def _below_arcs(problem: Problem, contact: Contact) -> Flags:
    """Points that touch, or where none does and arcs over facets would, those next to there, (n,).

    The gap of a round body a facet away from where it touches is four times as high as its arcs;
    the two points beside that place, and with them all places between, are among those below.
    """
    last, meeting = contact.last, contact.meeting()
    gap = np.where(contact.master.located(last.state), last.gap, np.inf)
    own = (bool(meeting.any()), float(gap.min(initial=np.inf)))
    touches, least = zip(*problem.comm.allgather(own), strict=True)
    if any(touches) or min(least) >= contact.sagitta:
        return meeting
    return np.asarray(gap <= ONE_AWAY * contact.sagitta)


def _rows(
    problem: Problem, body: Driven, contact: Contact, side: float, touching: Flags
) -> tuple[Floats, Floats, Floats, Floats, Floats] | None:
    """Arms, normals, normal forces, areas that touch and friction of all slave points, all ranks.

    None where the law is one in Python.
    """
    friction = contact.interface.tangential.friction
    if friction is None:
        return None
    last, areas = contact.last, contact.areas
    own = (
        (contact.points - body.centre) / body.size,
        side * last.normal,
        areas * last.pressure,
        areas * touching,
        _resistance(friction, last.directions_friction, last.normal),
    )
    arms, normal, force, area, rubs = (
        np.concatenate(column) for column in zip(*problem.comm.allgather(own), strict=True)
    )
    return arms, normal, force, area, rubs


def _resistance(friction: Friction, axes: Floats, normal: Floats) -> Floats:
    """`PressedPoints.friction` at points with these axes and normals.

    Dual to `T . F T <= N^2` with F of two coefficients [Konyukhov Schweizerhof 2006, eq. (43)]; of
    two surfaces the most that there is in any direction.
    """
    values = friction.named[1]
    across = np.eye(3) - np.einsum("ni,nj->nij", normal, normal)
    if friction.frictionless:
        return np.zeros_like(across)
    if "coefficients" not in values:
        first, *others = values["alpha"]
        return np.asarray((first + sum(max(value, 0.0) for value in others)) * across)
    first, second = values["coefficients"]
    if first == second:
        return np.asarray(first * across)
    found: Floats = np.zeros(across.shape)
    found[:, :2] = axes * np.array([first, second])[:, None]
    unknown = ~axes.any(axis=(1, 2))
    found[unknown] = max(first, second) * across[unknown]
    return found


def slipping(body: Driven) -> str:
    """How many points slip in the last state."""
    told = []
    for contact, _ in body.contacts:
        counts = contact.counts()
        closed = counts["stick"] + counts["slip"]
        if closed:
            told.append(f"{counts['slip']} of {closed} points that touch slip in {contact.name!r}")
    return f"; {', '.join(told)}" if told else ""


def moves(problem: Problem) -> bool:
    """Whether motion is prescribed along the step, which may press bodies on; collective."""
    supports = problem.comm.allreduce(int(not problem.supports.rest))
    return bool(supports > 0 or not problem.rigid.rest)


def shown(vector: Floats) -> str:
    """Components of a direction, two digits each."""
    return "(" + ", ".join(f"{v + 0.0:g}" for v in vector.round(2) + 0.0) + ")"
