"""What a state in equilibrium has to pass before it is accepted.

Newton's method knows balance of forces and nothing else. A state in balance in which cells are
inverted, or a body is where it cannot be, is no solution: it is refused with its reason, and the
increment is tried with another strategy or in smaller steps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from anisocontact.base.fenicsx import Vec
from anisocontact.solver.stepping.convergence_diagnostics import inverted_cells, strayed
from anisocontact.solver.system.culprit import Culprit
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.system.rotations import CURE, WARNED
from anisocontact.solver.terms.unsupported_rigid_body import flown

#: Error of the gap of a point that is held on a facet, over the size of a facet, that is none.
STRAYED = 1e-3


#: Why states with such cells are refused.
INVERTED = "cells are inverted (det F <= 0)"


@dataclass(frozen=True)
class Refusal:
    """Why a state in equilibrium is not accepted.

    Attributes:
        reason: In a line.
        culprits: The places that caused it, over all ranks.
        final: Whether no smaller sub-increment can help: the run stops.
    """

    reason: str
    culprits: tuple[Culprit, ...] = ()
    final: bool = False


type Check = Callable[[Problem, Vec], Refusal | None]
"""Takes the problem and all unknowns of the state that it was evaluated at last.

Collective: it is asked on every rank and says the same on each.
"""


def cells_inside_out(problem: Problem, _: Vec) -> Refusal | None:
    """Refuse states with inverted cells."""
    found = inverted_cells(problem)
    return Refusal(INVERTED, tuple(found)) if found else None


def energy_not_a_number(problem: Problem, _: Vec) -> Refusal | None:
    """Refuse states beyond the range of an energy, as past the lock of a rubber.

    Its derivative may well be a number there: that of a logarithm is one for every argument.
    """
    if not problem.reduction.whole:  # of linear bodies
        return None
    if math.isfinite(problem.assembly.bodies.energy(problem.nodal)):
        return None
    return Refusal(
        "the elastic energy is not a number: a body is strained beyond the range of its law"
    )


def contact_lets_go(problem: Problem, x: Vec) -> Refusal | None:
    """Refuse states in which nothing holds a free body."""
    stabilisation = problem.stabilisation
    reason = stabilisation.lets_go(problem.reduction.nodal(x)) if stabilisation.watches else ""
    return Refusal(reason) if reason else None


def rigid_body_overturns(problem: Problem, _: Vec) -> Refusal | None:
    """Refuse states in which a free rigid body turns by half a turn or more."""
    reason = problem.rigid.overturned()
    return Refusal(reason) if reason else None


def rigid_body_flies(problem: Problem, _: Vec) -> Refusal | None:
    """Refuse states to which loads alone have moved a free rigid body farther than all is long."""
    rigid, extent = problem.rigid, problem.layout.unknowns.extent
    if not rigid.free or problem.comm.allreduce(int(not (problem.supports.rest and rigid.rest))):
        return None
    extent = max(problem.comm.allgather(extent))
    found = (flown(b, rigid.holds(b), rigid.contacts[b], extent, problem.comm) for b in rigid.free)
    reason = next(filter(None, found), "")
    return Refusal(reason) if reason else None


def held_points_stray(problem: Problem, _: Vec) -> Refusal | None:
    """Refuse states in which points are held on a facet that is not the one below them."""
    found = strayed(problem, STRAYED)
    text = f"{len(found)} slave points are fixed to a facet that is not the closest any more"
    return Refusal(text, tuple(found)) if found else None


def turned_too_far(problem: Problem, x: Vec) -> Refusal | None:
    """Refuse states in which a body at small strain has turned beyond what its model can tell.

    Smaller sub-increments help where it had hardly turned before, since it may have jumped.
    """
    found = {name: t for name, t in problem.turned(x).items() if t.too_far}
    if not found:
        return None
    name = max(found, key=lambda body: found[body].angle)
    before = problem.rotations.accepted.get(name)
    reason = f"body {name!r}, at small strain, {found[name]}; {CURE}"
    return Refusal(reason, final=before is not None and before.angle > WARNED)


def behind_a_master(problem: Problem, x: Vec) -> Refusal | None:
    """Refuse states in which a body is behind its master."""
    found = problem.behind_a_master(x)
    return Refusal(f"contact {found.contact!r}: {found.why}", (found,)) if found else None


#: All checks, in the order in which they are asked.
CHECKS: tuple[Check, ...] = (
    cells_inside_out,
    energy_not_a_number,
    rigid_body_overturns,
    rigid_body_flies,
    held_points_stray,
    behind_a_master,
    contact_lets_go,
    turned_too_far,
)


def refused(problem: Problem, x: Vec) -> Refusal | None:
    """The first objection to a state in equilibrium; None if it may be accepted.

    Args:
        problem: The problem, evaluated at the state.
        x: All unknowns of the state.
    """
    for check in CHECKS:
        objection = check(problem, x)
        if objection is not None:
            return objection
    return None
