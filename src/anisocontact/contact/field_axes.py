"""Axes of polar and spiral fields, which have no direction there, beside slave points."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.anisotropy import DirectionField
from anisocontact.base.array_types import Floats
from anisocontact.interface import ContactLaw, Interface
from anisocontact.mesh.idealisation import Idealisation

#: Distance from an axis up to which a point lies on it, over the size of a facet.
ON = 1e-6
#: How far an axis is moved off points that lie on it, over the size of a facet: the directions of
#: their neighbours turn by as much, in radian.
OFF = 1e-4


def off_axes[L: (Interface, ContactLaw)](
    law: L, x: Floats, size: float, comm: Any, idealisation: Idealisation
) -> L:
    """The same laws with the axes of their fields beside the points that lie on them.

    Nodes of a mesh lie exactly on an axis where points of a quadrature do not, as the centre of a
    disc. There is no direction there, or what rounding makes of it; beside the axis there is one.
    An axisymmetric body, which has no slip there, keeps the directions of all other nodes: its axis
    is moved against their radius. Plane strain and stress keep their axes. Collective.

    Args:
        law: Laws, with or without a surface.
        x: Slave points, and nodes of facets that are met, of this process in the reference
            configuration, (n, 3), length.
        size: Of a facet, length.
        comm: Communicator of the mesh.
        idealisation: What the mesh is taken for.
    """
    axisymmetric = bool(idealisation.turn.any())
    if idealisation.dim == 2 and not axisymmetric:
        return law
    against = np.array([-1.0, 0.0, 0.0]) if axisymmetric else None
    moved: dict[int, DirectionField] = {}
    for one in law.carried:
        if one.field is not None and "axis" in one.field.named[1]:
            name, values = one.field.named
            beside = _beside(np.array(values["axis"]), x, size, comm, against)
            if beside is not None:
                moved[id(one.field)] = DirectionField(name, {**values, "axis": beside})
    return law.with_parts(moved) if moved else law


def _beside(
    axis: Floats, x: Floats, size: float, comm: Any, across: Floats | None
) -> list[float] | None:
    """An axis, point and direction in (6,), beside the points that lie on it; None if none does."""
    along = axis[3:] / np.linalg.norm(axis[3:])
    if not comm.allreduce(int((distances(axis, x) <= ON * size).sum())):
        return None
    if across is None:
        sizes = np.abs(along)
        across = np.cross(along, np.eye(3)[(sizes <= sizes.min() + ON).argmax()])
    return [*(axis[:3] + OFF * size * across / np.linalg.norm(across)), *along]


def distances(axis: Floats, x: Floats) -> Floats:
    """Distances of points from an axis, (n,), length.

    Args:
        axis: A point of it and its direction, (6,).
        x: Points, (n, 3), length.
    """
    along = axis[3:] / np.linalg.norm(axis[3:])
    return np.asarray(np.linalg.norm(np.cross(along, x - axis[:3]), axis=1))
