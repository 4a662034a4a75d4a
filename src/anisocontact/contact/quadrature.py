"""Surface-to-surface contact: points on the facets, areas and basis of the displacement there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats, Locals
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import basix, facet_sides, geometry, scalar_element
from anisocontact.mesh.idealisation import SOLID, Idealisation

#: Nodes of rows and columns, (p, r) and (p, c), -1 for none, and blocks (p, 3 r, 3 c), or one 3 x 3
#: matrix for each pair of nodes, (p, r, c, 3, 3).
type Couplings = tuple[Locals, Locals, Floats]


@dataclass(frozen=True, eq=False)
class FacetQuadrature:
    """Quadrature points of m facets, q on each, with the k nodes of a facet.

    Attributes:
        nodes: Local nodes (blocks of three unknowns) of each facet, (m, k).
        basis: Value of each node's basis function at each point, (m, q, k).
        weights: Area that belongs to each point in the reference configuration, (m, q), length^2.
        reference: Position of each point in the reference configuration, (m q, 3), length.
        gradient: Derivatives of the basis along the two coordinates of the facet, (m, q, k, 2).
        tangents: Derivatives of the position in the reference configuration, (m, q, 2, 3), length.
        rows: Number of the first nodes whose basis functions are not all zero; all if None.
        turn: Of edges of a mesh in the plane: change of the second tangent, which is that across
            the plane, with the position of the point, (3, 3); None of facets in space.
        spread: Shares of the nodes in the position that it goes with, (m, q, k); `basis` if None.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        >>> points = facet_quadrature(model.space, model.facets("bar.top"), 2)
        >>> points.count, points.nodes.shape  # 4 points on each of 4 facets of 4 nodes
        (16, (4, 4))
    """

    nodes: Locals
    basis: Floats
    weights: Floats
    reference: Floats
    gradient: Floats
    tangents: Floats
    rows: int | None = None
    turn: Floats | None = None
    spread: Floats | None = None

    @property
    def across(self) -> Floats:
        """Shares of the nodes in the position that the tangent across a plane goes with."""
        return self.basis if self.spread is None else self.spread

    @property
    def count(self) -> int:
        """Number of points on this rank."""
        return self.weights.size

    @property
    def areas(self) -> Floats:
        """Area of each point, (m q,), length^2."""
        return self.weights.reshape(-1)

    @cached_property
    def of_rule(self) -> Floats:
        """Weights of the rule: what the area of the tangents is multiplied by, (m, q)."""
        return self.weights / _norm(_cross(self.tangents[:, :, 0], self.tangents[:, :, 1]))

    @cached_property
    def interpolation(self) -> scipy.sparse.csr_array:
        """Matrix that takes a nodal field to the points, (m q, local nodes touched)."""
        basis, nodes = self.row_basis, self.nodes[:, : self.rows]
        m, q, k = basis.shape
        columns = np.broadcast_to(nodes[:, None, :], (m, q, k))
        starts = np.arange(0, m * q * k + 1, k)
        shape = (m * q, int(nodes.max(initial=-1)) + 1)
        entries = (basis.reshape(-1), columns.reshape(-1).astype(np.int64), starts)
        return scipy.sparse.csr_array(entries, shape=shape)

    @property
    def at_rest(self) -> Surfaced:
        """The facets in the reference configuration."""
        return Surfaced(self, self.tangents)

    def at_points(self, nodal: Floats) -> Floats:
        """Nodal vectors interpolated to the points: (local nodes, 3) -> (m q, 3)."""
        return np.asarray(self.interpolation @ nodal[: self.interpolation.shape[1]])

    def moved(self, nodal: Floats) -> Surfaced:
        """The facets with displaced nodes, (local nodes, 3), length."""
        own = nodal[self.nodes]
        tangents = self.tangents + self.gradient.swapaxes(2, 3) @ own[:, None]
        if self.turn is not None:
            tangents[:, :, 1] += self.across @ own @ self.turn.T
        return Surfaced(self, tangents)

    def to_nodes(self, traction: Floats, out: Floats, areas: Floats | None = None) -> None:
        """Add `integral of basis * traction` to the nodal vectors `out`, (local nodes, 3).

        Args:
            traction: At each point, (m q, 3), stress.
            out: Nodal forces, (local nodes, 3), force.
            areas: Area of each point, (m q,), length^2; that of the reference if not given.
        """
        weights = self.areas if areas is None else areas
        forces = self.interpolation.T @ (weights[:, None] * traction)
        out[: len(forces)] += forces

    @property
    def row_basis(self) -> Floats:
        """Basis functions of the nodes that forces act on, (m, q, r)."""
        return self.basis[:, :, : self.rows]

    def facet_matrices(self, point_matrices: Floats, areas: Floats | None = None) -> Floats:
        """`integral of basis_a D basis_b` on each facet.

        Args:
            point_matrices: D at each point, (m q, 3, 3), stress/length.
            areas: Area of each point, (m q,), length^2; that of the reference if not given.

        Returns:
            One matrix for each facet, rows and columns node by node, (m, 3 r, 3 k).
        """
        basis, (m, q, k) = self.row_basis, self.basis.shape
        r = basis.shape[2]
        weights = self.weights if areas is None else areas.reshape(m, q)
        weighted = weights[..., None, None] * point_matrices.reshape(m, q, 3, 3)
        columns = weighted[:, :, :, None, :] * basis[:, :, None, :, None]
        # (m, r, q) (m, q, 3 r 3): one product of small matrices per facet.
        blocks = (basis.swapaxes(1, 2) @ columns.reshape(m, q, 9 * r)).reshape(m, 3 * r, 3 * r)
        return blocks if r == k else np.pad(blocks, ((0, 0), (0, 0), (0, 3 * (k - r))))

    def tangent_matrices(self, by_tangent: Floats, areas: Floats) -> Floats:
        """`integral of basis_a D_i gradient_b,i` on each facet.

        Args:
            by_tangent: D_i at each point, derivatives by the tangents, (m q, 2, 3, 3).
            areas: Area of each point, (m q,), length^2.

        Returns:
            One matrix for each facet, rows and columns node by node, (m, 3 r, 3 k).
        """
        basis, (m, q, k) = self.row_basis, self.basis.shape
        weighted = (areas[:, None, None, None] * by_tangent).reshape(m, q, 2, 3, 3)
        blocks = np.einsum("mqa,mqdij,mqbd->maibj", basis, weighted, self.gradient, optimize=True)
        if self.turn is not None:
            across = weighted[:, :, 1] @ self.turn
            blocks += np.einsum("mqa,mqij,mqb->maibj", basis, across, self.across)
        return np.asarray(blocks.reshape(m, 3 * basis.shape[2], 3 * k))


@dataclass(frozen=True)
class Surfaced:
    """Facets of a quadrature in another configuration.

    Attributes:
        quadrature: The facets in the reference configuration.
        tangents: Derivatives of the position along the facet coordinates, (m, q, 2, 3), length.
    """

    quadrature: FacetQuadrature
    tangents: Floats

    @cached_property
    def normals(self) -> Floats:
        """The normals that the tangents make, as long as their area, (m, q, 3), length^2."""
        return _cross(self.tangents[:, :, 0], self.tangents[:, :, 1])

    @cached_property
    def _size(self) -> Floats:
        return _norm(self.normals)

    @property
    def _weights(self) -> Floats:
        return self.quadrature.of_rule

    @cached_property
    def areas(self) -> Floats:
        """Area of each point in this configuration, (m q,), length^2."""
        return (self._weights * self._size).reshape(-1)

    def area_matrices(self, traction: Floats) -> Floats:
        """`sum over the points of basis_a t (d area / d x_b)` on each facet.

        Args:
            traction: t at each point, (m q, 3), stress.

        Returns:
            One matrix for each facet, rows and columns node by node, (m, 3 r, 3 k).
        """
        m, q, k = self.quadrature.basis.shape
        rows = self.quadrature.row_basis
        pulls = (rows[..., None] * traction.reshape(m, q, 1, 3)).reshape(m, q, 3 * rows.shape[2])
        changes = self.area_changes.reshape(m, q, 3 * k)
        return np.asarray(pulls.swapaxes(1, 2) @ changes)

    @cached_property
    def area_changes(self) -> Floats:
        """`d area / d x_b` of each point, (m, q, k, 3), length."""
        unit = self.normals / self._size[..., None]
        sides = np.stack(
            [_cross(self.tangents[:, :, 1], unit), _cross(unit, self.tangents[:, :, 0])], axis=2
        )
        one = self.quadrature
        changes = one.gradient @ sides
        if one.turn is not None:
            changes += one.across[..., None] * (sides[:, :, 1] @ one.turn)[:, :, None]
        return np.asarray(self._weights[..., None, None] * changes)

    @property
    def vector_areas(self) -> Floats:
        """Area of each point times the normal that the tangents make, (m, q, 3), length^2."""
        return np.asarray(self._weights[..., None] * self.normals)

    def vector_area_matrices(self) -> Floats:
        """`sum over the points of basis_a (d vector area / d x_b)` on each facet.

        Returns:
            One matrix for each facet, rows and columns node by node, (m, 3 k, 3 k).
        """
        m, _, k = self.quadrature.basis.shape
        # d(t1 x t2) = (g2 t1 - g1 t2) x dx, with g the gradient of the basis of x_b
        first, second = self.tangents[:, :, None, 0], self.tangents[:, :, None, 1]
        g = self.quadrature.gradient[..., None]
        arm = g[..., 1, :] * first - g[..., 0, :] * second
        turned = np.cross(arm[..., None, :], np.eye(3))
        if (turn := self.quadrature.turn) is not None:
            across = np.cross(self.tangents[:, :, 0, None], turn.T)
            turned += self.quadrature.across[..., None, None] * across[:, :, None]
        weighted = self._weights[..., None] * self.quadrature.basis
        blocks = np.einsum("mqa,mqbji->maibj", weighted, turned, optimize=True)
        return np.asarray(blocks.reshape(m, 3 * k, 3 * k))


def _norm(vectors: Floats) -> Floats:
    return np.asarray(np.sqrt(np.einsum("...i,...i->...", vectors, vectors)))


def _cross(a: Floats, b: Floats) -> Floats:
    """Vector products, (..., 3): a third of the time of NumPy's for some hundred vectors."""
    out = np.empty(a.shape)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[..., i] = a[..., j] * b[..., k] - a[..., k] * b[..., j]
    return out


def chosen_degree(given: int | None, order: int, augmented: bool) -> int:
    """Degree of the quadrature: the one given, or one that suits the displacement.

    Twice the order integrates the product of two basis functions. Where every point carries a
    multiplier, the order: with more points than nodes the surfaces would be held together where
    they cannot follow each other.

    Args:
        given: What the user asks for, if anything.
        order: Order of the displacement.
        augmented: Whether every point carries a multiplier.

    Raises:
        InputError: It is below 1.

    Example:
        >>> chosen_degree(None, 2, False), chosen_degree(None, 2, True), chosen_degree(5, 2, True)
        (4, 2, 5)
    """
    if given is None:
        return order if augmented else 2 * order
    if given < 1:
        raise InputError(f"{given!r} given, must be >= 1", "degree")
    return given


def mean_size(quadrature: FacetQuadrature, comm: Any) -> float:
    """Length of a facet: square root of the mean area, or in the plane mean length; collective."""
    line, extent = quadrature.turn is not None, quadrature.areas
    if line:
        rule = quadrature.of_rule / quadrature.of_rule.sum(axis=1, keepdims=True)
        extent = rule * _norm(quadrature.tangents[:, :, 0])
    total, facets = comm.allreduce(np.array([extent.sum(), len(quadrature.nodes)]))
    mean = total / max(facets, 1.0)
    return float(mean if line else np.sqrt(mean))


def inward(space: Any, facets: Locals, quadrature: FacetQuadrature) -> Flags:
    """Whether the first tangent cross the second points into the body, of each facet, (m,).

    Args:
        space: Space of the displacement.
        facets: As of `facet_quadrature`.
        quadrature: What it gave.
    """
    cells, _ = facet_sides(space.mesh, np.sort(facets))
    _, nodes, points = geometry(space.mesh)
    area = quadrature.at_rest.vector_areas.sum(axis=1)
    middle = quadrature.reference.reshape(*quadrature.weights.shape, 3).mean(axis=1)
    away = middle - points[nodes[cells]].mean(axis=1)
    return np.asarray(np.einsum("mi,mi->m", away, area) < 0.0)


def facet_quadrature(
    space: Any, facets: Locals, degree: int, idealisation: Idealisation = SOLID
) -> FacetQuadrature:
    """Quadrature of the given degree on boundary facets.

    Args:
        space: Vector Lagrange space of order 1 or 2.
        facets: Local facets on the boundary; those of other ranks are left out.
        degree: Polynomials up to this degree are integrated exactly on flat facets.
        idealisation: What the mesh is taken for; areas are those of the thickness, or of the
            circumference.

    Returns:
        Points, areas and basis.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        >>> found = facet_quadrature(model.space, model.facets("bar.top"), 2)
        >>> round(float(found.areas.sum()), 12)
        1.0
    """
    dim = space.mesh.topology.dim
    if idealisation.dim != dim:
        raise ValueError(f"a mesh of {dim} dimensions taken for one of {idealisation.dim}")
    cells, local = facet_sides(space.mesh, np.sort(facets))
    element = scalar_element(space)
    shape_element, shape_nodes, shape_points = geometry(space.mesh)
    rule, weights = _facet_rule(element.cell_type, degree)
    closure = element.entity_closure_dofs[-2]
    basis, gradient = _on_sides(element, rule, closure)
    position, slope = _on_sides(shape_element, rule)
    nodes = shape_points[shape_nodes[cells]]
    tangents = np.einsum("mqbt,mbi->mqti", slope[local], nodes)
    places = np.einsum("mqb,mbi->mqi", position[local], nodes)
    gradients = gradient[local]
    if dim == 2:
        tangents = np.concatenate([tangents, idealisation.across(places)[:, :, None]], axis=2)
        gradients = np.concatenate([gradients, np.zeros_like(gradients)], axis=3)
    area = _norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]))
    return FacetQuadrature(
        nodes=space.dofmap.list[cells[:, None], np.array(closure)[local]],
        basis=basis[local],
        weights=weights * area,
        reference=places.reshape(-1, 3),
        gradient=gradients,
        tangents=tangents,
        turn=idealisation.turn if dim == 2 else None,
    )


def _on_sides(
    element: Any, rule: Floats, dofs: Sequence[Any] | None = None
) -> tuple[Floats, Floats]:
    """Functions of a cell at the points of a rule on each of its sides.

    Args:
        element: The functions.
        rule: Points on the reference facet, (q, t).
        dofs: Those that count on each side; all if not given.

    Returns:
        Values (sides, q, b), and derivatives along the facet (sides, q, b, t).
    """
    corners = basix.geometry(element.cell_type)
    values, slopes = [], []
    for side, vertices in enumerate(basix.topology(element.cell_type)[-2]):
        origin = corners[vertices[0]]
        edges = corners[vertices[1 : 1 + rule.shape[1]]] - origin
        table = element.tabulate(1, origin + rule @ edges)[..., 0]
        table = table if dofs is None else table[:, :, dofs[side]]
        values.append(table[0])
        slopes.append(np.einsum("td,dqb->qbt", edges, table[1:]))
    return np.stack(values), np.stack(slopes)


def _facet_rule(cell: Any, degree: int) -> tuple[Floats, Floats]:
    (facet,) = set(basix.cell.subentity_types(cell)[-2])
    points, weights = basix.make_quadrature(facet, degree)
    return np.asarray(points), np.asarray(weights)
