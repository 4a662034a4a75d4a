"""One mesh of several, and cells of degree 1 among those of degree 2."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from anisocontact.base.array_types import Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import cell_nodes, facet_nodes, middle_nodes
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays, facet_owners
from anisocontact.mesh.split import Route, Split, arranged


def merge(parts: Sequence[MeshArrays]) -> MeshArrays:
    """One mesh of several parts that share no nodes.

    Where one part has curved cells, those of the others become cells of that degree with straight
    edges; where one has order 2, the bodies of the others are noted as `linear`. On several
    processes each gets an even share of the whole.

    Raises:
        InputError: The parts differ in their cells, or two bodies have one name.
    """
    first = parts[0]
    for part in parts[1:]:
        if part.cell != first.cell:
            simple = {"tetrahedron", "triangle"} & {first.cell, part.cell}
            cure = "".join(f'; cell = "{cell}" makes a built-in shape of these' for cell in simple)
            raise InputError(
                f"bodies {', '.join(first.bodies)} and {', '.join(part.bodies)}: "
                f"all bodies of a mesh need the same cell, not {first.cell} and {part.cell}"
                + (cure if len(simple) == 1 else ""),
                "mesh",
            )
    names = [name for part in parts for name in part.bodies]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two bodies have the name {name!r}", "mesh")
    degree, order = (max(getattr(p, which) for p in parts) for which in ("degree", "order"))
    linear = [name for part in parts if part.order < order for name in part.bodies]
    return replace(
        _joined([lift(part) if part.degree < degree else part for part in parts]),
        order=order,
        linear=tuple(linear),
    )


def _joined(parts: Sequence[MeshArrays]) -> MeshArrays:
    """Parts of one kind of cells, one behind the other."""
    comm = parts[0].comm
    node = np.cumsum([0] + [p.node_split.total for p in parts])
    cell = np.cumsum([0] + [p.cell_split.total for p in parts])
    body = np.cumsum([0] + [len(p.bodies) for p in parts])
    (points,) = arranged(
        comm,
        int(node[-1]),
        _of_all(p.node_split.numbers + n for p, n in zip(parts, node[:-1], strict=True)),
        _of_all(p.points for p in parts),
    )
    cells, labels = arranged(
        comm,
        int(cell[-1]),
        _of_all(p.cell_split.numbers + c for p, c in zip(parts, cell[:-1], strict=True)),
        _of_all(p.cells + n for p, n in zip(parts, node[:-1], strict=True)),
        _of_all(p.labels + b for p, b in zip(parts, body[:-1], strict=True)),
    )
    names = [name for part in parts for name in part.bodies]
    return replace(
        parts[0],
        points=points,
        cells=cells,
        bodies={name: np.flatnonzero(labels == i) for i, name in enumerate(names)},
        facets={
            k: v + n for p, n in zip(parts, node[:-1], strict=True) for k, v in p.facets.items()
        },
        nodes={name: places for part in parts for name, places in part.nodes.items()},
        notes=tuple(note for part in parts for note in part.notes),
        torn=tuple(line for part in parts for line in part.torn),
    )


def _of_all(tables: Any) -> Any:
    return np.concatenate(list(tables))


def lift(mesh: MeshArrays) -> MeshArrays:
    """Cells of degree 1 as cells of degree 2 with straight edges: middle nodes are put in."""
    corners, nodes = mesh.cells, mesh.node_split
    cells = np.empty((len(corners), len(cell_nodes(mesh.cell, 2))), dtype=np.int64)
    cells[:, : corners.shape[1]] = corners
    numbers, points, count = [nodes.numbers], [mesh.points], nodes.total
    for ends, place in middle_nodes(mesh.cell):
        rows = np.sort(corners[:, ends].reshape(-1, ends.shape[1]), axis=1)
        mine, number = np.unique(rows, axis=0, return_inverse=True)
        # An edge or face gets its number on the process that has its first node.
        route = Route(mesh.comm, nodes.owner(mine[:, 0]))
        unique, there = np.unique(route.there(mine), axis=0, return_inverse=True)
        new = Split(mesh.comm, len(unique))
        found = route.back(count + new.first + there.reshape(-1))
        cells[:, place] = found[number.reshape(len(corners), -1)]
        numbers.append(count + new.numbers)
        points.append(nodes.fetch(mesh.points, unique).mean(axis=1))
        count += new.total
    if mesh.cell == "hexahedron":
        inner = count + mesh.cell_split.numbers
        cells[:, -1] = inner
        numbers.append(inner)
        points.append(nodes.fetch(mesh.points, corners).mean(axis=1))
        count += mesh.cell_split.total
    facets = {name: facet_rows(mesh, cells, rows, 2) for name, rows in mesh.facets.items()}
    (all_points,) = arranged(mesh.comm, count, _of_all(numbers), _of_all(points))
    return replace(mesh, degree=2, points=all_points, cells=cells, facets=facets)


def facet_rows(mesh: MeshArrays, lifted: Ints, facets: Ints, degree: int) -> Ints:
    """All nodes of facets of which the corners are given, in the order of DOLFINx.

    Args:
        mesh: The mesh, whose cells have the facets.
        lifted: Nodes of its cells of a degree, (cells, nodes of a cell).
        facets: Corners in any order, (facets, 3 or 4).
        degree: The degree.

    Returns:
        Nodes, vertices first, (facets, nodes of a facet).
    """
    owner, _ = facet_owners(mesh, facets)
    corners, nodes = (mesh.cell_split.fetch(cells, owner) for cells in (mesh.cells, lifted))
    sides = np.sort(corners[:, CELL_FACETS[mesh.cell]], axis=2)
    local = np.argmax(np.all(sides == np.sort(facets, axis=1)[:, None], axis=2), axis=1)
    return np.take_along_axis(nodes, facet_nodes(mesh.cell, degree)[local], axis=1)
