"""Whether directions of contacts are their own images in planes of symmetry."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.contact.contact import Contact
from anisocontact.contact.field_axes import distances
from anisocontact.contact.symmetric import AT_POINTS, AXIS, PLANES, on_plane, tractions_of_slip
from anisocontact.interface import ContactLaw

#: Difference of a traction from the image of its mirrored one, over the largest, worth a word.
MIRRORED = 0.01
#: Share of a normal of the slave along that of a plane up to which it is one of facets that end
#: there, of which those beyond the plane are not seen.
SQUARE = 0.5


def unmirrored(contacts: Sequence[Contact], planes: Sequence[tuple[Ints, Floats]]) -> list[str]:
    """Contacts whose directions have another image in a plane of symmetry that their slave meets.

    There the other half has the texture of the other hand, which pushes against the plane. A plane
    mesh without `lateral` has no displacement across it that could. Collective.

    Args:
        contacts: The contacts.
        planes: Nodes that this rank owns on each plane, and its normal, (3,).

    Returns:
        A line for each contact and plane.
    """
    found = []
    for contact in contacts:
        ideal = contact.model.idealisation
        given = {one.field.name for one in contact.interface.carried if one.field is not None}
        if not given or AT_POINTS in given or not (ideal.dim == 3 or ideal.lateral):
            continue
        for nodes, normal in planes:
            off = _apart(contact, nodes, normal)
            if off > MIRRORED:
                along = ", ".join(f"{v:.3g}" for v in normal)
                found.append(
                    f"contact of {' with '.join(contact.groups)}: directions are not their own "
                    f"image in the symmetry plane with the normal ({along}), tractions differ by "
                    f"{off:.2g} of the largest: the half that is left out would have marks of the "
                    "other hand; take the whole, or a sector with [[cyclic]]"
                )
    return found


def _apart(contact: Contact, nodes: Ints, normal: Floats) -> float:
    """Largest difference of a traction from the image of its mirrored one; collective."""
    comm, points = contact.space.mesh.comm, contact.slave_points
    on = np.intersect1d(np.unique(contact.quadrature.nodes), nodes)
    heights = comm.allgather((contact.model.positions[on] @ normal).tolist())
    levels = [height for own in heights for height in own]
    if not levels:
        return 0.0
    x, outward = points.quadrature.reference, points.outward
    away = x @ normal - levels[0]
    least = min(comm.allgather(float(np.abs(away).min(initial=np.inf))))
    near = np.abs(away) < least + 1e-3 * contact.facet_size
    near &= np.abs(outward @ normal) < SQUARE
    for axis in _axes(contact.interface):
        near &= distances(axis, x) > AXIS * contact.facet_size
    tried = np.flatnonzero(near)
    tried = tried[:: max(len(tried) // PLANES, 1)]
    level = x[tried] - np.outer(away[tried], normal)
    off = size = 0.0
    square = outward[tried] - np.outer(outward[tried] @ normal, normal)
    square /= np.linalg.norm(square, axis=1)[:, None]
    for place, out in zip(level, square, strict=True):
        here, image = _tractions(contact, place, out, normal)
        off, size = max(off, float(np.abs(here - image).max())), max(size, np.abs(here).max())
    off, size = np.max(comm.allgather([off, size]), axis=0)
    return float(off / size) if size > 0.0 else 0.0


def _tractions(
    contact: Contact, place: Floats, outward: Floats, normal: Floats
) -> tuple[Floats, Floats]:
    """Traction after a slip at a point of the plane, and the image of that of the mirrored slip."""
    if len(contact.groups) == 1:
        interface = contact.interface
    else:
        interface = on_plane(contact.interface, place, -outward)
    second = np.cross(outward, normal)
    both = np.array([[np.cross(second, outward), second]])
    one = place[None]
    here = tractions_of_slip(interface, one, both, contact.facet_size)
    other = tractions_of_slip(interface, one, both * [[[-1.0], [1.0]]], contact.facet_size)
    return here, other - 2.0 * np.outer(other @ normal, normal)


def _axes(law: ContactLaw) -> list[Floats]:
    """Axes of its fields, where there is no direction."""
    fields = [one.field.named[1] for one in law.carried if one.field is not None]
    return [np.array(values["axis"]) for values in fields if "axis" in values]
