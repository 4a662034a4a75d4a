"""Pressures of cells as unknowns of their own in Newton's method.

A correction du leads a pressure p to `C^-1 (e + B du)`, of which a share of the correction takes
the same share: `p + s (C^-1 (e + B du) - p)`, with e the change of volume at the last iterate and B
its derivative. Pressures are kept here by the changes of volume C p that they stand for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Mat, Vec


class FollowedPressures:
    """Changes of volume that the pressures in tangents stand for, while they follow corrections.

    Args:
        u: Displacement, a DOLFINx function.
        slope: B, derivatives of the changes of volume at the last tangent.
        changes: Gives the changes of volume of now, (cells, pressures of a cell, 1).
        near: Whether pressures of some changes of volume are near those of others; collective.
        hardness: Gives the stiffness against changes of volume over that against changes of shape
            of every pressure, in the shape of the changes.
    """

    def __init__(
        self,
        u: Any,
        slope: Mat,
        changes: Callable[[], Floats],
        near: Callable[[Floats, Floats], bool],
        hardness: Callable[[], Floats],
    ) -> None:
        self._u, self._slope, self._changes = u, slope, changes
        self._near, self._hardness = near, hardness
        self._linear: tuple[Vec, Floats] | None = None
        self._first = self._taken = False
        self._share: float | None = None
        #: C p of the last tangent; None where pressures are those of the displacement.
        self.in_tangent: Floats | None = None

    @property
    def active(self) -> bool:
        """Whether they follow."""
        return self._linear is not None

    def follow(self, begin: bool) -> None:
        """Let pressures follow from the displacement of now on, or not.

        Args:
            begin: Whether they do.
        """
        self._linear = self._here() if begin else None
        self._first, self._taken, self.in_tangent = begin, False, None

    def for_tangent(self) -> Floats:
        """C p of the tangent at the displacement of now: where the last correction has led to.

        The first one is that of the state where `follow` was called, unless that of now is near.
        """
        assert self._linear is not None
        if self._first:
            now, accepted = self._changes(), self._linear[1]
            self.in_tangent = now if self._near(now, accepted) else accepted
        elif not self._taken:
            self.in_tangent = self._led(1.0)
        self._first = self._taken = False
        assert self.in_tangent is not None
        return self.in_tangent

    def linearise(self) -> None:
        """Take it that B is that of now."""
        if self.active:
            self._linear = self._here()

    def of_residual(self, now: Floats) -> Floats:
        """C p of a residual where changes of volume are these.

        That is themselves. In a `trial` it is where the correction has led p to, and of what is
        left of the change of volume, `e - C p`, the share that makes it count as much as a strain
        of the shape.
        """
        if self._share is None:
            return now
        led = self._led(self._share)
        return np.asarray(led + (now - led) / np.maximum(self._hardness(), 1.0))

    @contextmanager
    def trial(self, share: float) -> Iterator[None]:
        """Inside, residuals are those of the mixed form after a share of a correction."""
        self._share = share
        try:
            yield
        finally:
            self._share = None

    def take(self, share: float) -> None:
        """Take it that this share of the correction is taken, which leads to where u is now."""
        self.in_tangent, self._taken = self._led(share), True

    def _led(self, share: float) -> Floats:
        assert self._linear is not None
        u, change = self._linear
        more = self._slope.createVecLeft()
        self._slope.mult(self._u.x.petsc_vec - u, more)
        before = change if self.in_tangent is None else self.in_tangent
        led = (1.0 - share) * before + share * change + more.array_r.reshape(change.shape)
        return np.asarray(led)

    def _here(self) -> tuple[Vec, Floats]:
        """Displacement and changes of volume of now."""
        return self._u.x.petsc_vec.copy(), self._changes()
