"""The parts of a contact from what it is given."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from typing import Any, TypedDict

import numpy as np

from anisocontact.base.array_types import Locals
from anisocontact.base.errors import InputError, tell_script
from anisocontact.base.fenicsx import facet_keys, facet_sides
from anisocontact.base.typed import unexpected
from anisocontact.contact.analytic import AnalyticMaster
from anisocontact.contact.beyond_cuts import BeyondCuts, Seam
from anisocontact.contact.contact_pair import PairParts
from anisocontact.contact.facet_mesh import facet_mesh, node_positions
from anisocontact.contact.field_axes import off_axes
from anisocontact.contact.images import Images
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.contact.options import ContactOptions
from anisocontact.contact.penalty import facet_size
from anisocontact.contact.poles import without_poles
from anisocontact.contact.quadrature import facet_quadrature, inward
from anisocontact.contact.sharp_edges import Towards, towards_facets, towards_itself
from anisocontact.contact.sides import check_sides, make_sides
from anisocontact.contact.slave_edges import SlaveEdges
from anisocontact.contact.slave_nodes import (
    NodesOfFacets,
    SlaveNodes,
    nodes_of_facets,
)
from anisocontact.contact.sweep import Sweep
from anisocontact.contact.symmetric import check_symmetry
from anisocontact.contact.whole_facets import around_own_nodes
from anisocontact.interface import ContactLaw, Interface
from anisocontact.mesh import Model
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.surfaces import Surface

#: Reference distance below which facets of self-contact do not meet, in facet sizes: more than the
#: search reaches, so that nothing touches at the start.
APART = 3.0

#: A surface, or one that has its laws, which may move.
type SurfaceMaster = Surface | Interface | MovingSurface


class DeprecatedArguments(TypedDict, total=False):
    """Arguments of `Contact` of before, for one more version."""

    interface: Interface
    body: RigidBody | None
    two_half: bool
    overlaps: bool


def before_this(
    master: str | SurfaceMaster | None, before: DeprecatedArguments
) -> tuple[str | SurfaceMaster | None, bool | None]:
    """The master, also from arguments of before, and whether these mean slave nodes or points.

    Raises:
        TypeError: There are other arguments.
    """
    if unknown := sorted(set(before) - set(DeprecatedArguments.__annotations__)):
        options = (field.name for field in fields(ContactOptions))
        raise unexpected(
            "Contact", unknown[0], ("model", "slave", "master", "law", *options, "name")
        )
    mortar = before.pop("two_half", False) or before.pop("overlaps", False)
    if mortar:
        text = "two_half, overlaps: take mortar=True, which is taken now"
        tell_script(text, DeprecationWarning)
    if not before:
        return master, mortar or None
    text = "interface, body: take master=interface or master=MovingSurface(interface, body)"
    tell_script(text, DeprecationWarning)
    surface: Any = before.get("interface", master)
    return MovingSurface(surface, before.get("body")), mortar


def make_pair_parts(
    model: Model,
    slave: str,
    master: str | SurfaceMaster | None,
    law: ContactLaw | None,
    options: ContactOptions,
    seams: Sequence[Seam] = (),
) -> PairParts:
    """The parts of a contact, see `Contact` and `Contact.go_on_beyond`."""
    if options.mortar and options.degree is not None:
        raise InputError("given, but slave nodes have no quadrature of a degree", "degree")
    if not isinstance(master, str):
        return _on_surface(model, slave, master, law, options)
    laws = _laws(law)
    if options.self_contact:
        options = _folded(model, slave, master, options)
    return _on_facets(model, slave, master, laws, options, seams)


def _on_surface(
    model: Model, slave: str, master: Any, law: ContactLaw | None, options: ContactOptions
) -> PairParts:
    facets = model.boundary(slave, "slave")
    for name in ("reach", "self_contact", "apart"):
        if getattr(options, name):
            raise InputError("given, but the master is a surface", name)
    moving = isinstance(master, MovingSurface)
    body, surface = (master.body, master.surface) if moving else (None, master)
    interface = _with_laws(surface, law)
    degree = options.chosen_degree(model)
    quadrature = facet_quadrature(model.space, facets, degree, model.idealisation)
    comm = model.mesh.comm
    current = options.current_area is not False
    if options.mortar:
        order = _order(model, facets)
        nodes = _slave_nodes(model, facets, current, SlaveEdges.in_plane, order=order)
        interface = without_poles(interface, nodes.quadrature.reference, comm)
        points: IntegrationPoints = nodes
    else:
        flip = inward(model.space, facets, quadrature)
        points = IntegrationPoints(quadrature, flip, current_area=current, comm=comm)
    check_symmetry(model.idealisation, interface, points, comm)
    x = points.quadrature.reference
    interface = off_axes(interface, x, points.size, comm, model.idealisation)
    found = AnalyticMaster(interface, body, points, comm)
    return PairParts(points, found, interface)


def _slave_nodes(
    model: Model,
    facets: Locals,
    current_area: bool,
    of_edges: Callable[[SlaveEdges], NodesOfFacets],
    towards: Towards | None = None,
    order: int | None = None,
    beyond: BeyondCuts | None = None,
) -> SlaveNodes:
    """Slave nodes of a mortar contact; of a body of order 1 in a space of order 2 its corners.

    Displacements of order 1 cannot hold multipliers of middle nodes.

    Raises:
        InputError: The mesh has two dimensions, on several processes.
    """
    sweep, comm = Sweep.of(model), model.mesh.comm
    if sweep is not None and comm.size > 1:
        text = f"mortar given on {comm.size} processes: in two dimensions it needs a single one"
        raise InputError(text, "pass")
    mesh = facet_mesh(model.space, facets, sweep, order)
    keys = facet_keys(model.mesh, np.sort(facets))
    whole = around_own_nodes(model.space, mesh, keys, beyond)
    x = whole.far.everywhere(model.positions)
    if beyond is not None:
        x = beyond.images.positions(x)
    if sweep is None:
        found = nodes_of_facets(whole, x, comm, towards)
    else:
        found = of_edges(SlaveEdges(whole.mesh, x, towards, whole.nodes))
    return SlaveNodes(found, whole, x, current_area=current_area, comm=comm)


def _nodes_towards(
    model: Model, slave: str, master: str, options: ContactOptions, beyond: BeyondCuts | None
) -> SlaveNodes:
    """Slave nodes of a contact whose master is facets."""
    if options.self_contact:
        towards = towards_itself(model, master)
    else:
        towards = towards_facets(model, master, beyond)
    facets, current = model.facets(slave), options.current_area is not False
    order = model.order if options.self_contact else _order(model, facets)
    if model.idealisation.dim == 2 and order < model.order:
        text = "slave nodes of a body of order 1 beside bodies of order 2"
        raise InputError(f'{text}: in two dimensions take "single", points', "pass")
    return _slave_nodes(model, facets, current, SlaveEdges.in_space, towards, order, beyond)


def _beyond(model: Model, seams: Sequence[Seam]) -> BeyondCuts:
    """What goes on beyond cut faces, in the plane swept out of its edges as well."""
    images, count = Sweep.of(model), len(node_positions(model.space))
    return BeyondCuts(images or Images(count, np.eye(3)[None], np.zeros((1, 3))), seams)


def _order(model: Model, facets: Locals) -> int:
    """Order of the displacement on facets, the higher one where bodies of both orders have them."""
    if not model.linear:
        return model.order
    cells, _ = facet_sides(model.mesh, np.sort(facets))
    linear = np.concatenate([model.cells(body) for body in model.linear])
    alike = bool(np.isin(cells, linear).all())
    return 1 if all(model.mesh.comm.allgather(alike)) else model.order


def _check_pair(model: Model) -> None:
    """Refuse what pairs of bodies of two dimensions do not have."""
    ideal, comm = model.idealisation, model.mesh.comm
    if ideal.dim == 3:
        return
    if ideal.lateral and ideal.turn.any():
        text = "facets given with twist; a surface is needed, or lateral = false"
        raise InputError(text, "master")
    if comm.size > 1:
        text = f"facets given on {comm.size} processes: in two dimensions they need a single one"
        raise InputError(text, "master")


def _laws(law: object) -> ContactLaw:
    """Laws without a surface."""
    if not isinstance(law, ContactLaw):
        given = "nothing" if law is None else type(law).__name__
        raise InputError(f"{given} given, Friction, ContactLaw or another law needed", "law")
    return law


def _with_laws(surface: Any, law: ContactLaw | None) -> Interface:
    """A surface with laws, one of which has to bring them."""
    if isinstance(surface, Surface):
        return Interface(surface, _laws(law))
    if not isinstance(surface, Interface):
        text = f"{type(surface).__name__} given, a surface, an Interface or a facet group needed"
        raise InputError(text, "master")
    if law is not None:
        raise InputError("given, but the master has laws", "law")
    return surface


def _folded(model: Model, slave: str, master: str, options: ContactOptions) -> ContactOptions:
    """Options of self-contact, a group against itself.

    What is near in the reference configuration and does not face each other does not count:
    neighbours, and the other side of a thin wall.
    """
    if master != slave:
        text = f"{master!r} given, {slave!r} needed: the slave is its own master"
        raise InputError(text, "master")
    model.facets(slave, "slave")
    size = facet_size(model, slave) if model.count_facets(slave) else 0.0
    apart = APART * size if options.apart is None else options.apart
    reach = min(2.0 * size, apart) if options.reach is None else options.reach
    return replace(options, apart=apart, reach=reach)


def _on_facets(
    model: Model,
    slave: str,
    master: str,
    law: ContactLaw,
    options: ContactOptions,
    seams: Sequence[Seam],
) -> PairParts:
    """Points and what they meet, which is facets.

    Args:
        model: Mesh with both groups.
        slave: Facet group of the slave.
        master: Facet group of the master.
        law: Laws.
        options: As of `Contact`.
        seams: As of `Contact.go_on_beyond`.
    """
    _check_pair(model)
    check_sides(model, slave, master, options.apart)
    beyond = _beyond(model, seams) if seams else None
    nodes = _nodes_towards(model, slave, master, options, beyond) if options.mortar else None
    sides = make_sides(model, (slave, master), options, nodes, beyond)
    met = model.positions[model.facet_nodes(master)]
    x = np.concatenate([(nodes or sides.points).quadrature.reference, met])
    law = off_axes(law, x, facet_size(model, slave), model.mesh.comm, model.idealisation)
    # the masters of two bodies, which contact with a surface does without
    if nodes is not None:
        from anisocontact.contact.mortar_master import MortarMaster

        size, itself = facet_size(model, master), options.self_contact
        pair = MortarMaster(sides, nodes, law, group=master, size=size, self_contact=itself)
        return PairParts(nodes, pair, law)
    from anisocontact.contact.facet_master import FacetMaster

    found = FacetMaster(sides, law, group=master, size=facet_size(model, master))
    return PairParts(sides.points, found, law)
