"""Slave nodes that several contacts with multipliers have in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from anisocontact.base.array_types import Flags, Locals
from anisocontact.contact.history import Snapshot
from anisocontact.contact.integration_points import IntegrationPoints


class AtSlavePoints(Protocol):
    """What is asked of a contact.

    Attributes:
        slave_points: Its points.
        accepted: The points in the accepted increment.
        trials: Its trials, see `Trials`, which look here in turn.
    """

    slave_points: IntegrationPoints
    accepted: Snapshot
    trials: Any

    @property
    def current(self) -> Snapshot:
        """The points in the trial."""


class SharedNodes:
    """Nodes at which the multipliers of two contacts would say more than one node can do.

    A node may be a slave of two contacts that it never meets at once, as of the plates on both
    sides of a tube: their multipliers are exact. One that was within a facet of two masters at the
    beginning of an increment, or touches two in it, is shared until the increment ends: what
    changed with every correction would let none converge.

    Args:
        contacts: Contacts with multipliers at nodes; none where a contact has its nodes alone.
    """

    def __init__(self, contacts: Sequence[AtSlavePoints]) -> None:
        self._contacts = contacts
        most = max((one.slave_points.nodes.max(initial=-1) for one in contacts), default=-1)
        self._shared = np.zeros(most + 1, dtype=bool)

    def begin(self) -> None:
        """Take it that an increment begins."""
        self._shared[:] = False

    def at(self, nodes: Locals) -> Flags:
        """Which of these nodes are shared by now, (n,)."""
        if not self._contacts:
            return np.zeros(len(nodes), dtype=bool)
        near = [one.slave_points.nodes[_near(one), 0] for one in self._contacts]
        self._shared |= np.bincount(np.concatenate(near), minlength=len(self._shared)) > 1
        return self._shared[nodes]


def _near(contact: AtSlavePoints) -> Flags:
    """Points that touch, or began the increment within a facet of the master, (n,)."""
    begun = contact.accepted.response
    near = contact.trials.master.located(begun.state) & (begun.gap < contact.slave_points.size)
    return np.asarray(near | (contact.current.response.pressure > 0.0))


def mark_shared(contacts: Sequence[AtSlavePoints]) -> None:
    """Let the multipliers of contacts know which slave nodes others have as well.

    A slave node is looked at where it is owned, by all contacts that have it.
    """
    own = [one for one in contacts if one.trials.augmented and one.slave_points.at_nodes]
    nodes = [one.slave_points.nodes[:, 0] for one in own]
    counts = np.bincount(np.concatenate([np.zeros(0, dtype=np.int64), *nodes]))
    several = [one for one, of in zip(own, nodes, strict=True) if np.any(counts[of] > 1)]
    shared = SharedNodes(several)
    for one in several:
        one.trials.shared = shared
