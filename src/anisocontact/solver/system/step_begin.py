"""A step begins: the parts of a problem take over its supports and loads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from anisocontact.bulk import Material
from anisocontact.mesh import Model
from anisocontact.solver.stepping.steps import Step
from anisocontact.solver.system.parts import Parts
from anisocontact.solver.terms.loads import Loads
from anisocontact.solver.terms.supports import Supports

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
    before = supports.unknowns
    supports.begin(step, start)
    gone = np.setdiff1d(before, supports.unknowns)
    released = np.zeros(len(start))
    _, of_supports = planes.forces(reaction)
    released[gone] = of_supports[gone]
    parts.loads.begin(step, released)
    parts.rigid.begin(step)
    parts.attached.begin(step)
    planes.begin(supports.unknowns, supports.end, step.name)
    held = [*supports.held(), *planes.held()]
    load = _at_the_end(parts.loads, start) if parts.attached else None
    parts.stabilisation.begin(held, step.name, load, now=not again)


def contact_must_hold(
    parts: Parts,
    model: Model,
    materials: Mapping[str, Material],
    steps: Sequence[Step],
    size: int,
) -> bool:
    """Whether contact alone has to hold a body without springs in one of the steps.

    Args:
        parts: Parts of the problem.
        model: Mesh of the bodies.
        materials: Material of each body.
        steps: The steps.
        size: Number of displacements of this rank's local nodes.

    Raises:
        InputError: A body is free to move and in no contact.
    """
    supports, loads, nothing = Supports(model), Loads(model, materials), np.zeros(size)
    load: Floats | None = None
    found = False
    for step in steps:
        supports.begin(step, nothing)
        held = [*supports.held(), *parts.constraints.planes.held()]
        if parts.attached:
            loads.begin(step, nothing)
            load = _at_the_end(loads, nothing)
        parts.stabilisation.begin(held, step.name, load, now=False)
        found = found or parts.stabilisation.contact_alone
    parts.stabilisation.clear()
    return found


def _at_the_end(loads: Loads, u: Floats) -> Floats:
    """Forces on the local nodes at the end of a step, at the displacement `u`, (nodes, 3)."""
    loads.set_level(1.0)
    return loads.force(u.reshape(-1, 3)).reshape(-1, 3)
