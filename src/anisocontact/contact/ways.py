"""The ways of one contact to its multipliers, and the one that is taken."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from anisocontact.contact.compliant import Compliant
from anisocontact.contact.multipliers import AugmentedLaw, Multipliers, augmentable
from anisocontact.contact.schemes import USUAL, make_multipliers
from anisocontact.interface.augmentation import Augmentation


class Ways:
    """Ways to multipliers that were asked for, or one to stiff penalties: none at first.

    Args:
        law: Laws, as the user gave them.
        comm: Communicator of the mesh.

    Attributes:
        taken: Multipliers that are found now, if there are any.
    """

    def __init__(self, law: AugmentedLaw, comm: Any) -> None:
        self._law, self._comm = law, comm
        self._usual: Mapping[str, Multipliers] = {}
        self.taken: Multipliers | None = None

    def augment(self, augmentation: Augmentation, size: float) -> None:
        """Let multipliers make the laws exact.

        Args:
            augmentation: How exactly the contact is to hold.
            size: Facet size, length.

        Raises:
            InputError: As of `make_multipliers`.
        """
        self._usual = make_multipliers(augmentation, self._law, size, self._comm)
        self.taken = self._usual[USUAL]

    def suit(self, stiffness: float) -> None:
        """Bring penalties to the stiffness of the bodies, stress/length."""
        for way in self._usual.values():
            way.suit(stiffness)

    @property
    def level(self) -> float:
        """What the penalties of multipliers are multiplied with."""
        return 1.0 if self.taken is None else self.taken.level

    @level.setter
    def level(self, level: float) -> None:
        if self.taken is not None:
            self.taken.level = level

    @property
    def names(self) -> tuple[str, ...]:
        """Ways in an increment, see `schemes`; none without augmentation."""
        return tuple(self._usual)

    def take(self, name: str) -> None:
        """Take another way until the increment ends."""
        self.taken = self._usual[name]

    def end(self, accepted: bool) -> None:
        """Take it that an increment is accepted or given up: the next one is found as usual."""
        if accepted and self.taken is not None:
            self.taken.commit()
        self.taken = self._usual.get(USUAL)

    @property
    def penalised(self) -> bool:
        """Whether penalties alone hold where multipliers could follow."""
        return self.taken is None and augmentable(self._law)

    def comply(self, stiffness: float, size: float) -> None:
        """Take the way to penalties, see `Compliant`.

        Args:
            stiffness: Of the bodies, stress/length.
            size: Facet size, length.
        """
        self.taken = Compliant(Augmentation(), size, self._law.penalties(), self._comm)
        self.taken.suit(stiffness)

    @property
    def exact(self) -> bool:
        """Whether multipliers, if there are any, stand for no compliance."""
        return self.taken is None or self.taken.exact
