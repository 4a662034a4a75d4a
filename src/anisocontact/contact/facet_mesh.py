"""Boundary facets of a mesh as surfaces: their nodes, orientation and shape functions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.sparse

from anisocontact.base.fenicsx import basix, facet_sides, scalar_element
from anisocontact.surfaces.facets import FacetSets, FacetSurface, outward_flips

Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]

#: Facet of a cell by the type of the cell and the order of the displacement.
TOPOLOGY = {
    ("tetrahedron", 1): "tri3",
    ("tetrahedron", 2): "tri6",
    ("hexahedron", 1): "quad4",
    ("hexahedron", 2): "quad9",
}


@dataclass(frozen=True)
class FacetMesh:
    """Facets with the nodes of the displacement.

    Attributes:
        topology: "tri3", "tri6", "quad4" or "quad9".
        nodes: Local nodes of each facet in the order of its reference facet, (m, k).
        flip: Whether the normal of the node order points into the body, (m,).
    """

    topology: str
    nodes: Ints
    flip: npt.NDArray[np.bool_]


def facet_mesh(space: Any, facets: Ints) -> FacetMesh:
    """Boundary facets that this rank owns, with outward orientation.

    Args:
        space: Vector Lagrange space of order 1 or 2.
        facets: Local facets on the boundary.

    Returns:
        Nodes and orientation.
    """
    cells, local = facet_sides(space.mesh, np.sort(facets))
    element = scalar_element(space)
    closure = np.array(element.entity_closure_dofs[2])
    nodes = space.dofmap.list[cells[:, None], closure[local]].astype(np.int32)
    x = node_positions(space)
    middle = x[space.dofmap.list[cells]].mean(axis=1)
    topology = TOPOLOGY[element.cell_type.name, element.degree]
    return FacetMesh(topology, nodes, outward_flips(x, nodes, topology, middle))


def near_facets(
    mesh: FacetMesh, numbers: Ints, surface: FacetSurface, x: Floats, apart: float
) -> FacetSets:
    """Facets that a facet cannot meet: those that are near from the beginning.

    Args:
        mesh: The facets.
        numbers: Their numbers on the surface, (m,).
        surface: The surface they are part of, in the reference configuration.
        x: Positions of the local nodes there, (nodes, 3), length.
        apart: Facets nearer than this to the middle or a corner of a facet are near, and its
            neighbours.

    Returns:
        A set for each facet, with itself.
    """
    corners = x[mesh.nodes[:, facet_corners(mesh.topology)]]
    points = np.concatenate([corners, corners.mean(axis=1, keepdims=True)], axis=1)
    count, each, _ = points.shape
    found = surface.within(points.reshape(-1, 3), apart)
    rings = surface.rings(numbers)
    owner = np.concatenate(
        [
            np.repeat(np.arange(count * each) // each, np.diff(found.offsets)),
            np.repeat(np.arange(count), np.diff(rings.offsets)),
        ]
    )
    all_facets = len(surface)
    pairs = np.unique(owner * all_facets + np.concatenate([found.facets, rings.facets]))
    offsets = np.searchsorted(pairs, np.arange(count + 1) * all_facets)
    return FacetSets(offsets.astype(np.int64), (pairs % all_facets).astype(np.int32))


def node_positions(space: Any) -> Floats:
    """Positions of the local nodes in the reference configuration, (nodes, 3), length."""
    return np.asarray(space.tabulate_dof_coordinates())


def facet_corners(topology: str) -> list[int]:
    """Vertices of a facet, once around."""
    return [0, 1, 2] if topology.startswith("tri") else [0, 1, 3, 2]


def group_area(mesh: FacetMesh, x: Floats) -> float:
    """Area of facets from their corners, length^2.

    Args:
        mesh: The facets.
        x: Positions of the local nodes, (nodes, 3), length.
    """
    corners = x[mesh.nodes[:, facet_corners(mesh.topology)]]
    fan = np.cross(corners[:, 1:-1] - corners[:, :1], corners[:, 2:] - corners[:, :1])
    return float(0.5 * np.linalg.norm(fan, axis=2).sum())


class FacetShapes:
    """Shape functions of a reference facet, and what it is.

    Args:
        topology: "tri3", "tri6", "quad4" or "quad9".

    Attributes:
        cell: Triangle or quadrilateral.
        order: Order of the shape functions.
        middle: Its middle, (2,).
        overlap_degree: Degree that integrates the functions of `moments` times a position on a
            part of the facet.
    """

    def __init__(self, topology: str) -> None:
        triangle = topology.startswith("tri")
        self.cell = basix.CellType.triangle if triangle else basix.CellType.quadrilateral
        self.order = 2 if topology in {"tri6", "quad9"} else 1
        self.middle = np.full(2, 1.0 / 3.0 if triangle else 0.5)
        self.overlap_degree = (1 if triangle else 2) * self.order + 1
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

    def moments(self, points: Floats, degree: int) -> Floats:
        """Orthonormal polynomials up to a degree (in each coordinate of a quadrilateral), (n, k).

        Args:
            points: Coordinates on the reference facet, (n, 2).
            degree: The degree.
        """
        kind = basix.PolynomialType.legendre
        return np.asarray(basix.tabulate_polynomials(kind, self.cell, degree, points)).T


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


def facet_rule(topology: str, degree: int) -> FacetRule:
    """Quadrature of the given degree on a facet.

    Args:
        topology: "tri3", "tri6", "quad4" or "quad9".
        degree: Polynomials up to this degree are integrated exactly on flat facets.

    Returns:
        Weights and shape functions.
    """
    shapes = FacetShapes(topology)
    rule: Any = basix.make_quadrature(shapes.cell, degree)
    points, weights = np.asarray(rule[0]), np.asarray(rule[1])
    return FacetRule(points, weights, degree, *shapes.at(points))


class SlavePoints:
    """Quadrature points on slave facets that move with their nodes.

    Args:
        facets: The slave facets.
        rule: Quadrature on the reference facet.
        reference: Positions of the local nodes in the reference configuration, (nodes, 3), length.
        current_area: Whether the area of a point is that of now or of the reference.
        share: Share of the area that counts.
        comm: Communicator of the mesh.

    Attributes:
        facet: Number of the facet of each point, (n,).
        nodes: Nodes of the facet of each point, (n, k).
        shape: Their shape functions at the point, (n, k).
        gradient: Derivatives of these, (n, k, 2).
        weight: Weight of each point: its area, or where the area is that of now what the area of
            the tangents is multiplied by, (n,).
        outward: Outward normals in the reference configuration, (n, 3).
        size: Length of a facet: square root of the mean area, over all ranks.
    """

    def __init__(
        self,
        facets: FacetMesh,
        rule: FacetRule,
        reference: Floats,
        current_area: bool,
        share: float,
        comm: Any,
    ) -> None:
        count, q = len(facets.nodes), len(rule.weights)
        self.facet = np.repeat(np.arange(count), q)
        self.nodes = np.repeat(facets.nodes, q, axis=0)
        self.shape = np.tile(rule.shape, (count, 1))
        self.gradient = np.tile(rule.gradient, (count, 1, 1))
        first = np.arange(0, self.nodes.size + 1, self.nodes.shape[1])
        self._interpolation = scipy.sparse.csr_array(
            (self.shape.ravel(), self.nodes.ravel(), first),
            shape=(len(self.nodes), int(self.nodes.max(initial=-1)) + 1),
        )
        tangents = np.einsum("pkd,pki->pdi", self.gradient, reference[self.nodes])
        stretch = np.linalg.norm(np.cross(tangents[:, 0], tangents[:, 1]), axis=1)
        weights = np.tile(rule.weights, count)
        self._share, self._stretch = share * weights, stretch
        self.take_area(current_area)
        sign = np.where(np.repeat(facets.flip, q), -1.0, 1.0)
        cross = np.cross(tangents[:, 0], tangents[:, 1])
        self.outward, self._sign = (sign / stretch)[:, None] * cross, sign
        area, facets_in_all = comm.allreduce(np.array([(weights * stretch).sum(), count]))
        self.size = float(np.sqrt(area / max(facets_in_all, 1.0)))

    def take_area(self, current: bool) -> None:
        """Take the area of now, or that of the reference."""
        self.current_area = current
        self.weight = self._share if current else self._share * self._stretch

    def areas(self, now: Floats) -> Floats:
        """Areas of the points, (n,), from the positions of the nodes, (nodes, 3), length^2."""
        if not self.current_area:
            return self.weight
        tangents = np.einsum("pkd,pki->pdi", self.gradient, now[self.nodes])
        cross = np.cross(tangents[:, 0], tangents[:, 1])
        return np.asarray(self.weight * np.linalg.norm(cross, axis=1))

    def positions(self, now: Floats) -> Floats:
        """Positions of the points, (n, 3), from those of the nodes, (nodes, 3), length."""
        return np.asarray(self._interpolation @ now[: self._interpolation.shape[1]])

    def outward_at(self, now: Floats) -> Floats:
        """Outward normals, (n, 3), from the positions of the nodes, (nodes, 3), length."""
        tangents = np.einsum("pkd,pki->pdi", self.gradient, now[self.nodes])
        cross = self._sign[:, None] * np.cross(tangents[:, 0], tangents[:, 1])
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(cross / np.linalg.norm(cross, axis=1)[:, None])
