"""The dome: a round block with a spherical end, a segment of a ball on a cylinder."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Entry, Parameter
from anisocontact.mesh.lattice import Block
from anisocontact.mesh.shapes.disc import (
    PARTS,
    check_disc,
    disc_blocks,
    disc_parameters,
    disc_planes,
)


@dataclass(frozen=True)
class DomeSpec:
    """A round block along z whose lower end is a segment of a ball; it touches z = 0 in the origin.

    A segment that ends in a sharp edge would have degenerate cells there; this one has a wall.

    Attributes:
        radius: Radius of the ball, > rim, length.
        rim: Radius of the wall, > 0, length.
        height: Height on the axis, more than the segment is high; length.
        cells: Number around the whole (a multiple of 4, of 8 for parts), from the inner square to
            the wall, along z.
        cell: "hexahedron" or "tetrahedron".
        order: Order of the displacement, 1 or 2; cells of order 2 are curved.
        ratio: Size of the last cell over the first, to the wall and along z, > 0.
        core: Distance of the corners of the inner square from the axis over the rim, < 1.
        part: "whole", "half" (x >= 0) or "quarter" (also y >= 0).
        zone_out: Where between square (0) and rim (1) cells are fine, and how fine.
        zone_z: The same along z.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> len(DomeSpec(radius=5.0, rim=1.0, height=1.0, cells=(8, 2, 2)).blocks())
        5
    """

    radius: float
    rim: float
    height: float
    cells: Sequence[int]
    cell: str = "hexahedron"
    order: int = 1
    ratio: Sequence[float] = (1.0, 1.0)
    core: float = 0.5
    part: str = "whole"
    zone_out: Sequence[float] = ()
    zone_z: Sequence[float] = ()

    curved: ClassVar[bool] = True
    entry: ClassVar[Entry] = Entry(
        "dome",
        "shape",
        "A round block along z whose lower end is a segment of a ball with its lowest point in the "
        "origin; facet groups bottom (the sphere), outer (the wall) and top, of a half (x >= 0) "
        "also left, of a quarter (y >= 0) also front.",
        (
            Parameter("radius", "scalar", "length", "radius of the ball", "positive"),
            Parameter("rim", "scalar", "length", "radius of the wall", "positive"),
            Parameter("height", "scalar", "length", "height on the axis", "positive"),
            *disc_parameters(),
        ),
    )

    def __post_init__(self) -> None:
        check_disc(self, self.cells, self.core, self.part)
        if not self.rim < self.radius:
            raise InputError(f"{self.rim:g} given, must be < radius, {self.radius:g}", "rim")
        segment = self.radius - math.sqrt(self.radius**2 - self.rim**2)
        if not self.height > segment:
            text = f"{self.height:g} given, must be > {segment:g}, the height of the segment"
            raise InputError(text, "height")
        self.blocks()

    def blocks(self) -> list[Block]:
        """A square and four blocks around it; see `Shape`."""
        planes, part = disc_planes(self, self.cells, self.ratio), PARTS[self.part]
        return disc_blocks(self.cells[0], planes, self.core, self._place, part)

    def _place(self, p: Floats) -> Floats:
        plane = self.rim * p[:, :2]
        squared = np.einsum("ni,ni->n", plane, plane)
        # Of small angles without cancellation: R - sqrt(R^2 - r^2).
        low = squared / (self.radius + np.sqrt(self.radius**2 - squared))
        return np.column_stack([plane, low + p[:, 2] * (self.height - low)])
