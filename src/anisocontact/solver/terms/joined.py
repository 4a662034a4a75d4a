"""Bodies that are in contact with each other alone, and the motions that they can make together."""

from __future__ import annotations

from collections.abc import Sequence

from anisocontact.contact import Contact
from anisocontact.mesh import Model
from anisocontact.solver.terms.free_modes import Body, bodies


def joined(model: Model, contacts: Sequence[Contact]) -> list[Body]:
    """Bodies that only supports and springs can hold, those in contact with each other as one.

    Contact between bodies resists what one does to the other, not what they do as one rigid body;
    contact with itself resists nothing. Bodies in contact with a surface that is given are left
    out.

    Args:
        model: Mesh of the bodies.
        contacts: The contacts.
    """
    others: set[str] = set()
    links = []
    for contact in contacts:
        on, *against = (model.body_of(group) for group in contact.groups)
        if against:
            links.append((on, against[0]))
        else:
            others.add(on)
    return [body for body in bodies(model, links) if not others & set(body.parts)]
