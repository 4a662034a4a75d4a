"""Limit of the force and adhesion domain of a row, from the laws the interface was made of."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.laws.domain import Strip, domain_from_tensors
from anisocontact.point.history import Records
from anisocontact.point.pictures.style import tangential_law

# Of a strip, which has no end, so many half-widths are drawn.
_STRIP = 6.0


def yield_ellipse(interface: Any, row: Records, pressure: float) -> Floats | None:
    """Limit of the force as products with the friction axes, (k, 2) [eq. (115)].

    None where the interface has no friction tensor, or the point is open.
    """
    friction = _friction(interface, row)
    if friction is None:
        return None
    frame = _frame(row)
    # The force limit is the domain of a surface of stiffness 1.
    domain = domain_from_tensors(np.eye(2), frame @ friction @ frame.T, pressure)
    assert not isinstance(domain, Strip)
    return np.asarray(domain.points() @ frame @ row["friction_axes"].T)


def adhesion_domain(interface: Any, row: Records) -> tuple[Floats, Floats] | None:
    """Elastic slip and its limit, (3,) and (k, 3) [eq. (116)].

    Of a strip, a part of both edges, and the slip across it: along it there is no centre. None but
    for elastic adhesion with a friction tensor, at a point that touches.
    """
    friction, adhesion = _friction(interface, row), _adhesion(interface, row)
    if friction is None or adhesion is None:
        return None
    frame = _frame(row)
    f, s = frame @ friction @ frame.T, frame @ adhesion @ frame.T
    domain = domain_from_tensors(s, f, float(row["pressure"]))
    if not isinstance(domain, Strip):
        return row["elastic"], np.asarray(domain.points() @ frame)
    first, second = domain.edges(_STRIP * domain.half_width) @ frame
    across = domain.matrix * domain.half_width**2  # n (x) n
    slip = frame.T @ across @ frame @ row["elastic"]
    return slip, np.concatenate([first, np.full((1, 3), np.nan), second])


def _friction(interface: Any, row: Records) -> Floats | None:
    """F in space, (3, 3)."""
    law = tangential_law(interface)
    friction = law.friction if law else None
    if friction is None or friction.frictionless or not row["status"]:
        return None
    return np.asarray(friction.tensor(interface.surface, row["xi"][None], "spatial")[0])


def _adhesion(interface: Any, row: Records) -> Floats | None:
    """S = -B in space, (3, 3)."""
    law = tangential_law(interface)
    adhesion = law.adhesion if law else None
    if adhesion is None or adhesion.named[0] != "elastic" or not row["status"]:
        return None
    axes = row["adhesion_axes"]
    stiffness = np.asarray(adhesion.named[1]["stiffness"], dtype=np.float64)
    tensor: Floats = np.einsum("a,ai,aj->ij", stiffness, axes, axes)
    return tensor


def _frame(row: Records) -> Floats:
    """Orthonormal vectors of the tangent plane, the first along the first friction axis, (2, 3)."""
    first = row["friction_axes"][0]
    return np.stack([first, np.cross(row["normal"], first)])
