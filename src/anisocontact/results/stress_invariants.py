"""Equivalent and principal stresses of components that files have."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats

#: Places of the components XX YY ZZ XY YZ XZ in a matrix.
_TENSOR = [[0, 3, 5], [3, 1, 4], [5, 4, 2]]


def von_mises(stress: Floats) -> Floats:
    """Equivalent stress of (n, 6) components XX YY ZZ XY YZ XZ, (n,)."""
    xx, yy, zz, xy, yz, xz = stress.T
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * normal + 3.0 * (xy**2 + yz**2 + xz**2)))


def principal(stress: Floats) -> Floats:
    """Principal stresses of (n, 6) components XX YY ZZ XY YZ XZ, the largest first, (n, 3).

    A node on a cell whose stress is no number there, being inverted at that node, has none.
    """
    known = np.isfinite(stress).all(axis=1)
    found = np.full((len(stress), 3), np.nan)
    found[known] = np.linalg.eigvalsh(stress[known][:, _TENSOR])[:, ::-1]
    return found
