"""Symmetric tensors as vectors of six, the way laws of other packages have them.

Mandel's notation: `11, 22, 33, sqrt(2) 12, sqrt(2) 13, sqrt(2) 23`, an orthonormal basis, so that
products of vectors are those of tensors. dolfinx-external-operator's return mappings and MFront's
behaviours have their strains, stresses and tangents in it.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats
from anisocontact.base.arrays import rows_of


def _basis() -> Floats:
    """The six tensors, (6, 3, 3)."""
    out = np.zeros((6, 3, 3))
    for k, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]):
        out[k, i, j] = out[k, j, i] = 1.0 if i == j else np.sqrt(0.5)
    return out


_BASIS = _basis()


def to_mandel(tensors: npt.ArrayLike) -> Floats:
    """Vectors of symmetric tensors.

    Args:
        tensors: The tensors, (n, 3, 3).

    Returns:
        The vectors, (n, 6), in the same unit.

    Raises:
        InputError: Another shape was given, or something else than numbers.

    Example:
        >>> shear = np.array([[[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 3.0]]])
        >>> to_mandel(shear).round(3).tolist()
        [[0.0, 0.0, 3.0, 1.414, 0.0, 0.0]]
    """
    return np.asarray(np.einsum("nij,aij->na", rows_of(tensors, (3, 3), "tensors"), _BASIS))


def from_mandel(vectors: npt.ArrayLike) -> Floats:
    """Symmetric tensors of vectors.

    Args:
        vectors: The vectors, (n, 6).

    Returns:
        The tensors, (n, 3, 3), in the same unit.

    Raises:
        InputError: Another shape was given, or something else than numbers.

    Example:
        >>> from_mandel(np.array([[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]]))[0].tolist()
        [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    """
    return np.asarray(np.einsum("na,aij->nij", rows_of(vectors, (6,), "vectors"), _BASIS))


def slope_from_mandel(matrices: npt.ArrayLike) -> Floats:
    """Derivatives of symmetric tensors by symmetric tensors.

    Args:
        matrices: Derivatives of vectors by vectors, (n, 6, 6).

    Returns:
        The derivatives, (n, 3, 3, 3, 3), symmetric in the last two indices.

    Raises:
        InputError: Another shape was given, or something else than numbers.

    Example:
        >>> unit = slope_from_mandel(np.eye(6)[None])[0]
        >>> float(unit[0, 1, 0, 1].round(9)), float(unit[0, 0, 0, 0])
        (0.5, 1.0)
    """
    matrices = rows_of(matrices, (6, 6), "matrices")
    return np.asarray(np.einsum("nab,aij,bkl->nijkl", matrices, _BASIS, _BASIS, optimize=True))
