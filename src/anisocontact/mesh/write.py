"""Meshes as files of other codes, with their bodies and facet groups."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import scipy

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import middle_nodes
from anisocontact.base.whole_files import named_by_user, replacing
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.merge import facet_rows
from anisocontact.mesh.meshio_files import GROUP, needed
from anisocontact.mesh.tetrahedra import EDGES
from anisocontact.mesh.whole import CORNERS, FACES

#: Ending -> format of meshio.
FORMATS = {".msh": "gmsh22", ".vtu": "vtu", ".vtk": "vtk"}
#: Cell and degree -> cell of meshio.
_CELLS = {
    ("tetrahedron", 1): "tetra",
    ("tetrahedron", 2): "tetra10",
    ("hexahedron", 1): "hexahedron",
    ("hexahedron", 2): "hexahedron27",
    ("triangle", 1): "triangle",
    ("triangle", 2): "triangle6",
    ("quadrilateral", 1): "quad",
    ("quadrilateral", 2): "quad9",
}
#: Corners of a facet and its degree -> its name in meshio, and its nodes in the order of VTK.
_FACETS = {
    (2, 1): ("line", [0, 1]),
    (2, 2): ("line3", [0, 1, 2]),
    (3, 1): ("triangle", [0, 1, 2]),
    (3, 2): ("triangle6", [0, 1, 2, 5, 3, 4]),
    (4, 1): ("quad", [0, 1, 3, 2]),
    (4, 2): ("quad9", [0, 1, 3, 2, 4, 6, 7, 5, 8]),
}


def write_mesh(mesh: MeshArrays, path: str | Path) -> None:
    """Write a mesh with its bodies and groups, so that reading it gives the same names.

    gmsh's files have them as physical groups, the others as an array of 0 and 1 for each, called
    `group:<name>`.

    Args:
        mesh: The mesh, of one process.
        path: The file; the ending of its name is one of `FORMATS`.

    Raises:
        InputError: Another ending, meshio is not installed, or the file cannot be written.
    """
    path = Path(path)
    kind = FORMATS.get(path.suffix.lower())
    if kind is None:
        raise InputError(f"'{path}' given; it has to end with one of: {', '.join(FORMATS)}")
    meshio = needed(path)
    cell = _CELLS[mesh.cell, mesh.degree]
    blocks = [(cell, mesh.cells[rows][:, _vtk_order(mesh)]) for rows in mesh.bodies.values()]
    blocks += [_facets(mesh, rows) for rows in mesh.facets.values()]
    blocks += [("vertex", _numbers(mesh, *one)[:, None]) for one in mesh.nodes.items()]
    names = [*mesh.bodies, *mesh.facets, *mesh.nodes]
    more = _numbered(mesh, blocks) if kind == "gmsh22" else _marked(names, blocks)
    options = {"binary": False} if kind == "gmsh22" else {}
    with named_by_user(path), replacing(path) as draft:
        meshio.Mesh(mesh.points, blocks, **more).write(draft, file_format=kind, **options)


def _facets(mesh: MeshArrays, rows: Ints) -> tuple[str, Ints]:
    corners = rows[:, : mesh.vertices_per_facet]
    nodes = facet_rows(mesh, mesh.cells, corners, mesh.degree)
    facet, order = _FACETS[mesh.vertices_per_facet, mesh.degree]
    return facet, nodes[:, order]


def _numbers(mesh: MeshArrays, name: str, places: Floats) -> Ints:
    """Nodes of the body of a group at some places."""
    own = np.unique(mesh.cells[mesh.bodies[name.partition(".")[0]]])
    return np.asarray(own[scipy.spatial.KDTree(mesh.points[own]).query(places)[1]])


def _vtk_order(mesh: MeshArrays) -> list[int]:
    """Nodes of a cell in the order of VTK."""
    corners = CORNERS[mesh.cell]
    if mesh.degree == 1:
        return corners
    between = {
        frozenset(ends): int(place)
        for all_ends, places in middle_nodes(mesh.cell)
        for ends, place in zip(all_ends.tolist(), places, strict=True)
    }
    inside = [*EDGES[mesh.cell], *(FACES if mesh.cell == "hexahedron" else [])]
    middles = [between[frozenset(corners[k] for k in ends)] for ends in inside]
    return [*corners, *middles, *range(len(corners) + len(middles), mesh.cells.shape[1])]


def _numbered(mesh: MeshArrays, blocks: list[tuple[str, Ints]]) -> dict[str, Any]:
    """Physical groups of gmsh."""
    numbers = [np.full(len(rows), k, dtype=np.int64) for k, (_, rows) in enumerate(blocks, 1)]
    dim = 2 if mesh.vertices_per_facet == 2 else 3
    dims = [dim] * len(mesh.bodies) + [dim - 1] * len(mesh.facets) + [0] * len(mesh.nodes)
    # gmsh has a name once: nodes beside the facets of a group have one of their own
    beside = [f"{name}_nodes" if name in mesh.facets else name for name in mesh.nodes]
    names = [*mesh.bodies, *mesh.facets, *beside]
    return {
        "cell_data": {"gmsh:physical": numbers, "gmsh:geometrical": numbers},
        "field_data": {
            name: np.array([k, dim])
            for k, (name, dim) in enumerate(zip(names, dims, strict=True), 1)
        },
    }


def _marked(names: list[str], blocks: list[tuple[str, Ints]]) -> dict[str, Any]:
    """An array of 0 and 1 for each name."""
    sizes = [len(rows) for _, rows in blocks]
    return {
        "cell_data": {
            f"{GROUP}{name}": [
                np.full(n, name == other, dtype=np.int32)
                for other, n in zip(names, sizes, strict=True)
            ]
            for name in names
        }
    }
