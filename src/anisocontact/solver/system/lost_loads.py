"""Loads on what the same step holds: the support takes them, and the bodies do not feel them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.solver.system.layout import Layout
from anisocontact.solver.terms.free_modes import Supported
from anisocontact.solver.terms.pressure import Given
from anisocontact.solver.terms.step import Step

#: Share of the squares of a load that may act on what is not held and still counts as rounding.
NOTHING = 1e-20
#: Square of the part of a direction that those held before leave, below which it is one of them.
SAME = 1e-12


def check_lost_loads(
    layout: Layout, step: Step, given: Iterable[Given], supported: list[Supported]
) -> None:
    """Refuse loads that act on nothing but prescribed displacements.

    Args:
        layout: Where the unknowns are.
        step: The step.
        given: What it gives, other than zero.
        supported: Nodes this rank owns and the directions along which each is held.

    Raises:
        InputError: Names group, component and step.
    """
    count = layout.owned // 3
    comm = layout.comm
    for one in given:
        force = layout.assembled(one.force)[: 3 * count].reshape(-1, 3)
        rest = unsupported(force, supported)
        total, left = comm.allreduce(np.array([(force**2).sum(), (rest**2).sum()]))
        if total > 0.0 and left <= NOTHING * total:
            along = f".{one.axis}" if one.axis else ""
            moves = f"displacement of {one.axis}" if one.axis else "displacement"
            raise InputError(
                f"acts on nothing: every node of {one.name!r} has a prescribed {moves} in this "
                'step, which takes it up; free the component ("free", None in Python), or leave '
                "the load out",
                f"step {step.name!r}.{one.kind}.{one.name}{along}",
            )


def unsupported(force: Floats, supported: Iterable[Supported]) -> Floats:
    """Forces on the nodes this rank owns without what acts along held directions, (nodes, 3)."""
    onto = supported_space(len(force), supported)
    return np.asarray(force - np.einsum("nij,nj->ni", onto, force))


def supported_space(count: int, supported: Iterable[Supported]) -> Floats:
    """Projections on what is held of each node, (nodes, 3, 3): directions made orthonormal."""
    onto = np.zeros((count, 3, 3))
    for nodes, direction in supported:
        along = np.broadcast_to(direction, (len(nodes), 3))
        d = along - np.einsum("nij,nj->ni", onto[nodes], along)
        size = np.einsum("ni,ni->n", d, d)
        new = size > SAME
        unit = d[new] / np.sqrt(size[new])[:, None]
        onto[nodes[new]] += unit[:, :, None] * unit[:, None, :]
    return onto
