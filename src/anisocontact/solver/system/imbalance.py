"""How much of the energy balance is left open, and why."""

from __future__ import annotations

from dataclasses import dataclass

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
    """

    share: float
    cause: str

    @property
    def large(self) -> bool:
        """Whether it is worth a warning."""
        return self.share > LARGE

    def __str__(self) -> str:
        """A line."""
        return f"the balance of energy leaves {self.share:.0%} of the work open: {self.cause}"
