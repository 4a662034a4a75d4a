"""Where a body stands: scaled, turned and moved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from anisocontact.base import registry
from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Parameter
from anisocontact.base.sizes import RANGE, out_of_range
from anisocontact.base.typed import typed
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.quality import check_cells

_ANGLE = Parameter("angle", "scalar", "angle", "angle of a rotation")


#: An angle that is not given.
_MISSING = math.nan


@typed
@dataclass(frozen=True)
class Rotation:
    """A rotation about an axis in space, right-handed.

    Attributes:
        axis: Direction of the axis, of any length but zero.
        angle: Angle, radian, at most a full turn.
        point: A point on the axis, length.
        angle_deg: The angle in degrees instead; None once it has been taken over.

    Raises:
        InputError: The axis is zero, a number is not finite, or the angle is missing, given twice
            or more than a full turn in radian.

    Example:
        >>> turn = Rotation((0, 0, 1), angle_deg=90.0)
        >>> turn.apply(np.array([[1.0, 0.0, 2.0]])).round(12).tolist()
        [[0.0, 1.0, 2.0]]
    """

    axis: Sequence[float]
    angle: float = _MISSING
    point: Sequence[float] = (0.0, 0.0, 0.0)
    angle_deg: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        check_vector("axis", self.axis)
        check_vector("point", self.point)
        if not any(self.axis):
            raise InputError(f"{list(self.axis)} given, must not be zero", "axis")
        radian = None if self.angle is _MISSING else self.angle
        given = registry.in_radian([_ANGLE], {"angle": radian, "angle_deg": self.angle_deg})
        if given["angle"] is None:
            raise InputError("missing; in radian, or angle_deg in degrees", "angle")
        object.__setattr__(self, "angle", given["angle"])
        object.__setattr__(self, "angle_deg", None)

    def matrix(self, share: float = 1.0) -> Floats:
        """Rotation matrix of a share of the angle, (3, 3).

        `R = I + sin(a) N + (1 - cos(a)) N^2` with `N x = n x x` (Rodrigues).

        Args:
            share: Share of the angle.

        Returns:
            The matrix, (3, 3).
        """
        n = np.asarray(self.axis, dtype=float)
        n = n / np.linalg.norm(n)
        cross = np.cross(n, np.eye(3)).T
        angle = share * self.angle
        turned = np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)
        return np.asarray(np.eye(3) + turned)

    def apply(self, points: Floats, share: float = 1.0) -> Floats:
        """Points turned by a share of the angle, (n, 3).

        Args:
            points: Points, (n, 3), length.
            share: Share of the angle.

        Returns:
            The points turned, (n, 3), length.
        """
        centre = np.asarray(self.point, dtype=float)
        return np.asarray(centre + (points - centre) @ self.matrix(share).T)


@typed
@dataclass(frozen=True)
class Placement:
    """First scaled about the origin, then turned, then moved.

    Attributes:
        scale: Factor of all lengths, > 0.
        rotate: Rotation, if there is one.
        move: Translation, length.

    Raises:
        InputError: The scale is not > 0, or a number is not finite.

    Example:
        >>> from anisocontact.mesh import Body, BoxSpec
        >>> box = BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))
        >>> placed = Body("block", box, Placement(scale=2.0, move=(0.0, 0.0, 5.0)))
        >>> placed.arrays().points.max(axis=0).tolist()
        [2.0, 2.0, 7.0]
    """

    scale: float = 1.0
    rotate: Rotation | None = None
    move: Sequence[float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not (math.isfinite(self.scale) and self.scale > 0.0):
            raise InputError(f"{self.scale!r} given, must be > 0", "scale")
        if out_of_range(self.scale):
            raise InputError(f"{self.scale!r} given, must be {RANGE}", "scale")
        check_vector("move", self.move)

    def apply(self, mesh: MeshArrays) -> MeshArrays:
        """The mesh where it is to stand.

        Args:
            mesh: The mesh where it was made.

        Returns:
            The mesh, with points and node groups moved; the one given is unchanged.

        Raises:
            InputError: Floating point cannot tell its nodes apart there.
        """
        if self == IN_PLACE:
            return mesh
        with np.errstate(over="ignore", invalid="ignore"):
            nodes = {name: self._placed(places) for name, places in mesh.nodes.items()}
            placed = replace(mesh, points=self._placed(mesh.points), nodes=nodes)
        try:
            check_cells(placed)
        except InputError as error:
            raise InputError(f"after scale, rotate and move {error}") from None
        return placed

    def _placed(self, points: Floats) -> Floats:
        points = self.scale * points
        if self.rotate is not None:
            points = self.rotate.apply(points)
        return np.asarray(points + np.asarray(self.move, dtype=float))


def check_vector(name: str, given: Sequence[float]) -> None:
    """Refuse what is not three finite numbers that can be computed with."""
    try:
        registry.check(Parameter(name, "vector", "1", ""), given, name)
    except InputError as error:
        text = f"{given!r} given, three finite numbers are needed"
        said = error.said if error.said.endswith(RANGE) else text
        raise InputError(said, name) from None


#: Nothing scaled, turned or moved.
IN_PLACE = Placement()
