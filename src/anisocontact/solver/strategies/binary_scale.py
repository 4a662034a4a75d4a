"""Powers of two that bring numbers in any units to about one: they round nothing."""

from __future__ import annotations

import math


def binary_scale(size: float) -> float:
    """Power of two with which a number is about one.

    Args:
        size: The number, not negative.

    Returns:
        The factor that brings it to between 0.5 and 1; 1 where there is nothing to bring there.

    Example:
        >>> binary_scale(3e-20) * 3e-20, binary_scale(6.0), binary_scale(0.0)
        (0.55..., 0.125, 1.0)
    """
    return math.ldexp(1.0, -math.frexp(size)[1]) if math.isfinite(size) else 1.0
