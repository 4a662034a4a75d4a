"""Smooth surfaces over meshes of linear facets.

Requirement: normals that hardly jump across edges, positions nearer to the surface that the mesh
approximates, exact derivatives, flat and sharp parts untouched.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from anisocontact.base.errors import InputError
from anisocontact.surfaces.facets import FacetSurface
from anisocontact.surfaces.smooth_facets import SmoothSurface

LINEAR = ("tri3", "quad4")


def smooth(mesh, **options) -> SmoothSurface:
    return SmoothSurface(mesh.points, mesh.facets, mesh.topology, **options)


def grid_of_facets(surface: FacetSurface, topology: str) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates inside every facet, and the facets."""
    at = [[0.2, 0.2], [0.5, 0.1], [0.1, 0.6], [0.3, 0.4]]
    at = at if topology == "tri3" else [*at, [0.5, 0.5], [0.9, 0.7]]
    facets = np.repeat(np.arange(len(surface)), len(at))
    return facets, np.tile(at, (len(surface), 1))


@pytest.mark.parametrize("topology", LINEAR)
@pytest.mark.parametrize("shape", ["ball", "ring"])
def test_nearer_to_the_curved_surface(meshes: SimpleNamespace, topology: str, shape: str) -> None:
    """Unit sphere and torus. Facets are off by h^2/8 R and their normals by h/2 R; halving h halves
    the error of their normals, and divides that of patches by four or more (3.5 asserted): on
    twelve facets to a right angle a twentieth of that of the facets at most."""

    def off(x: np.ndarray, n: np.ndarray) -> tuple[float, float]:
        centre = 0.0 if shape == "ball" else meshes.unit(x * [1, 1, 0])
        d = x - centre
        radius = 1.0 if shape == "ball" else 0.3
        return np.abs(np.linalg.norm(d, axis=1) - radius).max(), np.linalg.norm(
            n - meshes.unit(d), axis=1
        ).max()

    errors = {}
    for n in (6, 12):
        mesh = meshes.ball(n, topology) if shape == "ball" else meshes.ring(4 * n, 2 * n, topology)
        for kind, surface in (
            ("facets", mesh.surface()),
            ("patches", smooth(mesh, crease_angle=1)),
        ):
            facet, xi = grid_of_facets(surface, topology)
            position = surface.jet(facet, xi).position
            errors[kind, n] = off(position, surface.geometry(facet, xi).normal)
    assert errors["patches", 12][0] < 0.05 * errors["facets", 12][0]
    assert errors["patches", 12][1] < 0.05 * errors["facets", 12][1]
    assert errors["facets", 6][1] / errors["facets", 12][1] < 2.3
    assert errors["patches", 6][1] / errors["patches", 12][1] > 3.5


@pytest.mark.parametrize("topology", LINEAR)
def test_normals_hardly_jump(meshes: SimpleNamespace, topology: str) -> None:
    """Across the middle of every edge of a ball: a tenth of the jump of the facets at most."""
    mesh = meshes.ball(6, topology)
    jumps = []
    for surface in (mesh.surface(), smooth(mesh)):
        corner = {
            "tri3": [[0.5, 0.5], [0, 0.5], [0.5, 0]],
            "quad4": [[0.5, 0], [0, 0.5], [1, 0.5], [0.5, 1]],
        }[topology]
        f = np.repeat(np.arange(len(surface)), len(corner))
        normal = surface.geometry(f, np.tile(corner, (len(surface), 1))).normal
        sides = mesh.surface().core.sides()
        _, edge = np.unique(np.sort(sides[:, 1:], axis=1), axis=0, return_inverse=True)
        order = np.argsort(edge, kind="stable").reshape(-1, 2)
        jumps.append(np.linalg.norm(normal[order[:, 0]] - normal[order[:, 1]], axis=1).max())
    assert jumps[1] < 0.1 * jumps[0]


@pytest.mark.parametrize("topology", LINEAR)
def test_flat_stays_flat(meshes: SimpleNamespace, topology: str) -> None:
    """On a plane the patches are the facets, whatever the mesh: to rounding."""
    mesh = meshes.flat(100, topology, 3)
    q = meshes.rotation(4)
    surface = SmoothSurface(mesh.points @ q.T, mesh.facets, topology)
    facet, xi = grid_of_facets(surface, topology)
    g = surface.geometry(facet, xi)
    assert np.abs(g.normal - q[:, 2]).max() < 1e-13
    flat = FacetSurface(mesh.points @ q.T, mesh.facets, topology)
    difference = surface.jet(facet, xi).position - flat.jet(facet, xi).position
    assert np.abs(difference).max() < 1e-14


def test_sharp_edges_stay_sharp(meshes: SimpleNamespace) -> None:
    """A cube: no face bends; with a crease angle above a right angle it becomes round."""
    corners = np.array([[i, j, k] for k in (0, 1) for j in (0, 1) for i in (0, 1)], dtype=float)
    faces = [[0, 2, 1, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 6, 3, 7], [0, 4, 2, 6], [1, 3, 5, 7]]
    mesh = meshes.Mesh(corners, np.array(faces), "quad4")
    surface = smooth(mesh)
    facet, xi = grid_of_facets(surface, "quad4")
    sharp, plain = surface.geometry(facet, xi), mesh.surface().geometry(facet, xi)
    assert np.abs(sharp.normal - plain.normal).max() < 1e-15
    round_ = smooth(mesh, crease_angle=np.radians(91.0)).orientation()
    assert round_.outward and round_.volume > 1.2


@pytest.mark.parametrize("topology", LINEAR)
def test_part_of_a_cylinder_up_to_its_border(meshes: SimpleNamespace, topology: str) -> None:
    """A quarter of a cylinder with facets of uneven width: everywhere nearer than the facets,
    twice at least up to corners of the border, where a facet knows its neighbours on one side
    only; five times on the facets inside."""
    angle = np.cumsum([0.0, 8, 11, 9, 12, 8, 10, 12, 9, 11])
    a, z = (v.ravel() for v in np.meshgrid(np.radians(angle), np.linspace(0, 1, 6), indexing="ij"))
    quads = meshes.Mesh(
        np.column_stack((np.cos(a), np.sin(a), z)), meshes.grid(len(angle), 6), "quad4"
    )
    mesh = quads if topology == "quad4" else meshes.halved(quads)
    errors = []
    for surface in (mesh.surface(), smooth(mesh)):
        facet, xi = grid_of_facets(surface, topology)
        n, x = surface.geometry(facet, xi).normal, surface.jet(facet, xi).position
        radial = meshes.unit(x * [1, 1, 0])
        inside = np.abs(np.degrees(np.arctan2(x[:, 1], x[:, 0])) - 45.0) < 25.0
        inside &= np.abs(x[:, 2] - 0.5) < 0.3
        off = np.abs(np.linalg.norm(x[:, :2], axis=1) - 1.0)
        turned = np.linalg.norm(n - radial, axis=1)
        errors.append([off.max(), turned.max(), off[inside].max(), turned[inside].max()])
    gain = np.divide(*errors)
    assert (gain[:2] > 2.0).all() and (gain[2:] > 5.0).all()


@pytest.mark.parametrize("topology", LINEAR)
def test_derivatives_by_order(meshes: SimpleNamespace, topology: str) -> None:
    """Halving the step quarters the error of central differences of the middles: closed, open and
    creased surfaces."""
    rng = np.random.default_rng(3)
    for mesh, crease in (
        (meshes.ball(3, topology), 3.0),
        (meshes.ball(3, topology), 0.45),
        (meshes.flat(20, topology, 5), 1.0),
    ):
        points = mesh.points + 0.02 * rng.normal(size=mesh.points.shape)
        surface = SmoothSurface(points, mesh.facets, topology, crease_angle=crease)
        exact = surface.middle_derivatives(points)
        move = rng.normal(size=points.shape)

        def middles(x: np.ndarray, surface: SmoothSurface = surface) -> np.ndarray:
            return surface._smoothing.middles(np.ascontiguousarray(x)).ravel()

        wanted = exact @ move.ravel()
        errors = []
        for h in (2e-3, 1e-3):
            found = (middles(points + h * move) - middles(points - h * move)) / (2 * h)
            errors.append(np.linalg.norm(found - wanted))
        assert 3.8 < errors[0] / errors[1] < 4.2
        assert errors[1] < 1e-3 * np.linalg.norm(wanted)


@pytest.mark.parametrize("topology", LINEAR)
def test_moves_and_projects_like_a_surface(meshes: SimpleNamespace, topology: str) -> None:
    """After an update it is the surface built there, and rigid motion moves it along, to 1e-12."""
    mesh = meshes.ball(4, topology)
    rng = np.random.default_rng(5)
    surface = smooth(mesh, crease_angle=np.pi)
    x = 1.1 * meshes.unit(rng.normal(size=(500, 3)))
    p = surface.project(x)
    assert (p.status == 0).all() and (p.feature == 0).mean() > 0.95
    q, move = meshes.rotation(6), np.array([1.0, 2.0, 3.0])
    surface.update(mesh.points @ q.T + move)
    r = surface.project(x @ q.T + move)
    assert np.abs(r.gap - p.gap).max() < 1e-12
    assert np.abs(r.normal @ q - p.normal).max() < 1e-12
    stretched = mesh.points * [1.0, 1.2, 0.7]
    surface.update(stretched)
    fresh = SmoothSurface(stretched, mesh.facets, topology, crease_angle=np.pi)
    assert np.array_equal(surface.project(x).gap, fresh.project(x).gap)


def test_mistakes(meshes: SimpleNamespace) -> None:
    """One line for each."""
    mesh = meshes.ball(1, "quad9")
    with pytest.raises(InputError, match=r"^topology: given 'quad9', allowed: tri3, quad4$"):
        smooth(mesh)
    with pytest.raises(InputError, match=r"^crease_angle: given -1, 0 to pi allowed$"):
        smooth(meshes.ball(1, "tri3"), crease_angle=-1)
    with pytest.raises(InputError, match=r"^connectivity: facet 0: node 9 given, "):
        SmoothSurface(np.zeros((3, 3)), [[0, 1, 9]], "tri3")
