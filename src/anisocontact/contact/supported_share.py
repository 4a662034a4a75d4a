"""What points carry along directions in which supports hold their nodes."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Codes, Flags, Floats, Ints
from anisocontact.base.statuses import SLIP, STICK

#: Trace of a projection on one direction, and more than that; it is 2 of two directions.
_ALONG_ONE = 1.5


def supported_share(
    traction: Floats,
    held: Floats,
    *,
    last: Floats,
    carried: Floats,
    normal: Floats,
    kept: Flags,
) -> Floats:
    """Tractions with a bound on what they are along supported directions.

    Equilibrium of a supported node leaves its traction along the support undetermined. A point that
    sticks keeps there what it had at the last accepted increment; one that slides carries at most
    the friction of the trial, and keeps that where it comes to stick: with what it had before it
    would slide again, and so on.

    Args:
        traction: Of the points, (n, 3), stress.
        held: Projections on the supported directions, (n, 3, 3).
        last: Tangential traction of the last accepted increment, (n, 3), stress.
        carried: Traction of the trial, (n, 3), stress.
        normal: Normals, (n, 3).
        kept: Which points stick and have not slid in this increment, (n,).

    Returns:
        The tractions, (n, 3), stress.
    """
    along = (held @ traction[..., None])[..., 0]
    before = (held @ last[..., None])[..., 0]
    pressure = np.einsum("nd,nd->n", carried, normal)
    most = np.linalg.norm(carried - pressure[:, None] * normal, axis=1)
    size = np.linalg.norm(along, axis=1)
    less = along * np.divide(most, size, out=np.ones_like(size), where=size > most)[:, None]
    return np.asarray(traction - along + np.where(kept[:, None], before, less))


def add_direction(held: Floats, points: Ints, direction: Floats, least: float) -> None:
    """Let projections of some points contain another direction.

    Args:
        held: Projections on the directions so far, (n, 3, 3), changed.
        points: Numbers of the points.
        direction: Unit vector, (3,).
        least: Size of what is beside the directions so far that counts as none.
    """
    rest = direction - held[points] @ direction
    size = np.linalg.norm(rest, axis=1)
    new = size > least
    unit = rest[new] / size[new][:, None]
    held[points[new]] += unit[:, :, None] * unit[:, None]


def at_rest(resting: Floats) -> Flags:
    """Points that rest along all of the surface, (n,).

    Nothing slips there: what a trial before equilibrium has slipped, as one that is extrapolated,
    would stay as friction.

    Args:
        resting: Projections on directions along the surface, (n, 3, 3).
    """
    return np.asarray(np.trace(resting, axis1=1, axis2=2) > _ALONG_ONE)


class SupportedPoints:
    """What supports take of the tractions of an increment.

    Args:
        count: How many points there are.
    """

    def __init__(self, count: int) -> None:
        self._slid: Flags = np.zeros(count, dtype=bool)

    def bounded(
        self,
        traction: Floats,
        held: Floats,
        *,
        status: Codes,
        still: Flags | bool = False,
        **others: Floats,
    ) -> Floats:
        """As of `supported_share`.

        Args:
            traction: Of the points, (n, 3), stress.
            held: Projections on the supported directions, (n, 3, 3).
            status: Of the points in the trial before, (n,).
            still: Which points cannot slide, whatever a trial says, (n,).
            **others: `last`, `carried` and `normal`.
        """
        self._slid = self._slid | (status == SLIP)
        kept = still | ((status == STICK) & ~self._slid)
        return supported_share(traction, held, kept=np.asarray(kept), **others)
