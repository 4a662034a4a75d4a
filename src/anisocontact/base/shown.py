"""A point or a direction as a message has it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

#: Share of the size of what is shown below which a component is round-off.
ROUNDED = 1e-9


def shown(x: npt.ArrayLike, digits: int = 4, size: float = 0.0) -> str:
    """Components in parentheses, those that are nothing but round-off as zero.

    Args:
        x: The components, (n,).
        digits: Digits of each.
        size: Size of what the point belongs to, length; that of the largest component counts too.

    Returns:
        The text.

    Example:
        >>> shown([1.0, -2e-17, 0.333333])
        '(1, 0, 0.3333)'
        >>> shown([-9e-17, 1e-16, 0.0], size=20.0)
        '(0, 0, 0)'
    """
    values = np.asarray(x, dtype=float)
    least = ROUNDED * max(size, float(np.abs(values).max(initial=0.0)))
    return "(" + ", ".join(f"{v if abs(v) > least else 0.0:.{digits}g}" for v in values) + ")"
