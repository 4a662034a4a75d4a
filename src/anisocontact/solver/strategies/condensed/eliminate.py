"""Ways to eliminate the interior of a body, the fastest that this machine has first."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import override

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.solver.strategies.condensed import multifrontal, mumps, pardiso
from anisocontact.solver.strategies.condensed.blocked import BlockedFactor
from anisocontact.solver.strategies.condensed.factor import Eliminated, Way

_OF_FRONTS: Way = multifrontal.MultifrontalFactor
#: Name of each way, whether it is there, and who goes it.
WAYS: tuple[tuple[str, Callable[[], bool], Way], ...] = (
    ("Pardiso of MKL", lambda: pardiso.routine() is not None, pardiso.PardisoFactor),
    ("fronts", multifrontal.reachable, _OF_FRONTS),
    ("MUMPS", mumps.reachable, mumps.MumpsFactor),
    ("PETSc, column by column", lambda: True, BlockedFactor),
)
#: Square of the border over all unknowns from which on fronts are so large that what is done beside
#: their products does not count: 30 to 160 in space, where they take 0.8 of the time of MUMPS, 1 to
#: 4 in the plane, where they take longer.
_LARGE = 10.0


def chosen(unknowns: int, border: int) -> tuple[str, Way]:
    """The first way that is there: its name and who goes it.

    Args:
        unknowns: Unknowns of a body, with those of the border.
        border: Unknowns that stay.
    """
    small = border**2 < _LARGE * unknowns
    ways = [(name, way) for name, way in _there() if not (small and way is _OF_FRONTS)]
    return ways[0]


@cache
def _there() -> list[tuple[str, Way]]:
    return [(name, way) for name, there, way in WAYS if there()]


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
