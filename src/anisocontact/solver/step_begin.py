"""A step begins: the parts of a problem take over its supports and loads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from anisocontact.mesh import Model
from anisocontact.solver.parts import Parts
from anisocontact.solver.steps import Step
from anisocontact.solver.supports import Supports

Floats = npt.NDArray[np.float64]


def begin_step(parts: Parts, step: Step, start: Floats, reaction: Floats, again: bool) -> None:
    """Take over the loads of a step; what is no longer prescribed goes on from its reaction.

    Args:
        parts: Parts of the problem.
        step: The step.
        start: Accepted displacements of the local nodes, (3 nodes,), length.
        reaction: What the supports carry there, on the unknowns this rank owns, force.
        again: Whether the step had begun before, in a run that now goes on.

    Raises:
        InputError: See `Supports.begin` and `DeadLoads.begin`.
    """
    supports, planes = parts.supports, parts.constraints.planes
    held = supports.unknowns
    supports.begin(step, start)
    gone = np.setdiff1d(held, supports.unknowns)
    released = np.zeros(len(start))
    _, of_supports = planes.forces(reaction)
    released[gone] = of_supports[gone]
    parts.loads.begin(step, released)
    parts.rigid.begin(step)
    parts.attached.begin(step)
    planes.begin(supports.unknowns, supports.end, step.name)
    parts.stabilisation.begin([*supports.held(), *planes.held()], step.name, now=not again)


def contact_must_hold(parts: Parts, model: Model, steps: Sequence[Step], size: int) -> bool:
    """Whether contact alone has to hold a body in one of the steps.

    Args:
        parts: Parts of the problem.
        model: Mesh of the bodies.
        steps: The steps.
        size: Number of displacements of this rank's local nodes.

    Raises:
        InputError: A body is free to move and in no contact.
    """
    supports, nothing = Supports(model), np.zeros(size)
    found = False
    for step in steps:
        supports.begin(step, nothing)
        held = [*supports.held(), *parts.constraints.planes.held()]
        parts.stabilisation.begin(held, step.name, now=False)
        found = found or bool(parts.stabilisation)
    parts.stabilisation.clear()
    return found
