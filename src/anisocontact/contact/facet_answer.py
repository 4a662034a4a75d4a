"""What the laws of an interface answer at slave points that meet facets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.contact.record import Snapshot
from anisocontact.contact.sides import Sides, located
from anisocontact.interface import Response, State
from anisocontact.interface.contact_law import FacetLaw
from anisocontact.surfaces.facets import FACET_STATUS, FacetProjections

#: Code of the kernel for a point without a facet below it.
OFF = 3
#: Gap up to which a point may be in contact, as a share of the size of the facets: rounding.
NEAR = 1e-6

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Question:
    """What laws are asked.

    Attributes:
        state: History of the points.
        hit: Where they are on the master.
        now: Positions of the nodes, (nodes, 3), length.
        dt: Time increment.
        tangent: Whether derivatives are wanted.
        by_points: Whether every point is to have a block, or those of one pair of facets share one.
    """

    state: State
    hit: FacetProjections
    now: Floats
    dt: float
    tangent: bool
    by_points: bool


def ask(sides: Sides, law: FacetLaw, q: Question) -> tuple[dict[str, Any], Snapshot]:
    """What a law answers, with forces and blocks, and the points as they are then."""
    slave, master, hit = sides.points, sides.master, q.hit
    touches = hit.gap - q.state["offset"] <= NEAR * slave.size  # as far as rounding goes
    batch = (
        slave.nodes,
        slave.shape,
        slave.gradient,
        slave.weight,
        slave.current_area,
        q.now,
        sides.reference,
        master.nodes,
        sides.kinds,
        master.flip,
        np.maximum(hit.facet, 0),
        np.nan_to_num(hit.xi),
        np.where(located(hit), hit.feature, np.int8(OFF)),
        hit.edge,
        touches | (q.state["multiplier"] > 0.0),
        q.tangent,
        sides.threads,
    )
    answer = _answer(sides.comm, law, q, batch)
    lost = hit.status == FACET_STATUS.index("failed")
    response = Response(
        traction=answer["traction"],
        tangent=np.empty((0, 3, 3)),
        state=answer["state"],
        normal=answer["normal"],
        directions_adhesion=answer["adhesion_axes"],
        directions_friction=answer["friction_axes"],
        failure=np.where(lost, np.int8(1), answer["failure"]),
    )
    return answer, Snapshot(slave.positions(q.now), answer["area"], response)


def _answer(comm: Any, law: FacetLaw, q: Question, batch: tuple[Any, ...]) -> dict[str, Any]:
    def evaluate() -> dict[str, Any]:
        return law.evaluate(q.state, q.by_points, q.dt, *batch)

    return _on_all(comm, evaluate) if law.in_python else evaluate()


def _on_all[T](comm: Any, ask: Callable[[], T]) -> T:
    """What is asked on every rank; a mistake of one is raised on all, which would wait for it."""
    answer: T | None = None
    said: tuple[str, str] | None = None
    try:
        answer = ask()
    except InputError as mistake:
        said = str(mistake), mistake.field
    first = next((one for one in comm.allgather(said) if one is not None), None)
    if first is not None:
        raise InputError(*first)
    assert answer is not None
    return answer
