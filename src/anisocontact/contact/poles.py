"""Poles of a sphere, where its coordinates are none, away from slave nodes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.anisotropy import BY_COORDINATES
from anisocontact.interface import Interface
from anisocontact.surfaces import Surface

Floats = npt.NDArray[np.float64]


def without_poles(interface: Interface, x: Floats) -> Interface:
    """The same laws on the same sphere, with an axis that does not point at what touches.

    Nodes of a mesh lie exactly below a pole where points of a quadrature do not. The axis is turned
    across the direction of the slave unless directions go by the coordinates of the sphere. Other
    surfaces stay as they are.

    Args:
        interface: Surface and laws.
        x: Slave nodes, (n, 3), length.
    """
    name, values = interface.surface.named
    fields = [one.field.name for one in interface.carried if one.field is not None]
    if name != "sphere" or not len(x) or BY_COORDINATES.intersection(fields):
        return interface
    towards = x.mean(axis=0) - np.array(values["centre"])
    axis = np.cross(towards, np.eye(3)[np.abs(towards).argmin()])
    if not axis.any():
        return interface
    surface = Surface(name, {**values, "axis": [*axis], "start": [*towards]})
    return Interface(surface, interface.law, threads=interface.threads)
