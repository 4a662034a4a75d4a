"""How much of the energy balance is left open, and why."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

#: Share of the work beyond which the residual is worth a warning.
LARGE = 0.05


@dataclass(frozen=True)
class Imbalance:
    """Residual of the balance of energy.

    Attributes:
        share: Residual over the work done so far, that of all increments without its sign, or over
            the energies stored and dissipated where these are larger; 0 where both are round-off
            or a body or law stores no energy.
        cause: What most of it came from; empty where there is none.
        driven: Energy that a law gave in the increment where it should have dissipated, over the
            work done so far, by name of the contact; contacts that gave none are left out.
        driven_by: The same of materials, by name of the body.
    """

    share: float
    cause: str
    driven: Mapping[str, float] = field(default_factory=dict)
    driven_by: Mapping[str, float] = field(default_factory=dict)

    @property
    def large(self) -> bool:
        """Whether it is worth a warning."""
        return self.share > LARGE

    def __str__(self) -> str:
        """A line."""
        return f"the balance of energy leaves {self.share:.0%} of the work open: {self.cause}"
