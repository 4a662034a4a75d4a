"""Cells a finite-element mesh can be made of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import curved_gradients, middle_nodes
from anisocontact.base.shown import shown
from anisocontact.base.sizes import RANGE, out_of_range
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays
from anisocontact.mesh.split import Route

# Corners, each with its neighbours in an order that makes a right-handed frame in a sound cell.
_CORNERS = {
    "tetrahedron": np.array([[0, 1, 2, 3]]),
    "hexahedron": np.array(
        [
            [0, 1, 2, 4],
            [1, 3, 0, 5],
            [2, 0, 3, 6],
            [3, 2, 1, 7],
            [4, 6, 5, 0],
            [5, 4, 7, 1],
            [6, 7, 4, 2],
            [7, 5, 6, 3],
        ]
    ),
    "triangle": np.array([[0, 1, 2]]),
    "quadrilateral": np.array([[0, 1, 2], [1, 3, 0], [2, 0, 3], [3, 2, 1]]),
}
#: Volume at a corner over the largest in the body, below which a cell is flat.
FLAT = 1e-12
#: Scaled Jacobian of a needle ten million times as long as it is thick, and the square of the
#: shortest over the longest edge of one with right angles: its stiffness across leaves nothing of
#: that along it but rounding, whatever its volume.
NEEDLE = 1e-14
_AT_ONCE = 2000


def check_cells(mesh: MeshArrays) -> None:
    """Refuse flat or inverted cells, facets of more than two cells, and edges with two middles.

    Args:
        mesh: Mesh with straight or curved cells. The corners are looked at, and inside of curved
            cells the points of a quadrature.

    Raises:
        InputError: Says what is wrong and how often.
    """
    extent = max(mesh.comm.allgather(float(np.abs(mesh.points).max(initial=0.0))))
    if out_of_range(extent):
        raise InputError(f"nodes are up to {extent:g} from the origin, must be {RANGE}")
    # Sizes whose volumes overflow or underflow count as flat.
    placed = mesh.with_points()
    with np.errstate(all="ignore"):
        least, most, shaped = _sizes(placed)
    for name, cells in mesh.bodies.items():
        largest = np.max(mesh.comm.allgather(most[cells].max(initial=0.0)))
        sound = (least[cells] > FLAT * largest) & (shaped[cells] > NEEDLE)
        bad, count = mesh.sum(len(cells) - int(sound.sum())), mesh.sum(len(cells))
        if bad:
            own = placed.points[placed.cells[cells[~sound][:1]]].mean(axis=1)
            first = shown(np.concatenate(mesh.comm.allgather(own))[0], size=extent)
            text = f"{bad} of {count} cells are flat or inverted, the first at {first}"
            raise InputError(f"body {name!r}: {text}")
    shared = _facets_of_more_than_two(mesh)
    if shared:
        raise InputError(f"{shared} facets belong to more than two cells")
    if mesh.degree == 2 and not _is_conforming(mesh):
        raise InputError("neighbouring cells do not have the same nodes on their common edges")


def scaled_jacobian(mesh: MeshArrays) -> Floats:
    """Least volume at a corner of each cell over the lengths of its edges, (cells,).

    1 for a cube or a square and, scaled, for a regular tetrahedron or triangle [Knupp 2000].

    Args:
        mesh: The mesh, of one process; the corners are looked at.
    """
    return _shaped(mesh, _corner_volumes(mesh))


def _shaped(mesh: MeshArrays, volumes: Floats) -> Floats:
    """`scaled_jacobian` with the volumes at the corners of each cell, (cells, corners)."""
    points = mesh.points[mesh.cells[:, _CORNERS[mesh.cell]]]
    arms = points[:, :, 1:] - points[:, :, :1]
    lengths = np.moveaxis(np.linalg.norm(arms, axis=3), 2, 0)
    size = np.prod(lengths, axis=0)
    if mesh.cell == "tetrahedron":  # one corner stands for all: its volume, their longest edges
        edges = mesh.points[mesh.cells[:, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]]]
        long = np.linalg.norm(edges[:, :, 1] - edges[:, :, 0], axis=2)
        at = [(0, 1, 2), (0, 3, 4), (1, 3, 5), (2, 4, 5)]
        size = np.max([long[:, list(k)].prod(axis=1) for k in at], axis=0)[:, None] / np.sqrt(2.0)
    if mesh.cell == "triangle":
        third = np.linalg.norm(points[:, :, 2] - points[:, :, 1], axis=2)
        longest = np.sort([*lengths, third], axis=0)[1:]
        size = longest.prod(axis=0) * np.sqrt(0.75)
    return np.asarray((volumes / size).min(axis=1))


def _slender(mesh: MeshArrays) -> Floats:
    """Square of the shortest over the longest arm at the corners of each cell, (cells,)."""
    points = mesh.points[mesh.cells[:, _CORNERS[mesh.cell]]]
    lengths = np.linalg.norm(points[:, :, 1:] - points[:, :, :1], axis=3).reshape(len(points), -1)
    return np.asarray((lengths.min(axis=1) / lengths.max(axis=1)) ** 2)


def _sizes(mesh: MeshArrays) -> tuple[Floats, Floats, Floats]:
    """Least and largest volume of each cell, by size, and its scaled Jacobian, (cells,) each."""
    found = [np.empty((3, 0))]
    # some cells after the others: at all corners of all of them at once takes many times the mesh
    for begin in range(0, len(mesh.cells), _AT_ONCE):
        some = replace(mesh, cells=mesh.cells[begin : begin + _AT_ONCE])
        volumes = _corner_volumes(some)
        shaped = np.minimum(_shaped(some, volumes), _slender(some))
        if mesh.degree == 2:
            volumes = np.hstack([volumes, _inner_volumes(some)])
        found.append(np.stack([volumes.min(axis=1), np.abs(volumes).max(axis=1), shaped]))
    least, most, shaped = np.concatenate(found, axis=1)
    return least, most, shaped


def _corner_volumes(mesh: MeshArrays) -> Floats:
    corners = _CORNERS[mesh.cell]
    dim = corners.shape[1] - 1
    points = mesh.points[mesh.cells[:, corners]]
    edges = points[:, :, 1:, :dim] - points[:, :, :1, :dim]
    return _either_side(np.linalg.det(edges), dim)


def _either_side(volumes: Floats, dim: int) -> Floats:
    """Cells in the plane may be seen from either side."""
    return volumes * np.sign(volumes[:, :1]) if dim == 2 else volumes


def _inner_volumes(mesh: MeshArrays) -> Floats:
    dim = _CORNERS[mesh.cell].shape[1] - 1
    points = np.ascontiguousarray(mesh.points[mesh.cells][..., :dim].swapaxes(1, 2))
    # One point after the other: all at once would be many times the mesh.
    volumes = [np.linalg.det(points @ g) for g in curved_gradients(mesh.cell)]
    return _either_side(np.column_stack(volumes), dim)


def _facets_of_more_than_two(mesh: MeshArrays) -> int:
    local = CELL_FACETS[mesh.cell]
    # The three lowest corners tell a facet from any other.
    rows = np.sort(mesh.cells[:, local].reshape(-1, local.shape[1]), axis=1)[:, :3]
    rows = Route(mesh.comm, mesh.node_split.owner(rows[:, 0])).there(rows)
    rows = rows[np.lexsort(rows.T)]
    return mesh.sum(int(np.sum(np.all(rows[2:] == rows[:-2], axis=1))))


def _is_conforming(mesh: MeshArrays) -> bool:
    """Whether every node inside an edge or face of quadratic cells belongs to it alone."""
    nodes = mesh.node_split
    uses = nodes.marked(mesh.cells[:, np.unique(_CORNERS[mesh.cell])]).astype(int)
    for corners, middle in middle_nodes(mesh.cell):
        entities = np.sort(mesh.cells[:, corners].reshape(-1, corners.shape[1]), axis=1)
        inside = mesh.cells[:, middle].reshape(-1)
        pairs = np.unique(np.column_stack([entities, inside]), axis=0)
        pairs = np.unique(Route(mesh.comm, nodes.owner(pairs[:, 0])).there(pairs), axis=0)
        marked = nodes.marked(inside)
        uses += marked
        alike = len(np.unique(pairs[:, :-1], axis=0)), len(pairs), int(marked.sum())
        if len({mesh.sum(count) for count in alike}) > 1:
            return False
    return mesh.sum(int(np.sum(uses > 1))) == 0
