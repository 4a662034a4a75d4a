"""The solid cylinder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from anisocontact.base.registry import Entry, Parameter
from anisocontact.mesh.lattice import Block
from anisocontact.mesh.shapes.disc import (
    PARTS,
    check_disc,
    disc_blocks,
    disc_parameters,
    disc_planes,
)
from anisocontact.mesh.shapes.shape import check_focus, focus_parameter


@dataclass(frozen=True)
class CylinderSpec:
    """A solid cylinder along z that stands on the origin.

    Attributes:
        radius: Radius, > 0, length.
        length: Length along z, > 0, length.
        cells: Number around the whole (a multiple of 4, of 8 for parts), from the inner square to
            the rim, along z.
        cell: "hexahedron" or "tetrahedron".
        order: Order of the displacement, 1 or 2; cells of order 2 are curved.
        ratio: Size of the last cell over the first, to the rim and along z, > 0.
        core: Distance of the corners of the inner square from the axis over the radius, < 1.
        part: "whole", "half" (x >= 0) or "quarter" (also y >= 0).
        focus: Size of the cells at the lines x = 0 over that of those farthest from there, <= 1.
        zone_out: Where between square (0) and rim (1) cells are fine, and how fine.
        zone_z: The same along z.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> from anisocontact.mesh import Body, build_mesh
        >>> roll = CylinderSpec(radius=0.5, length=2.0, cells=(8, 1, 2), order=2)
        >>> build_mesh([Body("roll", roll)]).facet_names()
        ['roll.bottom', 'roll.top', 'roll.outer']
    """

    radius: float
    length: float
    cells: Sequence[int]
    cell: str = "hexahedron"
    order: int = 1
    ratio: Sequence[float] = (1.0, 1.0)
    core: float = 0.5
    part: str = "whole"
    focus: float = 1.0
    zone_out: Sequence[float] = ()
    zone_z: Sequence[float] = ()

    curved: ClassVar[bool] = True
    entry: ClassVar[Entry] = Entry(
        "cylinder",
        "shape",
        "A solid cylinder along z, its lower end around the origin; facet groups outer, bottom "
        "and top, of a half (x >= 0) also left, of a quarter (y >= 0) also front.",
        (
            Parameter("radius", "scalar", "length", "radius", "positive"),
            Parameter("length", "scalar", "length", "length along z", "positive"),
            *disc_parameters(),
            focus_parameter("at the lines x = 0"),
        ),
    )

    def __post_init__(self) -> None:
        check_disc(self, self.cells, self.core, self.part)
        check_focus(self.focus)
        self.blocks()

    def blocks(self) -> list[Block]:
        """A square and four blocks around it; see `Shape`."""
        size = np.array([self.radius, self.radius, self.length])
        part = PARTS[self.part]
        place, focus = (lambda p: p * size), self.focus
        planes = disc_planes(self, self.cells, self.ratio)
        return disc_blocks(self.cells[0], planes, self.core, place, part, focus=focus)
