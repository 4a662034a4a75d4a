"""Schemes by which a contact finds its multipliers: by name, and the one in use."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from anisocontact.contact.augmentable_laws import (
    AugmentedLaw,
    augmentable,
    check,
    simultaneous,
)
from anisocontact.contact.compliant import Compliant
from anisocontact.contact.multipliers import Multipliers
from anisocontact.contact.nested_uzawa import Graded, GradedSlender, NestedUzawa
from anisocontact.contact.semismooth import Semismooth, Singly, Slender, Softer
from anisocontact.contact.uzawa import Penalties, Uzawa
from anisocontact.interface.augmentation import AUTO, NEWTON, UZAWA, Augmentation

#: Schemes of an increment, the usual one and what is tried where that fails: with smaller
#: penalties, with those of slender bodies, in cycles, in such that begin with soft penalties, of
#: slender bodies too, with points that close one at a time, and with penalties alone where
#: multipliers are not required. Penalties are come to by multipliers with their compliance.
USUAL, SOFTER, IN_CYCLES, GRADED = "usual", "softer", "in cycles", "graded"
SLENDER, GRADED_SLENDER, SINGLY = "slender", "graded slender", "singly"
PENALTIES, COMPLIANT = "penalties", "compliant"

#: Their classes, by `Augmentation.multipliers`.
SCHEMES: Mapping[str, Mapping[str, type[Multipliers]]] = {
    NEWTON: {
        USUAL: Semismooth,
        SOFTER: Softer,
        SLENDER: Slender,
        SINGLY: Singly,
        IN_CYCLES: NestedUzawa,
        GRADED: Graded,
        GRADED_SLENDER: GradedSlender,
    },
    UZAWA: {USUAL: Uzawa},
}


def make_multipliers(
    augmentation: Augmentation, law: AugmentedLaw, size: float, comm: Any
) -> dict[str, Multipliers]:
    """Multipliers for a law, by the schemes of an increment.

    Args:
        augmentation: What is asked for.
        law: The law.
        size: Facet size, length.
        comm: Communicator of the mesh.

    Raises:
        InputError: A part to be augmented is physical, see `check`.
    """
    check(augmentation, law)
    name = augmentation.multipliers
    if name == AUTO:
        name = NEWTON if simultaneous(augmentation, law) else UZAWA
    kinds = dict(SCHEMES[name])
    if not augmentation.required:
        kinds[PENALTIES] = Penalties
    penalties = law.penalties()
    return {scheme: kind(augmentation, size, penalties, comm) for scheme, kind in kinds.items()}


class MultiplierSchemes:
    """The schemes of one contact, and the one in use: none at first.

    Args:
        law: Laws, as the user gave them.
        comm: Communicator of the mesh.

    Attributes:
        taken: Multipliers that are found now, if there are any.
    """

    def __init__(self, law: AugmentedLaw, comm: Any) -> None:
        self._law, self._comm = law, comm
        self._schemes: Mapping[str, Multipliers] = {}
        self.taken: Multipliers | None = None

    def augment(self, augmentation: Augmentation, size: float) -> None:
        """Let multipliers make the laws exact.

        Args:
            augmentation: How exactly the contact is to hold.
            size: Facet size, length.

        Raises:
            InputError: As of `make_multipliers`.
        """
        self._schemes = make_multipliers(augmentation, self._law, size, self._comm)
        self.taken = self._schemes[USUAL]

    def suit(self, stiffness: float) -> None:
        """Bring penalties to the stiffness of the bodies, stress/length."""
        for scheme in self._schemes.values():
            scheme.suit(stiffness)

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
        """Names of the schemes, such as `USUAL`; none without augmentation."""
        return tuple(self._schemes)

    def take(self, name: str) -> None:
        """Take another scheme until the increment ends."""
        self.taken = self._schemes[name]

    def end(self, accepted: bool) -> None:
        """Take it that an increment is accepted or given up: the next one is found as usual."""
        if accepted and self.taken is not None:
            self.taken.commit()
        self.taken = self._schemes.get(USUAL)

    @property
    def first(self) -> bool:
        """Whether the scheme is none that is tried where the usual one has failed."""
        others = [one for name, one in self._schemes.items() if name != USUAL]
        return all(self.taken is not one for one in others)

    @property
    def penalised(self) -> bool:
        """Whether penalties alone hold where multipliers could follow."""
        return self.taken is None and augmentable(self._law)

    def comply(self, stiffness: float, size: float) -> None:
        """Take the scheme that leads to penalties, see `Compliant`.

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
