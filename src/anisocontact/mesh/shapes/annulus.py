"""The annulus: the face of a ring in the plane z = 0, or a sector of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

from anisocontact.base.cells import IN_PLANE
from anisocontact.base.registry import Entry, Parameter
from anisocontact.mesh.lattice import Block
from anisocontact.mesh.shapes.ring import ZONES, RingSpec
from anisocontact.mesh.shapes.shape import (
    FACE,
    cells_parameter,
    check_shape,
    focus_parameter,
    ratio_parameter,
    zone_parameter,
)

_KEPT = ("inner", "outer", "start", "end")


@dataclass(frozen=True)
class AnnulusSpec:
    """An annulus around the origin, or a sector of it.

    Attributes:
        inner: Inner radius, > 0, length.
        outer: Outer radius, > inner, length.
        cells: Number through the wall and around; at least 3 around a whole annulus.
        cell: "quadrilateral" or "triangle".
        order: Order of the displacement, 1 or 2; cells of order 2 are curved.
        start: Angle at which the sector starts, from x towards y, radian.
        end: Angle at which it ends, > start, at most a full turn further; radian.
        ratio: Size of the last cell over the first, through the wall and around, > 0.
        focus: Size of the cells in the middle between start and end over that of those farthest
            from there, <= 1; instead of the second ratio.
        zone_wall: Where from the inner (0) to the outer radius (1) cells are fine, and how fine.
        zone_around: The same from start to end, instead of focus.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> from anisocontact.mesh import Body, PlaneStrain, build_mesh
        >>> arch = AnnulusSpec(inner=1.0, outer=2.0, cells=(1, 4), end=math.pi)
        >>> build_mesh([Body("arch", arch)], idealisation=PlaneStrain()).facet_names()
        ['arch.inner', 'arch.outer', 'arch.start', 'arch.end']
    """

    inner: float
    outer: float
    cells: Sequence[int]
    cell: str = "quadrilateral"
    order: int = 1
    start: float = 0.0
    end: float = 2.0 * math.pi
    ratio: Sequence[float] = (1.0, 1.0)
    focus: float = 1.0
    zone_wall: Sequence[float] = ()
    zone_around: Sequence[float] = ()

    curved: ClassVar[bool] = True
    entry: ClassVar[Entry] = Entry(
        "annulus",
        IN_PLANE,
        "An annulus around the origin in the plane z = 0, or a sector of it; facet groups inner "
        "and outer, of a sector also start and end.",
        (
            Parameter("inner", "scalar", "length", "inner radius", "positive"),
            Parameter("outer", "scalar", "length", "outer radius", "positive"),
            cells_parameter("through the wall", "around"),
            *(p for p in RingSpec.entry.parameters if p.name in ("start", "end")),
            ratio_parameter("through the wall", "around"),
            focus_parameter("in the middle between start and end"),
            *(zone_parameter(*zone) for zone in ZONES[:2]),
        ),
    )

    def __post_init__(self) -> None:
        check_shape(self)
        self.blocks()

    def blocks(self) -> list[Block]:
        """One block; see `Shape`."""
        ring = RingSpec(
            self.inner,
            self.outer,
            1.0,
            (*self.cells, 1),
            start=self.start,
            end=self.end,
            ratio=(*self.ratio, 1.0),
            focus=self.focus,
            zone_wall=self.zone_wall,
            zone_around=self.zone_around,
        )
        return [
            replace(
                block,
                sides={side: name for side, name in block.sides.items() if name in _KEPT}
                | {(2, 0): FACE},
            )
            for block in ring.blocks()
        ]
