"""Names of contacts before there was one `Contact`, for one more version."""

from __future__ import annotations

from functools import partial
from typing import Any

from anisocontact.contact.contact import Contact
from anisocontact.contact.making import Options, facet_pass
from anisocontact.interface import ContactLaw
from anisocontact.mesh import Model


def _facet_contact(
    model: Model,
    slave: str,
    master: str,
    *,
    law: ContactLaw,
    weight: float = 1.0,
    mirrored: bool = False,
    name: str = "",
    **options: Any,
) -> Contact:
    given = Options(**options)
    half = facet_pass(model, slave, master, law, given, weight=weight, mirrored=mirrored)
    return Contact.of(half, name=name)


def _self_contact(model: Model, group: str, *, law: ContactLaw, **options: Any) -> Contact:
    return Contact(model, group, group, law, self_contact=True, **options)


#: Names, what makes the same, and what to take instead.
BEFORE = {
    "FacetContact": (_facet_contact, 'Contact(model, slave, "body.group", law)'),
    "TwoHalfPass": (partial(Contact, two_half=True), "Contact(..., two_half=True)"),
    "SelfContact": (_self_contact, "Contact(model, group, group, law, self_contact=True)"),
    "AnyContact": (Contact, "Contact"),
    "MeshedContact": (Contact, "Contact"),
}
