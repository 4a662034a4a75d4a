"""What the laws of an interface answer at slave points that meet facets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact._core import FacetPairs
from anisocontact.contact.record import Snapshot
from anisocontact.contact.sides import Sides, located
from anisocontact.facets import FACET_STATUS, FacetProjections
from anisocontact.interface import Response, State, as_state, raw_state

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


def ask(sides: Sides, law: FacetPairs, q: Question) -> tuple[dict[str, Any], Snapshot]:
    """Answer of the kernel, with forces and blocks, and the points as they are then."""
    slave, master, hit = sides.points, sides.master, q.hit
    touches = hit.gap - q.state["offset"] <= NEAR * slave.size  # as far as rounding goes
    answer = (law.update if q.by_points else law.assemble)(
        raw_state(q.state),
        q.dt,
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
    lost = hit.status == FACET_STATUS.index("failed")
    response = Response(
        traction=answer["traction"],
        tangent=np.empty((0, 3, 3)),
        state=as_state(answer["state"]),
        normal=answer["normal"],
        directions_adhesion=answer["adhesion_axes"],
        directions_friction=answer["friction_axes"],
        failure=np.where(lost, np.int8(1), answer["failure"]),
    )
    return answer, Snapshot(slave.positions(q.now), answer["area"], response)
