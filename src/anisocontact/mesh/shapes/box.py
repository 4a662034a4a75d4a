"""The box: cells between planes along the axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Entry, Parameter
from anisocontact.mesh.lattice import SAME_NODE, Block, Side
from anisocontact.mesh.shapes.shape import (
    cells_parameter,
    check_shape,
    ratio_parameter,
    spaced,
    zone_parameter,
)

AXES = ("x", "y", "z")
FACES: dict[Side, str] = {
    (0, 0): "left",
    (0, 1): "right",
    (1, 0): "front",
    (1, 1): "back",
    (2, 0): "bottom",
    (2, 1): "top",
}


def planes_parameter(axis: str) -> Parameter:
    """Parameter `planes_<axis>`: where the planes of nodes along an axis are."""
    doc = (
        f"planes of nodes along {axis} as shares of the size, rising from 0 to 1, for uneven cells"
    )
    return Parameter(f"planes_{axis}", "array", "1", doc, required=False)


@dataclass(frozen=True)
class BoxSpec:
    """A box parallel to the axes.

    Attributes:
        origin: Lowest corner, length.
        size: Edge lengths, > 0, length.
        cells: Number of cells along each axis, >= 1.
        cell: "hexahedron" or "tetrahedron" (six to each hexahedron).
        order: Order of the displacement, 1 or 2.
        ratio: Size of the last cell over that of the first along each axis, > 0.
        planes_x: Planes of nodes along x as shares of the size, from 0 to 1; none: as `ratio` says.
        planes_y: The same along y.
        planes_z: The same along z.
        zone_x: Where along x cells are fine, as a share of the size, and how fine; none: nowhere.
        zone_y: The same along y.
        zone_z: The same along z.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> box = BoxSpec(origin=(0, 0, 0), size=(2, 1, 1), cells=(4, 2, 2), ratio=(1, 1, 0.5))
        >>> [len(planes) for planes in box.blocks()[0].planes]
        [5, 3, 3]
    """

    origin: Sequence[float]
    size: Sequence[float]
    cells: Sequence[int]
    cell: str = "hexahedron"
    order: int = 1
    ratio: Sequence[float] = (1.0, 1.0, 1.0)
    planes_x: Sequence[float] = ()
    planes_y: Sequence[float] = ()
    planes_z: Sequence[float] = ()
    zone_x: Sequence[float] = ()
    zone_y: Sequence[float] = ()
    zone_z: Sequence[float] = ()

    curved: ClassVar[bool] = False
    entry: ClassVar[Entry] = Entry(
        "box",
        "shape",
        "A box parallel to the axes; facet groups left, right (x- and x+), front, back (y- and "
        "y+), bottom and top (z- and z+).",
        (
            Parameter("origin", "vector", "length", "lowest corner"),
            Parameter("size", "vector", "length", "edge lengths", "positive"),
            cells_parameter("along x", "along y", "along z"),
            ratio_parameter("along x", "along y", "along z"),
            *map(planes_parameter, AXES),
            *(zone_parameter(axis, f"along {axis}") for axis in AXES),
        ),
    )

    def __post_init__(self) -> None:
        check_shape(self)
        for axis, cells, ratio in zip(AXES, self.cells, self.ratio, strict=True):
            planes = self._given(axis)
            if len(planes) == 0:
                continue
            field = f"planes_{axis}"
            if len(planes) != cells + 1:
                text = f"{len(planes)} given, {cells + 1} needed for {cells} cells along {axis}"
                raise InputError(text, field)
            if planes[0] != 0.0 or planes[-1] != 1.0 or np.any(np.diff(planes) <= 0.0):
                raise InputError(f"{planes.tolist()} given, must rise from 0 to 1", field)
            if len(getattr(self, f"zone_{axis}")):
                raise InputError(f"given with zone_{axis}, one of the two", field)
            if ratio != 1.0:
                raise InputError(f"given with ratio {ratio:g} along {axis}, one of the two", field)
        self.blocks()

    def blocks(self) -> list[Block]:
        """One block; see `Shape`."""
        planes = [
            self._given(axis) if len(self._given(axis)) else spaced(self, axis, cells, ratio)
            for axis, cells, ratio in zip(AXES, self.cells, self.ratio, strict=True)
        ]
        return [Block((planes[0], planes[1], planes[2]), self._place, FACES)]

    def _given(self, axis: str) -> Floats:
        """The planes along an axis; ends that miss 0 or 1 by rounding are there."""
        planes = np.array(getattr(self, f"planes_{axis}"), dtype=float)
        for at, end in ((0, 0.0), (-1, 1.0)):
            if len(planes) and abs(planes[at] - end) <= SAME_NODE:
                planes[at] = end
        return planes

    def _place(self, share: Floats) -> Floats:
        return np.asarray(np.asarray(self.origin, float) + share * np.asarray(self.size, float))
