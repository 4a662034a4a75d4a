"""What points carry along directions in which supports hold their nodes."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Flags, Floats


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
