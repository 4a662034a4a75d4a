"""What the problem of a script is made of: unknowns, terms, and the bodies that it moves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from anisocontact.base.errors import InputError
from anisocontact.contact import Contact
from anisocontact.contact.given_twice import check_given_once
from anisocontact.mesh.node_unknowns import NodeUnknowns
from anisocontact.mesh.own_space import own_unknowns
from anisocontact.solver.system.assembly import Assembly
from anisocontact.solver.system.fields import Fields
from anisocontact.solver.system.layout import Layout
from anisocontact.solver.terms.bodies import Bodies
from anisocontact.solver.terms.constraints import Constraints
from anisocontact.solver.terms.contacts import Contacts
from anisocontact.solver.terms.form import Dirichlet
from anisocontact.solver.terms.rigid import RigidBodies


def script_assembly(
    bodies: Bodies, contacts: Sequence[Contact], conditions: Dirichlet, fields: Fields
) -> Assembly:
    """The system of a script, which has no constraints, and rigid bodies that it moves alone."""
    layout = Layout(bodies.unknowns, 0)
    return Assembly(
        layout,
        bodies,
        Contacts(contacts),
        conditions,
        constraints=Constraints(layout.new_vector()),
        rigid=RigidBodies([], bodies.unknowns.comm),
        fields=fields,
    )


def script_unknowns(contacts: Sequence[Contact], space: Any) -> NodeUnknowns:
    """Where the displacement is among the unknowns of a script."""
    check_given_once(contacts, "contacts")
    for contact in contacts:
        if not (contact.unknowns.among(space) and contact.unknowns.same(contacts[0].unknowns)):
            raise InputError(
                f"contact {contact.name!r} is defined on another space than u", "contacts"
            )
    if contacts:
        return contacts[0].unknowns
    return own_unknowns(space)


def moved_bodies(contacts: Sequence[Contact]) -> list[Any]:
    """Rigid bodies of contacts that a script can have."""
    found: list[Any] = [contact.body for contact in contacts if contact.body is not None]
    for body in found:
        if body.free:
            raise InputError(
                f"rigid body {body.name!r} is free; a script can only move it", "contacts"
            )
    return found
