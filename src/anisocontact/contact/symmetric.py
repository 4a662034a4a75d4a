"""Whether a surface and its laws are the same in every plane that a plane mesh stands for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.interface import ContactLaw, Interface, SlaveSurface
from anisocontact.mesh.idealisation import Idealisation
from anisocontact.surfaces import PROJECTION_STATUS, make_surface

#: Slip and penetration of the points that are tried, over the size of a facet.
TRIED = 1e-4
#: Difference of tractions that is rounding, over the largest.
SAME = 1e-6
#: Where another plane is, share of the thickness or of a full turn: no fraction of small numbers.
SHARE = 0.1379
#: Kind of field that is given at points.
AT_POINTS = "tabulated-points"
#: Distance from the axis of revolution up to which directions are those of an axis beside it, over
#: the size of a facet.
AXIS = 0.1
#: At least so many slave points of a process, of those there are, are tried on planes.
PLANES = 12


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

    def tractions(reference: Floats, tangents: Floats) -> Floats:
        return tractions_of_slip(interface, reference, tangents, points.size)

    off = _apart(idealisation, points, tractions, comm)
    if off:
        text = (
            f"surface and directions are not the same {alike(idealisation)}: tractions differ by "
            f"{off:.2g} of the largest"
        )
        raise InputError(text, "master")


def alike(idealisation: Idealisation) -> str:
    """How what a plane mesh stands for goes on out of the plane that is drawn, in words."""
    return "of revolution about the axis x = 0" if idealisation.turn.any() else "along z"


def apart_in_another_plane(
    idealisation: Idealisation, law: ContactLaw, points: IntegrationPoints, comm: Any
) -> float:
    """How far laws between facets are from what they are in another plane; collective.

    They are tried on planes along the slave. Directions that are given at points are those of the
    plane that is drawn, and are not looked at.

    Args:
        idealisation: What the mesh is taken for.
        law: The laws.
        points: The slave points.
        comm: Communicator of the mesh.

    Returns:
        Difference of tractions over the largest; 0 where it is rounding.
    """
    given = {one.field.name for one in law.carried if one.field is not None}
    if idealisation.dim == 3 or not given or AT_POINTS in given:
        return 0.0

    def tractions(reference: Floats, tangents: Floats) -> Floats:
        found = np.zeros_like(reference)
        across = np.linalg.norm(idealisation.across(reference), axis=1)
        whole = np.flatnonzero((across > AXIS * points.size) | (not idealisation.turn.any()))
        for i in whole[:: max(len(whole) // PLANES, 1)]:
            one = slice(i, i + 1)
            normal = np.cross(*tangents[i])
            interface = on_plane(law, reference[i], normal)
            found[one] = tractions_of_slip(interface, reference[one], tangents[one], points.size)
        return found

    return _apart(idealisation, points, tractions, comm)


def _apart(
    idealisation: Idealisation,
    points: IntegrationPoints,
    tractions: Callable[[Floats, Floats], Floats],
    comm: Any,
) -> float:
    """Difference of tractions at slave points, by places and tangents, from another plane's."""
    x, tangents = points.quadrature.reference, points.quadrature.tangents.reshape(-1, 2, 3)
    rotation, shift = idealisation.image(SHARE)
    here = tractions(x, tangents)
    there = tractions(x @ rotation.T + shift, tangents @ rotation.T)
    off = np.abs(there - here @ rotation.T).max(initial=0.0)
    off, size = np.max(comm.allgather([off, np.abs(here).max(initial=0.0)]), axis=0)
    return 0.0 if off <= SAME * size else float(off / size)


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
    leaves = np.abs(np.einsum("ni,ni->n", hit.dgap_dx, across)) > SAME * np.abs(across).max(
        initial=0.0
    )
    if any(comm.allgather(bool(np.any(leaves & below)))):
        text = "the normal of the surface is not in the plane of the mesh"
        raise InputError(f"{text}, in which it has to be a line", "master")


def on_plane(law: ContactLaw, place: Floats, normal: Floats) -> Interface:
    """The laws of a facet on a plane through a place, (3,), length, with a normal, (3,)."""
    return Interface(make_surface("plane", point=place, normal=normal), law)


def tractions_of_slip(
    interface: Interface, reference: Floats, tangents: Floats, size: float
) -> Floats:
    """Tractions where points are pushed onto a surface and moved along it by a small slip.

    Args:
        interface: Surface and laws.
        reference: The points, (n, 3), length.
        tangents: Two tangents of the slave, between which the slip is, (n, 2, 3).
        size: Of a facet, length.

    Returns:
        Tractions, (n, 3), stress; zero where there is no point of the surface below.
    """
    hit = interface.surface.project(reference)
    below = hit.status == PROJECTION_STATUS.index("interior")
    normal = np.where(below[:, None], hit.dgap_dx, 0.0)
    foot = reference - hit.gap[:, None] * normal
    unit = tangents / np.linalg.norm(tangents, axis=2)[..., None]
    way = TRIED * size * (0.6 * unit[:, 0] + 0.8 * unit[:, 1] - normal)
    seen = SlaveSurface(reference, tangents, tangents) if interface.takes_slave() else None
    found = interface.update(interface.initial_state(foot), foot + way, slave=seen).traction
    return np.where(below[:, None], np.nan_to_num(found), 0.0)
