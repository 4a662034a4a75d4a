"""The built-in box: structured hexahedra or tetrahedra with named faces."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from anisocontact.errors import InputError
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays, Nodes, merge
from anisocontact.mesh.model import Model

CELLS = ("hexahedron", "tetrahedron")
# Face name -> axis and end (0: low, 1: high).
FACES = {
    "left": (0, 0),
    "right": (0, 1),
    "front": (1, 0),
    "back": (1, 1),
    "bottom": (2, 0),
    "top": (2, 1),
}


@dataclass(frozen=True)
class BoxSpec:
    """A box parallel to the axes.

    Attributes:
        origin: Lowest corner, length.
        size: Edge lengths, > 0, length.
        cells: Number of cells along each axis, >= 1.
        cell: "hexahedron" or "tetrahedron" (six to each hexahedron).
        order: Order of the displacement, 1 or 2.

    Raises:
        InputError: A value is out of range.
    """

    origin: Sequence[float]
    size: Sequence[float]
    cells: Sequence[int]
    cell: str = "hexahedron"
    order: int = 1

    def __post_init__(self) -> None:
        for field in ("origin", "size", "cells"):
            value = getattr(self, field)
            if len(value) != 3 or not all(math.isfinite(v) for v in value):
                raise InputError(f"{field}: got {list(value)}, needs three finite numbers", field)
        if min(self.size) <= 0.0:
            raise InputError(f"size: got {list(self.size)}, every edge must be > 0", "size")
        if min(self.cells) < 1 or any(int(n) != n for n in self.cells):
            raise InputError(f"cells: got {list(self.cells)}, needs whole numbers >= 1", "cells")
        if self.cell not in CELLS:
            raise InputError(f"cell: got {self.cell!r}, allowed: {', '.join(CELLS)}", "cell")
        if self.order not in (1, 2):
            raise InputError(f"order: got {self.order!r}, allowed: 1, 2", "order")


def build_box(boxes: Mapping[str, BoxSpec]) -> Model:
    """Mesh of one or several boxes, each a body of its own.

    The faces of body "block" are block.left, .right (x- and x+), .front, .back (y- and y+),
    .bottom, .top (z- and z+).

    Args:
        boxes: Body name -> box.

    Returns:
        The model.

    Raises:
        InputError: No box, or boxes of different cells or orders.

    Example:
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (4, 4, 2))})
        >>> model.body_names()
        ['block']
    """
    if not boxes:
        raise InputError("mesh.box: no box given, needs at least one named box", "mesh.box")
    return Model.from_arrays(merge([box_arrays(name, spec) for name, spec in boxes.items()]))


def box_arrays(name: str, spec: BoxSpec) -> MeshArrays:
    """Nodes, cells and faces of one box."""
    counts = [int(n) for n in spec.cells]
    shape = tuple(n + 1 for n in counts)
    lattice = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, 3)
    fraction = lattice / np.asarray(counts)
    points = np.asarray(spec.origin, float) + fraction * np.asarray(spec.size, float)
    cells = _hexahedra(shape)
    if spec.cell == "tetrahedron":
        cells = _split(cells)
    sides = cells[:, CELL_FACETS[spec.cell]].reshape(-1, CELL_FACETS[spec.cell].shape[1])
    facets = {}
    for face, (axis, end) in FACES.items():
        on_face = np.all(lattice[sides, axis] == end * counts[axis], axis=1)
        facets[f"{name}.{face}"] = sides[on_face]
    return MeshArrays(
        cell=spec.cell,
        degree=1,
        points=points,
        cells=cells,
        bodies={name: np.arange(len(cells))},
        facets=facets,
        order=spec.order,
    )


def _hexahedra(shape: tuple[int, ...]) -> Nodes:
    number = np.arange(math.prod(shape)).reshape(shape)
    corners = [
        number[i : shape[0] - 1 + i, j : shape[1] - 1 + j, k : shape[2] - 1 + k].reshape(-1)
        for k in (0, 1)
        for j in (0, 1)
        for i in (0, 1)
    ]
    return np.stack(corners, axis=1)


def _split(hexahedra: Nodes) -> Nodes:
    """Six tetrahedra along the diagonal 0-7 of each hexahedron (Kuhn), faces matching."""
    step = {0: 1, 1: 2, 2: 4}
    paths = [(0, step[a], step[a] + step[b], 7) for a, b, _ in permutations((0, 1, 2))]
    return hexahedra[:, np.array(paths)].reshape(-1, 4)
