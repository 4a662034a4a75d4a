"""Contacts that are so stiff that the rounding of positions is a force."""

from __future__ import annotations

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.contact import Contact
from anisocontact.solver.system.force_balance import ROUND_OFF

#: What rounding of positions makes of a traction, over Young's modulus, at most: a hundredth of the
#: pressure at strains of a thousandth. It is what may be left out of balance.
ROUNDED = 1e-5


def check_rounding(contact: Contact) -> None:
    """Refuse a contact whose stiffness makes forces of the rounding of positions; collective.

    Args:
        contact: The contact, which knows how stiff its bodies are.

    Raises:
        InputError: The stiffness is too large.
    """
    here = float(np.linalg.norm(contact.points, axis=1).max(initial=0.0))
    far = max(contact.space.mesh.comm.allgather(here))
    most = ROUNDED * contact.body_stiffness * contact.facet_size
    for field, stiffness in contact.given_stiffnesses().items():
        if stiffness * far * ROUND_OFF > most > 0.0:
            raise InputError(
                f"a stiffness of {stiffness:.3g}, must be at most {most / (far * ROUND_OFF):.2g}: "
                f"beyond it rounding of positions, {far:.3g} from the origin, makes forces; a mesh "
                "nearer to the origin has less of it",
                f"contact {contact.name!r}.{field}",
            )
