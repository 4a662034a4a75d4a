"""Ways to eliminate the interior of a body, the fastest that this machine has first."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import override

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.solver.strategies.condensed import mumps, pardiso
from anisocontact.solver.strategies.condensed.blocked import BlockedFactor
from anisocontact.solver.strategies.condensed.factor import Eliminated, Eliminator

#: Name of each way, whether it is there, and who goes it.
WAYS: tuple[tuple[str, Callable[[], bool], Eliminator], ...] = (
    ("Pardiso of MKL", lambda: pardiso.routine() is not None, pardiso.PardisoFactor),
    ("MUMPS", mumps.reachable, mumps.MumpsFactor),
    ("PETSc, column by column", lambda: True, BlockedFactor),
)


@cache
def chosen() -> tuple[str, Eliminator]:
    """The first way that is there: its name and who goes it."""
    return next((name, way) for name, there, way in WAYS if there())


class WholeBorder(Eliminated):
    """A matrix without interior, which is its own Schur complement.

    Args:
        matrix: The matrix, (c, c).
    """

    def __init__(self, matrix: Floats) -> None:
        self.schur = matrix

    @override
    def interior(self, b: Floats) -> Floats:
        return np.zeros_like(b)

    @override
    def close(self) -> None:
        pass
