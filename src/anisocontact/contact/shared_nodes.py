"""Slave nodes that several contacts with multipliers have in common."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.contact.contact import Contact


def mark_shared(contacts: Sequence[Contact]) -> None:
    """Let the multipliers of contacts know which slave nodes others have as well.

    A slave node is looked at where it is owned, by all contacts that have it.
    """
    shared = [one for one in contacts if one.trials.augmented and one.slave_points.at_nodes]
    if len(shared) < 2:
        return
    own = [one.slave_points.nodes[:, 0] for one in shared]
    times = np.bincount(np.concatenate(own))
    for one, nodes in zip(shared, own, strict=True):
        one.trials.shared = times[nodes] > 1
