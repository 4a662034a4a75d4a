"""Bodies that go through their own planes of symmetry, where nothing but a contact stops them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.fenicsx import MPI
from anisocontact.solver.system.problem import Problem

#: Share of a facet of the plane by which a body may be beyond it.
BEYOND = 0.05
#: What is said of it.
CROSSED = (
    "has gone through its plane of symmetry {group!r} by up to {depth:.3g}, where its mirror image "
    "comes towards it: forces are wrong from there on; let the faces that get there be slaves of a "
    "rigid plane in it, or take the whole body with self_contact = true"
)


@dataclass(frozen=True)
class _Plane:
    """A plane of symmetry, with all of its body on one side of it at first.

    Attributes:
        group: Facet group in it.
        normal: Out of the body, (3,).
        nodes: Nodes of the body on this rank.
        touchable: Which of them contacts act on.
        heights: Where they are along the normal before, (nodes,), negative within, length.
        allowed: How far one may be beyond the plane, length.
    """

    group: str
    normal: Floats
    nodes: Ints
    touchable: Flags
    heights: Floats
    allowed: float


class SymmetryWatch:
    """Says which bodies have gone through their planes of symmetry, and how far.

    A plane of symmetry holds the nodes in it and no others. Bodies of which a part is beyond their
    plane from the start have no mirror image there: the plane is a support, and not looked at.

    Args:
        problem: The problem at the start of the run.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        inclined = problem.inclined
        planes = zip(inclined.groups, inclined.of_planes(), strict=True)
        found = [self._plane(group, *plane) for group, plane in planes]
        self._planes = [plane for plane in found if plane is not None]

    def crossed(self) -> dict[str, float]:
        """How far bodies are beyond their planes, by facet group, length; collective."""
        problem = self._problem
        found: dict[str, float] = {}
        if not self._planes:
            return found
        # nothing is evaluated: a run that goes on from here has to find it as it is
        whole = problem.reduction.whole
        u = problem.nodal if whole else problem.reduction.nodal(problem.accepted())
        for plane in self._planes:
            beyond = plane.heights + u[plane.nodes] @ plane.normal
            depth = self._most(beyond if whole else beyond[plane.touchable])
            if depth > plane.allowed:
                found[plane.group] = depth
        return found

    def _plane(self, group: str, on: Ints, normal: Floats) -> _Plane | None:
        """None where the body lies on both sides of it; collective."""
        problem = self._problem
        model, comm = problem.model, problem.comm
        places = model.positions
        height = self._most(places[on] @ normal)
        name = model.body_of(group)
        nodes = np.unique(model.space.dofmap.list[model.cells(name)]).astype(np.int64)
        facets = model.facets(group)
        sizes = model.mesh.h(model.idealisation.dim - 1, facets)
        total, count = comm.allreduce(np.array([sizes.sum(), len(sizes)]))
        allowed = BEYOND * float(total / count)
        heights = places[nodes] @ normal - height
        if self._most(heights) > allowed:
            return None
        touchable = np.zeros(len(nodes), dtype=bool)
        for contact in problem.contacts:
            for touched in contact.nodes_of_groups:
                touchable |= np.isin(nodes, touched)
        return _Plane(group, normal, nodes, touchable, heights, allowed)

    def _most(self, values: Floats) -> float:
        """The largest of all ranks; minus infinity if there are none."""
        return float(self._problem.comm.allreduce(float(values.max(initial=-np.inf)), MPI.MAX))
