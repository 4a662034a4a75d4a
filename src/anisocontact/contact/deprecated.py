"""Names of contacts before there was one `Contact`, for one more version."""

from __future__ import annotations

from functools import partial
from typing import Any

from anisocontact.contact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.mesh import Model


def _self_contact(model: Model, group: str, *, law: ContactLaw, **options: Any) -> Contact:
    return Contact(model, group, group, law, self_contact=True, **options)


#: Names, what makes the same, and what to take instead.
BEFORE = {
    "FacetContact": (
        partial(Contact, mortar=False),
        'Contact(model, slave, "body.group", law, mortar=False)',
    ),
    "TwoHalfPass": (partial(Contact, mortar=True), "Contact(..., mortar=True)"),
    "SelfContact": (_self_contact, "Contact(model, group, group, law, self_contact=True)"),
    "AnyContact": (Contact, "Contact"),
    "MeshedContact": (Contact, "Contact"),
}
