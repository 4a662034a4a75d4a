"""What friction can hold of a body: the upper bound of limit analysis, of forces that press it.

Where the forces that press a body on are known, friction balances its loads if and only if they
work less on every sliding motion than friction can dissipate in it [Drucker 1954]. The motion with
the smallest margin is found by weighted least squares, again and again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from anisocontact.base.array_types import Floats

#: Share of the velocity of points, squared, that may be along normals where a motion is sliding.
FLAT = 0.02
#: Work on a sliding motion, over that of the loads on all motions, that is none.
NONE = 1e-9
#: Iterations of the least squares, and the share of the largest velocity that is rounding.
ROUNDS, REST = 60, 1e-7
#: Corners of the polygon around the ellipse of friction, which touches it on its axes.
CORNERS = 32
#: Points up to which forces at them are looked for.
FEW = 2000


@dataclass(frozen=True)
class PressedPoints:
    """Points at which a body is pressed on what it touches.

    Attributes:
        arms: Places relative to a centre over a size, (n, 3).
        normal: Directions in which contact pushes the body, (n, 3).
        force: Normal forces, (n,).
        friction: `|friction v|` is what friction dissipates in a velocity v, over the normal
            force, (n, 3, 3).
    """

    arms: Floats
    normal: Floats
    force: Floats
    friction: Floats

    @classmethod
    def joined(cls, parts: Sequence[PressedPoints]) -> PressedPoints:
        """All points of several."""
        names = ("arms", "normal", "force", "friction")
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))

    def velocities(self, motions: Floats) -> Floats:
        """Of each point, (n, 3, k), in translations and turns times the size, (k, 6)."""
        spin = np.cross(motions[None, :, 3:], self.arms[:, None])
        return np.asarray((motions[None, :, :3] + spin).transpose(0, 2, 1))

    def sliding(self, motions: Floats) -> Floats:
        """Those of the motions in which no point moves along its normal, (j, 6)."""
        along = self.velocities(motions)
        normal = np.einsum("nik,ni->nk", along, self.normal)
        weights = self.force / max(self.force.sum(), np.finfo(float).tiny)
        into = np.einsum("n,nk,nl->kl", weights, normal, normal)
        every = np.einsum("n,nik,nil->kl", weights, along, along)
        every += REST * (np.trace(every) or 1.0) * np.eye(len(every))
        shares, mixed = scipy.linalg.eigh(into, every)
        kept = mixed[:, shares <= FLAT]
        return np.asarray(np.linalg.qr(kept)[0].T @ motions)


@dataclass(frozen=True)
class Limit:
    """The sliding motion in which friction holds least of the loads.

    Attributes:
        motion: Translation and turn times the size in which loads and normal forces work 1, (6,).
        held: What friction can dissipate in it: how many times these loads can be held.
    """

    motion: Floats
    held: float


def limit(points: PressedPoints, motions: Floats, load: Floats) -> Limit | None:
    """The sliding motion with the least margin; None where loads do not work on any.

    Args:
        points: Where the body is pressed on.
        motions: Motions that nothing but contact holds, orthonormal, (k, 6).
        load: Force, and moment about the centre over the size, (6,).
    """
    slides = points.sliding(motions)
    if not len(slides):
        return None
    along = points.velocities(slides)
    pushes = np.einsum("n,ni,nik->k", points.force, points.normal, along)
    driven = slides @ load + pushes
    if np.linalg.norm(driven) <= NONE * np.linalg.norm(load):
        return None
    rubs = np.einsum("nij,njk->nik", points.friction, along)
    mixed = driven / (driven @ driven)
    for _ in range(ROUNDS):
        speeds = np.linalg.norm(rubs @ mixed, axis=1)
        slow = REST * float(speeds.max(initial=0.0))
        weights = points.force / np.maximum(speeds, slow or 1.0)
        stiff = np.einsum("n,nik,nil->kl", weights, rubs, rubs)
        stiff += REST**2 * (np.trace(stiff) or 1.0) * np.eye(len(stiff))
        mixed = np.linalg.solve(stiff, driven)
        mixed /= driven @ mixed
    held = float(points.force @ np.linalg.norm(rubs @ mixed, axis=1))
    return Limit(mixed @ slides, held)


def withdrawal(points: PressedPoints, motions: Floats, load: Floats) -> Limit | None:
    """The motion with the least margin of those in which no point moves into what it touches.

    A wedge that is pulled out opens as it slides, so that it has no sliding motion. Normal forces
    fall as it goes: those of now hold more than any that come.

    Args:
        points: Where the body is pressed on.
        motions: Motions that nothing but contact holds, orthonormal, (k, 6).
        load: Force, and moment about the centre over the size, (6,).

    Returns:
        None where loads and normal forces do not work on any, or there are too many points.
    """
    along = points.velocities(motions)
    normal = np.einsum("ni,nik->nk", points.normal, along)
    driven = motions @ load + points.force @ normal
    size, count = float(np.linalg.norm(driven)), len(points.force)
    if count > FEW or size <= NONE * np.linalg.norm(load):
        return None
    rubs = np.einsum("njc,nck->njk", friction_polygons(points), along).reshape(-1, len(motions))
    speeds = scipy.sparse.kron(scipy.sparse.eye(count), np.ones((CORNERS, 1)))
    found = scipy.optimize.linprog(
        np.concatenate([np.zeros(len(motions)), points.force]),
        A_ub=scipy.sparse.block_array([[rubs, -speeds], [-normal, None]]).tocsr(),
        b_ub=np.zeros(len(rubs) + count),
        A_eq=np.concatenate([driven / size, np.zeros(count)])[None],
        b_eq=[1.0],
        bounds=[(None, None)] * len(motions) + [(0.0, None)] * count,
    )
    if not found.success:
        return None
    mixed = found.x[: len(motions)] / size
    held = np.linalg.norm(np.einsum("nij,njk,k->ni", points.friction, along, mixed), axis=1)
    return Limit(mixed @ motions, float(points.force @ held))


def friction_polygons(points: PressedPoints) -> Floats:
    """Largest forces of friction over the normal force, corners around its ellipse, (n, j, 3)."""
    _, widths, axes = np.linalg.svd(points.friction)
    turns = 2.0 * np.pi * (np.arange(CORNERS) + 0.5) / CORNERS
    corners = np.column_stack([np.cos(turns), np.sin(turns)]) / np.cos(np.pi / CORNERS)
    return np.asarray(np.einsum("ji,ni,nic->njc", corners, widths[:, :2], axes[:, :2]))
