"""Shape functions and geometry of facets.

Requirement: facets are surfaces like any other; shape functions in the node order of DOLFINx.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

TOPOLOGIES = ("tri3", "tri6", "quad4", "quad8", "quad9")
# shape functions have coefficients up to 16 and sums of nine terms: some 1e-15
ROUNDING = 1e-13


def coordinates(topology: str, count: int, seed: int = 0) -> np.ndarray:
    """Random coordinates inside the reference facet."""
    u, v = np.random.default_rng(seed).uniform(0.0, 1.0, (2, count))
    return np.column_stack((u, v * (1.0 - u) if topology.startswith("tri") else v))


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_functions_take_their_values_at_the_nodes(meshes: SimpleNamespace, topology: str) -> None:
    """N_i is one at node i and zero at the others, in the order of the nodes."""
    nodes = meshes.nodes[topology]
    value, _, _ = meshes.facet(topology, 1, 0.2).surface().shapes(np.zeros(len(nodes)), nodes)
    assert np.array_equal(value[:, : len(nodes)], np.eye(len(nodes)))
    assert not value[:, len(nodes) :].any()


@pytest.mark.parametrize("topology", TOPOLOGIES)
@pytest.mark.parametrize("flip", [False, True])
def test_functions_are_those_of_their_monomials(
    meshes: SimpleNamespace, topology: str, flip: bool
) -> None:
    """Values and derivatives, against the functions found from their nodal values by a linear
    system; a flipped facet has its two coordinates exchanged."""
    xi = coordinates(topology, 50)
    value, d1, d2 = meshes.facet(topology, 1, 0.2).surface([flip]).shapes(np.zeros(50), xi)
    at = xi[:, ::-1] if flip else xi
    k = len(meshes.nodes[topology])
    orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
    found = [value, d1[..., 0], d1[..., 1], d2[..., 0], d2[..., 1], d2[..., 2]]
    for (du, dv), f in zip(orders, found, strict=True):
        wanted = meshes.shapes(topology, at, *((dv, du) if flip else (du, dv)))
        assert np.abs(f[:, :k] - wanted).max() < ROUNDING
    assert np.abs(value.sum(axis=1) - 1.0).max() < ROUNDING
    assert np.abs(d1.sum(axis=1)).max() < ROUNDING
    assert np.abs(d2.sum(axis=1)).max() < ROUNDING


@pytest.mark.parametrize("topology", ["tri3", "tri6", "quad4", "quad9"])
def test_functions_are_those_of_basix(meshes: SimpleNamespace, topology: str) -> None:
    """Node order and functions of DOLFINx, value and derivatives up to the second."""
    basix = pytest.importorskip("basix")
    cell = basix.CellType.triangle if topology.startswith("tri") else basix.CellType.quadrilateral
    degree = 1 if topology in {"tri3", "quad4"} else 2
    element = basix.create_element(
        basix.ElementFamily.P, cell, degree, basix.LagrangeVariant.equispaced
    )
    xi = coordinates(topology, 20)
    table = element.tabulate(2, xi)[..., 0]
    value, d1, d2 = meshes.facet(topology, 1, 0.2).surface().shapes(np.zeros(20), xi)
    k = table.shape[2]
    found = [value, d1[..., 0], d1[..., 1], d2[..., 0], d2[..., 1], d2[..., 2]]
    # basix inverts a Vandermonde matrix: a few digits less
    for wanted, f in zip(table, found, strict=True):
        assert np.abs(f[:, :k] - wanted).max() < 1e-12
    sides = basix.topology(cell)[1]
    facet = meshes.facet(topology, 1, 0.2)
    ends = facet.surface().core.sides()[:, 1:]
    assert [sorted(e) for e in ends.tolist()] == [sorted(s) for s in sides]


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_derivatives_by_order(meshes: SimpleNamespace, topology: str) -> None:
    """Halving the step quarters the error of central differences of rho and rho_i.

    Polynomials of second degree a coordinate have no third derivative along it: there the
    difference is exact and only rounding, 1e-16 / step, is left.
    """
    surface = meshes.facet(topology, 3, 0.6).surface()
    xi = coordinates(topology, 20, 5)
    facet = np.zeros(20)
    j = surface.jet(facet, xi)
    for k in range(2):
        errors = []
        for h in (1e-2, 5e-3):
            step = h * np.eye(2)[k]
            up, down = surface.jet(facet, xi + step), surface.jet(facet, xi - step)
            first = (up.position - down.position) / (2 * h) - j.d1[:, k]
            second = (up.d1 - down.d1) / (2 * h) - j.d2[:, [k, k + 1]]
            errors.append(max(np.abs(first).max(), np.abs(second).max()))
        assert errors[0] < 1e-12 or 3.9 < errors[0] / errors[1] < 4.1


@pytest.mark.parametrize("topology", TOPOLOGIES)
@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize("bend", [0.05, 0.5])
def test_identities_of_the_geometry(
    meshes: SimpleNamespace, topology: str, flip: bool, bend: float
) -> None:
    """Gauss, Weingarten, the connection from the metric [Konyukhov Schweizerhof 2006, (3), (8)].

    The derivatives of n and of a_ij come from the jet alone, by the product rule. Relative to the
    largest term, 1e-12: rounding times the condition of metrics up to some 1e3.
    """
    for seed in range(10):
        surface = meshes.facet(topology, seed, bend).surface([flip])
        xi = coordinates(topology, 20, seed)
        j, g = surface.jet(np.zeros(20), xi), surface.geometry(np.zeros(20), xi)
        dd = j.d2[:, [[0, 1], [1, 2]]]  # rho_ij
        small = 1e-12 * (1.0 + np.abs(g.christoffel).max() + np.abs(g.h_mixed).max()) ** 2
        cross = np.cross(j.d1[:, 0], j.d1[:, 1])
        n = cross / np.linalg.norm(cross, axis=1)[:, None]
        assert np.abs(n - g.normal).max() < small
        gauss = np.einsum("pkij,pkc->pijc", g.christoffel, j.d1) + np.einsum(
            "pij,pc->pijc", g.h_co, n
        )
        assert np.abs(gauss - dd).max() < small
        dcross = np.cross(dd[:, :, 0], j.d1[:, None, 1]) + np.cross(j.d1[:, None, 0], dd[:, :, 1])
        dn = (dcross - np.einsum("pc,pd,pid->pic", n, n, dcross)) / np.linalg.norm(cross, axis=1)[
            :, None, None
        ]
        weingarten = -np.einsum("pki,pkc->pic", g.h_mixed, j.d1)
        assert np.abs(dn - weingarten).max() < small
        da = np.einsum("pikc,pjc->pijk", dd, j.d1)
        da = da + np.swapaxes(da, 1, 2)
        lowered = 0.5 * (da + np.swapaxes(da, 2, 3) - np.moveaxis(da, 3, 1))  # [l, i, j]
        christoffel = np.einsum("pkl,plij->pkij", g.a_contra, lowered)
        assert np.abs(christoffel - g.christoffel).max() < small


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_flip_turns_the_normal_and_nothing_else(meshes: SimpleNamespace, topology: str) -> None:
    """n and the sign of the curvature turn; position, area and Gauss curvature stay."""
    mesh = meshes.facet(topology, 4, 0.4)
    xi = coordinates(topology, 20)
    a = mesh.surface().geometry(np.zeros(20), xi)
    b = mesh.surface([True]).geometry(np.zeros(20), xi[:, ::-1])
    assert np.abs(a.normal + b.normal).max() < ROUNDING
    assert np.abs(a.area - b.area).max() < ROUNDING
    # curvatures of some 1 to 10 here
    assert np.abs(a.mean_curvature + b.mean_curvature).max() < 1e-11
    assert np.abs(a.gaussian_curvature - b.gaussian_curvature).max() < 1e-11
