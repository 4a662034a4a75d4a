"""Where the law is evaluated: integration points on slave facets that move with their nodes."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Locals
from anisocontact.contact.facet_mesh import FacetMesh
from anisocontact.contact.history import Snapshot
from anisocontact.contact.near_facets import NearFacets
from anisocontact.contact.quadrature import FacetQuadrature, Surfaced, mean_size
from anisocontact.surfaces import FacetSets

#: Share of the normal along free displacements below which a point does not move along it.
FREE = 0.1


class IntegrationPoints:
    """Integration points of the slave facets of one pass.

    Args:
        quadrature: Points on the facets.
        flip: Whether the normal of the tangents points into the body, of each facet, (m,).
        current_area: Whether the area of a point is that of now or of the reference.
        comm: Communicator of the mesh.

    Attributes:
        quadrature: As given.
        facet: Number of the facet of each point, (n,).
        current_area: As given, until `take_area`.
        size: Length of a facet over all ranks, see `mean_size`.
        spread: How far from a point its traction acts, length.
        beside: How far points that stand for nodes are from these, length.
        at_nodes: Whether points are nodes of the mesh.
        polygons: Points around the pieces of facets on which fields go on between nodes, seen from
            outside, (m, corners); none of integration points.

    Example:
        >>> from anisocontact import Adhesion, Contact, ContactLaw, Friction, NormalLaw
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> from anisocontact.surfaces import make_surface
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 1))})
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> adhesion, friction = Adhesion(stiffness=(1, 1)), Friction(coefficients=(0.3, 0.3))
        >>> law = ContactLaw(NormalLaw(penalty=100.0), adhesion, friction)
        >>> points = Contact(model, "block.bottom", plane, law).slave_points
        >>> len(points.facet), round(points.size, 12), points.at_nodes
        (9, 0.5, True)
    """

    spread = beside = 0.0
    at_nodes = False
    polygons: Locals = np.zeros((0, 3), dtype=np.int32)

    def __init__(
        self,
        quadrature: FacetQuadrature,
        flip: Flags,
        *,
        current_area: bool,
        comm: Any,
    ) -> None:
        count, each = quadrature.weights.shape
        self.quadrature = quadrature
        self.facet = np.repeat(np.arange(count), each)
        self.current_area = current_area
        self._sign = np.where(np.repeat(flip, each), -1.0, 1.0)
        self.size = mean_size(quadrature, comm)

    def held(self, fixed: Floats, normal: Floats) -> Flags:
        """Points that cannot move along the normal.

        Args:
            fixed: Projections on prescribed directions of the local nodes, (nodes, 3, 3).
            normal: At the points, (n, 3).
        """
        # images of nodes have the numbers after them, row by row, see `Sweep`
        nodes = self.nodes % max(len(fixed), 1)
        free = free_along(fixed, nodes, self.shape != 0.0, normal)
        return np.asarray(free.max(axis=1) < FREE)

    def all_of(self, there: Flags) -> Flags:
        """Points all of whose nodes are among some local ones, images of nodes not, (n,)."""
        at = self.nodes % max(len(there), 1)
        among = (self.nodes < len(there)) & there[at]
        return np.asarray((among | (self.shape == 0.0)).all(axis=1))

    def peaks(self, areas: Floats) -> Flags:
        """Points whose tractions count among peaks, of those with some areas, (n,)."""
        return np.ones(len(areas), dtype=bool)

    def covered(self, areas: Floats) -> Floats:
        """Share of the weight of each point, of some area, that a master is opposite to, (n,)."""
        return np.ones(len(areas))

    def touching(self, now: Snapshot) -> Floats:
        """Area of each point on which it touches, (n,), length^2."""
        return np.asarray(now.areas * (now.response.status != 0))

    def take_area(self, current: bool) -> None:
        """Take the area of now, or that of the reference."""
        self.current_area = current

    def everywhere(self, nodal: Floats) -> Floats:
        """Values of the nodes as points number them from those of the local nodes; collective."""
        return nodal

    def coupled(self, nodes: Locals) -> Locals:
        """Nodes as `Couplings` name them from those of points."""
        return nodes

    def searched(self, slave: FacetMesh) -> FacetMesh:
        """Facets from which a master is searched, of the slave's own on this rank."""
        return slave

    def unseen(self, near: NearFacets) -> FacetSets:
        """Facets that each point does not look at, from what is near to those that are searched."""
        return near.unseen.take(self.facet)

    @cached_property
    def nodes(self) -> Locals:
        """Local nodes of the facet of each point, (n, k)."""
        return np.repeat(self.quadrature.nodes, self.quadrature.basis.shape[1], axis=0)

    @cached_property
    def shape(self) -> Floats:
        """Their shape functions at the point, (n, k)."""
        return np.ascontiguousarray(self.quadrature.basis.reshape(self.nodes.shape))

    @cached_property
    def gradient(self) -> Floats:
        """Derivatives of these along the coordinates of the facet, (n, k, 2)."""
        return np.ascontiguousarray(self.quadrature.gradient.reshape(*self.nodes.shape, 2))

    @property
    def weight(self) -> Floats:
        """Area of each point, or where it is that of now what that of the tangents counts, (n,)."""
        one = self.quadrature
        return one.of_rule.reshape(-1) if self.current_area else one.areas

    @cached_property
    def outward(self) -> Floats:
        """Outward normals in the reference configuration, (n, 3)."""
        return self.outward_of(self.quadrature.at_rest)

    def positions(self, now: Floats) -> Floats:
        """Positions of the points, (n, 3), from those of the nodes, (nodes, 3), length."""
        return self.quadrature.at_points(now)

    def at(self, now: Floats) -> Surfaced:
        """The facets with their nodes at positions, (nodes, 3), length."""
        one = self.quadrature
        return Surfaced(one, one.gradient.swapaxes(2, 3) @ now[one.nodes][:, None])

    def areas(self, there: Surfaced) -> Floats:
        """Areas of the points, (n,), of facets in some configuration, length^2."""
        return there.areas if self.current_area else self.quadrature.areas

    def outward_of(self, there: Surfaced) -> Floats:
        """Outward normals, (n, 3), of facets in some configuration."""
        cross = self._sign[:, None] * there.normals.reshape(-1, 3)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(cross / np.linalg.norm(cross, axis=1)[:, None])


def free_along(fixed: Floats, nodes: Locals, there: Flags, normal: Floats) -> Floats:
    """Share of the normal of each point along which its nodes can move, (n, k).

    Args:
        fixed: Projections on prescribed directions, (nodes, 3, 3); of images that are turned they
            turn back first.
        nodes: Of each point, (n, k).
        there: Which of these count, (n, k); none at the others.
        normal: At the points, (n, 3).
    """
    out = np.zeros(nodes.shape)
    n = normal[np.nonzero(there)[0]]
    held = np.einsum("mij,mj->mi", fixed[nodes[there]], n)
    out[there] = np.sqrt(np.maximum((n**2).sum(axis=1) - (held**2).sum(axis=1), 0.0))
    return out
