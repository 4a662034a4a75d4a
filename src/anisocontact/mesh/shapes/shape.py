"""What a built-in shape is: parameters and the blocks they make."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import ClassVar, Protocol

from anisocontact.base import registry
from anisocontact.base.array_types import Floats
from anisocontact.base.cells import CELLS, IN_PLANE, IN_SPACE
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Entry, Parameter
from anisocontact.mesh.blocks import check_count
from anisocontact.mesh.lattice import Block, graded, zoned

#: Cells of shapes in the plane, and those of bodies whose facets they are.
FLAT = dict(zip(CELLS[IN_PLANE], CELLS[IN_SPACE], strict=True))
#: Facet group of their blocks that is the body.
FACE = "face"


class Shape(Protocol):
    """A body that is meshed block by block.

    One in the plane has blocks in space, one cell thick, of which the facet group `FACE` is meshed.

    Attributes:
        entry: Name, one line of text, parameters; they are attributes of the same names.
        curved: Whether it has curved sides, so that cells of order 2 are curved.
    """

    entry: ClassVar[Entry]
    curved: ClassVar[bool]

    @property
    def cell(self) -> str:
        """Cells: "hexahedron" or "tetrahedron" (six to each hexahedron), or those of `FLAT`."""
        ...

    @property
    def order(self) -> int:
        """Order of the displacement, 1 or 2."""
        ...

    def blocks(self) -> list[Block]:
        """The blocks, in place."""
        ...


def cells_parameter(*axes: str) -> Parameter:
    """Parameter `cells`: how many along each of the axes."""
    doc = f"cells {', '.join(axes)}"
    return Parameter("cells", "integers", "1", doc, "positive", count=len(axes))


def ratio_parameter(*axes: str) -> Parameter:
    """Parameter `ratio`: growth of the cells along each of the axes, even by default."""
    doc = f"size of the last cell over the first {', '.join(axes)}"
    one = (1.0,) * len(axes)
    kind = {1: "scalar", 2: "pair", 3: "vector"}[len(axes)]
    return Parameter("ratio", kind, "1", doc, "positive", default=one)


def core_parameter() -> Parameter:
    """Parameter `core`: size of the blocks in the middle of round shapes."""
    doc = "distance of the corners of the inner block from the middle, as a share of the radius"
    return Parameter("core", "scalar", "1", doc, "positive", default=(0.5,))


def focus_parameter(where: str) -> Parameter:
    """Parameter `focus`: how fine cells are where contact is expected."""
    doc = f"size of the cells {where} over that of those farthest from there, around the shape"
    return Parameter("focus", "scalar", "1", doc, "positive", default=(1.0,))


def check_focus(focus: float) -> None:
    """Refuse cells that are coarse where they ought to be fine."""
    if focus > 1.0:
        raise InputError(f"{focus!r} given, must be <= 1", "focus")


def zone_parameter(name: str, along: str) -> Parameter:
    """Parameter `zone_<name>`: where inside the shape cells are fine."""
    doc = (
        f"cells that are fine inside: where {along}, as a share from 0 to 1, and their size there "
        "over that of the largest; instead of ratio"
    )
    return Parameter(f"zone_{name}", "array", "1", doc, required=False)


def spaced(shape: Shape, name: str, cells: int, ratio: float) -> Floats:
    """Planes of the cells along one direction of a shape, by its ratio or its zone of fine cells.

    Args:
        shape: The shape.
        name: Of the direction, in `zone_<name>`.
        cells: Number of cells along it.
        ratio: Size of the last over that of the first.

    Returns:
        Positions of the planes, from 0 to 1, (cells + 1,).

    Raises:
        InputError: The zone is out of range, or given with a ratio.
    """
    zone, field = getattr(shape, f"zone_{name}"), f"zone_{name}"
    if len(zone) == 0:
        return graded(int(cells), ratio)
    if len(zone) != 2 or not (0.0 <= zone[0] <= 1.0 and 0.0 < zone[1] <= 1.0):
        text = "a place from 0 to 1 and a size > 0, at most 1, are needed"
        raise InputError(f"{list(zone)} given, {text}", field)
    if ratio != 1.0:
        raise InputError(f"given with ratio {ratio:g} along the same, one of the two", field)
    return zoned(int(cells), *zone)


def part_parameter(parts: Iterable[str]) -> Parameter:
    """Parameter `part`: how much of a round shape, all of it by default."""
    return Parameter("part", "choice", "1", "how much of it", default=(0.0,), choices=tuple(parts))


def check_shape(shape: Shape) -> None:
    """Check the parameters of a shape one by one; one number in the place of a pair is made two.

    Raises:
        InputError: A value is of the wrong form or out of range.
    """
    for p in shape.entry.parameters:
        numbers = registry.check(p, getattr(shape, p.name))
        if p.alike:
            object.__setattr__(shape, p.name, tuple(numbers))
    cells = CELLS[shape.entry.kind]
    if shape.cell not in cells:
        raise InputError(f"{shape.cell!r} given, allowed: {', '.join(cells)}", "cell")
    if shape.order not in (1, 2):
        raise InputError(f"{shape.order!r} given, allowed: 1, 2", "order")


def check_core(core: float) -> None:
    """Refuse a core that leaves no room for cells around it."""
    if not core < 1.0:
        raise InputError(f"{core!r} given, must be < 1", "core")


def check_around(cells: Sequence[int], multiple: int) -> None:
    """Refuse a number of cells around that the blocks cannot share.

    Raises:
        InputError: Says what it must be a multiple of.
    """
    if cells[0] % multiple:
        text = f"{cells[0]} cells around given, a multiple of {multiple} is needed"
        raise InputError(text, "cells")


def checked_blocks(shape: Shape) -> list[Block]:
    """The blocks of a shape that are not too many.

    Args:
        shape: The shape.

    Returns:
        Its blocks.

    Raises:
        InputError: More cells than fit in memory.
    """
    blocks = shape.blocks()
    check_count(blocks)
    return blocks


def full_circle(angle: float) -> bool:
    """Whether an angle goes all the way around."""
    return math.isclose(abs(angle), 2.0 * math.pi, rel_tol=1e-12)
