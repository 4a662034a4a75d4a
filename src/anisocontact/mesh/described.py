"""What a mesh contains, in a few lines: bodies, groups, sizes and the shape of the cells."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays
from anisocontact.mesh.quality import scaled_jacobian

#: Distance of nodes at the same place, over the size of a body.
SAME = 1e-9


def described(mesh: MeshArrays) -> list[str]:
    """What is in a mesh, a line for each body and each group.

    Args:
        mesh: The mesh, of one process.

    Returns:
        The lines. The quality of a cell is its least scaled Jacobian: 1 for a cube or a regular
        tetrahedron, 0 for a flat cell.

    Example:
        >>> from anisocontact.mesh import Body, make_shape
        >>> box = make_shape("box", origin=(0, 0, 0), size=(2, 1, 1), cells=(2, 1, 1))
        >>> for line in described(Body("block", box).arrays())[:2]:
        ...     print(line)
        body      block: 2 hexahedra of order 1, box (0, 0, 0) to (2, 1, 1), edges 1 to 1
        quality   block: worst 1, mean 1
    """
    lines = []
    many = {"tetrahedron": "tetrahedra", "hexahedron": "hexahedra"}.get(mesh.cell, f"{mesh.cell}s")
    shapes, edges = scaled_jacobian(mesh), _edge_lengths(mesh)
    for name, cells in mesh.bodies.items():
        points = mesh.points[np.unique(mesh.cells[cells])]
        low, high = _place(points.min(axis=0)), _place(points.max(axis=0))
        own, shape = edges[cells], shapes[cells]
        order = 1 if name in mesh.linear else mesh.order
        lines += [
            f"body      {name}: {len(cells)} {many} of order {order}, box {low} to {high}, "
            f"edges {own.min():.4g} to {own.max():.4g}",
            f"quality   {name}: worst {shape.min():.3g}, mean {shape.mean():.3g}",
            *_pieces(mesh, name, cells),
        ]
    for name, facets in mesh.facets.items():
        area = _area(mesh.points[facets[:, : mesh.vertices_per_facet]])
        word = "length" if mesh.vertices_per_facet == 2 else "area"
        lines.append(f"group     {name}: {len(facets)} facets, {word} {area:.6g}")
    for name, places in mesh.nodes.items():
        low, high = _place(places.min(axis=0)), _place(places.max(axis=0))
        more = " beside its facets" if name in mesh.facets else ""
        lines.append(f"nodes     {name}: {len(places)}{more}, box {low} to {high}")
    return [*lines, *(f"cells     {note}" for note in mesh.notes)]


def _pieces(mesh: MeshArrays, name: str, cells: Ints) -> Iterator[str]:
    """A line on a body that is not one: several parts, or cells whose nodes were not joined."""
    from scipy.sparse import bmat, csr_matrix
    from scipy.sparse.csgraph import connected_components

    nodes, own = np.unique(mesh.cells[cells], return_inverse=True)
    rows = np.repeat(np.arange(len(cells)), mesh.cells.shape[1])
    shape = (len(cells), len(nodes))
    of_cells = csr_matrix((np.ones(own.size, dtype=np.int8), (rows, own.ravel())), shape=shape)
    links = bmat([[None, of_cells], [of_cells.T, None]])
    count = connected_components(links, directed=False)[0]
    if count > 1:
        places = mesh.points[nodes]
        size = np.ptp(places, axis=0).max()
        same = len(places) - len(np.unique(np.round(places / (SAME * size)), axis=0))
        joined = f", {same} nodes are at places of others: they were not joined" if same else ""
        yield f"pieces    {name}: {count} that share no node{joined}"


def _place(x: Floats) -> str:
    return f"({', '.join(f'{v + 0.0:.5g}' for v in x)})"


def _edge_lengths(mesh: MeshArrays) -> Floats:
    """Between the corners that two facets of a cell share, or of its facets, (cells, edges)."""
    corners = CELL_FACETS[mesh.cell].tolist()
    pairs = {tuple(pair) for pair in corners if len(pair) == 2} or {
        tuple(sorted(both))
        for i, first in enumerate(corners)
        for second in corners[:i]
        if len(both := set(first) & set(second)) == 2
    }
    ends = mesh.points[mesh.cells[:, sorted(pairs)]]
    return np.asarray(np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2))


def _area(corners: Floats) -> float:
    """Of facets with straight edges, their corners in any order; the length of those in a plane."""
    if corners.shape[1] == 2:
        return float(np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1).sum())
    if corners.shape[1] == 3:
        sides = [((0, 1), (0, 2))]
    else:  # of the three ways to pair them the one of the diagonals gives the largest product
        sides = [((0, 1), (2, 3)), ((0, 2), (1, 3)), ((0, 3), (1, 2))]
    vectors = [[corners[:, b] - corners[:, a] for a, b in pair] for pair in sides]
    products = [np.linalg.norm(np.cross(a, b), axis=1) for a, b in vectors]
    return float(0.5 * np.max(products, axis=0).sum())
