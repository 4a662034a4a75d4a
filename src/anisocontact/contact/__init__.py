"""Which facets meet what: forces and tangent of contact, history of the slave points."""

import importlib
import warnings
from typing import Any

from anisocontact.contact.contact import Contact
from anisocontact.contact.directions import facet_directions
from anisocontact.contact.hints import coarse_slaves, warn_of
from anisocontact.contact.initial import Overlap, check_start, initial_overlap
from anisocontact.contact.multipliers import NotHeldError
from anisocontact.contact.one_pass import Pass
from anisocontact.contact.penalty import PENALTY_FACTOR, auto_penalty, facet_size
from anisocontact.contact.quadrature import FacetQuadrature, facet_quadrature
from anisocontact.interface import Augmentation as Augmentation

__all__ = [
    "PENALTY_FACTOR",
    "Contact",
    "FacetQuadrature",
    "NotHeldError",
    "Overlap",
    "Pass",
    "auto_penalty",
    "check_start",
    "coarse_slaves",
    "facet_directions",
    "facet_quadrature",
    "facet_size",
    "initial_overlap",
    "warn_of",
]

#: What to take instead of classes of before, which work for one more version.
_BEFORE = {
    "FacetContact": 'Contact(model, slave, "body.group", law)',
    "TwoHalfPass": 'Contact(model, slave, "body.group", law, two_half=True)',
    "SelfContact": "Contact(model, group, group, law, self_contact=True)",
}


def __getattr__(name: str) -> Any:
    if name in {"AnyContact", "MeshedContact"}:
        warnings.warn(f"{name}: take Contact", DeprecationWarning, stacklevel=2)
        return Contact
    if name not in _BEFORE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    warnings.warn(f"{name}: take {_BEFORE[name]}", DeprecationWarning, stacklevel=2)
    return getattr(importlib.import_module("anisocontact.contact.deprecated"), name)
