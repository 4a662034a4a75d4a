"""Limit of the force and adhesion domain of a row, from the laws the interface was made of."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.point.history import Table
from anisocontact.surfaces import Floats

_ANGLES = np.linspace(0.0, 2.0 * np.pi, 121)
# Of a strip, which has no end, so many half-widths are drawn.
_STRIP = 3.0


def friction_tensor(interface: Any, row: Table) -> Floats | None:
    """F in space, (3, 3); None where the interface has no friction tensor."""
    friction = getattr(interface, "friction", None)
    if friction is None or not row["status"]:
        return None
    return np.asarray(friction.tensor(interface.surface, row["xi"][None], "spatial")[0])


def adhesion_tensor(interface: Any, row: Table) -> Floats | None:
    """S = -B of elastic adhesion in space, (3, 3); None for other models."""
    named = getattr(getattr(interface, "adhesion", None), "named", None)
    if named is None or named[0] != "elastic" or not row["status"]:
        return None
    axes, stiffness = row["adhesion_axes"], np.asarray(named[1]["stiffness"], dtype=np.float64)
    tensor: Floats = np.einsum("a,ai,aj->ij", stiffness, axes, axes)
    return tensor


def yield_ellipse(interface: Any, row: Table, pressure: float) -> Floats | None:
    """Limit of the force as products with the friction axes, (k, 2) [eq. (115)]."""
    friction = friction_tensor(interface, row)
    if friction is None:
        return None
    return np.asarray(_limit(friction, pressure) @ row["friction_axes"].T)


def adhesion_domain(interface: Any, row: Table) -> Floats | None:
    """Elastic slip at the limit, (k, 3) [eq. (116)].

    An ellipse; where one stiffness is zero, a part of both edges of the strip.
    """
    friction, adhesion = friction_tensor(interface, row), adhesion_tensor(interface, row)
    if friction is None or adhesion is None:
        return None
    pressure = float(row["pressure"])
    values, vectors = np.linalg.eigh(adhesion)
    if values[1] > 1e-12 * values[2]:
        return np.asarray(-_limit(friction, pressure) @ np.linalg.pinv(adhesion))
    across = vectors[:, 2]
    half = pressure / (values[2] * np.sqrt(across @ friction @ across))
    along = _STRIP * half * np.cross(row["normal"], across)
    edge = np.stack([half * across - along, half * across + along])
    return np.concatenate([edge, np.full((1, 3), np.nan), -edge])


def _limit(friction: Floats, pressure: float) -> Floats:
    """Tangential forces at the limit, (k, 3)."""
    values, vectors = np.linalg.eigh(friction)
    # The smallest eigenvalue, zero, is that of the normal.
    semi = pressure / np.sqrt(values[1:]) * vectors[:, 1:]
    circle = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1)
    return np.asarray(circle @ semi.T)
