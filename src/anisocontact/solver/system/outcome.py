"""What an accepted state of all unknowns amounts to: reactions and energies."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.solver.system.parts import Parts

Floats = npt.NDArray[np.float64]


def reactions(parts: Parts, reaction: Floats, nodal: Floats) -> dict[str, Floats]:
    """Force of the supports of each facet group on the bodies, and of springs, (3,), force.

    Args:
        parts: Parts of the problem.
        reaction: What the supports carry, on the unknowns this rank owns, force.
        nodal: Displacement of the local nodes, (nodes, 3), length.
    """
    across, rest = parts.constraints.planes.forces(reaction)
    sums = parts.supports.reactions(rest)
    attached = parts.attached.reactions(nodal)
    for name, force in (*across.items(), *attached.items()):
        sums[name] = sums.get(name, 0.0) + force
    return sums


def energies(parts: Parts, elastic: float, work: float, nodal: Floats) -> dict[str, float]:
    """Energies, see `Problem.energies`, force times length.

    Args:
        parts: Parts of the problem.
        elastic: Elastic energy of the bodies.
        work: Work of all that acts from outside since the start.
        nodal: Displacement of the local nodes, (nodes, 3), length.
    """
    stored = {"elastic": elastic}
    stored |= dict.fromkeys(("adhesion", "normal", "friction", "viscous"), 0.0)
    stored["stabilisation"] = parts.stabilisation.energy
    stored["flow"] = parts.stabilisation.released
    for contact in parts.contacts:
        for name, value in contact.energies().items():
            stored[name] = stored.get(name, 0.0) + value
    if parts.attached or any(body.springs.any() for body in parts.rigid.bodies):
        stored["springs"] = parts.rigid.energy() + parts.attached.energy(nodal)
    return {"external": work} | stored | {"residual": work - sum(stored.values())}
