"""The blocks of a round disc: a square in the middle and four blocks around it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from anisocontact.base.registry import Parameter
from anisocontact.mesh.arrays import Floats
from anisocontact.mesh.lattice import Block, even, graded
from anisocontact.mesh.shapes.shape import (
    Shape,
    cells_parameter,
    check_around,
    check_core,
    check_shape,
    core_parameter,
    ratio_parameter,
)

#: Facet groups of bodies made of discs.
ENDS = {(2, 0): "bottom", (2, 1): "top"}


def disc_parameters() -> tuple[Parameter, ...]:
    """Parameters of the cells of bodies made of discs: `cells`, `ratio` and `core`."""
    return (
        cells_parameter("around (a multiple of 4)", "from the inner square outwards", "along z"),
        ratio_parameter("outwards", "along z"),
        core_parameter(),
    )


def check_disc(shape: Shape, cells: Sequence[int], core: float) -> None:
    """Check the parameters of a body made of discs.

    Args:
        shape: The body.
        cells: Number around, and others.
        core: Size of the square in the middle.

    Raises:
        InputError: A value is of the wrong form or out of range.
    """
    check_shape(shape)
    check_around(cells, 4)
    check_core(core)


def disc_blocks(
    cells: Sequence[int], ratio: Sequence[float], core: float, place: Callable[[Floats], Floats]
) -> list[Block]:
    """Blocks of a cylinder of radius 1 and height 1, each point taken to its place.

    Args:
        cells: Number around (a multiple of 4), between the square and the rim, along the axis.
        ratio: Growth of the cells from the square to the rim, and along the axis.
        core: Distance of the corners of the square from the axis.
        place: Takes points of that cylinder to points in space, (n, 3).

    Returns:
        The blocks, with the facet groups outer, bottom and top.
    """
    side, along = even(cells[0] // 4), graded(cells[2], ratio[1])
    out = graded(cells[1], ratio[0])
    half = core / np.sqrt(2.0)
    blocks = [Block((side, side, along), lambda p: place(_square(p, half)), ENDS)]
    for quarter in range(4):
        to_rim = partial(_rim, half=half, start=(quarter - 0.5) * np.pi / 2.0)
        sides = {(0, 1): "outer", **ENDS}
        blocks.append(Block((out, side, along), partial(_through, to_rim, place), sides))
    return blocks


def _through(
    first: Callable[[Floats], Floats], then: Callable[[Floats], Floats], p: Floats
) -> Floats:
    return then(first(p))


def _square(p: Floats, half: float) -> Floats:
    return np.column_stack([half * (2.0 * p[:, :2] - 1.0), p[:, 2]])


def _rim(p: Floats, half: float, start: float) -> Floats:
    """Between a side of the square and the arc outside of it."""
    s, t, z = p.T
    middle = start + np.pi / 4.0
    outward, onward = _unit(middle), _unit(middle + np.pi / 2.0)
    inner = half * (outward + (2.0 * t - 1.0)[:, None] * onward)
    outer = _unit(start + t * np.pi / 2.0)
    return np.column_stack([(1.0 - s)[:, None] * inner + s[:, None] * outer, z])


def _unit(angle: Floats | float) -> Floats:
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)
