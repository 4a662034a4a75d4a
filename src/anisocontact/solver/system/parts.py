"""What a problem is made of: bodies, contacts, and all that holds or loads them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.bulk import LinearBulk, Material, NonlinearBulk
from anisocontact.contact import AnyContact
from anisocontact.mesh import Model
from anisocontact.solver.stepping.sides_kept import SidesKept
from anisocontact.solver.system.layout import Layout
from anisocontact.solver.terms.attached import ElasticSupport, Spring
from anisocontact.solver.terms.attachments import Attachments
from anisocontact.solver.terms.constraints import Constraints
from anisocontact.solver.terms.loads import Loads
from anisocontact.solver.terms.rigid import RigidBodies
from anisocontact.solver.terms.stabilisation import Stabilisation
from anisocontact.solver.terms.supports import Supports


@dataclass(frozen=True)
class Parts:
    """Parts of one system of equations.

    Attributes:
        contacts: Contacts.
        bulk: The bodies.
        rigid: Rigid bodies of the contacts.
        layout: Where the unknowns are.
        attached: Elastic supports and springs.
        supports: Prescribed displacements.
        loads: Loads on the bodies.
        constraints: Ties and symmetry planes.
        stabilisation: Springs that keep bodies in reach.
        sides: Finds bodies behind their masters.
        support_scale: Force for a unit of length in the rows of given unknowns, force/length.
    """

    contacts: list[AnyContact]
    bulk: LinearBulk | NonlinearBulk
    rigid: RigidBodies
    layout: Layout
    attached: Attachments
    supports: Supports
    loads: Loads
    constraints: Constraints
    stabilisation: Stabilisation
    sides: SidesKept
    support_scale: float


def make_parts(
    model: Model,
    materials: Mapping[str, Material],
    contacts: Sequence[AnyContact],
    attached: Sequence[ElasticSupport | Spring],
    symmetry: Sequence[str],
    stabilised: bool,
) -> Parts:
    """Parts of a problem, from the arguments of `Problem`.

    Raises:
        InputError: A body without material, a material without body, or two contacts of one name.
    """
    _check(model, materials, contacts)
    linear = all(material.linear for material in materials.values())
    bulk = LinearBulk(model, materials) if linear else NonlinearBulk(model, materials)
    rigid = RigidBodies(contacts, model.mesh.comm)
    layout = Layout(model.space, rigid.size)
    attachments = Attachments(attached, model)
    supports, loads = Supports(model), Loads(model, materials)
    constraints = Constraints(model, symmetry, layout.new_vector())
    scale = bulk.diagonal.sum() / bulk.diagonal.getSize()
    for contact in contacts:
        contact.suit_strain(_finite(model, materials, contact))
        contact.suit(np.array(bulk.diagonal.array_r).reshape(-1, 3))
    holders = {model.body_of(group) for one in attached for group in one.groups}
    return Parts(
        contacts=list(contacts),
        bulk=bulk,
        rigid=rigid,
        layout=layout,
        attached=attachments,
        supports=supports,
        loads=loads,
        constraints=constraints,
        stabilisation=Stabilisation(model, contacts, scale, attachments, holders, stabilised),
        sides=SidesKept(contacts, model),
        support_scale=scale,
    )


def _finite(model: Model, materials: Mapping[str, Material], contact: AnyContact) -> bool:
    """Whether one of the bodies of a contact is at finite strain."""
    return not all(materials[model.body_of(group)].linear for group in contact.groups)


def _check(
    model: Model,
    materials: Mapping[str, Material],
    contacts: Sequence[AnyContact],
) -> None:
    for body in materials:
        model.cells(body, f"material.{body}")
    for body in model.body_names():
        if body not in materials:
            raise InputError(f"body {body!r} has no material", "material")
    names = [contact.name for contact in contacts]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two contacts have the name {name!r}", "contact")
