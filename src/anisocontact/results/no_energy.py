"""Energies of a run as people read them: one that does not exist is said to be none."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

#: What stands for an energy that there is not.
NO_ENERGY = "no energy"


def energies_by_name(energy: Mapping[str, Any]) -> dict[str, Any]:
    """Energies by name, where a law of adhesion may store none.

    Args:
        energy: Energies, force times length; not a number where there is none, or null as a
            checkpoint has it.

    Returns:
        The same, with the words "no energy" there.

    Example:
        >>> energies_by_name({"friction": 2.0, "adhesion": float("nan")})
        {'friction': 2.0, 'adhesion': 'no energy'}
    """
    return {name: NO_ENERGY if _none(value) else value for name, value in energy.items()}


def finite(value: Any) -> Any:
    """Nested values as JSON can have them: a number that is none becomes null.

    Args:
        value: Numbers, texts, and lists and dictionaries of them.

    Example:
        >>> finite({"gap": [0.5, float("nan")]})
        {'gap': [0.5, None]}
    """
    if isinstance(value, dict):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _none(value: Any) -> bool:
    return value is None or (isinstance(value, float) and math.isnan(value))
