"""Yield ellipse and adhesion ellipse of a row, from what the interface was made of."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.point.history import Table
from anisocontact.surfaces import Floats

_ANGLES = np.linspace(0.0, 2.0 * np.pi, 121)


def coefficients(interface: Any) -> Floats | None:
    """Friction coefficients along the two axes, (2,); None where the law has none."""
    named = getattr(getattr(interface, "friction", None), "named", None)
    values = named[1].get("coefficients") if named else None
    return None if values is None else np.asarray(values, dtype=np.float64)


def stiffness(interface: Any) -> Floats | None:
    """Tangential stiffness along the two axes, (2,); None where the law has none."""
    named = getattr(getattr(interface, "adhesion", None), "named", None)
    values = named[1].get("stiffness") if named and named[0] == "elastic" else None
    return None if values is None else np.asarray(values, dtype=np.float64)


def yield_ellipse(interface: Any, pressure: float) -> Floats | None:
    """Limit of T along the friction axes, (k, 2) [Konyukhov Schweizerhof 2006, eq. (115)]."""
    mu = coefficients(interface)
    if mu is None:
        return None
    return np.asarray(pressure * mu * np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1))


def adhesion_ellipse(interface: Any, row: Table) -> Floats | None:
    """Elastic slip at the limit, vectors (k, 3) [Konyukhov Schweizerhof 2006, eq. (116)].

    None for a strip, which has no end, and where the law has no ellipse.
    """
    limit, k = yield_ellipse(interface, float(row["pressure"])), stiffness(interface)
    if limit is None or k is None or not k.all() or not row["status"]:
        return None
    force = limit @ row["friction_axes"]
    lower = row["adhesion_axes"]
    # Along axes that are not orthogonal S = sum k_a e_a (x) e_a.
    tensor = np.einsum("a,ai,aj->ij", k, lower, lower)
    return np.asarray(-force @ np.linalg.pinv(tensor))
