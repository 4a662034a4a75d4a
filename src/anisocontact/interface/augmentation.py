"""How exactly a contact is to hold what its penalties stand for."""

from __future__ import annotations

from dataclasses import dataclass

from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed

#: Ways to the multipliers: with the displacements in one Newton iteration, in cycles around it, or
#: whichever of the two suits the laws.
NEWTON, UZAWA, AUTO = "newton", "uzawa", "auto"
SCHEMES = (AUTO, NEWTON, UZAWA)


@typed
@dataclass(frozen=True)
class Augmentation:
    """Settings of multipliers (augmented Lagrangian): tolerance and how they are found.

    Args:
        tolerance: Largest penetration and elastic slip, share of the facet size, > 0.
        tangential: Whether the stiffness of adhesion is a penalty as well; not if it is physical.
        multipliers: Method for the multipliers, one of `SCHEMES`.
        required: Whether an increment fails in which no multipliers are found; if not, penalties
            hold in it, and the run says so.

    Raises:
        InputError: The tolerance is out of range, or there is no such method.

    Example:
        >>> Augmentation().tolerance
        1e-06
    """

    tolerance: float = 1e-6
    tangential: bool = True
    multipliers: str = AUTO
    required: bool = True

    def __post_init__(self) -> None:
        if not 0.0 < self.tolerance < 1.0:
            raise InputError(f"{self.tolerance!r} given, must be > 0 and < 1", "tolerance")
        if self.multipliers not in SCHEMES:
            allowed = ", ".join(f'"{name}"' for name in SCHEMES)
            raise InputError(f"{self.multipliers!r} given, allowed: {allowed}", "multipliers")
