"""What to look at in contacts before they are used: a line each."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

from anisocontact.base.errors import ModelWarning
from anisocontact.contact.contact import Contact

__all__ = ["COARSE", "coarse_slaves", "warn_of"]

#: Size of the facets of the slave over those of the master beyond which points between which
#: something of the master fits are worth a word; where nothing touches, already at MISSED.
COARSE, MISSED = 3.0, 1.5


def coarse_slaves(contacts: Sequence[Contact], ratio: float = COARSE) -> list[str]:
    """Contacts whose slave has much larger facets than the master.

    A single pass looks from points of the slave: what of the master lies between two of them is
    not met. Two half passes and self-contact look from both sides.

    Args:
        contacts: The contacts.
        ratio: Size of the facets of the slave over those of the master that is worth a word.

    Returns:
        A line for each of them.
    """
    found = []
    for contact in contacts:
        if not contact.of_two_groups or len(contact.passes) > 1:
            continue
        slave, master = contact.facet_size, contact.master_size
        if slave > ratio * master:
            found.append(
                f"contact of {contact.slave} with {contact.master}: the facets of the slave are "
                f"{slave / master:.2g} times as large as those of the master ({slave:.3g} and "
                f"{master:.3g}), and what lies between its points is not met; swap slave and "
                'master, or take two half passes (pass = "two-half", Contact(..., two_half=True))'
            )
    return found


def warn_of(contacts: Sequence[Contact]) -> None:
    """Tell a script: a Python warning of the category `ModelWarning` for each line."""
    for line in coarse_slaves(contacts):
        warnings.warn(line, ModelWarning, stacklevel=3)
