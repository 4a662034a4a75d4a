"""Slave nodes that several contacts with multipliers have in common."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.fenicsx import dolfinx
from anisocontact.contact.contact import Contact


def tell_shared(contacts: Sequence[Contact]) -> None:
    """Let the multipliers of contacts know which slave nodes others have as well; collective.

    Args:
        contacts: The contacts, the same ones on all ranks.
    """
    passes = [half for one in contacts for half in one.passes]
    halves = [half for half in passes if half.trials.augmented and half.slave_points.at_nodes]
    if len(halves) < 2:
        return
    mark = dolfinx.la.vector(halves[0].space.dofmap.index_map)
    times = np.zeros(len(mark.array), dtype=int)
    own = [half.slave_points.nodes[:, 0] % max(len(times), 1) for half in halves]
    for nodes in own:
        mark.array[:] = 0.0
        mark.array[nodes] = 1.0
        mark.scatter_reverse(dolfinx.la.InsertMode.add)
        mark.scatter_forward()
        times += mark.array > 0.0
    for half, nodes in zip(halves, own, strict=True):
        half.trials.take_shared(times[nodes] > 1)
