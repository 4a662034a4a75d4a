"""What there is to choose from: surfaces, direction fields, laws and rules with their parameters.

Everything here comes from the descriptions that the C++ core registers; the case schema, the
command `anisocontact info` and the conformance tests are made from the same entries.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from anisocontact import _core
from anisocontact.base.errors import InputError
from anisocontact.base.parameters import (
    FULL_TURN,
    Entry,
    Parameter,
    Value,
    arguments,
    check,
    check_radian,
    in_radian,
    values,
)
from anisocontact.base.words import meant

__all__ = [
    "FULL_TURN",
    "Entry",
    "Parameter",
    "Value",
    "adhesion_models",
    "arguments",
    "check",
    "check_radian",
    "direction_fields",
    "entry",
    "evolution_forms",
    "friction_models",
    "in_radian",
    "normal_laws",
    "sliding_rules",
    "surfaces",
    "values",
]


def _entries(kind: str, describe: Callable[[], list[_core.Descriptor]]) -> tuple[Entry, ...]:
    return tuple(
        Entry(
            d.name,
            kind,
            d.doc,
            tuple(
                Parameter(
                    p.name,
                    p.kind,
                    p.unit,
                    p.doc,
                    p.bound,
                    p.required,
                    tuple(p.fallback),
                    tuple(p.choices),
                    isotropic=tuple(p.isotropic),
                )
                for p in d.parameters
            ),
            d.directions,
        )
        for d in describe()
    )


def surfaces() -> tuple[Entry, ...]:
    """Analytic surfaces.

    Returns:
        An entry for each, in the order of registration.

    Example:
        >>> [entry.name for entry in surfaces()][:3]
        ['plane', 'cylinder', 'sphere']
    """
    return _entries("surface", _core.surfaces)


def direction_fields() -> tuple[Entry, ...]:
    """Fields of directions on a surface.

    Returns:
        An entry for each.

    Example:
        >>> "polar" in [entry.name for entry in direction_fields()]
        True
    """
    return _entries("direction field", _core.direction_fields)


def normal_laws() -> tuple[Entry, ...]:
    """Laws of the pressure.

    Returns:
        An entry for each.

    Example:
        >>> "penalty" in [entry.name for entry in normal_laws()]
        True
    """
    return _entries("normal law", _core.normal_laws)


def adhesion_models() -> tuple[Entry, ...]:
    """Laws of the tangential force inside the yield ellipse.

    Returns:
        An entry for each.

    Example:
        >>> "maxwell" in [entry.name for entry in adhesion_models()]
        True
    """
    return _entries("adhesion model", _core.adhesion_models)


def friction_models() -> tuple[Entry, ...]:
    """Friction tensors, which make the yield ellipse.

    Returns:
        An entry for each.

    Example:
        >>> "he-curnier" in [entry.name for entry in friction_models()]
        True
    """
    return _entries("friction model", _core.friction_models)


def sliding_rules() -> tuple[Entry, ...]:
    """Rules of the force in slip.

    Returns:
        An entry for each.

    Example:
        >>> [entry.name for entry in sliding_rules()][0]
        'maximum-dissipation'
    """
    return _entries("sliding rule", _core.sliding_rules)


def evolution_forms() -> tuple[Entry, ...]:
    """Discrete forms of the evolution of the tangential force along the path.

    Returns:
        An entry for each.

    Example:
        >>> [entry.name for entry in evolution_forms()]
        ['transport', 'backward-euler', 'covariant', 'incremental', 'total']
    """
    return _entries("evolution form", _core.evolution_forms)


def entry(entries: Iterable[Entry], name: str, field: str = "") -> Entry:
    """The entry called `name`.

    Args:
        entries: A registry.
        name: Name of an entry.
        field: Where the name was given, for the message.

    Returns:
        The entry.

    Raises:
        InputError: There is none of that name; the message lists those there are.

    Example:
        >>> [p.name for p in entry(surfaces(), "sphere").parameters][:2]
        ['centre', 'radius']
    """
    found = tuple(entries)
    for e in found:
        if e.name == name:
            return e
    names = [e.name for e in found]
    near = meant(str(name), names)
    hint = f"; did you mean {near!r}?" if near else ""
    kind = found[0].kind if found else "entry"
    raise InputError(
        f"unknown {kind} {name!r}, there are: {', '.join(names)}{hint}", field=field or kind
    )
