"""Shapes in the plane z = 0: the face of a body in space that is one cell thick."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

from anisocontact.base.cells import IN_PLANE
from anisocontact.base.registry import Entry, Parameter
from anisocontact.mesh.lattice import Block, Side, even
from anisocontact.mesh.shapes.box import BoxSpec, planes_parameter
from anisocontact.mesh.shapes.disc import AROUND, PARTS, Ranges, check_disc, disc_blocks
from anisocontact.mesh.shapes.shape import (
    FACE,
    cells_parameter,
    check_focus,
    check_shape,
    core_parameter,
    focus_parameter,
    part_parameter,
    ratio_parameter,
    spaced,
    zone_parameter,
)

_SIDES: dict[Side, str] = {
    (0, 0): "left",
    (0, 1): "right",
    (1, 0): "bottom",
    (1, 1): "top",
    (2, 0): FACE,
}
_PARTS: dict[str, Ranges] = PARTS | {"quarter": ((0, 1), (-1, 0))}


@dataclass(frozen=True)
class RectangleSpec:
    """A rectangle parallel to the axes x and y.

    Attributes:
        origin: Lowest corner, (2,), length.
        size: Edge lengths, > 0, length.
        cells: Number of cells along x and y, >= 1.
        cell: "quadrilateral" or "triangle".
        order: Order of the displacement, 1 or 2.
        ratio: Size of the last cell over that of the first along x and y, > 0.
        planes_x: Lines of nodes along x as shares of the size, from 0 to 1; none: as `ratio` says.
        planes_y: The same along y.
        zone_x: Where along x cells are fine, as a share of the size, and how fine; none: nowhere.
        zone_y: The same along y.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> from anisocontact.mesh import Axisymmetric, Body, build_mesh
        >>> disc = RectangleSpec(origin=(0, 0), size=(2, 1), cells=(4, 2))
        >>> build_mesh([Body("disc", disc)], idealisation=Axisymmetric()).facet_names()
        ['disc.left', 'disc.right', 'disc.bottom', 'disc.top']
    """

    origin: Sequence[float]
    size: Sequence[float]
    cells: Sequence[int]
    cell: str = "quadrilateral"
    order: int = 1
    ratio: Sequence[float] = (1.0, 1.0)
    planes_x: Sequence[float] = ()
    planes_y: Sequence[float] = ()
    zone_x: Sequence[float] = ()
    zone_y: Sequence[float] = ()

    curved: ClassVar[bool] = False
    entry: ClassVar[Entry] = Entry(
        "rectangle",
        IN_PLANE,
        "A rectangle parallel to the axes, in the plane z = 0; facet groups left, right (x- and "
        "x+), bottom and top (y- and y+).",
        (
            Parameter("origin", "pair", "length", "lowest corner"),
            Parameter("size", "pair", "length", "edge lengths", "positive"),
            cells_parameter("along x", "along y"),
            ratio_parameter("along x", "along y"),
            *map(planes_parameter, ("x", "y")),
            *(zone_parameter(axis, f"along {axis}") for axis in ("x", "y")),
        ),
    )

    def __post_init__(self) -> None:
        check_shape(self)
        self.blocks()

    def blocks(self) -> list[Block]:
        """One block; see `Shape`."""
        box = BoxSpec(
            (*self.origin, 0.0),
            (*self.size, 1.0),
            (*self.cells, 1),
            ratio=(*self.ratio, 1.0),
            planes_x=self.planes_x,
            planes_y=self.planes_y,
            zone_x=self.zone_x,
            zone_y=self.zone_y,
        )
        return [replace(block, sides=_SIDES) for block in box.blocks()]


@dataclass(frozen=True)
class DiscSpec:
    """A disc around the origin, or the part of it with x >= 0, then y <= 0.

    Attributes:
        radius: Radius, > 0, length.
        cells: Number around the whole (a multiple of 4, of 8 for parts), and from the inner square
            to the rim.
        cell: "quadrilateral" or "triangle".
        order: Order of the displacement, 1 or 2; cells of order 2 are curved.
        ratio: Size of the cell at the rim over that at the square, > 0.
        core: Distance of the corners of the inner square from the middle over the radius, < 1.
        part: "whole", "half" or "quarter".
        focus: Size of the cells at the points x = 0 over that of those farthest from there, <= 1.
        zone_out: Where between square (0) and rim (1) cells are fine, and how fine.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> from anisocontact.mesh import Axisymmetric, Body, build_mesh
        >>> ball = DiscSpec(radius=1.0, cells=(8, 1), part="half")
        >>> build_mesh([Body("ball", ball)], idealisation=Axisymmetric()).facet_names()
        ['ball.left', 'ball.outer']
    """

    radius: float
    cells: Sequence[int]
    cell: str = "quadrilateral"
    order: int = 1
    ratio: float = 1.0
    core: float = 0.5
    part: str = "whole"
    focus: float = 1.0
    zone_out: Sequence[float] = ()

    curved: ClassVar[bool] = True
    entry: ClassVar[Entry] = Entry(
        "disc",
        IN_PLANE,
        "A disc around the origin in the plane z = 0, or a part of it; facet groups outer, of a "
        "half (x >= 0) also left, of a quarter (y <= 0) also top.",
        (
            Parameter("radius", "scalar", "length", "radius", "positive"),
            cells_parameter(AROUND, "from the inner square outwards"),
            ratio_parameter("outwards"),
            core_parameter(),
            part_parameter(_PARTS),
            focus_parameter("at the points x = 0"),
            zone_parameter("out", "from the inner square to the rim"),
        ),
    )

    def __post_init__(self) -> None:
        check_disc(self, self.cells, self.core, self.part)
        check_focus(self.focus)
        self.blocks()

    def blocks(self) -> list[Block]:
        """A square and blocks around it; see `Shape`."""
        cells, part = (*self.cells, 1), _PARTS[self.part]
        radius, ends = [self.radius, self.radius, 1.0], {(2, 0): FACE}
        out = spaced(self, "out", cells[1], self.ratio)
        planes, cuts, place = (out, even(1)), ("left", "top"), (lambda p: p * radius)
        return disc_blocks(cells[0], planes, self.core, place, part, cuts, ends, self.focus)
