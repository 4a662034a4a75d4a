"""Slave nodes that several contacts with multipliers have in common."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.contact.contact import Contact


def tell_shared(contacts: Sequence[Contact]) -> None:
    """Let the multipliers of contacts know which slave nodes others have as well.

    A slave node is looked at where it is owned, by all contacts that have it.

    Args:
        contacts: The contacts.
    """
    passes = [half for one in contacts for half in one.passes]
    halves = [half for half in passes if half.trials.augmented and half.slave_points.at_nodes]
    if len(halves) < 2:
        return
    own = [half.slave_points.nodes[:, 0] for half in halves]
    times = np.bincount(np.concatenate(own))
    for half, nodes in zip(halves, own, strict=True):
        half.trials.take_shared(times[nodes] > 1)
