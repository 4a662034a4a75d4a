"""Which facets meet what: forces and tangent of contact, history of the slave points."""

from anisocontact.contact.contact import Contact
from anisocontact.contact.directions import facet_directions
from anisocontact.contact.facet_contact import FacetContact
from anisocontact.contact.hints import coarse_slaves, warn_of
from anisocontact.contact.initial import Overlap, check_start, initial_overlap
from anisocontact.contact.multipliers import NotHeldError
from anisocontact.contact.penalty import PENALTY_FACTOR, auto_penalty, facet_size
from anisocontact.contact.quadrature import FacetQuadrature, facet_quadrature
from anisocontact.contact.self_contact import SelfContact
from anisocontact.contact.two_half_pass import TwoHalfPass
from anisocontact.interface import Augmentation as Augmentation

#: Contact of two meshed bodies.
type MeshedContact = FacetContact | TwoHalfPass
#: Every kind of contact.
type AnyContact = Contact | MeshedContact

__all__ = [
    "PENALTY_FACTOR",
    "AnyContact",
    "Contact",
    "FacetContact",
    "FacetQuadrature",
    "MeshedContact",
    "NotHeldError",
    "Overlap",
    "SelfContact",
    "TwoHalfPass",
    "auto_penalty",
    "check_start",
    "coarse_slaves",
    "facet_directions",
    "facet_quadrature",
    "facet_size",
    "initial_overlap",
    "warn_of",
]
