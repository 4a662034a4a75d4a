"""What to look at where fields have no direction, or hardly one, a line each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact.contact import Contact
from anisocontact.contact.facet_mesh import node_positions
from anisocontact.contact.field_axes import OFF, distances
from anisocontact.contact.symmetric import alike, apart_in_another_plane

#: Share of the area of a slave whose friction has an arbitrary direction that is worth a word.
UNCERTAIN = 1e-3
#: Angle between a slave and the helicoid of a spiral, radian, up to which facets say how it runs:
#: half of the angle between facets of which there are 32 around.
GRAZING = 0.1
#: Difference of tractions in another plane, over the largest, that is worth a word.
ELSEWHERE = 0.01


def doubtful_fields(contacts: Sequence[Contact]) -> list[str]:
    """Contacts on which a field has no direction in places that are worth a word; collective.

    Args:
        contacts: The contacts.

    Returns:
        A line for each contact and field.
    """
    return [*_on_axes(contacts), *_along_helicoids(contacts), *_of_one_plane(contacts)]


def _on_axes(contacts: Sequence[Contact]) -> list[str]:
    """Contacts with nodes on the axis of a polar or spiral field, where there is no direction.

    They have that of an axis beside them, see `off_axes`; in an axisymmetric body, which has no
    slip there, it is worth no word. Collective.

    Args:
        contacts: The contacts.

    Returns:
        A line for each contact and axis.
    """
    found = []
    for contact in contacts:
        if contact.model.idealisation.turn.any():
            continue
        fields = [one.field.named[1] for one in contact.interface.carried if one.field is not None]
        for axis in dict.fromkeys(tuple(values["axis"]) for values in fields if "axis" in values):
            where = _on_axis(contact, np.array(axis))
            if where:
                found.append(
                    f"contact of {' with '.join(contact.groups)}: {where} on the axis of a "
                    "direction field, where there is no direction: an arbitrary one is taken, and "
                    "that part of the friction is uncertain; finer facets make it smaller, an axis "
                    "off the nodes avoids it"
                )
    return found


def _on_axis(contact: Contact, axis: Floats) -> str:
    """What lies where an axis was put beside it, in words; empty if nothing does."""
    near, points = 2.0 * OFF * contact.facet_size, contact.slave_points.quadrature
    own = distances(axis, points.reference) <= near
    x, met = node_positions(contact.space), contact.nodes_of_groups[1:]
    opposite = sum(int((distances(axis, x[nodes]) <= near).sum()) for nodes in met)
    local = np.array([own.sum(), points.areas[own].sum(), points.areas.sum(), opposite])
    count, area, all_of_it, opposite = contact.space.mesh.comm.allreduce(local)
    share = (area if count else opposite and contact.master_size**2) / all_of_it
    if share < UNCERTAIN:
        return ""
    return f"{'slave points' if count else 'nodes of the master'} with {share:.2g} of its area lie"


def _along_helicoids(contacts: Sequence[Contact]) -> list[str]:
    """Contacts whose slave lies along the helicoid that a spiral is where it cuts a surface.

    The flank of a square thread is such a helicoid: every line on it has the pitch, and facets that
    are a little off it would say which of them the spiral is. Collective.

    Args:
        contacts: The contacts.

    Returns:
        A line for each contact and spiral.
    """
    found = []
    for contact in contacts:
        fields = [one.field.named for one in contact.interface.carried if one.field is not None]
        spirals = [(*values["axis"], *values["pitch"]) for kind, values in fields if kind == _KIND]
        for spiral in dict.fromkeys(spirals):
            share = _share_along(contact, np.array(spiral[:6]), spiral[6])
            if share >= UNCERTAIN:
                found.append(
                    f"contact of {' with '.join(contact.groups)}: {share:.0%} of the slave lies on "
                    f"the helicoid of a spiral of pitch {spiral[6]:g}, as the flank of a thread: "
                    "every line there has that pitch, and facets say which one is taken; "
                    'kind = "polar" has lines across the thread (first axis) and along it (second)'
                )
    return found


def _of_one_plane(contacts: Sequence[Contact]) -> list[str]:
    """Contacts of two meshes in the plane whose directions differ from plane to plane; collective.

    Rigid surfaces of that kind are refused, see `check_symmetry`.

    Args:
        contacts: The contacts.

    Returns:
        A line for each contact.
    """
    found = []
    for contact in contacts:
        ideal, points = contact.model.idealisation, contact.slave_points
        if len(contact.groups) == 1:
            continue
        off = apart_in_another_plane(ideal, contact.interface, points, contact.space.mesh.comm)
        if off > ELSEWHERE:
            found.append(
                f"contact of {' with '.join(contact.groups)}: directions are not the same "
                f"{alike(ideal)}, tractions elsewhere differ by {off:.2g} of the largest: those "
                "of the plane that is drawn are taken everywhere"
            )
    return found


def _share_along(contact: Contact, axis: Floats, pitch: float) -> float:
    """Share of the area of a slave within an angle `GRAZING` of a helicoid; collective."""
    points = contact.slave_points
    along = axis[3:] / np.linalg.norm(axis[3:])
    around = np.cross(along, points.quadrature.reference - axis[:3])
    across = np.einsum("nd,nd->n", around, around)[:, None] * along - pitch / (2.0 * np.pi) * around
    sizes = np.linalg.norm(across, axis=1) * np.sin(GRAZING)
    grazing = np.linalg.norm(np.cross(across, points.outward), axis=1) < sizes
    areas = points.quadrature.areas
    local = np.array([areas[grazing].sum(), areas.sum()])
    there, all_of_it = contact.space.mesh.comm.allreduce(local)
    return float(there / all_of_it)


_KIND = "spiral"
