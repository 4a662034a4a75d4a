"""Whether a surface and its laws are the same in every plane that a plane mesh stands for."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.interface import Interface, SlaveSurface
from anisocontact.mesh.idealisation import Idealisation
from anisocontact.surfaces import PROJECTION_STATUS

#: Slip and penetration of the points that are tried, over the size of a facet.
TRIED = 1e-4
#: Difference of tractions that is rounding, over the largest.
SAME = 1e-6
#: Where another plane is, share of the thickness or of a full turn: no fraction of small numbers.
SHARE = 0.1379


def check_symmetry(
    idealisation: Idealisation, interface: Interface, points: IntegrationPoints, comm: Any
) -> None:
    """Refuse a master that answers otherwise in another plane.

    The slave points are put on the surface, pushed in and moved along it, and the same is done
    with their images in another plane: the tractions have to be the images of the first ones. This
    is so for surfaces of extrusion, or of revolution, with laws whose axes are alike everywhere.

    Args:
        idealisation: What the mesh is taken for.
        interface: Surface and laws.
        points: The slave points.
        comm: Communicator of the mesh; the call is collective.

    Raises:
        InputError: The tractions differ, or the surface lies across the plane.
    """
    if idealisation.dim == 3:
        return
    _check_normals(idealisation, interface, points, comm)
    here = _tractions(interface, points, np.eye(3), np.zeros(3))
    rotation, shift = idealisation.image(SHARE)
    there = _tractions(interface, points, rotation, shift)
    off = np.abs(there - here @ rotation.T).max(initial=0.0)
    off, size = np.max(comm.allgather([off, np.abs(here).max(initial=0.0)]), axis=0)
    if not off <= SAME * size:
        kind = "of revolution about the axis x = 0" if idealisation.turn.any() else "along z"
        text = (
            f"surface and directions are not the same {kind}: tractions differ by "
            f"{off / size:.2g} of the largest"
        )
        raise InputError(text, "master")


def _check_normals(
    idealisation: Idealisation, interface: Interface, points: IntegrationPoints, comm: Any
) -> None:
    """Refuse a surface whose normals leave the plane, which it does not cut in a line.

    Raises:
        InputError: There is such a normal.
    """
    places = points.quadrature.reference
    hit = interface.surface.project(places)
    below = hit.status == PROJECTION_STATUS.index("interior")
    across = idealisation.across(places)
    leaves = np.abs(np.einsum("ni,ni->n", hit.dgap_dx, across)) > SAME * np.abs(across).max()
    if any(comm.allgather(bool(np.any(leaves & below)))):
        text = "the normal of the surface is not in the plane of the mesh"
        raise InputError(f"{text}, in which it has to be a line", "master")


def _tractions(
    interface: Interface, points: IntegrationPoints, rotation: Floats, shift: Floats
) -> Floats:
    """Tractions after a small slip, (n, 3); zero where there is no point of the surface below."""
    quadrature = points.quadrature
    reference = quadrature.reference @ rotation.T + shift
    tangents = quadrature.tangents.reshape(-1, 2, 3) @ rotation.T
    hit = interface.surface.project(reference)
    below = hit.status == PROJECTION_STATUS.index("interior")
    normal = np.where(below[:, None], hit.dgap_dx, 0.0)
    foot = reference - hit.gap[:, None] * normal
    unit = tangents / np.linalg.norm(tangents, axis=2)[..., None]
    way = TRIED * points.size * (0.6 * unit[:, 0] + 0.8 * unit[:, 1] - normal)
    seen = SlaveSurface(reference, tangents, tangents) if interface.takes_slave() else None
    found = interface.update(interface.initial_state(foot), foot + way, slave=seen).traction
    return np.where(below[:, None], np.nan_to_num(found), 0.0)
