"""A mesh that a reader of other formats has read as a whole, and what becomes of it.

Readers hand over nodes and sets as their format has them, in the order of VTK and of
Abaqus; here they become the arrays of all meshes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import cell_nodes, facet_nodes, middle_nodes
from anisocontact.base.words import hint
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays, check_has_cells
from anisocontact.mesh.elements import (
    Elements,
    Kind,
    check_apart,
    check_degenerate,
    check_elements,
    check_nodes,
    check_single,
    in_words,
)
from anisocontact.mesh.inside import told_inside
from anisocontact.mesh.merge import merge
from anisocontact.mesh.mirrored import turned
from anisocontact.mesh.quality import check_cells
from anisocontact.mesh.tetrahedra import COUNT, EDGES, Middles, tetrahedra, triangles
from anisocontact.mesh.torn import torn_cells

#: Corners of a cell in VTK's order -> DOLFINx's, which goes along one axis after the other.
CORNERS = {
    "tetrahedron": [0, 1, 2, 3],
    "hexahedron": [0, 1, 3, 2, 4, 5, 7, 6],
    "triangle": [0, 1, 2],
    "quadrilateral": [0, 1, 3, 2],
}
#: Corners of the faces that have a middle node in VTK's hexahedra of 27 nodes, in their order.
FACES = [(0, 3, 7, 4), (1, 2, 6, 5), (0, 1, 5, 4), (3, 2, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7)]


@dataclass(eq=False)
class WholeMesh:
    """Nodes, cells and names.

    Attributes:
        points: Places of the nodes, (nodes, 3), length.
        cells: For each kind of element: cell, nodes (elements, nodes of an element).
        bodies: Body of each element, in the order of `cells`; empty where it is in none.
        node_sets: Name -> nodes.
        surfaces: Name -> corners of facets, an array for each number of corners.
        named: Name of a surface -> element and face by which a file calls each of its facets, an
            array (facets, 2) for each in `surfaces`; face 0 where it means all that are free.
        left_out: Elements that are no solids -> how many there are.
        notes: What was made of the mesh, a line each.
        torn: Bodies that end where the mesh goes on, a line each.

    Example:
        >>> mesh = WholeMesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]))
        >>> mesh.add_cells("tetrahedron", np.array([[0, 1, 2, 3]]), ["body"])
        >>> mesh.bodies
        [['body']]
    """

    points: Floats
    cells: list[tuple[str, Ints]] = field(default_factory=list)
    bodies: list[Sequence[str]] = field(default_factory=list)
    node_sets: dict[str, Ints] = field(default_factory=dict)
    surfaces: dict[str, list[Ints]] = field(default_factory=dict)
    named: dict[str, list[Ints]] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    torn: tuple[str, ...] = ()

    def add_cells(self, cell: str, nodes: Ints, bodies: Sequence[str]) -> None:
        """Add elements of one kind with the body of each.

        Args:
            cell: Kind of the elements, such as "hexahedron".
            nodes: Nodes of each, in the order of VTK, (n, k).
            bodies: Name of the body of each, (n,); "" for none.

        Raises:
            InputError: An unknown kind, or nodes or bodies that are none of such elements.
        """
        check_elements(cell, nodes, bodies)
        self.cells.append((cell, nodes))
        self.bodies.append(bodies)

    def arrays(self, bodies: Sequence[str] | None = None) -> MeshArrays:
        """The arrays of bodies.

        Args:
            bodies: Which; all of them if not given.

        Returns:
            Cells in DOLFINx's order; prisms, pyramids and cells of several kinds as tetrahedra.
            Of quadratic hexahedra with a node in each face and in their middle, where the shape
            functions of fewer nodes say that these are.

        Raises:
            InputError: A body is unknown, a node is missing or nowhere, cells are of several
                orders, flat or inverted, or a facet of a surface belongs to no cell or, while
                others do not, lies inside the mesh.
        """
        known = list(dict.fromkeys(name for labels in self.bodies for name in labels if name))
        for name in bodies or ():
            if name not in known:
                raise InputError(f"no body {name!r}; {hint(name, known)}")
        wanted = known if bodies is None else bodies
        self._check_facets(wanted)
        return self._arrays(wanted)

    def _check_facets(self, wanted: Sequence[str]) -> None:
        """Refuse surfaces in part of nodes that no cell has."""
        none = np.zeros(0, dtype=np.int64)
        used = np.unique(np.concatenate([none, *(nodes.ravel() for _, nodes in self.cells)]))
        for name, parts in self.surfaces.items():
            lost = sum(int((~np.isin(corners, used).all(axis=1)).sum()) for corners in parts)
            check_has_cells(name, lost, sum(map(len, parts)), wanted)

    def _arrays(self, wanted: Sequence[str]) -> MeshArrays:
        joined = self._by_kind(wanted)
        if not joined:
            raise InputError("no element is in a body")
        check_nodes(joined, self.points)
        check_single(joined)
        self.torn = (*self.torn, *torn_cells(self.cells, self.bodies, wanted))
        told = self._told_inside(joined)
        self.notes = (*self.notes, *told.values())
        wrong = 0
        for kind, (given, labels) in joined.items():
            nodes, count = turned(kind[0], given, self.points, FACES)
            joined[kind], wrong = (nodes, labels), wrong + count
        if wrong:
            self.notes = (*self.notes, f"{wrong} cells are numbered the other way round, turned")
        cells = {cell for cell, _ in joined}
        free = {name: parts for name, parts in self.surfaces.items() if name not in told}
        left = replace(self, surfaces=free)
        if cells <= set(COUNT) and (len(cells) > 1 or cells & {"prism", "pyramid"}):
            return left._cut(joined)._arrays(wanted)
        if cells == {"triangle", "quadrilateral"}:
            return in_triangles(left, joined).arrays(wanted)
        check_apart(joined)
        check_degenerate(joined)
        mesh = merge([self._of_kind(cell, *part) for (cell, _), part in joined.items()])
        return replace(mesh, notes=self.notes, torn=self.torn)

    def _told_inside(self, kinds: Mapping[Kind, Elements]) -> dict[str, str]:
        """Surfaces inside the mesh and what to say of them, before cells are cut."""
        cells = [(cell, nodes) for (cell, _), (nodes, _) in kinds.items()]
        told = {
            name: told_inside(name, parts, self.named.get(name), cells)
            for name, parts in self.surfaces.items()
        }
        return {name: line for name, line in told.items() if line}

    def _by_kind(self, wanted: Sequence[str]) -> dict[Kind, Elements]:
        """Nodes and bodies of the elements of some bodies, by cell and number of nodes."""
        kinds: dict[tuple[str, int], list[tuple[Ints, list[str]]]] = {}
        for (cell, nodes), labels in zip(self.cells, self.bodies, strict=True):
            taken = np.isin(np.array(labels), list(wanted))
            if taken.any():
                own = [label for label in labels if label in wanted]
                kinds.setdefault((cell, nodes.shape[1]), []).append((nodes[taken], own))
        return {
            kind: (np.concatenate([n for n, _ in parts]), [x for _, own in parts for x in own])
            for kind, parts in kinds.items()
        }

    def _cut(self, kinds: Mapping[Kind, Elements]) -> WholeMesh:
        """The same bodies in tetrahedra, where not all cells are of one kind that a mesh can have.

        Raises:
            InputError: Some cells have middle nodes on their edges, others have none.
        """
        curved = [n > COUNT[cell] for cell, n in kinds]
        said = in_words(kinds)
        if any(curved) and not all(curved):
            raise InputError(f"{said}: cells of one order are needed")
        middles = None
        if all(curved):
            given = [(cell, nodes) for (cell, _), (nodes, _) in kinds.items()]
            middles = Middles(self.points, given)
        cut = WholeMesh(self.points if middles is None else middles.points)
        for (cell, _), (nodes, labels) in kinds.items():
            corners, owner = tetrahedra(cell, nodes[:, : COUNT[cell]], self.points)
            rows = corners if middles is None else np.hstack([corners, middles.of(corners)])
            cut.add_cells("tetrahedron", rows, [labels[k] for k in owner.tolist()])
        cut.node_sets = self.node_sets
        cut.surfaces = {
            name: [part for facets in parts for part in triangles(facets)]
            for name, parts in self.surfaces.items()
        }
        count = sum(len(nodes) for _, nodes in cut.cells)
        cut.notes = (*self.notes, f"{said} are cut into {count} tetrahedra")
        cut.torn = self.torn
        return cut

    def _of_kind(self, cell: str, nodes: Ints, labels: Sequence[str]) -> MeshArrays:
        """The arrays of elements of one kind with the body of each."""
        names = list(dict.fromkeys(labels))
        points, cells, degree = _in_order(cell, nodes, self.points)
        used, compact = np.unique(cells, return_inverse=True)
        numbers = np.full(len(points), -1, dtype=np.int64)
        numbers[used] = np.arange(len(used))
        rows = np.array(labels)
        places = {name: np.flatnonzero(rows == name) for name in names}
        mesh = MeshArrays(
            cell, degree, points[used], compact.reshape(cells.shape), places, {}, degree
        )
        check_cells(mesh)
        groups = _Groups(mesh, names)
        for name, parts in self.surfaces.items():
            for corners in parts:
                groups.add_surface(name, numbers[corners])
        for name, found in self.node_sets.items():
            if name not in self.surfaces:
                groups.add_nodes(name, numbers[found])
        return replace(mesh, facets=groups.facets, nodes=self._points_and_edges(groups, numbers))

    def _points_and_edges(self, groups: _Groups, numbers: Ints) -> dict[str, Floats]:
        """Sets of nodes of each body, what they have beyond their facets: places by "body.set"."""
        mesh, found = groups.mesh, {}
        for body, cells in mesh.bodies.items():
            own = np.zeros(len(mesh.points) + 1, dtype=bool)  # the last one stands for no node
            own[mesh.cells[cells]] = True
            for name, nodes in self.node_sets.items():
                key = f"{body}.{name.removeprefix(f'{body}.')}"
                there = numbers[nodes][own[numbers[nodes]]]
                if name not in self.surfaces and key in groups.facets:
                    there = np.setdiff1d(there, groups.facets[key])
                if len(there):
                    found[key] = mesh.points[there]
        return found


def in_triangles(mesh: WholeMesh, kinds: Mapping[Kind, Elements]) -> WholeMesh:
    """A mesh in the plane whose quadrilaterals are cut at the shorter diagonal.

    Args:
        mesh: The mesh.
        kinds: Nodes and bodies of the elements of it that are taken, by cell and number of nodes.

    Raises:
        InputError: Some cells have middle nodes on their edges, others have none, or all have.
    """
    said = in_words(kinds)
    if any(n > 4 or (cell == "triangle" and n > 3) for cell, n in kinds):
        raise InputError(f"{said}: a mesh in the plane of order 2 needs cells of one kind")
    cut = WholeMesh(mesh.points, node_sets=mesh.node_sets, surfaces=mesh.surfaces, torn=mesh.torn)
    for (cell, _), (nodes, labels) in kinds.items():
        if cell == "triangle":
            cut.add_cells(cell, nodes, labels)
            continue
        corners = mesh.points[nodes]
        across = np.linalg.norm(corners[:, [0, 1]] - corners[:, [2, 3]], axis=2)
        turned = np.where((across[:, 0] <= across[:, 1])[:, None], nodes, np.roll(nodes, -1, 1))
        cut.add_cells("triangle", turned[:, [0, 1, 2]], labels)
        cut.add_cells("triangle", turned[:, [0, 2, 3]], labels)
    count = sum(len(nodes) for _, nodes in cut.cells)
    cut.notes = (*mesh.notes, f"{said} are taken as {count} triangles")
    return cut


def _in_order(cell: str, nodes: Ints, points: Floats) -> tuple[Floats, Ints, int]:
    """Points, cells in DOLFINx's order, and their degree."""
    order = CORNERS[cell]
    corners = nodes[:, order]
    count = len(order) + len(EDGES[cell])
    if nodes.shape[1] == len(order):
        return points, corners, 1
    cells = np.empty((len(nodes), len(cell_nodes(cell, 2))), dtype=np.int64)
    cells[:, : len(order)] = corners
    given = {frozenset(edge): len(order) + k for k, edge in enumerate(EDGES[cell])}
    if nodes.shape[1] > count:
        faces = FACES if cell == "hexahedron" else [tuple(order)]
        given |= {frozenset(face): count + k for k, face in enumerate(faces)}
        cells[:, -1] = nodes[:, -1]
    missing = []
    for ends, places in middle_nodes(cell):
        for end, place in zip(ends, places, strict=True):
            own = frozenset(order[k] for k in end)
            if own in given:
                cells[:, place] = nodes[:, given[own]]
            else:
                edges = [given[frozenset(edge)] for edge in EDGES[cell] if own.issuperset(edge)]
                missing.append((place, corners[:, end], nodes[:, edges]))
    if missing:
        points = _with_faces(points, cells, missing)
    if missing and cell == "hexahedron":
        middle = 0.25 * (points[nodes[:, 8:20]].sum(axis=1) - points[nodes[:, :8]].sum(axis=1))
        cells[:, -1] = len(points) + np.arange(len(cells))
        points = np.concatenate([points, middle])
    return points, cells, 2


def _with_faces(points: Floats, cells: Ints, missing: Sequence[tuple[int, Ints, Ints]]) -> Floats:
    """The points with one in each face, where the shape functions of eight nodes have its middle.

    Args:
        points: Places of the nodes.
        cells: Gets the numbers of the new ones.
        missing: Column of the cells, corners of the face and middle nodes of its edges.
    """
    corners = np.concatenate([rows for _, rows, _ in missing])
    edges = np.concatenate([rows for _, _, rows in missing])
    _, first, face = np.unique(
        np.sort(corners, axis=1), axis=0, return_index=True, return_inverse=True
    )
    middles = 0.5 * points[edges[first]].sum(axis=1) - 0.25 * points[corners[first]].sum(axis=1)
    numbers = (len(points) + face.reshape(-1)).reshape(len(missing), -1)
    for (place, _, _), found in zip(missing, numbers, strict=True):
        cells[:, place] = found
    return np.concatenate([points, middles])


class _Groups:
    """Facet groups of a mesh by the corners or nodes of a format's sets.

    Args:
        mesh: The cells.
        names: Bodies in the order of their labels.
    """

    def __init__(self, mesh: MeshArrays, names: Sequence[str]) -> None:
        self.mesh = mesh
        local = CELL_FACETS[mesh.cell]
        sides = mesh.cells[:, local].reshape(-1, local.shape[1])
        keys, self._first, self._side, counts = np.unique(
            np.sort(sides, axis=1),
            axis=0,
            return_index=True,
            return_inverse=True,
            return_counts=True,
        )
        self._known = {tuple(key): k for k, key in enumerate(keys.tolist())}
        self._free = counts == 1
        full = facet_nodes(mesh.cell, mesh.degree)
        self._nodes = mesh.cells[:, full].reshape(-1, full.shape[1])
        self._corners, self._names = keys, list(names)
        self._body = np.repeat(mesh.labels, len(local))
        self.facets: dict[str, Ints] = {}

    def add_surface(self, name: str, corners: Ints) -> None:
        """Add the free facets of a surface by their corners, -1 for those of bodies not taken.

        Raises:
            InputError: Some are facets of no cell.
        """
        rows = np.sort(corners[(corners >= 0).all(axis=1)], axis=1).tolist()
        places = [self._known.get(tuple(row), -1) for row in rows]
        loose = places.count(-1)
        if loose:
            text = f"{loose} of {len(places)} facets belong to no cell of a body"
            raise InputError(f"facet group {name!r}: {text}")
        found = np.unique(np.array(places, dtype=np.int64))
        self._add(name, found[self._free[found]])

    def add_nodes(self, name: str, nodes: Ints) -> None:
        """Add the facets at the boundary with all corners among some nodes, if there are any."""
        marked = np.zeros(int(self._corners.max(initial=0)) + 1, dtype=bool)
        marked[nodes[(nodes >= 0) & (nodes < len(marked))]] = True
        self._add(name, np.flatnonzero(marked[self._corners].all(axis=1) & self._free))

    def _add(self, name: str, found: Ints) -> None:
        rows = self._first[found]
        for label, body in enumerate(self._names):
            own = rows[self._body[rows] == label]
            if len(own):
                key = f"{body}.{name.removeprefix(f'{body}.')}"
                before = self.facets.get(key, np.zeros((0, self._nodes.shape[1]), dtype=np.int64))
                self.facets[key] = np.concatenate([before, self._nodes[own]])
