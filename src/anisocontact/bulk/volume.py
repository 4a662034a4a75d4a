"""Change of volume of a material, kept apart from its change of shape."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from anisocontact.base.fenicsx import ufl


@dataclass(frozen=True)
class Volume:
    """What a material says of its change of volume.

    Attributes:
        bulk: Bulk modulus K of the energy `K/2 e^2`, UFL, stress.
        change: Takes a displacement gradient H to e, UFL: `tr(H)`, `J - 1` or `ln J`.
    """

    bulk: Any
    change: Callable[[Any], Any]

    def stress(self, u: Any, pressure: Any = None) -> Any:
        """Stress `p de/dH`, (3, 3), UFL.

        Args:
            u: Displacement, UFL.
            pressure: p, tension positive; `K e` at every point if left out.
        """
        gradient = ufl.variable(ufl.grad(u))
        e = self.change(gradient)
        return (self.bulk * e if pressure is None else pressure) * ufl.diff(e, gradient)


def volume_ratio(gradient: Any) -> Any:
    """`J - 1` of a displacement gradient, UFL."""
    return ufl.det(ufl.Identity(3) + gradient) - 1.0


def volume_of(material: Any, u: Any) -> Volume | None:
    """The change of volume that a material keeps apart, if it does."""
    return material.volume(u) if hasattr(material, "volume") else None
