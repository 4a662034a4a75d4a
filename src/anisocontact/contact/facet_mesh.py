"""Boundary facets of a mesh as surfaces: their nodes, orientation and shape functions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from anisocontact import _core
from anisocontact.base.array_types import Flags, Floats, Locals
from anisocontact.base.fenicsx import basix, facet_sides, scalar_element
from anisocontact.contact.quadrature import FacetQuadrature
from anisocontact.contact.sweep import Sweep
from anisocontact.surfaces.facets import outward_flips

#: Facet of a cell by the type of the cell and the order of the displacement; in the plane that
#: which is swept out of an edge.
TOPOLOGY = {
    ("tetrahedron", 1): "tri3",
    ("tetrahedron", 2): "tri6",
    ("hexahedron", 1): "quad4",
    ("hexahedron", 2): "quad9",
    ("triangle", 1): "quad4",
    ("triangle", 2): "quad9",
    ("quadrilateral", 1): "quad4",
    ("quadrilateral", 2): "quad9",
}
#: Corners of the facet of a cell, which come first.
_CORNERS = {"tetrahedron": 3, "hexahedron": 4, "triangle": 2, "quadrilateral": 2}


@dataclass(frozen=True)
class FacetMesh:
    """Facets with the nodes of the displacement.

    Attributes:
        topology: "tri3", "tri6", "quad4" or "quad9".
        nodes: Local nodes of each facet in the order of its reference facet, (m, k).
        flip: Whether the normal of the node order points into the body, (m,).
        sweep: How they are swept out of edges; None of facets in space.
    """

    topology: str
    nodes: Locals
    flip: Flags
    sweep: Sweep | None = None

    @property
    def share(self) -> float:
        """Share of the area that counts."""
        return 1.0 if self.sweep is None else self.sweep.share


def facet_mesh(
    space: Any, facets: Locals, sweep: Sweep | None = None, order: int | None = None
) -> FacetMesh:
    """Boundary facets that this rank owns, with outward orientation.

    Args:
        space: Vector Lagrange space of order 1 or 2.
        facets: Local facets on the boundary.
        sweep: Of a mesh in the plane.
        order: Order of the displacement there, 1 where middle nodes follow the corners; that of
            the space if left out.

    Returns:
        Nodes and orientation.
    """
    nodes, cells = _of_cells(space, facets)
    element, x = scalar_element(space), node_positions(space)
    middle = x[space.dofmap.list[cells]].mean(axis=1)
    cell = element.cell_type.name
    topology = TOPOLOGY[cell, order or element.degree]
    if order == 1:
        nodes = nodes[:, : _CORNERS[cell]]
    if sweep is not None:
        x, nodes = sweep.positions(x), sweep.facets(nodes)
    return FacetMesh(topology, nodes, outward_flips(x, nodes, topology, middle), sweep)


def facet_nodes(space: Any, facets: Locals) -> Locals:
    """Local nodes of boundary facets, of edges in the plane, (m, k)."""
    return _of_cells(space, facets)[0]


def _of_cells(space: Any, facets: Locals) -> tuple[Locals, Locals]:
    """Nodes of facets in increasing order, and the cells that they bound."""
    cells, local = facet_sides(space.mesh, np.sort(facets))
    closure = np.array(scalar_element(space).entity_closure_dofs[-2])
    return space.dofmap.list[cells[:, None], closure[local]].astype(np.int32), cells


def node_positions(space: Any) -> Floats:
    """Positions of the local nodes in the reference configuration, (nodes, 3), length."""
    return np.asarray(space.tabulate_dof_coordinates())


def facet_corners(topology: str) -> list[int]:
    """Vertices of a facet, once around."""
    return [0, 1, 2] if topology.startswith("tri") else [0, 1, 3, 2]


def facet_areas(mesh: FacetMesh, x: Floats) -> Floats:
    """Area of each facet from its corners, (m,), length^2.

    Args:
        mesh: The facets.
        x: Positions of the local nodes, (nodes, 3), length.
    """
    corners = x[mesh.nodes[:, facet_corners(mesh.topology)]]
    fan = np.cross(corners[:, 1:-1] - corners[:, :1], corners[:, 2:] - corners[:, :1])
    return np.asarray(0.5 * mesh.share * np.linalg.norm(fan, axis=2).sum(axis=1))


class FacetShapes:
    """Shape functions of a reference facet, and what it is.

    Args:
        topology: "tri3", "tri6", "quad4" or "quad9".

    Attributes:
        cell: Triangle or quadrilateral.
        order: Order of the shape functions.
        middle: Its middle, (2,).
    """

    def __init__(self, topology: str) -> None:
        triangle = topology.startswith("tri")
        self.cell = basix.CellType.triangle if triangle else basix.CellType.quadrilateral
        self.order = 2 if topology in {"tri6", "quad9"} else 1
        self.middle = np.full(2, 1.0 / 3.0 if triangle else 0.5)
        self._element = basix.create_element(
            basix.ElementFamily.P, self.cell, self.order, basix.LagrangeVariant.equispaced
        )

    def at(self, points: Floats) -> tuple[Floats, Floats]:
        """Shape functions and their derivatives.

        Args:
            points: Coordinates on the reference facet, (n, 2).

        Returns:
            Values (n, k) and derivatives along the two coordinates (n, k, 2).
        """
        table = np.asarray(self._element.tabulate(1, points))[..., 0]
        return table[0], np.stack([table[1], table[2]], axis=-1)


@dataclass(frozen=True)
class FacetRule:
    """Quadrature on the reference facet with the shape functions there.

    Attributes:
        points: Coordinates on the reference facet, (q, 2).
        weights: Weights on the reference facet, (q,).
        degree: Polynomials up to this degree are integrated exactly on flat facets.
        shape: Shape functions, (q, k).
        gradient: Their derivatives along the two coordinates, (q, k, 2).
    """

    points: Floats
    weights: Floats
    degree: int
    shape: Floats
    gradient: Floats


def facet_rule(topology: str, degree: int, across: float | None = None) -> FacetRule:
    """Quadrature of the given degree on a facet.

    Args:
        topology: "tri3", "tri6", "quad4" or "quad9".
        degree: Polynomials up to this degree are integrated exactly on flat facets.
        across: Of a facet swept out of an edge, with points on that edge: share of its area.

    Returns:
        Weights and shape functions.
    """
    shapes = FacetShapes(topology)
    rule: Any = basix.make_quadrature(shapes.cell, degree)
    points, weights = np.asarray(rule[0]), np.asarray(rule[1])
    if across is not None:
        line: Any = basix.make_quadrature(basix.CellType.interval, degree)
        points = np.column_stack([line[0], np.full(len(line[0]), 0.5)])
        weights = across * np.asarray(line[1])
    return FacetRule(points, weights, degree, *shapes.at(points))


def isoparametric(facets: FacetMesh, rule: FacetRule, reference: Floats) -> FacetQuadrature:
    """Quadrature on facets whose shape is that of the displacement's nodes.

    Args:
        facets: The facets.
        rule: Quadrature on the reference facet.
        reference: Positions of the local nodes in the reference configuration, (nodes, 3), length.
    """
    count = len(facets.nodes)
    corners = reference[facets.nodes]
    gradient = np.tile(rule.gradient, (count, 1, 1, 1))
    tangents = gradient.swapaxes(2, 3) @ corners[:, None]
    stretch = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=2)
    return FacetQuadrature(
        nodes=facets.nodes,
        basis=np.tile(rule.shape, (count, 1, 1)),
        weights=rule.weights * stretch,
        reference=(rule.shape @ corners).reshape(-1, 3),
        gradient=gradient,
        tangents=tangents,
        turn=None if facets.sweep is None else np.zeros((3, 3)),  # the images have it
    )


def node_coordinates(topology: str, corners: Floats) -> Floats:
    """Coordinates of the nodes on the reference facet, (k, 2), from those of its corners."""
    ends = {"tri": ((1, 2), (0, 2), (0, 1)), "quad": ((0, 1), (0, 2), (1, 3), (2, 3))}[
        topology.rstrip("0123456789")
    ]
    if topology in {"tri3", "quad4"}:
        return corners
    middles = [corners[list(pair)].mean(axis=0) for pair in ends]
    return np.array([*corners, *middles, *[corners.mean(axis=0)] * (topology == "quad9")])


def beyond_sides(topology: str, xi: Floats) -> Floats:
    """How far coordinates, (n, 2), are beyond the sides of a facet, (n,); negative inside."""
    last = xi.sum(axis=1) if topology.startswith("tri") else xi.max(axis=1)
    return np.asarray(np.maximum(-xi.min(axis=1), last - 1.0))


def outward_normals(mesh: FacetMesh, now: Floats) -> Floats:
    """Outward unit normals at the middles of facets, (facets, 3)."""
    return _core.facet_normals(mesh.nodes, mesh.flip, _middle_gradient(mesh.topology), now)


@cache
def _middle_gradient(topology: str) -> Floats:
    """Derivatives of the shape functions at the middle of a facet, (k, 2)."""
    shapes = FacetShapes(topology)
    return np.ascontiguousarray(shapes.at(shapes.middle[None])[1][0])
