"""Poles of a sphere, where its coordinates are none, away from slave nodes."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.anisotropy import BY_COORDINATES
from anisocontact.base.array_types import Floats
from anisocontact.interface import Interface
from anisocontact.surfaces import Surface

#: Share of a direction up to which two components are as large as each other: rounding.
SAME = 1e-6


def without_poles(interface: Interface, x: Floats, comm: Any) -> Interface:
    """The same laws on the same sphere, with an axis that does not point at what touches.

    Nodes of a mesh lie exactly below a pole where points of a quadrature do not. The axis is turned
    across the direction of the slave unless directions go by the coordinates of the sphere. Other
    surfaces stay as they are. Collective.

    Args:
        interface: Surface and laws.
        x: Slave nodes of this process, (n, 3), length.
        comm: Communicator of the mesh.
    """
    *total, count = comm.allreduce(np.array([*x.sum(axis=0), len(x)]))
    name, values = interface.surface.named
    fields = [one.field.name for one in interface.carried if one.field is not None]
    if name != "sphere" or not count or BY_COORDINATES.intersection(fields):
        return interface
    towards = np.array(total) / count - np.array(values["centre"])
    # the same on any number of processes
    sizes = np.abs(towards)
    axis = np.cross(towards, np.eye(3)[(sizes <= sizes.min() + SAME * sizes.max()).argmax()])
    if not axis.any():
        return interface
    surface = Surface(name, {**values, "axis": [*axis], "start": [*towards]})
    return Interface(surface, interface.law, threads=interface.threads)
