"""What a problem is made of: bodies, contacts, and all that holds or loads them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import Vec
from anisocontact.bulk import LinearBulk, Material, NonlinearBulk, small_strain, without_expansion
from anisocontact.contact import Contact
from anisocontact.contact.given_twice import check_given_once
from anisocontact.contact.shared_nodes import mark_shared
from anisocontact.mesh import Model
from anisocontact.solver.system.assembly import Assembly, ExternalTerms
from anisocontact.solver.system.layout import Layout
from anisocontact.solver.system.rounding import check_rounding
from anisocontact.solver.system.sides_kept import SidesKept
from anisocontact.solver.terms.attached import ElasticSupport, Spring
from anisocontact.solver.terms.attachments import Attachments
from anisocontact.solver.terms.bodies import Bodies
from anisocontact.solver.terms.constraints import Constraints
from anisocontact.solver.terms.contacts import Contacts
from anisocontact.solver.terms.cyclic import CyclicSymmetry
from anisocontact.solver.terms.face_on_body import CoupledFace
from anisocontact.solver.terms.faces import CoupledFaces
from anisocontact.solver.terms.free_modes import bodies as all_bodies
from anisocontact.solver.terms.inclined_supports import InclinedSupports
from anisocontact.solver.terms.loads import Loads
from anisocontact.solver.terms.midside_nodes import constrain_middles, midside_nodes
from anisocontact.solver.terms.rigid import RigidBodies
from anisocontact.solver.terms.sector_contacts import go_on_beyond_cuts
from anisocontact.solver.terms.stabilisation import Stabilisation
from anisocontact.solver.terms.supports import Supports
from anisocontact.solver.terms.symmetry import SymmetryPlanes
from anisocontact.solver.terms.tied_faces import Tie, TiedFaces


@dataclass(frozen=True)
class Connections:
    """What holds and connects the bodies for the whole run, see `Problem`.

    Attributes:
        attached: Elastic supports and springs.
        symmetry: Facet groups on symmetry planes.
        coupled: Facet groups that follow rigid bodies.
        ties: Facet groups that are glued together.
        cyclic: Cut faces of sectors.
    """

    attached: Sequence[ElasticSupport | Spring] = ()
    symmetry: Sequence[str] = ()
    coupled: Sequence[CoupledFace] = ()
    ties: Sequence[Tie] = ()
    cyclic: Sequence[CyclicSymmetry] = ()


@dataclass(frozen=True)
class ProblemParts:
    """Parts of one system of equations.

    Attributes:
        model: Mesh of the bodies.
        materials: Material of each body.
        contacts: Contacts.
        bulk: Forces inside the bodies.
        rigid: Rigid bodies of the contacts.
        layout: Where the unknowns are.
        attached: Elastic supports and springs.
        supports: Prescribed displacements.
        loads: Loads on the bodies.
        inclined: Symmetry planes and cylindrical supports.
        stabilisation: Springs that keep bodies in reach.
        sides: Finds bodies behind their masters.
        assembly: All of it as one system of terms.
    """

    model: Model
    materials: Mapping[str, Material]
    contacts: tuple[Contact, ...]
    bulk: LinearBulk | NonlinearBulk
    rigid: RigidBodies
    layout: Layout
    attached: Attachments
    supports: Supports
    loads: Loads
    inclined: InclinedSupports
    stabilisation: Stabilisation
    sides: SidesKept
    assembly: Assembly


def make_parts(
    model: Model,
    materials: Mapping[str, Material],
    contacts: Sequence[Contact],
    connections: Connections,
    stabilised: bool,
) -> ProblemParts:
    """Parts of a problem, from the arguments of `Problem`.

    Raises:
        InputError: A body without material, a material without body, two contacts of one name,
            one on another model, or a slave or master in a plane of symmetry.
    """
    _check(model, materials, contacts, connections.symmetry)
    specs = connections.attached
    faces = CoupledFaces(connections.coupled, model, materials, midside_nodes(model))
    bulk = _bulk(model, materials, faces)
    bodies, rigid = Bodies(bulk, model.unknowns), RigidBodies(contacts, model.mesh.comm, faces)
    layout = Layout(model.unknowns, rigid.size)
    attached, supports, loads = Attachments(specs, model), Supports(model), Loads(model, materials)
    like = layout.new_vector()
    tied = _tied(model, like, contacts, connections)
    inclined = _inclined(model, connections.symmetry, like, tied, faces)
    middles = constrain_middles(model, like, faces.whole)
    constraints = Constraints(like, middles, tied, inclined, faces)
    suit(contacts, bodies, [_finite(model, materials, contact) for contact in contacts])
    holders = {model.body_of(group) for one in specs for group in one.groups}
    links = faces.links + ([] if tied is None else tied.links)
    aid = Stabilisation(model, contacts, bodies.scale, attached, holders, stabilised, links)
    external = ExternalTerms(holders=[attached], loads=[loads], aids=[aid])
    assembly = Assembly(layout, bodies, Contacts(contacts), supports, constraints, rigid, external)
    return ProblemParts(
        model=model,
        materials=dict(materials),
        contacts=tuple(contacts),
        bulk=bulk,
        rigid=rigid,
        layout=layout,
        attached=attached,
        supports=supports,
        loads=loads,
        inclined=inclined,
        stabilisation=aid,
        sides=SidesKept(contacts, all_bodies(model)),
        assembly=assembly,
    )


def _tied(
    model: Model, like: Vec, contacts: Sequence[Contact], connections: Connections
) -> TiedFaces | None:
    """Ties and cut faces, beyond which contacts go on; None where there are neither."""
    if not (connections.ties or connections.cyclic):
        return None
    tied = TiedFaces(connections.ties, model, like, connections.cyclic)
    go_on_beyond_cuts(contacts, tied.sectors)
    return tied


def _bulk(
    model: Model, materials: Mapping[str, Material], faces: CoupledFaces
) -> LinearBulk | NonlinearBulk:
    """The bodies that deform.

    Raises:
        InputError: There is none.
    """
    soft = {name: law for name, law in materials.items() if name not in faces.whole}
    if not soft:
        raise InputError("all bodies follow rigid ones as a whole: nothing deforms", "coupled")
    linear = all(material.linear for material in soft.values())
    return LinearBulk(model, soft) if linear else NonlinearBulk(model, soft)


def _inclined(
    model: Model, symmetry: Sequence[str], like: Vec, tied: TiedFaces | None, faces: CoupledFaces
) -> InclinedSupports:
    """What holds nodes along directions of their own, which coupled faces have none of."""
    planes = SymmetryPlanes(model, symmetry, midside_nodes(model))
    sectors = None if tied is None else tied.sectors
    inclined = InclinedSupports(model, planes, like, midside_nodes(model), sectors)
    on = [np.zeros(0, int), *(nodes for nodes, _ in inclined.of_planes())]
    faces.check_planes(np.unique(np.concatenate(on)))
    return inclined


def suit(contacts: Sequence[Contact], bodies: Bodies, finite: Sequence[bool]) -> None:
    """Tell contacts how stiff their bodies are, which are at finite strain, and what they share.

    Raises:
        InputError: As of `check_rounding`.
    """
    mark_shared(contacts)
    diagonal = bodies.unknowns.own_nodal(np.array(bodies.bulk.yielding.array_r))
    for contact, is_finite in zip(contacts, finite, strict=True):
        contact.suit_strain(is_finite)
        contact.suit(diagonal)
        check_rounding(contact)


def _finite(model: Model, materials: Mapping[str, Material], contact: Contact) -> bool:
    """Whether one of the bodies of a contact is at finite strain."""
    return not all(small_strain(materials[model.body_of(group)]) for group in contact.groups)


def _check_planes(contacts: Sequence[Contact], symmetry: Sequence[str]) -> None:
    """Refuse slaves and masters in planes of symmetry: held along their normal, planes carry."""
    for contact in contacts:
        for group, side, what in zip(contact.groups, ("slave", "master"), _HELD, strict=False):
            if group in symmetry:
                text = f"{group!r} given, the {side} of contact {contact.name!r}"
                cure = f"held along its normal {what}; name the cut faces"
                raise InputError(f"{text}: {cure}", "symmetry")


#: What comes of a slave and of a master in a plane of symmetry.
_HELD = (
    "it would carry no pressure",
    "its body would feel no pressure, which the plane would carry",
)


def _check(
    model: Model,
    materials: Mapping[str, Material],
    contacts: Sequence[Contact],
    symmetry: Sequence[str],
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
    check_given_once(contacts, "contact")
    for contact in contacts:
        if not contact.unknowns.among(model.space):
            raise InputError(
                "it was made on another model, and knows nothing of this mesh: make a contact on "
                "the model of the problem",
                f"contact {contact.name!r}",
            )
    for name, material in materials.items():
        model.idealisation.check_material(without_expansion(material), f"material.{name}")
    _check_planes(contacts, symmetry)
