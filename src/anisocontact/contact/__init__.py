"""Which facets meet what: forces and tangent of contact, history of the slave points."""

from typing import Any

from anisocontact.base.renamed import renamed
from anisocontact.contact.contact import Contact
from anisocontact.contact.directions import facet_directions
from anisocontact.contact.hints import coarse_slaves, doubtful_sides, warn_of
from anisocontact.contact.initial import Overlap, check_start, initial_overlap
from anisocontact.contact.multipliers import NotHeldError
from anisocontact.contact.penalty import PENALTY_FACTOR, auto_penalty, facet_size
from anisocontact.contact.quadrature import FacetQuadrature, facet_quadrature
from anisocontact.contact.tie_gaps import close_gaps
from anisocontact.interface import Augmentation as Augmentation

__all__ = [
    "PENALTY_FACTOR",
    "Contact",
    "FacetQuadrature",
    "NotHeldError",
    "Overlap",
    "auto_penalty",
    "check_start",
    "close_gaps",
    "coarse_slaves",
    "doubtful_sides",
    "facet_directions",
    "facet_quadrature",
    "facet_size",
    "initial_overlap",
    "warn_of",
]


def __getattr__(name: str) -> Any:
    return renamed(__name__, name)
