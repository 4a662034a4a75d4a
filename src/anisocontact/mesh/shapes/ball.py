"""The ball and its half, quarter and eighth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.registry import Entry, Parameter
from anisocontact.mesh.lattice import Block, Side, focused
from anisocontact.mesh.shapes.shape import (
    cells_parameter,
    check_around,
    check_core,
    check_focus,
    check_shape,
    core_parameter,
    focus_parameter,
    part_parameter,
    ratio_parameter,
    spaced,
    zone_parameter,
)

# Part -> range along each axis of a cube from -1 to 1.
PARTS: dict[str, tuple[tuple[int, int], ...]] = {
    "ball": ((-1, 1), (-1, 1), (-1, 1)),
    "half": ((-1, 1), (-1, 1), (-1, 0)),
    "quarter": ((0, 1), (-1, 1), (-1, 0)),
    "eighth": ((0, 1), (0, 1), (-1, 0)),
}
# Axis -> name of the plane cut through the middle.
CUTS = ("left", "front", "top")


@dataclass(frozen=True)
class BallSpec:
    """A ball around the origin, or the part of it with z <= 0, then x >= 0, then y >= 0.

    A cube in the middle and a block outside of each of its faces: no cell is degenerate.

    Attributes:
        radius: Radius, > 0, length.
        cells: Number around a great circle (a multiple of 4, of 8 for parts of a ball), and from
            the inner cube to the surface.
        part: "ball", "half", "quarter" or "eighth".
        cell: "hexahedron" or "tetrahedron".
        order: Order of the displacement, 1 or 2; cells of order 2 are curved.
        ratio: Size of the cell at the surface over that at the cube, > 0.
        core: Distance of the corners of the inner cube from the middle over the radius, < 1.
        focus: Size of the cells at the poles x = y = 0 over that of those farthest from there,
            <= 1.
        zone_out: Where between cube (0) and surface (1) cells are fine, and how fine.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> from anisocontact.mesh import Body, build_mesh
        >>> ball = BallSpec(radius=1.0, cells=(8, 1), part="half")
        >>> build_mesh([Body("ball", ball)]).facet_names()
        ['ball.top', 'ball.outer']
    """

    radius: float
    cells: Sequence[int]
    part: str = "ball"
    cell: str = "hexahedron"
    order: int = 1
    ratio: float = 1.0
    core: float = 0.5
    focus: float = 1.0
    zone_out: Sequence[float] = ()

    curved: ClassVar[bool] = True
    entry: ClassVar[Entry] = Entry(
        "ball",
        "shape",
        "A ball around the origin, or a part of it; facet groups outer, of a half (z <= 0) also "
        "top, of a quarter (x >= 0) also left, of an eighth (y >= 0) also front.",
        (
            Parameter("radius", "scalar", "length", "radius", "positive"),
            cells_parameter(
                "around (a multiple of 4, of 8 for parts)", "from the inner cube outwards"
            ),
            part_parameter(PARTS),
            ratio_parameter("outwards"),
            core_parameter(),
            focus_parameter("at the poles x = y = 0"),
            zone_parameter("out", "from the inner cube outwards"),
        ),
    )

    def __post_init__(self) -> None:
        check_shape(self)
        check_around(self.cells, 4 if self.part == "ball" else 8)
        check_core(self.core)
        check_focus(self.focus)
        self.blocks()

    def blocks(self) -> list[Block]:
        """The cube and a block for each face of it that is not cut away; see `Shape`."""
        half = self.core * self.radius / np.sqrt(3.0)
        ranges = PARTS[self.part]
        whole = self.part == "ball"
        planes = [
            focused(
                self.cells[0] // 4 if whole else self.cells[0] // 8 * (high - low), f, low, high
            )
            for f, (low, high) in zip((self.focus, self.focus, 1.0), ranges, strict=True)
        ]
        low, high = np.array(ranges, dtype=float).T
        cube = Block(
            (planes[0], planes[1], planes[2]),
            lambda p: half * (low + p * (high - low)),
            {(axis, end): CUTS[axis] for axis, end in self._cuts((0, 1, 2))},
        )
        out = spaced(self, "out", self.cells[1], self.ratio)
        blocks = [cube]
        for axis, end in ((a, e) for a in range(3) for e in (0, 1)):
            if ranges[axis][end] == 0:
                continue
            # Outward, then the two axes of the face, right-handed.
            axes = (axis, *((axis + k) % 3 for k in ((1, 2) if end else (2, 1))))
            sides: dict[Side, str] = {(0, 1): "outer"}
            sides |= {(place, e): CUTS[axes[place]] for place, e in self._cuts(axes) if place}
            place = partial(self._outside, half=half, axes=axes, end=2 * end - 1)
            blocks.append(Block((out, planes[axes[1]], planes[axes[2]]), place, sides))
        return blocks

    def _cuts(self, axes: Sequence[int]) -> Iterator[Side]:
        """Sides of a block that lie in a cut, given the axis of space along each of its own."""
        for place, axis in enumerate(axes):
            for end, limit in enumerate(PARTS[self.part][axis]):
                if limit == 0:
                    yield place, end

    def _outside(self, p: Floats, half: float, axes: Sequence[int], end: int) -> Floats:
        low, high = np.array(PARTS[self.part], dtype=float).T
        on_cube = np.empty((len(p), 3))
        on_cube[:, axes[0]] = end
        for k in (1, 2):
            a = axes[k]
            on_cube[:, a] = low[a] + p[:, k] * (high[a] - low[a])
        # Equal angles instead of equal lengths make cells of about one size on the sphere.
        away = np.tan(np.pi / 4.0 * on_cube)
        sphere = self.radius * away / np.linalg.norm(away, axis=1)[:, None]
        return np.asarray((1.0 - p[:, :1]) * half * on_cube + p[:, :1] * sphere)
