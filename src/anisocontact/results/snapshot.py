"""The numbers of an accepted increment, as `summary.json` and `history.csv` have them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact import Contact, facet_size
from anisocontact.results.quantities import CONTACT, RIGID, numbers
from anisocontact.results.resultants import Resultant, check_resultants, resultant
from anisocontact.results.round_area import SymmetryImages, round_radius
from anisocontact.results.slave_points import SlavePoints
from anisocontact.rigid import Pose, RigidBody, rotation_vector
from anisocontact.solver import Accepted, Problem, Step
from anisocontact.solver.terms.loads import mean_shares

#: Share of a pressure by which others are as large: rounding.
ALIKE = 1e-9


class Observer:
    """Takes the numbers of a problem after each accepted increment.

    Args:
        problem: The problem.
        steps: Its steps; their facet groups are the ones that are watched.
        resultants: Forces and moments that are wanted, by name.

    Raises:
        InputError: A resultant is that of no group or body of the mesh, or nothing holds it.
    """

    def __init__(
        self,
        problem: Problem,
        steps: Iterable[Step],
        resultants: Mapping[str, Resultant] = MappingProxyType({}),
    ) -> None:
        self._problem = problem
        model = problem.model
        steps = list(steps)
        nodes = check_resultants(resultants, problem, steps)
        self._resultants = {name: (what, nodes[name]) for name, what in resultants.items()}
        self._supports = named_groups(
            [problem.holding, *(step.prescribed_groups() for step in steps)]
        )
        driven = [step.driven() for step in steps]
        self._watched = {
            group: mean_shares(model, group, group)
            for group in named_groups([*driven, problem.holding, problem.coupled])
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
        bodies = self._problem.rigid
        whole = np.array([1.0, 1.0, 1.0, *self._problem.model.idealisation.moments])
        rigid = {
            body.name: numbers(
                RIGID,
                _RigidNow(body, whole * bodies.contact_force(body), whole * bodies.support(body)),
            )
            for body in bodies.bodies
        }
        return {
            "contacts": [
                numbers(CONTACT, _ContactNow(number, contact, displacements, rigid, self._problem))
                for number, contact in enumerate(self._problem.contacts)
            ],
            "reactions": {g: reactions.get(g, zero).tolist() for g in self._supports},
            **self._of_nodes(),
            "displacements": displacements,
            "rigid": rigid,
            "energy": accepted.energies if accepted else self._problem.energies(),
        }

    def _of_nodes(self) -> dict[str, Any]:
        """The resultants that are wanted, if there are any."""
        found = {
            name: resultant(what, self._problem, nodes)
            for name, (what, nodes) in self._resultants.items()
        }
        return {"resultants": found} if found else {}


@dataclass(frozen=True)
class _RigidNow:
    """A rigid body in the accepted state.

    Args:
        body: The body.
        force: Force and moment of the contacts about its reference point of now, (6,); moments that
            cancel over the whole body are 0.
        support: What holds its prescribed components, (6,).
    """

    body: RigidBody
    force: Floats
    support: Floats

    @property
    def pose(self) -> Pose:
        return self.body.accepted

    @property
    def rotation(self) -> Floats:
        return rotation_vector(self.pose.rotation)


@dataclass(frozen=True)
class _ContactNow(SlavePoints):
    """A contact in the accepted state, all processes together.

    Args:
        displacements: Mean displacement of facet groups with prescribed motion or loads, by name.
        rigid: What the summary has of rigid bodies, by name.
        problem: The problem.
    """

    displacements: Mapping[str, Any]
    rigid: Mapping[str, Any]
    problem: Problem

    @cached_property
    def resultant(self) -> tuple[Floats, Floats]:
        force, moment = self.contact.resultant()
        return force, moment

    @cached_property
    def means(self) -> tuple[float, Floats, float]:
        """Area that touches; means over it of elastic slip and accumulated slip."""
        touching = self.contact.touching()
        slips = np.column_stack([self.contact.elastic_slip(), self.state["slip_accumulated"]])
        comm = self.contact.space.mesh.comm
        total = comm.allreduce(np.append(touching @ slips, touching.sum()))
        area = float(total[4])
        mean = total[:4] / area if area > 0.0 else np.zeros(4)
        return area, mean[:3], float(mean[3])

    def place_of_peak(self) -> Floats:
        """Where the largest pressure is, (3,); no number where nothing touches."""
        contact, comm = self.contact, self.contact.space.mesh.comm
        pressure = np.where(contact.counted(), self.last.pressure, 0.0)
        most = contact.extreme(pressure)
        if not most > 0.0:
            return np.full(3, np.nan)
        # of those alike the first by its place at rest, on any number of processes
        best = np.flatnonzero(pressure >= (1.0 - ALIKE) * most)
        rest = np.round(contact.quadrature.reference[best] / contact.facet_size, 6) + 0.0
        own = [(place.tolist(), contact.points[i]) for place, i in zip(rest, best, strict=True)]
        found = [one for each in comm.allgather(own) for one in each]
        return np.asarray(min(found, key=lambda one: one[0])[1])

    def radius(self) -> float:
        """Radius of the area that touches, no number where it is not round."""
        return round_radius(self.contact, SymmetryImages(self.problem, self.contact))

    def least_gap(self) -> float:
        """Smallest gap, negative where points overlap; 0 where no point has a surface below it."""
        state = self.contact.state
        gaps = state["gap"][self.contact.master.located(state)]
        least = min(self.contact.space.mesh.comm.allgather(float(gaps.min(initial=np.inf))))
        return float(least) if np.isfinite(least) else 0.0

    def approach(self) -> float:
        return _approach(self.contact, self.displacements, self.rigid)


def _approach(
    contact: Contact, displacements: Mapping[str, Any], rigid: Mapping[str, Any]
) -> float:
    """Displacement of the slave's body against the master's, along the force that presses them.

    A body moves as far as that one of its facet groups with prescribed motion or loads that moves
    most; one without such groups counts as at rest. Gaps at the start are part of it.

    Args:
        contact: The contact.
        displacements: Mean displacement of facet groups with prescribed motion or loads, length.
        rigid: What the summary has of rigid bodies, by name.

    Returns:
        The approach, length; 0 where nothing presses.
    """
    last = contact.last
    local = (last.pressure * contact.areas) @ last.normal
    pressing = np.asarray(contact.space.mesh.comm.allreduce(local))
    size = float(np.linalg.norm(pressing))
    if size == 0.0:
        return 0.0
    away = pressing / size  # from the master to the slave
    slave = _farthest(contact.slave, displacements, -away)
    master = sum(_farthest(group, displacements, away) for group in contact.groups[1:])
    if contact.body is not None:
        master += float(np.dot(rigid[contact.body.name]["translation"], away))
    return slave + master


def _farthest(side: str, displacements: Mapping[str, Any], along: Floats) -> float:
    """Largest displacement along a direction of the groups of the body that has a group."""
    body = side.partition(".")[0]
    own = [u for group, u in displacements.items() if group.partition(".")[0] == body]
    return max((float(np.dot(u, along)) for u in own), default=0.0)


def named_groups(loads: Iterable[Iterable[str]]) -> list[str]:
    """Facet groups in the order in which they are first named."""
    return list(dict.fromkeys(group for groups in loads for group in groups))


def laws(contact: Contact) -> dict[str, Any]:
    """Laws of a contact with the numbers they were given, by name."""
    interface = contact.interface
    named = {"normal": interface.normal.named, **interface.tangential.named()}
    return {what: {"name": name, **values} for what, (name, values) in named.items()}


def exact_laws(contact: Contact) -> list[str]:
    """Those of its laws that multipliers make exact, whose stiffness is no property then."""
    trials = contact.trials
    found = {"normal": trials.augmented, "adhesion": not trials.does_work}
    return [name for name, exact in found.items() if exact]


def constants(problem: Problem, masters: Sequence[str]) -> list[dict[str, Any]]:
    """What stays the same of each contact for the whole run.

    Args:
        problem: The problem.
        masters: Names of the masters of its contacts.
    """
    return [
        {
            "slave": contact.slave,
            "master": master,
            "facet_size": facet_size(problem.model, contact.slave),
            "laws": laws(contact),
            "multipliers": exact_laws(contact),
        }
        for contact, master in zip(problem.contacts, masters, strict=True)
    ]
