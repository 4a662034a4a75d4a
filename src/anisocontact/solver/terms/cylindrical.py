"""Prescribed displacements along the directions of cylinder coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError, within
from anisocontact.base.load_curve import PrescribedValue, check_prescribed
from anisocontact.base.typed import typed
from anisocontact.mesh.placement import check_vector

#: Directions of cylinder coordinates, in this order.
COMPONENTS = ("radial", "tangential", "axial")
#: Share of a direction along an axis that counts as none; roundings of mesh files are below.
NO_SHARE = 1e-6


@typed
@dataclass(frozen=True)
class Cylindrical:
    """Displacement of a group along the directions of cylinder coordinates about an axis.

    `u . e = g` at every node, with e of where the node is in the reference configuration: radial
    away from the axis, axial along it, tangential right-handed about it.

    Args:
        values: Component "radial", "tangential" or "axial" -> displacement at the end of a step,
            length, a `LoadCurve`, or None, which frees it. What is not named is as it was.
        axis: Direction of the axis, of any length but zero.
        point: A point of the axis, length.

    Raises:
        InputError: An unknown component, no component, a value that is no number, or a wrong axis.

    Example:
        >>> Cylindrical({"radial": 0.1}).directions(np.array([[0.0, 2.0, 5.0]]))["radial"].tolist()
        [[0.0, 1.0, 0.0]]
    """

    values: Mapping[str, PrescribedValue | None]
    axis: Sequence[float] = (0.0, 0.0, 1.0)
    point: Sequence[float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not self.values:
            raise InputError(f"nothing given, at least one of {', '.join(COMPONENTS)} needed")
        for name, value in self.values.items():
            if name not in COMPONENTS:
                text = f"no component {name!r}, allowed: {', '.join(COMPONENTS)}"
                raise InputError(text, name)
            if value is not None:
                with within(name):
                    check_prescribed(value)
        check_vector("axis", self.axis)
        check_vector("point", self.point)
        if not np.any(self.axis):
            raise InputError(f"{tuple(self.axis)!r} given, must not be zero", "axis")

    @property
    def system(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Axis and point, to tell whether two are about the same."""
        return tuple(map(float, self.axis)), tuple(map(float, self.point))

    def directions(self, x: Floats) -> dict[str, Floats]:
        """Unit vectors at points.

        Args:
            x: The points, (n, 3), length.

        Returns:
            Component -> unit vectors, (n, 3); NaN where there are none, on the axis.
        """
        along = np.asarray(self.axis, dtype=float) / np.linalg.norm(self.axis)
        arm = x - np.asarray(self.point, dtype=float)
        away = arm - np.outer(arm @ along, along)
        distance = np.linalg.norm(away, axis=1)
        far = NO_SHARE * max(float(np.abs(arm).max(initial=0.0)), np.finfo(float).tiny)
        with np.errstate(invalid="ignore", divide="ignore"):
            radial = np.where(distance[:, None] > far, away / distance[:, None], np.nan)
        found = (radial, np.cross(along, radial), np.broadcast_to(along, x.shape))
        return dict(zip(COMPONENTS, map(_clean, found), strict=True))


def _clean(e: Floats) -> Floats:
    """Unit vectors without the roundings of those along the axes of space."""
    e = np.where(np.abs(e) < NO_SHARE, 0.0, e)
    return np.asarray(e / np.linalg.norm(e, axis=1)[:, None])
