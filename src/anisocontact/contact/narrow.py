"""Contacts that are narrower than two facets: what pressures at their points are worth."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Flags
from anisocontact.contact.contact import Contact
from anisocontact.contact.remote_nodes import node_count, with_ghosts
from anisocontact.contact.slave_nodes import SlaveNodes

#: What is said of them. The peak pressure of a sphere on a block over that of Hertz is 0.61 with a
#: radius of contact of 0.54 of a facet, 0.85 with 0.75, 0.90 with 0.98, where all of them are
#: narrow, and 0.98 to 1.05 from 1.3 on, where none is.
NARROW = (
    "no slave node that touches is among nodes that all touch, in any increment: the contact is "
    "narrower than two facets, and pressures at points are off by 10 to 40% (a Hertz contact of "
    "0.5 to 1 facet in radius); resultants are not; finer facets where it touches reduce that"
)


#: Pressure that is rounding, over that which presses a surface in by a facet.
_ROUNDING = 1e-13


def pressed(contact: Contact) -> Flags:
    """Points of the accepted state whose pressure is more than rounding, (n,)."""
    none = _ROUNDING * contact.body_stiffness * contact.facet_size
    return np.asarray(contact.last.pressure > none)


def narrow_so_far(contact: Contact, before: bool | None) -> bool | None:
    """Whether a contact was narrow whenever it touched, see `is_narrow`; collective.

    Args:
        contact: The contact, in its accepted state.
        before: The same at the increment before; nothing at the start.
    """
    now = is_narrow(contact) if before is not False else False
    return before if now is None else now


def is_narrow(contact: Contact) -> bool | None:
    """Whether no slave node and all of its neighbours on facets are pressed; collective.

    Args:
        contact: The contact, in its accepted state.

    Returns:
        Nothing where no slave node is pressed, or the law is not asked at slave nodes, or in the
        plane on several processes.
    """
    points, space = contact.slave_points, contact.space
    flat = contact.model.idealisation.dim == 2
    if not isinstance(points, SlaveNodes) or (flat and space.mesh.comm.size > 1):
        return None
    nodal = np.zeros(node_count(space))
    here = pressed(contact)
    nodal[points.nodes[here, 0]] = 1.0
    nodal = points.led(points.everywhere(with_ghosts(space, nodal)))
    around = points.around.nodes % len(nodal)  # images, beside a plane or in other sectors
    inside = here & (nodal[around] > 0.0).all(axis=1)
    counts = space.mesh.comm.allreduce(np.array([here.sum(), inside.sum()]))
    return None if not counts[0] else not counts[1]
