"""What kept an increment from converging, and where."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.arrays import by_place
from anisocontact.contact import facet_size
from anisocontact.contact.held_points import facet_of
from anisocontact.interface import FAILURE, STATUS
from anisocontact.interface.failed_point import FailedPoint
from anisocontact.solver.stepping.status_watch import StatusWatch
from anisocontact.solver.system.culprit import Culprit
from anisocontact.solver.system.problem import Problem

#: How many places are named.
NAMED = 5


def find_culprits(problem: Problem, watch: StatusWatch, residual: Floats) -> list[Culprit]:
    """Places that caused a failure, of the most severe kind that there is.

    Args:
        problem: The problem as the last evaluation left it.
        watch: Status of the slave points in the last iterations.
        residual: Last residual of the unknowns this rank owns, force.

    Returns:
        Over all ranks, the same on each: points without answer of their law, else inverted cells,
        else points whose status alternates, else points whose facet alternates, else the node
        that is farthest from equilibrium.
    """
    kinds = (
        _of_laws(problem, watch),
        _inverted(problem),
        _chattering(problem, watch),
        _alternating_facets(problem, watch),
    )
    for kind in kinds:
        found = _everywhere(problem, list(kind))
        if found:
            return [found[k] for k in by_place([one.position for one in found])]
    worst = _everywhere(problem, list(_worst(problem, residual)))
    return [max(worst, key=lambda one: one[0])[1]] if worst else []


def _everywhere[T](problem: Problem, local: list[T]) -> list[T]:
    return [one for part in problem.comm.allgather(local) for one in part]


def failed_point(problem: Problem) -> FailedPoint | None:
    """A slave point whose laws failed in the last evaluation, whole; collective.

    Returns:
        The first point by its place of the first contact that has one, on its rank; None on the
        others.
    """
    found, rank = None, -1
    for contact in problem.contacts:
        point = contact.failed_point()
        here = None if point is None else contact.current.points[point.point].tolist()
        mine = None if here is None else (problem.comm.rank, *here)
        known = [one for one in problem.comm.allgather(mine) if one is not None]
        if known and rank < 0:
            rank = known[by_place([place for _, *place in known])[0]][0]
            found = point if rank == problem.comm.rank else None
    return found


def _of_laws(problem: Problem, watch: StatusWatch) -> Iterator[Culprit]:
    for i, contact in enumerate(problem.contacts):
        failure = contact.trial.failure
        for point in np.flatnonzero(failure):
            yield _slave_point(problem, watch, i, int(point), "law", FAILURE[failure[point]])


def _chattering(problem: Problem, watch: StatusWatch) -> Iterator[Culprit]:
    for i, flags in enumerate(watch.chattering()):
        for point in np.flatnonzero(flags):
            seen = watch.history(i)[:, point]
            names = " and ".join(STATUS[code] for code in np.unique(seen))
            why = f"the status alternates between {names}"
            found = _slave_point(problem, watch, i, int(point), "chattering", why)
            if watch.on_border(i)[point]:
                why = f"{why}, over the border of the master and back"
                found = replace(found, why=why, border=True)
            yield found


def _alternating_facets(problem: Problem, watch: StatusWatch) -> Iterator[Culprit]:
    for i, flags in enumerate(watch.alternating_facets()):
        for point in np.flatnonzero(flags):
            facets = np.unique(facet_of(watch.feet(i)[:, point]))
            names = " and ".join(str(facet) for facet in facets)
            why = f"the closest point alternates between the facets {names} of the master"
            if len(facets) == 1:
                why = (
                    f"the closest point alternates between facet {names} of the master and its edge"
                )
            yield _slave_point(problem, watch, i, int(point), "alternating facets", why)


def strayed(problem: Problem, far: float) -> list[Culprit]:
    """Points that are held on a facet while another one is below them, over all ranks.

    Args:
        problem: The problem as the last evaluation left it.
        far: Error of the gap, over the size of a slave facet, beyond which they count.
    """
    watch = StatusWatch(problem.contacts)
    found: list[Culprit] = []
    every = [contact.strayed() for contact in problem.contacts]
    if not any(_everywhere(problem, [bool(wrong.any()) for wrong in every])):
        return found
    for i, (contact, wrong) in enumerate(zip(problem.contacts, every, strict=True)):
        size = facet_size(problem.model, contact.slave)
        for point in np.flatnonzero(wrong > far * size):
            share = f"{wrong[point] / size:.1g} of the facet size"
            why = f"fixed to a facet beyond its edge: the error of the gap is {share}"
            found.append(_slave_point(problem, watch, i, int(point), "alternating facets", why))
    return _everywhere(problem, found)


def _slave_point(
    problem: Problem, watch: StatusWatch, contact: int, point: int, kind: str, why: str
) -> Culprit:
    found = problem.contacts[contact]
    return Culprit(
        kind=kind,
        position=_place(found.current.points[point]),
        why=why,
        contact=found.name,
        point=point,
        facet=int(found.facet_of_point[point]),
        statuses=tuple(STATUS[code] for code in watch.history(contact)[:, point]),
    )


def inverted_cells(problem: Problem) -> list[Culprit]:
    """Inverted cells of the last evaluation, over all ranks."""
    return _everywhere(problem, list(_inverted(problem)))


def _inverted(problem: Problem) -> Iterator[Culprit]:
    for middle in problem.inverted_cells():
        yield Culprit("inverted", _place(middle), "the cell here is inverted (det F <= 0)")


def folded_by_deformation(
    problem: Problem,
) -> dict[str, tuple[int, tuple[float, float, float]]]:
    """Cells folded over at a corner, over all ranks: how many, and where the first is, by body."""
    found: dict[str, list[Floats]] = {}
    for some in problem.comm.allgather(problem.folded_cells()):
        for name, middles in some.items():
            found.setdefault(name, []).extend(middles)
    return {name: (len(middles), _place(middles[0])) for name, middles in found.items()}


def _worst(problem: Problem, residual: Floats) -> Iterator[tuple[float, Culprit]]:
    """The node of this rank with the largest residual, and how large it is."""
    x = problem.model.space.tabulate_dof_coordinates()
    with np.errstate(over="ignore"):
        nodal = np.linalg.norm(residual[: 3 * (len(residual) // 3)].reshape(-1, 3), axis=1)
    nodal = nodal[: problem.model.space.dofmap.index_map.size_local]
    if nodal.size and np.isfinite(nodal).any():
        node = int(np.nanargmax(nodal))
        now = x[node] + problem.u.x.array.reshape(-1, 3)[node]
        why = f"the largest residual, {nodal[node]:.3g}, is that of the node here"
        yield float(nodal[node]), Culprit("residual", _place(now), why)


def _place(x: Floats) -> tuple[float, float, float]:
    return float(x[0]), float(x[1]), float(x[2])
