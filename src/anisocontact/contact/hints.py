"""What to look at in contacts before they are used: a line each."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from anisocontact.base.errors import ModelWarning, tell_script
from anisocontact.base.shown import shown
from anisocontact.contact.contact import Contact
from anisocontact.contact.contact_pair import TOUCHING
from anisocontact.contact.defaults import FINER, STIFF
from anisocontact.contact.facet_mesh import facet_areas, node_positions
from anisocontact.contact.field_hints import doubtful_fields
from anisocontact.contact.hidden_borders import hidden_borders
from anisocontact.contact.initial import initial_overlap
from anisocontact.contact.meshed_master import MeshedMaster
from anisocontact.contact.sharp_edges import SMOOTH
from anisocontact.contact.tips import points_on_tips

#: Size of the facets of the slave over those of the master beyond which points between which
#: something of the master fits are worth a word; where nothing touches, already at MISSED.
COARSE, MISSED = 3.0, 1.5
#: Height of arcs over flat facets over an overlap at the start that is worth a word: a press fit of
#: two rings whose arcs are 1.3 times as high as the overlap carries 15 to 19 % too much.
FLAT = 0.1
#: Pressure that closes the gaps between flat facets over the one there is beyond which a word is
#: due: pressures at the nodes of a finer slave are off by that share.
UNEVENNESS = 0.5
#: Distance up to which pressures are averaged for that, over the size of the coarser facets.
LEVELLED = 2.0
#: Distance of nodes over the height of arcs up to which meshes of both sides match.
MATCHING = 0.1
#: Share of the nodes of the slave that do, from which on they do.
MATCHED = 0.5


def coarse_slaves(contacts: Sequence[Contact], ratio: float = COARSE) -> list[str]:
    """Contacts whose slave has much larger facets than the master.

    A single pass looks from points of the slave: what of the master lies between two of them is
    not met. Slave nodes meet it, by its mean. Of a graded slave the facets that face the master
    count. Collective.

    Args:
        contacts: The contacts.
        ratio: Size of the facets of the slave over those of the master that is worth a word.

    Returns:
        A line for each of them.

    Example:
        >>> from anisocontact import Contact, ContactLaw, Friction, NormalLaw, Adhesion
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> block = BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))
        >>> base = BoxSpec((-1, -1, -1), (3, 3, 1), (12, 12, 1))
        >>> model = build_box({"block": block, "base": base})
        >>> laws = Adhesion(stiffness=(5, 5)), Friction(coefficients=(0.3, 0.3))
        >>> law = ContactLaw(NormalLaw(penalty=10.0), *laws)
        >>> pair = Contact(model, "block.bottom", "base.top", law, mortar=False)
        >>> coarse_slaves([pair])
        ['contact of block.bottom with base.top: the facets of the slave are 4 times ...']
    """
    found = []
    for contact in contacts:
        if not contact.of_two_groups:
            continue
        slave, master = _size_facing_master(contact), contact.master_size
        if slave > ratio * master:
            at_nodes = contact.slave_points.at_nodes
            found.append(
                f"contact of {' with '.join(contact.groups)}: the facets of the slave are "
                f"{slave / master:.2g} times as large as those of the master ({slave:.3g} and "
                f"{master:.3g}), {_AT_NODES if at_nodes else _AT_POINTS}"
            )
    return found


def _size_facing_master(contact: Contact) -> float:
    """Length of the slave facets most of whose nodes face the master, of all where none does."""
    assert isinstance(contact.master, MeshedMaster)
    points, sides = contact.slave_points, contact.master.sides
    found = contact.master.located(contact.state)
    seen = points.nodes[found][points.shape[found] != 0.0]
    covered = np.isin(sides.slave.nodes, seen).sum(axis=1)
    comm = contact.space.mesh.comm
    before = covered == max(comm.allgather(int(covered.max(initial=0))))
    areas = facet_areas(sides.slave, sides.reference)
    own = [areas.sum(), len(areas), areas[before].sum(), np.count_nonzero(before)]
    whole, every, area, count = comm.allreduce(np.array(own))
    power = 0.5 if contact.model.idealisation.dim == 3 else 1.0
    return float(contact.facet_size * (area / count * every / whole) ** power)


#: What a coarse slave does to a contact.
_AT_POINTS = (
    "and what lies between its points is not met; swap slave and master, or take slave nodes "
    '(pass = "mortar", Contact(..., mortar=True))'
)
_AT_NODES = "and pressures are as coarse as these; swap slave and master"


def stiff_slaves(contacts: Sequence[Contact]) -> list[str]:
    """Contacts whose slave is stiffer and finer than the master.

    Every slave node demands that its gap closes, and a master of fewer nodes that gives way cannot
    do so for all of them: pressures alternate. Points of a single pass ask for less, by their
    penalties.

    Returns:
        A line for each of them.
    """
    return [
        f"contact of {' with '.join(one.groups)}: the slave is {one.master_yields:.2g} times as "
        f"stiff as the master and its facets are smaller ({one.facet_size:.3g} and "
        f"{one.master_size:.3g}): {_ALTERNATE if one.slave_points.at_nodes else _SCATTER}"
        for one in contacts
        if one.of_two_groups
        and one.master_yields > STIFF
        and one.facet_size < FINER * one.master_size
    ]


#: What a stiff and fine slave does to a contact: a die on a slab, docs/howto/passes.md.
_ALTERNATE = "pressures at its nodes alternate; swap slave and master"
_SCATTER = (
    "pressures at its points scatter by a fifth, friction that sticks is off by as much and "
    'increments are hard; swap slave and master, and with pass = "mortar" nodes hold exactly'
)


def doubtful_sides(contacts: Sequence[Contact]) -> list[str]:
    """Contacts whose slave had better be the master, a line each.

    As of `coarse_slaves`, or else `hidden_borders`, and `stiff_slaves`.

    Args:
        contacts: The contacts.

    Returns:
        A line for each of them.
    """
    return [
        line + _angles(contact)
        for contact in contacts
        for line in (coarse_slaves([contact]) or hidden_borders([contact]))
        + stiff_slaves([contact])
    ]


def _angles(contact: Contact) -> str:
    """What to do with angles of a texture where the sides are swapped; empty if it has none."""
    fields = [one.field.named[1] for one in contact.interface.carried if one.field is not None]
    turned = any(
        name.startswith("angle") and any(angle) for field in fields for name, angle in field.items()
    )
    return f"; {_MIRRORED}" if turned else ""


#: What an angle of a direction field means on the other side.
_MIRRORED = "angles of its directions are about the normal of the master: change their signs then"


#: What tetrahedra of order 1 do to pressures, docs/verification/mortar.md.
UNEVEN = (
    "pressures at single nodes of tetrahedra of order 1 scatter as forces of these elements do, in "
    "a Hertz contact with 7 facets across the radius by 12% of the peak; means over facets by 5%, "
    "order 2 by 3%"
)


def uneven(contacts: Sequence[Contact]) -> list[str]:
    """What to know of pressures where slave nodes are those of tetrahedra of order 1.

    Returns:
        A line, or none.
    """
    found = [
        one.slave_points.at_nodes and one.space.mesh.topology.cell_name() == "tetrahedron"
        for one in contacts
    ]
    plain = any(found) and contacts[0].space.element.basix_element.degree == 1
    return [UNEVEN] if plain else []


def faceted(contacts: Sequence[Contact]) -> list[str]:
    """Contacts whose pressures are no larger than what closes the gaps between flat facets.

    Where chords of two bodies stand for one round face and do not match, they are apart by the
    height of their arcs, here more, there less. Pressures at points differ from their mean by what
    closes these gaps, if they are closed at all; where they are not, what touches carries more, so
    that it is a mean over some facets that is looked at. Collective.

    Args:
        contacts: The contacts, in their accepted state.

    Returns:
        A line for each of them.
    """
    found = []
    for one in contacts:
        comm = one.space.mesh.comm
        made = one.sagitta * one.body_stiffness
        if not one.of_two_groups or one.sagitta < TOUCHING * one.facet_size:
            continue
        peak = max(comm.allgather(_levelled(one)))
        if not 0.0 < UNEVENNESS * peak < made or any(comm.allgather(_match(one))):
            continue
        found.append(
            f"contact of {one.name}: arcs over its facets are {one.sagitta:.3g} high, which "
            f"bodies as stiff as these close under {made:.3g}, and the largest pressure, as a mean "
            f"over some facets, is {peak:.3g}: pressures at points are those of the meshes, "
            f"resultants are not; {_finer(one)} or nodes that match reduce that"
        )
    return found


def _levelled(contact: Contact) -> float:
    """Largest mean of the pressure over some facets of the coarser side, of points of this rank."""
    from scipy.spatial import cKDTree  # slow to import, and few get here

    pressure, areas, x = contact.last.pressure, contact.areas, contact.points
    closed = np.flatnonzero(pressure > 0.0)
    if not len(closed):
        return 0.0
    reach = LEVELLED * max(contact.facet_size, contact.master_size)
    near = cKDTree(x).query_ball_point(x[closed], reach)
    return max(float(np.average(pressure[i], weights=areas[i])) for i in near)


def _match(contact: Contact) -> bool:
    """Whether most nodes of the slave lie on nodes of the master; those of each process."""
    from scipy.spatial import cKDTree  # slow to import, and few get here

    x = node_positions(contact.space)
    slave, master = (x[nodes] for nodes in contact.nodes_of_groups)
    if not (len(slave) and len(master)):
        return False
    near = cKDTree(master).query(slave)[0] <= MATCHING * contact.sagitta
    return bool(near.mean() > MATCHED)


def pressed_aside(contacts: Sequence[Contact]) -> list[str]:
    """Contacts with a surface of which points are pressed by a face that does not face them.

    At a sharp edge of a profile the closest point of a node that has got into the tool by more than
    its distance from the edge is on the other face, which pushes it aside: by how much depends on
    the increments. So are the edges of a side of a body that stands on a plane. Collective.

    Args:
        contacts: The contacts, in their accepted state.

    Returns:
        A line for each of them.
    """
    found = []
    for one in contacts:
        aside = (one.last.pressure > 0.0) & (one.master.facing(one.last.normal) < SMOOTH)
        count = one.space.mesh.comm.allreduce(int(aside.sum()))
        if count:
            found.append(
                f"contact of {one.name}: a face of the master that stands across the slave presses "
                f"its points ({count}) aside, and what they carry depends on the increments; at a "
                "sharp edge of the master round that by a facet or so (`rounding` of a profile), "
                "elsewhere let the slave be the face of the body that looks at the master"
            )
    return found


def overlapping(pairs: Iterable[tuple[Contact, str, float]], cure: str) -> list[str]:
    """Contacts whose bodies overlap where they are.

    Args:
        pairs: Each contact, what it is called, and the size of its facets, length.
        cure: What lets them just touch.

    Returns:
        A line for each of them.
    """
    found = []
    for contact, name, size in pairs:
        overlap = initial_overlap(contact, size)
        if overlap is None or overlap.depth <= contact.slave_points.beside:
            continue
        place = shown(overlap.point, size=size)
        found.append(
            f"{name}: the bodies overlap by {overlap.depth:.3g} at the start, "
            f"{100.0 * overlap.depth / size:.2g}% of the facet size, at {overlap.count} points, "
            f"most at {place}; the first increment pushes them apart, {cure} lets them just touch"
            + _flat(contact, overlap.depth)
        )
    return found


def _flat(contact: Contact, depth: float) -> str:
    """What facets beside their arcs do to an overlap that is meant; empty if next to nothing."""
    sagitta = contact.sagitta
    if sagitta <= FLAT * depth:
        return ""
    return (
        f"; arcs over their facets are {sagitta:.3g} high, {100.0 * sagitta / depth:.0f}% of that: "
        f"where an interference is meant it is wrong by as much, {_finer(contact)} reduce that"
    )


def _finer(contact: Contact) -> str:
    """What brings facets nearer to their arcs."""
    round_now = contact.space.element.basix_element.degree > 1
    return "finer facets" if round_now else "round cells (order 2) or finer facets"


def warn_of(contacts: Sequence[Contact]) -> None:
    """Issue a Python warning of the category `ModelWarning` for each doubtful side or field.

    Args:
        contacts: The contacts, as of `doubtful_sides`.
    """
    _warn([*doubtful_sides(contacts), *doubtful_fields(contacts), *points_on_tips(contacts)])


def warn_of_overlaps(contacts: Sequence[Contact]) -> None:
    """The same of bodies that overlap before the first step.

    Args:
        contacts: The contacts, as of `overlapping`.
    """
    pairs = ((one, f"contact of {one.name}", one.facet_size) for one in contacts)
    _warn(overlapping(pairs, "Contact(..., adjust=0.0)"))


def _warn(lines: Iterable[str]) -> None:
    for line in lines:
        tell_script(line, ModelWarning)
