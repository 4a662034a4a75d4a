"""Points that are rigidly linked: where they are and how they move with their reference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.sizes import check_size
from anisocontact.base.typed import typed
from anisocontact.point.foot import Foot

#: What a group may do with its orientation.
ORIENTATIONS = ("held", "surface", "free")


@typed
class Group:
    """Points at fixed places of a rigid body, which is loaded at its reference.

    Args:
        offsets: Places of the points relative to the reference [length]: (n, 3) in space, or
            (n, 2) in the tangent plane at the start, along the first coordinate line and across
            it.
        areas: Area each point stands for, one number or (n,) [area]; with 1 a stiffness of a
            spring or a dashpot is one per area, and a force is a stress.
        orientation: "held" keeps its orientation in space, "surface" turns with the normal under
            the reference, "free" also turns about that normal, free of moment.

    Raises:
        InputError: An array of another shape, an area that is not positive, a number that cannot
            be computed with, an unknown word.

    Example:
        >>> Group([(0, 0, 0), (1, 0, 0)], areas=0.5).areas
        array([0.5, 0.5])
    """

    def __init__(
        self,
        offsets: npt.ArrayLike = ((0.0, 0.0, 0.0),),
        *,
        areas: npt.ArrayLike = 1.0,
        orientation: str = "held",
    ) -> None:
        self.offsets = np.atleast_2d(np.asarray(offsets, dtype=np.float64))
        if self.offsets.ndim != 2 or self.offsets.shape[1] not in (2, 3):
            raise InputError(
                f"an array of shape {np.shape(offsets)} given, (n, 2) or (n, 3) needed",
                field="offsets",
            )
        if not np.isfinite(self.offsets).all():
            raise InputError(f"{offsets!r} given, finite numbers are needed", field="offsets")
        check_size("offsets", self.offsets)
        n = len(self.offsets)
        a = np.asarray(areas, dtype=np.float64)
        if a.shape not in ((), (n,)) or not (np.isfinite(a) & (a > 0.0)).all():
            raise InputError(f"{areas!r} given, one number or {n} > 0 needed", field="areas")
        check_size("areas", a, zero=False)
        self.areas: Floats = np.full(n, a) if a.ndim == 0 else a
        if orientation not in ORIENTATIONS:
            raise InputError(
                f"{orientation!r} given, allowed: {', '.join(ORIENTATIONS)}", field="orientation"
            )
        if orientation == "free" and not self.offsets.any():
            raise InputError(
                "a free orientation needs points away from the reference", field="orientation"
            )
        self.orientation = orientation

    def arms(self, at: Foot) -> Floats:
        """Offsets in space at the start.

        Args:
            at: Foot of the reference.

        Returns:
            The offsets, (n, 3), length; given in two components they lie in the tangent plane
            there.
        """
        if self.offsets.shape[1] == 3:
            return np.asarray(self.offsets)
        first = at.basis[0] / np.linalg.norm(at.basis[0])
        return np.asarray(self.offsets @ np.stack([first, np.cross(at.normal, first)]))


@dataclass(frozen=True)
class Arms:
    """Arms from the reference to the points and their derivatives.

    Args:
        vectors: Arms, (n, 3) [length].
        d_position: d(arm)/d(reference), (n, 3, 3).
        d_turn: d(arm)/d(turn about the normal), (n, 3, 1); (n, 3, 0) unless it
            is free.
    """

    vectors: Floats
    d_position: Floats
    d_turn: Floats


def turned_arms(orientation: str, arms: Floats, before: Foot, now: Foot, turn: float) -> Arms:
    """The arms of a step: turned with the normal, then about it.

    Args:
        orientation: One of `ORIENTATIONS`.
        arms: Committed arms, (n, 3).
        before: Committed foot of the reference.
        now: Foot of the reference.
        turn: Turn about the normal in this step, radians.

    Returns:
        Arms and derivatives. v - c (n_0 + n) + 2 (v.n_0) n with c = v.(n_0 + n)/(1 + n_0.n) takes
        n_0 to n by the least rotation.
    """
    n = len(arms)
    if orientation == "held" or not arms.any():
        return Arms(arms, np.zeros((n, 3, 3)), np.zeros((n, 3, 0)))
    n0, n1, w = before.normal, now.normal, now.d_normal
    s, both, up = 1.0 + n0 @ n1, n0 + n1, arms @ n0
    c = (arms @ both) / s
    v = arms - np.outer(c, both) + 2.0 * np.outer(up, n1)
    dc = (arms @ w) / s - np.outer(c, n0 @ w) / s
    dv = -np.einsum("i,nj->nij", both, dc) + (2.0 * up - c)[:, None, None] * w
    if orientation == "surface":
        return Arms(v, dv, np.zeros((n, 3, 0)))
    cos, sin = np.cos(turn), np.sin(turn)
    u = cos * v + sin * np.cross(n1, v) + (1.0 - cos) * up[:, None] * n1
    spin = np.stack([np.cross(n1, dv[:, :, j]) + np.cross(w[:, j], v) for j in range(3)], axis=2)
    du = cos * dv + sin * spin + (1.0 - cos) * up[:, None, None] * w
    return Arms(u, du, np.cross(n1, u)[:, :, None])
