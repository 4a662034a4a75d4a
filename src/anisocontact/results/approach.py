"""How far the bodies of a contact have come towards each other, as what drives them says."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.contact import Contact

__all__ = ["approach"]

Floats = npt.NDArray[np.float64]


def approach(contact: Contact, displacements: Mapping[str, Any], rigid: Mapping[str, Any]) -> float:
    """Displacement of the slave's body against the master's, along the force that presses them.

    A body moves as far as the facet group of it that is led or loaded and has gone farthest; one
    without such groups counts as at rest. Gaps at the start are part of it.

    Args:
        contact: The contact.
        displacements: Mean displacement of the facet groups that are led or loaded, length.
        rigid: What the summary has of rigid bodies, by name.

    Returns:
        The approach, length; 0 where nothing presses.
    """
    last = contact.last
    local = (last.pressure * contact.areas) @ last.normal
    pressing = np.asarray(contact.space.mesh.comm.allreduce(local))
    size = float(np.linalg.norm(pressing))
    if size == 0.0:
        return 0.0
    away = pressing / size  # from the master to the slave
    slave = _farthest(contact.slave, displacements, -away)
    master = sum(_farthest(group, displacements, away) for group in contact.groups[1:])
    if contact.body is not None:
        master += float(np.dot(rigid[contact.body.name]["translation"], away))
    return slave + master


def _farthest(side: str, displacements: Mapping[str, Any], along: Floats) -> float:
    """Largest displacement along a direction of the groups of the body that has a group."""
    body = side.partition(".")[0]
    own = [u for group, u in displacements.items() if group.partition(".")[0] == body]
    return max((float(np.dot(u, along)) for u in own), default=0.0)
