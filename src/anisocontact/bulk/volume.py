"""Change of volume of a material, kept apart from its change of shape."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from anisocontact.base.fenicsx import ufl


@dataclass(frozen=True)
class Volume:
    """Volumetric part of a material: its bulk modulus and measure of the change of volume.

    Attributes:
        bulk: Bulk modulus K of the energy `K/2 e^2`, UFL, stress.
        change: Takes a displacement gradient H to e, UFL: `tr(H)`, `J - 1` or `ln J`.

    Example:
        Small strain, whose change of volume is the trace of the gradient:

        >>> small = Volume(175e3, ufl.tr)
        >>> small.change(0.01 * ufl.Identity(3)).ufl_shape
        ()
    """

    bulk: Any
    change: Callable[[Any], Any]

    def stress(self, u: Any, pressure: Any = None) -> Any:
        """Stress `p de/dH`.

        Args:
            u: Displacement, UFL.
            pressure: p, tension positive; `K e` at every point if left out.

        Returns:
            First Piola-Kirchhoff stress of the change of volume, (3, 3), UFL, stress.
        """
        gradient = ufl.grad(u)
        tension = self.bulk * self.change(gradient) if pressure is None else pressure
        return tension * derivative_at(self.change, gradient)


def derivative_at(function: Callable[[Any], Any], gradient: Any) -> Any:
    """Derivative of a number by a tensor, UFL.

    It is taken here, and has no variable, see `without_variables`.

    Args:
        function: Takes the tensor to the number.
        gradient: The tensor, UFL.

    Example:
        >>> derivative_at(lambda b: ufl.inner(b, b), ufl.Identity(3)).ufl_shape
        (3, 3)
    """
    variable = ufl.variable(gradient)
    return without_variables(ufl.diff(function(variable), variable))


def without_variables(expression: Any) -> Any:
    """An expression of UFL without its variables, whose derivatives by them are taken.

    UFL numbers variables, and these numbers are in the name under which a compiled form is kept: it
    would be compiled anew in every run.

    Args:
        expression: The expression, UFL.

    Example:
        >>> without_variables(ufl.variable(ufl.Identity(3))).ufl_shape
        (3, 3)
    """
    ways: Any = ufl.algorithms
    found = ways.apply_algebra_lowering.apply_algebra_lowering(expression)
    return ways.strip_variables(ways.apply_derivatives.apply_derivatives(found))


def volume_ratio(gradient: Any) -> Any:
    """`J - 1` of a displacement gradient, UFL."""
    return ufl.det(ufl.Identity(3) + gradient) - 1.0


def volume_of(material: Any, u: Any) -> Volume | None:
    """The change of volume that a material keeps apart, if it does."""
    return material.volume(u) if hasattr(material, "volume") else None
