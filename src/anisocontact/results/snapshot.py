"""The numbers of an accepted increment, as `summary.json` and `history.csv` have them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.contact import AnyContact
from anisocontact.interface import STATUS
from anisocontact.interface.python_pair import PYTHON_LAWS
from anisocontact.results.approach import approach
from anisocontact.rigid import RigidBody, rotation_vector
from anisocontact.solver import Accepted, Problem, Step
from anisocontact.solver.terms.loads import mean_shares

__all__ = ["Observer", "laws", "named_groups"]

Floats = npt.NDArray[np.float64]


class Observer:
    """Takes the numbers of a problem after each accepted increment.

    Args:
        problem: The problem.
        steps: Its steps; their facet groups are the ones that are watched.
    """

    def __init__(self, problem: Problem, steps: Iterable[Step]) -> None:
        self._problem = problem
        self._comm = problem.model.mesh.comm
        model = problem.model
        steps = list(steps)
        self._supports = named_groups([problem.holding, *(step.led() for step in steps)])
        self._watched = {
            group: mean_shares(model, group, group)
            for group in named_groups([*(step.driven() for step in steps), problem.holding])
            if group in model.facet_names()
        }

    def numbers(self, accepted: Accepted | None = None) -> dict[str, Any]:
        """Resultants, energies and counts of the accepted state.

        Args:
            accepted: What the solver said of it; None before the first increment.

        Returns:
            Nested numbers: `contacts`, `reactions`, `displacements`, `rigid`, `energy`.
        """
        zero = np.zeros(3)
        reactions = accepted.reactions if accepted else {}
        displacements = {
            g: self._problem.mean_displacement(g, shares).tolist()
            for g, shares in self._watched.items()
        }
        rigid = {body.name: self._rigid(body) for body in self._problem.rigid.bodies}
        contacts = self._problem.contacts
        approaches = [approach(contact, displacements, rigid) for contact in contacts]
        return {
            "contacts": [
                self._contact(contact) | {"approach": come}
                for contact, come in zip(contacts, approaches, strict=True)
            ],
            "reactions": {g: reactions.get(g, zero).tolist() for g in self._supports},
            "displacements": displacements,
            "rigid": rigid,
            "energy": accepted.energies if accepted else self._problem.energies(),
        }

    def _rigid(self, body: RigidBody) -> dict[str, Any]:
        """Where a rigid body is and what acts on it; moments about its reference point of now."""
        rigid, now = self._problem.rigid, body.accepted
        force, support = rigid.contact_force(body), rigid.support(body)
        return {
            "position": (body.reference + now.translation).tolist(),
            "translation": now.translation.tolist(),
            "rotation": rotation_vector(now.rotation).tolist(),
            "turn": now.turn.tolist(),
            "force": force[:3].tolist(),
            "moment": force[3:].tolist(),
            "support_force": support[:3].tolist(),
            "support_moment": support[3:].tolist(),
        }

    def _contact(self, contact: AnyContact) -> dict[str, Any]:
        """Resultant, extremes and counts; the means are over the area that touches."""
        force, moment = contact.resultant()
        last = contact.last
        touching = contact.areas * (last.status != STATUS.index("open"))
        slips = np.column_stack([contact.elastic_slip(), contact.state["slip_accumulated"]])
        total = self._comm.allreduce(np.append(touching @ slips, touching.sum()))
        area = float(total[4])
        mean = total[:4] / area if area > 0.0 else np.zeros(4)
        return {
            "force": force.tolist(),
            "moment": moment.tolist(),
            "max_pressure": contact.extreme(last.pressure),
            "max_penetration": contact.extreme(-last.gap),
            "max_elastic_slip": contact.extreme(np.linalg.norm(slips[:, :3], axis=1)),
            "max_turn": contact.extreme(contact.state["turn"]),
            "area": area,
            "elastic_slip": mean[:3].tolist(),
            "slip": float(mean[3]),
            "least_gap": self._least_gap(contact),
            "points": contact.counts(),
        }

    def _least_gap(self, contact: AnyContact) -> float:
        """Smallest gap, negative where points overlap; 0 where no point has a surface below it."""
        located = [part.located(part.state) for part in contact.parts]
        gaps = [p.state["gap"][on] for p, on in zip(contact.parts, located, strict=True)]
        least = min(self._comm.allgather(float(np.concatenate(gaps).min(initial=np.inf))))
        return float(least) if np.isfinite(least) else 0.0


def named_groups(loads: Iterable[Iterable[str]]) -> list[str]:
    """Facet groups in the order in which they are first named."""
    return list(dict.fromkeys(group for groups in loads for group in groups))


def laws(contact: AnyContact) -> dict[str, Any]:
    """Laws of a contact with the numbers they were given, by name."""
    interface = contact.interface
    if isinstance(interface, PYTHON_LAWS):
        name, values = interface.normal.named
        own = {"name": type(interface.law).__name__}
        return {"normal": {"name": name, **values}, "adhesion": own, "friction": own}
    named = {
        "normal": interface.normal.named,
        "adhesion": interface.adhesion.named,
        "friction": interface.friction.named,
        "sliding_rule": interface.friction.rule,
    }
    return {what: {"name": name, **values} for what, (name, values) in named.items()}
