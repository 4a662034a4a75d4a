"""Materials by name."""

from __future__ import annotations

from typing import Any

from anisocontact.base.kinds import Kinds
from anisocontact.base.registry import Entry
from anisocontact.base.typed import typed
from anisocontact.bulk.hyperelastic import (
    NeoHookean,
    NeoHookeanIncompressible,
    StVenantKirchhoff,
)
from anisocontact.bulk.materials import LinearElastic, LinearElasticIncompressible, Material
from anisocontact.bulk.ogden import Ogden
from anisocontact.bulk.orthotropic import Orthotropic, TransverselyIsotropic
from anisocontact.bulk.plasticity import Hill, Plastic
from anisocontact.bulk.rubber import MooneyRivlin, Yeoh
from anisocontact.bulk.viscoelastic import Viscoelastic

_MATERIALS = Kinds(
    "material",
    "model",
    (
        LinearElastic,
        LinearElasticIncompressible,
        Orthotropic,
        TransverselyIsotropic,
        StVenantKirchhoff,
        NeoHookean,
        NeoHookeanIncompressible,
        MooneyRivlin,
        Yeoh,
        Ogden,
        Viscoelastic,
        Plastic,
        Hill,
    ),
)


def register_material[T: type[Any]](model: T) -> T:
    """Register a material by its name, for Python and case files that are read afterwards.

    Args:
        model: Class with an `entry`, whose parameters its constructor takes by name.

    Returns:
        The class, so that this serves as a decorator.

    Raises:
        InputError: There is a material of that name, or it is no class with an `entry`.

    Example:
        >>> register_material(LinearElastic)
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: material: 'linear-elastic' is registered already
    """
    _MATERIALS.add(model)
    return model


def materials() -> tuple[Entry, ...]:
    """The registered materials with their parameters.

    Returns:
        An entry for each.

    Example:
        >>> [entry.name for entry in materials()][0]
        'linear-elastic'
    """
    return _MATERIALS.entries()


@typed
def make_material(model: str, *, field: str = "", **parameters: Any) -> Material:
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
    found: Material = _MATERIALS.make(model, field, parameters)
    return found
