"""Multipliers of contacts that follow every Newton step, as a system of equations sees them."""

from __future__ import annotations

from collections.abc import Sequence

from anisocontact.contact import AnyContact


class Following:
    """What every `System` with contacts answers about multipliers that follow.

    Attributes:
        contacts: The contacts.
        norm_as_they_are: Norm of the residual of the last evaluation with the multipliers as they
            are, force; asked for only where some follow.
    """

    contacts: Sequence[AnyContact]
    norm_as_they_are: float = 0.0

    @property
    def follows(self) -> bool:
        """Whether multipliers follow every correction."""
        return any(contact.follows for contact in self.contacts)

    def unbalanced(self, norm: float) -> float:
        """Norm of the residual with the multipliers as they are, see `System`."""
        return self.norm_as_they_are if self.follows else norm

    def held(self) -> bool:
        """Whether multipliers that follow are what the last evaluation answers to them."""
        return all([contact.held() for contact in self.contacts])

    def take_share(self, share: float) -> None:
        """Let multipliers take only a share of the next correction."""
        for contact in self.contacts:
            contact.take_share(share)

    @property
    def ways(self) -> frozenset[str]:
        """Ways to the multipliers that a contact has, see `ContactRecord.ways`."""
        return frozenset(way for contact in self.contacts for way in contact.ways)

    def take_way(self, name: str) -> None:
        """Find multipliers in another way in this attempt, see `ContactRecord.take_way`."""
        for contact in self.contacts:
            contact.take_way(name)
