"""Slave points that came on to a master, or over its border, without their slip.

The usual trials have these points slip from where they were, see `contact.beyond_border`. Those
that are tried where these have failed let them come as if from nowhere: they carry no friction in
that increment. So do points that were farther away than the master is searched.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from anisocontact.contact import Contact
from anisocontact.solver.system.problem import Problem

#: Share of the normal force of a contact, carried by such points, of which nothing is said.
SLIGHT = 0.01


@dataclass(frozen=True)
class WithoutSlip:
    """Points of a contact that came to its master and carry no friction.

    Attributes:
        count: How many they are.
        share: Of the normal force that they carry.
    """

    count: int
    share: float

    def __str__(self) -> str:
        """What is wrong with it, and what to do."""
        came = "slave point that came" if self.count == 1 else "slave points that came"
        has = "has" if self.count == 1 else "have"
        return (
            f"{self.count} {came} to the master, or over its border, in this increment {has} no "
            f"friction in it, with {self.share:.2g} of the normal force: where they were, more "
            "than twice the size of their facets away, it was not searched, or iterations with "
            "their slip did not converge; their friction begins in the next increment, so take "
            "smaller ones there"
        )


def without_slip(problem: Problem) -> dict[str, WithoutSlip]:
    """Such points of the accepted increment, by contact; collective.

    Contacts where they carry next to nothing, or that are without friction, are left out.
    """
    return dict(_found(problem))


def _found(problem: Problem) -> Iterator[tuple[str, WithoutSlip]]:
    for contact in problem.contacts:
        if _frictionless(contact):
            continue
        force = contact.areas * contact.last.pressure
        came = contact.without_slip & (force > 0.0)
        own = np.array([np.count_nonzero(came), force[came].sum(), force.sum()])
        count, part, whole = problem.comm.allreduce(own)
        if part > SLIGHT * whole:
            yield contact.name, WithoutSlip(int(count), float(part / whole))


def _frictionless(contact: Contact) -> bool:
    friction = contact.interface.tangential.friction
    return friction is not None and friction.frictionless
