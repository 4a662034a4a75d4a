"""The blocks of a round disc: a square in the middle and four blocks around it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.registry import Parameter
from anisocontact.mesh.lattice import Block, Side, focused
from anisocontact.mesh.shapes.shape import (
    Shape,
    cells_parameter,
    check_around,
    check_core,
    check_shape,
    core_parameter,
    part_parameter,
    ratio_parameter,
    spaced,
    zone_parameter,
)

#: How far a part of a disc goes along x and y, from -1 to 1.
type Ranges = tuple[tuple[int, int], tuple[int, int]]

AROUND = "around a whole disc (a multiple of 4, of 8 for parts)"
#: Facet groups of bodies made of discs.
ENDS: dict[Side, str] = {(2, 0): "bottom", (2, 1): "top"}
#: Parts of a disc: how far it goes along x and y, and the groups of cuts at x = 0 and y = 0.
PARTS: dict[str, Ranges] = {
    "whole": ((-1, 1), (-1, 1)),
    "half": ((0, 1), (-1, 1)),
    "quarter": ((0, 1), (0, 1)),
}
CUTS = ("left", "front")


def disc_parameters() -> tuple[Parameter, ...]:
    """Parameters of the cells of bodies made of discs: `cells`, `ratio`, `core`, `part`, zones."""
    return (
        cells_parameter(AROUND, "from the inner square outwards", "along z"),
        ratio_parameter("outwards", "along z"),
        core_parameter(),
        part_parameter(PARTS),
        zone_parameter("out", "from the inner square outwards"),
        zone_parameter("z", "along z"),
    )


def disc_planes(
    shape: Shape, cells: Sequence[int], ratio: Sequence[float]
) -> tuple[Floats, Floats]:
    """Planes of the cells of a body made of discs, from the square to the rim and along z."""
    return spaced(shape, "out", cells[1], ratio[0]), spaced(shape, "z", cells[2], ratio[1])


def check_disc(shape: Shape, cells: Sequence[int], core: float, part: str) -> None:
    """Check the parameters of a body made of discs.

    Args:
        shape: The body.
        cells: Number around a whole disc, and others.
        core: Size of the square in the middle.
        part: How much of the disc.

    Raises:
        InputError: A value is of the wrong form or out of range.
    """
    check_shape(shape)
    check_around(cells, 4 if part == "whole" else 8)
    check_core(core)


def disc_blocks(
    around: int,
    planes: tuple[Floats, Floats],
    core: float,
    place: Callable[[Floats], Floats],
    part: Ranges = PARTS["whole"],
    cuts: Sequence[str] = CUTS,
    ends: Mapping[Side, str] = ENDS,
    focus: float = 1.0,
) -> list[Block]:
    """Blocks of a cylinder of radius 1 and height 1, or a part; each point taken to its place.

    Args:
        around: Number of cells around a whole disc.
        planes: Planes of the cells from the square to the rim, and along the axis, from 0 to 1.
        core: Distance of the corners of the square from the axis.
        place: Takes points of that cylinder to points in space, (n, 3).
        part: How far it goes along x and y.
        cuts: Facet groups of cuts at x = 0 and at y = 0.
        ends: Facet groups of the ends.
        focus: Size of the cells around x = 0 over that of those farthest from there.

    Returns:
        The blocks, with the facet groups outer and those of cuts and ends.
    """
    out, along = planes
    half = core / np.sqrt(2.0)
    shares = [((1 + low) / 2.0, (1 + high) / 2.0) for low, high in part]
    square = partial(_part, partial(_square, half=half), shares[0], shares[1])
    sides = {(axis, end): cuts[axis] for axis in (0, 1) for end in (0, 1) if not part[axis][end]}
    x, y = _planes(around, shares[0], focus), _planes(around, shares[1])
    blocks = [Block((x, y, along), partial(_through, square, place), {**sides, **ends})]
    for quarter in range(4):
        axis, end = quarter % 2, int(quarter < 2)
        if not part[axis][end]:
            continue
        # along the rim, against the clock: y, -x, -y, x
        first, last = shares[1 - axis]
        arc = (first, last) if quarter in (0, 3) else (1.0 - last, 1.0 - first)
        rim = partial(_rim, half=half, start=(quarter - 0.5) * np.pi / 2.0)
        cut = {(1, e): cuts[1 - axis] for e in (0, 1) if arc[e] == 0.5}
        to_rim = partial(_through, partial(_part, rim, (0.0, 1.0), arc), place)
        own = out, _planes(around, arc, focus if axis else 1.0), along
        blocks.append(Block(own, to_rim, {(0, 1): "outer", **cut, **ends}))
    return blocks


def _planes(around: int, share: tuple[float, float], focus: float = 1.0) -> Floats:
    """Planes of the cells along a share of a side of the square, fine around its middle."""
    low, high = (2.0 * s - 1.0 for s in share)
    return focused(round(around / 4 * (share[1] - share[0])), focus, low, high)


def _part(
    then: Callable[[Floats], Floats], x: tuple[float, float], y: tuple[float, float], p: Floats
) -> Floats:
    """Of a part of a block: shares of the part to shares of the whole."""
    low, high = np.array([x, y, (0.0, 1.0)]).T
    return then(low + p * (high - low))


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
