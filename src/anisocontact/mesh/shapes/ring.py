"""The ring: a hollow cylinder, or a sector of one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from anisocontact.base import registry
from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Entry, Parameter
from anisocontact.mesh.lattice import Block, Side, focused
from anisocontact.mesh.shapes.shape import (
    cells_parameter,
    check_focus,
    check_shape,
    focus_parameter,
    full_circle,
    ratio_parameter,
    spaced,
    zone_parameter,
)

#: Directions with zones of fine cells.
ZONES = (("wall", "through the wall"), ("around", "around"), ("z", "along z"))


@dataclass(frozen=True)
class RingSpec:
    """A ring or hollow cylinder along z that stands on the origin, or a sector of it.

    Attributes:
        inner: Inner radius, > 0, length.
        outer: Outer radius, > inner, length.
        length: Length along z, > 0, length.
        cells: Number through the wall, around, along z; at least 3 around a whole ring.
        cell: "hexahedron" or "tetrahedron".
        order: Order of the displacement, 1 or 2; cells of order 2 are curved.
        start: Angle at which the sector starts, from x towards y, radian.
        end: Angle at which it ends, > start, at most a full turn further; radian.
        ratio: Size of the last cell over the first, through the wall, around and along z, > 0.
        focus: Size of the cells in the middle between start and end over that of those farthest
            from there, <= 1; instead of the second ratio.
        zone_wall: Where from the inner (0) to the outer radius (1) cells are fine, and how fine.
        zone_around: The same from start to end, instead of focus.
        zone_z: The same along z.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> quarter = RingSpec(inner=1.0, outer=2.0, length=1.0, cells=(1, 4, 1), end=math.pi / 2)
        >>> sorted(quarter.blocks()[0].sides.values())
        ['bottom', 'end', 'inner', 'outer', 'start', 'top']
    """

    inner: float
    outer: float
    length: float
    cells: Sequence[int]
    cell: str = "hexahedron"
    order: int = 1
    start: float = 0.0
    end: float = 2.0 * math.pi
    ratio: Sequence[float] = (1.0, 1.0, 1.0)
    focus: float = 1.0
    zone_wall: Sequence[float] = ()
    zone_around: Sequence[float] = ()
    zone_z: Sequence[float] = ()

    curved: ClassVar[bool] = True
    entry: ClassVar[Entry] = Entry(
        "ring",
        "shape",
        "A ring or hollow cylinder along z, its lower end around the origin, or a sector of it; "
        "facet groups inner, outer, bottom and top, of a sector also start and end.",
        (
            Parameter("inner", "scalar", "length", "inner radius", "positive"),
            Parameter("outer", "scalar", "length", "outer radius", "positive"),
            Parameter("length", "scalar", "length", "length along z", "positive"),
            cells_parameter("through the wall", "around", "along z"),
            Parameter(
                "start",
                "scalar",
                "angle",
                "angle at which a sector starts, from x towards y",
                default=(0.0,),
            ),
            Parameter(
                "end", "scalar", "angle", "angle at which a sector ends", default=(2.0 * math.pi,)
            ),
            ratio_parameter("through the wall", "around", "along z"),
            focus_parameter("in the middle between start and end"),
            *(zone_parameter(*zone) for zone in ZONES),
        ),
    )

    def __post_init__(self) -> None:
        check_shape(self)
        check_focus(self.focus)
        if self.focus != 1.0 and self.ratio[1] != 1.0:
            text = f"given with ratio {self.ratio[1]:g} around, one of the two"
            raise InputError(text, "focus")
        if self.focus != 1.0 and len(self.zone_around):
            raise InputError("given with focus, one of the two", "zone_around")
        if not self.inner < self.outer:
            text = f"{self.outer:g} given, must be > inner, {self.inner:g}"
            raise InputError(text, "outer")
        if not 0.0 < self._turn <= 2.0 * math.pi * (1.0 + 1e-12):
            given, start = math.degrees(self.end), math.degrees(self.start)
            text = f"{given:g} given, must be > start, {start:g}, and at most 360 more"
            slip = "; in Python end is in radian" if self.end > registry.FULL_TURN else ""
            raise InputError(text + slip, "end_deg")
        if full_circle(self._turn) and self.cells[1] < 3:
            text = f"{self.cells[1]} cells around a whole ring given, at least 3 needed"
            raise InputError(text, "cells")
        if self._turn / self.cells[1] >= math.pi:
            text = f"{self.cells[1]} cells around {math.degrees(self._turn):g} degrees given, more "
            raise InputError(f"{text}needed", "cells")
        self.blocks()

    @property
    def _turn(self) -> float:
        return self.end - self.start

    def blocks(self) -> list[Block]:
        """One block; see `Shape`."""
        names = [name for name, _ in ZONES]
        wall, around, along = (
            spaced(self, *way) for way in zip(names, self.cells, self.ratio, strict=True)
        )
        around = around if self.focus == 1.0 else focused(self.cells[1], self.focus)
        sides: dict[Side, str] = {
            (0, 0): "inner",
            (0, 1): "outer",
            (2, 0): "bottom",
            (2, 1): "top",
        }
        if not full_circle(self._turn):
            sides |= {(1, 0): "start", (1, 1): "end"}
        return [Block((wall, around, along), self._place, sides)]

    def _place(self, share: Floats) -> Floats:
        s, t, z = share.T
        radius, angle = self.inner + (self.outer - self.inner) * s, self.start + self._turn * t
        return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), self.length * z])
