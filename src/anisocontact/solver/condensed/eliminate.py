"""Ways to eliminate the interior of a body, the fastest that this machine has first."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Protocol

import numpy as np
import numpy.typing as npt

from anisocontact.solver.condensed import mumps, pardiso
from anisocontact.solver.condensed.blocked import BlockedFactor

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]


class Eliminated(Protocol):
    """The interior of a symmetric positive definite matrix eliminated, its border left."""

    @property
    def schur(self) -> Floats:
        """Schur complement of the border, (c, c), symmetric; memory of the factor."""
        ...

    def interior(self, b: Floats) -> Floats:
        """Solutions with the interior, the border held at zero, (n, k)."""
        ...

    def close(self) -> None:
        """Give back the memory; `schur` must not be used any more."""
        ...


type Way = Callable[[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike, Ints], Eliminated]

#: Name of each way, whether it is there, and who goes it.
WAYS: tuple[tuple[str, Callable[[], bool], Way], ...] = (
    ("Pardiso of MKL", lambda: pardiso.routine() is not None, pardiso.PardisoFactor),
    ("MUMPS", mumps.reachable, mumps.MumpsFactor),
    ("PETSc, column by column", lambda: True, BlockedFactor),
)


@cache
def chosen() -> tuple[str, Way]:
    """The first way that is there: its name and who goes it."""
    return next((name, way) for name, there, way in WAYS if there())


class WholeBorder:
    """A matrix without interior, which is its own Schur complement.

    Args:
        matrix: The matrix, (c, c).
    """

    def __init__(self, matrix: Floats) -> None:
        self.schur = matrix

    def interior(self, b: Floats) -> Floats:
        """Zero, as all unknowns are of the border."""
        return np.zeros_like(b)

    def close(self) -> None:
        """Nothing to give back."""
