"""Materials by name."""

from __future__ import annotations

from collections.abc import Callable

from anisocontact import registry
from anisocontact.bulk.hyperelastic import (
    NeoHookean,
    NeoHookeanIncompressible,
    StVenantKirchhoff,
)
from anisocontact.bulk.materials import LinearElastic, Material
from anisocontact.registry import Entry

_MATERIALS: dict[str, Callable[..., Material]] = {
    material.entry.name: material
    for material in (LinearElastic, StVenantKirchhoff, NeoHookean, NeoHookeanIncompressible)
}


def materials() -> tuple[Entry, ...]:
    """The registered materials with their parameters.

    Returns:
        An entry for each.

    Example:
        >>> [entry.name for entry in materials()][0]
        'linear-elastic'
    """
    return tuple(m.entry for m in _MATERIALS.values())  # type: ignore[attr-defined]


def make_material(model: str, *, field: str = "", **parameters: float) -> Material:
    """Material by name.

    Args:
        model: Name of a registered material.
        field: Where the material was written, for messages.
        **parameters: Its parameters.

    Returns:
        The material.

    Raises:
        InputError: Unknown name or parameter, a parameter missing or out of range.

    Example:
        >>> make_material("linear-elastic", E=210e3, nu=0.3).young
        210000.0
    """
    entry = registry.entry(materials(), model, f"{field}.model" if field else "model")
    registry.values(entry, parameters, field)
    return _MATERIALS[model](**parameters, field=field)
