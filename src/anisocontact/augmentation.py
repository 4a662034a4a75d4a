"""How exactly a contact is to hold what its penalties stand for."""

from __future__ import annotations

from dataclasses import dataclass

from anisocontact.errors import InputError

__all__ = ["Augmentation"]


@dataclass(frozen=True)
class Augmentation:
    """How exactly a contact is to hold.

    Args:
        tolerance: Largest penetration and elastic slip, share of the facet size, > 0.
        tangential: Whether the stiffness of adhesion is a penalty as well; not if it is physical.

    Raises:
        InputError: The tolerance is out of range.

    Example:
        >>> Augmentation().tolerance
        1e-06
    """

    tolerance: float = 1e-6
    tangential: bool = True

    def __post_init__(self) -> None:
        if not 0.0 < self.tolerance < 1.0:
            raise InputError(f"{self.tolerance!r} given, must be > 0 and < 1", "tolerance")
