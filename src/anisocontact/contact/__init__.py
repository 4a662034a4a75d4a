"""Which facets meet what: forces and tangent of contact, history of the slave points."""

from anisocontact.contact.contact import Contact
from anisocontact.contact.facet_contact import FacetContact
from anisocontact.contact.penalty import PENALTY_FACTOR, auto_penalty, facet_size
from anisocontact.contact.quadrature import FacetQuadrature, facet_quadrature
from anisocontact.contact.self_contact import SelfContact
from anisocontact.contact.two_half_pass import TwoHalfPass

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
    "SelfContact",
    "TwoHalfPass",
    "auto_penalty",
    "facet_quadrature",
    "facet_size",
]
