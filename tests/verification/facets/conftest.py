"""Meshes of facets and formulas of their own to test against."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial import Delaunay

from anisocontact.surfaces.facets import FacetSurface

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

TRIANGLE = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0.5], [0, 0.5], [0.5, 0]])
SQUARE = np.array(
    [[0, 0], [1, 0], [0, 1], [1, 1], [0.5, 0], [0, 0.5], [1, 0.5], [0.5, 1], [0.5, 0.5]]
)
#: Nodes of the reference facets, and the exponents of u and v of the monomials they span.
NODES = {
    "tri3": TRIANGLE[:3],
    "tri6": TRIANGLE,
    "quad4": SQUARE[:4],
    "quad8": SQUARE[:8],
    "quad9": SQUARE,
}
MONOMIALS = {
    "tri3": [(0, 0), (1, 0), (0, 1)],
    "tri6": [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)],
    "quad4": [(0, 0), (1, 0), (0, 1), (1, 1)],
    "quad8": [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2), (2, 1), (1, 2)],
    "quad9": [(i, j) for i in range(3) for j in range(3)],
}
#: Vertices of the edges, in the order of the nodes on them.
EDGES = {3: [(1, 2), (0, 2), (0, 1)], 4: [(0, 1), (0, 2), (1, 3), (2, 3)]}


def monomials(topology: str, xi: Floats, du: int = 0, dv: int = 0) -> Floats:
    """Derivatives of the monomials at coordinates, (n, number of monomials)."""

    def power(t: Floats, k: int, d: int) -> Floats:
        factor = np.prod([k - i for i in range(d)]) if d else 1.0
        return factor * t ** max(k - d, 0)

    u, v = xi.T
    return np.column_stack([power(u, i, du) * power(v, j, dv) for i, j in MONOMIALS[topology]])


def shapes(topology: str, xi: Floats, du: int = 0, dv: int = 0) -> Floats:
    """Shape functions from the values they have at the nodes, (n, nodes)."""
    return monomials(topology, xi, du, dv) @ np.linalg.inv(monomials(topology, NODES[topology]))


def vertices(topology: str) -> int:
    """Number of vertices of a facet."""
    return 3 if topology.startswith("tri") else 4


@dataclass(frozen=True)
class Mesh:
    """Points and facets of one topology."""

    points: Floats
    facets: Integers
    topology: str

    def surface(self, flip: npt.ArrayLike | None = None) -> FacetSurface:
        """The surface of the core."""
        return FacetSurface(self.points, self.facets, self.topology, flip)

    def moved(self, points: Floats) -> Mesh:
        """The same facets on other points."""
        return replace(self, points=points)

    def sample(self, count: int) -> tuple[Floats, Integers]:
        """Points of each facet on a grid of its coordinates, and the triangles between them.

        Returns:
            Points (facets, grid, 3) and triangles (k, 3) of a facet.
        """
        t = np.linspace(0.0, 1.0, count + 1)
        u, v = (a.ravel() for a in np.meshgrid(t, t, indexing="ij"))
        if vertices(self.topology) == 3:
            v = v * (1.0 - u)
        at = np.column_stack((u, v))
        n = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
        a, b, c, d = (m.ravel() for m in (n[:-1, :-1], n[1:, :-1], n[:-1, 1:], n[1:, 1:]))
        triangles = np.concatenate((np.column_stack((a, b, d)), np.column_stack((a, d, c))))
        return np.einsum("gk,fkc->fgc", shapes(self.topology, at), self.points[self.facets]), (
            triangles
        )


def with_order(mesh: Mesh, topology: str, onto: Callable[[Floats], Floats]) -> Mesh:
    """A mesh of quadratic facets over one of linear ones; `onto` places the new nodes."""
    if topology == mesh.topology:
        return mesh
    sides = EDGES[vertices(mesh.topology)]
    ends = np.sort(np.concatenate([mesh.facets[:, list(e)] for e in sides]), axis=1)
    unique, number = np.unique(ends, axis=0, return_inverse=True)
    n, k = len(mesh.points), len(mesh.facets)
    middle = onto(mesh.points[unique].mean(axis=1))
    facets = np.concatenate((mesh.facets, n + number.reshape(len(sides), k).T), axis=1)
    points = np.concatenate((mesh.points, middle))
    if topology == "quad9":
        centre = onto(mesh.points[mesh.facets].mean(axis=1))
        facets = np.column_stack((facets, len(points) + np.arange(k)))
        points = np.concatenate((points, centre))
    return Mesh(points, facets, topology)


def halved(mesh: Mesh) -> Mesh:
    """Each quadrilateral cut into two triangles."""
    f = mesh.facets
    return Mesh(mesh.points, np.concatenate((f[:, [0, 1, 2]], f[:, [3, 2, 1]])), "tri3")


def grid(n: int, m: int, wrap: tuple[bool, bool] = (False, False)) -> Integers:
    """Quadrilaterals between n x m points; a direction may close on itself."""
    i, j = np.meshgrid(
        np.arange(n if wrap[0] else n - 1), np.arange(m if wrap[1] else m - 1), indexing="ij"
    )
    corner = [((i + a) % n * m + (j + b) % m).ravel() for b in (0, 1) for a in (0, 1)]
    return np.column_stack(corner)


def ball(n: int, topology: str) -> Mesh:
    """Unit sphere: a cube of 6 n^2 squares blown up; normals point outward."""
    t = np.tan(np.linspace(-np.pi / 4, np.pi / 4, n + 1))
    points, facets = [], []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            a, b = (s.ravel() for s in np.meshgrid(t, t, indexing="ij"))
            p = np.empty((a.size, 3))
            p[:, axis], p[:, (axis + 1) % 3], p[:, (axis + 2) % 3] = sign, a, b
            q = grid(n + 1, n + 1) + len(points) * a.size
            points.append(p)
            facets.append(q if sign > 0 else q[:, [0, 2, 1, 3]])
    unique, number = np.unique(np.round(np.concatenate(points), 12), axis=0, return_inverse=True)
    quads = Mesh(unit(unique), number[np.concatenate(facets)], "quad4")
    linear = halved(quads) if vertices(topology) == 3 else quads
    return with_order(linear, topology, unit)


def unit(x: Floats) -> Floats:
    """Each row at length one."""
    return x / np.linalg.norm(x, axis=-1, keepdims=True)


def crumpled(n: int, topology: str, depth: float, seed: int) -> Mesh:
    """A ball with a random radius at every node."""
    mesh = ball(n, topology)
    radius = 1.0 + depth * np.random.default_rng(seed).uniform(-1.0, 1.0, len(mesh.points))
    return mesh.moved(mesh.points * radius[:, None])


def ring(n: int, m: int, topology: str) -> Mesh:
    """Torus of radii 1 and 0.3, n x m facets: periodic in both directions."""

    def onto(x: Floats) -> Floats:
        spine = x * [1.0, 1.0, 0.0]
        spine = unit(spine)
        return spine + 0.3 * unit(x - spine)

    u, v = (
        a.ravel()
        for a in np.meshgrid(
            2 * np.pi * np.arange(n) / n, 2 * np.pi * np.arange(m) / m, indexing="ij"
        )
    )
    r = 1.0 + 0.3 * np.cos(v)
    x = np.column_stack((r * np.cos(u), r * np.sin(u), 0.3 * np.sin(v)))
    quads = Mesh(x, grid(n, m, (True, True)), "quad4")
    return with_order(halved(quads) if vertices(topology) == 3 else quads, topology, onto)


def flat(count: int, topology: str, seed: int) -> Mesh:
    """Unit square in z = 0 of about `count` random facets; normals point up."""
    rng = np.random.default_rng(seed)
    n = max(1, round(np.sqrt(count / (2 if vertices(topology) == 3 else 1))))
    t = np.linspace(0.0, 1.0, n + 1)
    u, v = (a.ravel() for a in np.meshgrid(t, t, indexing="ij"))
    inner = (u > 0) & (u < 1), (v > 0) & (v < 1)
    u = u + inner[0] * rng.uniform(-0.3, 0.3, u.size) / n
    v = v + inner[1] * rng.uniform(-0.3, 0.3, v.size) / n
    x = np.column_stack((u, v, np.zeros(u.size)))
    mesh = Mesh(x, grid(n + 1, n + 1), "quad4")
    if vertices(topology) == 3:
        f = Delaunay(x[:, :2]).simplices
        d = x[f][:, 1:, :2] - x[f][:, :1, :2]
        area = d[:, 0, 0] * d[:, 1, 1] - d[:, 0, 1] * d[:, 1, 0]
        f, area = f[np.abs(area) > 1e-9], area[np.abs(area) > 1e-9]
        mesh = Mesh(x, np.where((area > 0)[:, None], f, f[:, [0, 2, 1]]), "tri3")
    return with_order(mesh, topology, lambda p: p)


def bent_facet(topology: str, seed: int, bend: float) -> Mesh:
    """One facet, its nodes moved at random by up to `bend` / 2 of its size."""
    n = NODES[topology]
    x = np.column_stack((n, np.zeros(len(n))))
    x = x + bend * np.random.default_rng(seed).uniform(-0.5, 0.5, x.shape)
    return Mesh(x, np.arange(len(n))[None], topology)


def rotation(seed: int) -> Floats:
    """A random rotation, (3, 3)."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


@pytest.fixture(scope="session")
def meshes() -> SimpleNamespace:
    """Meshes and reference formulas."""
    return SimpleNamespace(
        topologies=tuple(NODES),
        nodes=NODES,
        shapes=shapes,
        vertices=vertices,
        Mesh=Mesh,
        ball=ball,
        crumpled=crumpled,
        ring=ring,
        flat=flat,
        facet=bent_facet,
        grid=grid,
        halved=halved,
        rotation=rotation,
        unit=unit,
    )
