"""Slave points on the tip of a rigid surface, where there is no normal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.shown import shown
from anisocontact.contact.contact import Contact
from anisocontact.interface import Interface
from anisocontact.surfaces import Surface

#: Distance from a tip up to which a point is on it, over the size of a facet.
ON = 1e-3
#: Sine of the angle between normals beside a tip and its axis from which on it is worth a word: 1
#: degree.
LEANING = 0.0175
#: How far from its tip a surface is looked at, over the size of a facet: a round one is flat there.
BESIDE = 1e-5


def points_on_tips(contacts: Sequence[Contact]) -> list[str]:
    """Contacts with slave points on the tip of a cone or profile; collective.

    The closest face of such a point is one of those around, by rounding, and its normal presses the
    point aside. In an axisymmetric body it cannot go there.

    Args:
        contacts: The contacts.

    Returns:
        A line for each of them.
    """
    found = []
    for contact in contacts:
        if not isinstance(contact.interface, Interface) or contact.model.idealisation.turn.any():
            continue
        surface, size = contact.interface.surface, contact.facet_size
        x = contact.slave_points.quadrature.reference
        for tip, axis in _ends(surface):
            off = np.linalg.norm(x - tip, axis=1)
            if not contact.space.mesh.comm.allreduce(int((off <= ON * size).sum())):
                continue
            lean = _lean(surface, tip, axis, BESIDE * size)
            if lean > LEANING:
                at = shown(tip)
                found.append(
                    f"contact of {contact.name}: a slave point is on the tip of the surface, at "
                    f"{at}, where it has no normal: one of those around is taken by rounding, "
                    f"and presses the point aside, by {lean:.0%} of its force; let the tip be "
                    "between the points, or round it"
                )
    return found


def _ends(surface: Surface) -> Iterator[tuple[Floats, Floats]]:
    """Places at which a surface meets its axis, with unit vectors along that."""
    name, values = surface.named
    if name == "cone":
        along = np.array(values["axis"])
        yield np.array(values["apex"]), along / np.linalg.norm(along)
    elif name == "revolution":
        along = np.array(values["axis"])
        along /= np.linalg.norm(along)
        profile = np.array(values["profile"]).reshape(-1, 2)
        for r, z in (profile[0], profile[-1]):
            if abs(r) <= 1e-12 * np.abs(profile).max():
                yield np.array(values["point"]) + z * along, along


def _lean(surface: Surface, tip: Floats, axis: Floats, off: float) -> float:
    """Sine of the angle between the normal at a distance from the axis and the axis; 0 if none."""
    across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    there = surface.project([tip + off * across / np.linalg.norm(across)])
    normal = there.dgap_dx[0]
    return float(np.linalg.norm(np.cross(normal, axis))) if np.isfinite(normal).all() else 0.0
