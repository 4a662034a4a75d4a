"""Forces and moments about a point: of what holds a facet group, and through a section.

Forces at finite strain are in balance where nodes are now, those of a body at small strain where
its nodes are in the mesh: moments are taken there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem
from anisocontact.bulk import small_strain
from anisocontact.solver import Problem, Step

#: Distance of a node from a plane, over the largest of the body, that is rounding.
_IN_PLANE = 1e-9


@dataclass(frozen=True)
class GroupResultant:
    """What the supports of a facet group carry: their force on the body.

    Args:
        group: The group, "body.group".
        about: Point of the moment, length.
    """

    group: str
    about: Sequence[float] = (0.0, 0.0, 0.0)

    def body_of(self, problem: Problem) -> str:
        """Name of the body."""
        return problem.model.body_of(self.group)

    def nodes(self, problem: Problem, field: str) -> Ints:
        """Nodes of the group that this process owns."""
        model, dim = problem.model, problem.model.idealisation.dim - 1
        facets = model.facets(self.group, f"{field}.group")
        return _owned(problem, fem.locate_dofs_topological(model.space, dim, facets))

    def forces(self, problem: Problem) -> Floats:
        """At all nodes that this process owns, (nodes, 3), force."""
        return problem.support_forces()


@dataclass(frozen=True)
class SectionResultant:
    """What goes through a section of a body: the force of the part in front of it on the rest.

    The sum over the nodes in front of a plane of what balances the cells. Cells that lie wholly
    on one side add nothing to it, so it is the mean of the traction through the layer of
    cells that the plane cuts: with equilibrium of the nodes the exact force. Nodes in the plane
    count half, so that it is the mean of the layers on both sides; where the body ends there, not.

    Args:
        body: The body.
        point: A point of the plane in the reference configuration, length.
        normal: Normal of the plane, towards the front.
        about: Point of the moment, length.
    """

    body: str
    point: Sequence[float]
    normal: Sequence[float]
    about: Sequence[float] = (0.0, 0.0, 0.0)

    def body_of(self, problem: Problem) -> str:
        """Name of the body."""
        return self.body

    def nodes(self, problem: Problem, field: str) -> Ints:
        """Nodes of the body that this process owns, to be summed with half of their force.

        Collective. Those in front of the plane are there twice, those in it once.

        Raises:
            InputError: There is no such body, or the plane does not cut it.
        """
        space, cells = problem.model.space, problem.model.cells(self.body, f"{field}.body")
        dim = problem.model.idealisation.dim
        own = _owned(problem, fem.locate_dofs_topological(space, dim, cells))
        away = space.tabulate_dof_coordinates()[own] - np.array(self.point)
        distance = away @ np.array(self.normal)
        least = _IN_PLANE * max(problem.comm.allgather(np.abs(distance).max(initial=0.0)))
        front, behind = distance > least, distance < -least
        counts = np.array([len(own), front.sum(), behind.sum()])
        there, before, back = problem.comm.allreduce(counts)
        if before in (0, there):
            side = "behind" if before == 0 else "in front of"
            text = f"all of the body {self.body!r} is {side} the plane, which has to cut it"
            raise InputError(text, f"{field}.point")
        once = ~(front | behind) if back else np.zeros_like(front)
        return np.concatenate([own[front], own[front], own[once]])

    def forces(self, problem: Problem) -> Floats:
        """Half of those at all nodes that this process owns, (nodes, 3), force."""
        return -0.5 * problem.internal_forces()


type Resultant = GroupResultant | SectionResultant


def check_resultants(
    resultants: Mapping[str, Resultant], problem: Problem, steps: Sequence[Step]
) -> dict[str, Ints]:
    """Nodes of resultants, by their names; collective.

    Args:
        resultants: Forces and moments that are wanted, by name.
        problem: The problem.
        steps: Its steps, which hold facet groups.

    Raises:
        InputError: One is that of no group or body of the mesh, of a plane that does not cut its
            body, or of a group that nothing holds.
    """
    found = {n: what.nodes(problem, f"output.resultant.{n}") for n, what in resultants.items()}
    held = dict.fromkeys([*problem.inclined.groups, *problem.attached.supported, *problem.coupled])
    held |= dict.fromkeys(group for step in steps for group in step.prescribed_groups())
    nodes = np.unique(np.concatenate([np.zeros(0, int), *map(problem.model.nodes, held)]))
    for name, what in resultants.items():
        touched = problem.comm.allreduce(int(np.isin(found[name], nodes).sum()))
        if isinstance(what, GroupResultant) and not touched:
            text = (
                f"no support holds a node of {what.group!r}, so that it carries nothing; groups "
                f"with supports: {', '.join(held) or 'none'}; the force of a contact is in "
                "`contacts`, one through a body that of a section"
            )
            raise InputError(text, f"output.resultant.{name}.group")
    return found


def resultant(what: Resultant, problem: Problem, nodes: Ints) -> dict[str, Any]:
    """Force and moment about the point in the accepted state; collective.

    Args:
        what: Whose.
        problem: The problem.
        nodes: Its nodes on this process.

    Returns:
        `force` and `moment`.
    """
    forces = what.forces(problem)[nodes]
    arms = _places(problem, what.body_of(problem), nodes) - np.array(what.about)
    moments = np.cross(arms, forces)
    force, moment = problem.comm.allreduce(np.stack([forces.sum(axis=0), moments.sum(axis=0)]))
    moment = moment * problem.model.idealisation.moments
    return {"force": force.tolist(), "moment": moment.tolist()}


def _places(problem: Problem, body: str, nodes: Ints) -> Floats:
    """Where the forces at nodes of a body are in balance, (nodes, 3), length."""
    places = problem.model.space.tabulate_dof_coordinates()[nodes]
    if small_strain(problem.materials[body]):
        return np.asarray(places)
    return np.asarray(places + problem.u.x.array.reshape(-1, 3)[nodes])


def _owned(problem: Problem, nodes: Any) -> Ints:
    return np.asarray(nodes[nodes < problem.model.space.dofmap.index_map.size_local])
