"""Tabulated fields: order of convergence to the field they were sampled from.

Requirement: bilinear second order, bicubic fourth, scattered points second (smooth) and first
(nearest); v and -v are one line; periodic coordinates have no seam; derivatives are those of what
is interpolated. Source: interpolation theory, docs/theory/direction-fields.md.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import (
    from_callable,
    from_reparametrisation,
    make_directions,
    tensor,
    tensor_derivative,
)
from anisocontact.surfaces import make_surface

VALUES = (4.0, 1.0)
RNG = np.random.default_rng(3)


def plane() -> Any:
    return make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))


def cylinder() -> Any:
    return make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=0.8, start=(1, 0, 0))


def polar_case() -> tuple[Any, Any, Any, Any]:
    """A plane beside the pole of a polar field."""
    field = make_directions("polar", axis=((0, 0, 0), (0, 0, 1)), angle=0.3)
    return plane(), field, (0.5, 0.5), (1.5, 1.5)


def thread_case() -> tuple[Any, Any, Any, Any]:
    """All around a cylinder, with a direction that changes along it; the seam is inside."""
    surface = cylinder()
    field = make_directions("polar", axis=((0.3, 3.0, 0.2), (1.0, 0.2, 0.4)), angle=0.9)
    return surface, field, (-np.pi, -0.5), (np.pi, 0.5)


CASES = {"polar": polar_case, "seam": thread_case}


def sampled(surface: Any, field: Any) -> Any:
    """The first axis of a field as a function of the position, its sign at random."""

    def f(x: Any) -> Any:
        e, valid = field.axes(surface, surface.project(x).xi)
        assert valid.all()
        return e[:, 0] * RNG.choice([-1.0, 1.0], len(x))[:, None]

    return f


def points_between(lower: Any, upper: Any, margin: float = 0.0) -> Any:
    """2000 random points, off the open ends by a part of the grid's width."""
    lower, upper = np.array(lower), np.array(upper)
    inset = margin * (upper - lower) * ((upper - lower) < 6.0)  # not where it goes all around
    return np.random.default_rng(4).uniform(lower + inset, upper - inset, (2000, 2))


def order(errors: list[float]) -> float:
    """Order from the last two of errors at doubled numbers of nodes."""
    return float(np.log2(errors[-2] / errors[-1]))


@pytest.mark.parametrize(("interpolation", "expected"), [("bilinear", 2.0), ("bicubic", 4.0)])
@pytest.mark.parametrize("case", CASES)
def test_grid_converges(case: str, interpolation: str, expected: float) -> None:
    """Largest error of the tensor over 2000 points, grids of 48 to 192 cells.

    The two cells at each open end are left out of the order: the one-sided slopes there have an
    error of the same order with a larger constant, which hides it. Tolerance: 0.25 in the order,
    what the largest error over random points scatters.
    """
    surface, field, lower, upper = CASES[case]()
    xi = points_between(lower, upper, margin=0.1)
    exact = tensor(surface, xi, field, VALUES, "spatial")
    errors = []
    for n in (48, 96, 192):
        counts = (n, n) if case == "seam" else (n + 1, n + 1)
        table = from_callable(
            surface,
            sampled(surface, field),
            counts=counts,
            lower=lower,
            upper=upper,
            interpolation=interpolation,
        )
        errors.append(np.abs(tensor(surface, xi, table, VALUES, "spatial") - exact).max())
    assert order(errors) == pytest.approx(expected, abs=0.25), errors
    assert errors[-1] < {"bilinear": 5e-3, "bicubic": 1e-5}[interpolation]


@pytest.mark.parametrize(("interpolation", "expected"), [("smooth", 2.0), ("nearest", 1.0)])
def test_scattered_points_converge(interpolation: str, expected: float) -> None:
    """Root mean square error of the tensor with n^2 jittered points on a cylinder.

    Tolerance: 0.3 in the order, random points.
    """
    surface, field, lower, upper = thread_case()
    xi = np.random.default_rng(4).uniform(lower, np.multiply(upper, (1.0, 0.9)), (1000, 2))
    xi[:, 1] *= 0.8
    exact = tensor(surface, xi, field, VALUES, "spatial")
    errors = []
    for n in (16, 32, 64):
        lines = [
            np.linspace(a, b, k, endpoint=False)
            for a, b, k in zip(lower, upper, (5 * n, n), strict=True)
        ]
        nodes = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
        nodes += RNG.uniform(0.2, 0.8, nodes.shape) * (1.0 / n)
        x = surface.position(nodes)
        vectors = sampled(surface, field)(x)
        table = make_directions(
            "tabulated-points", points=x, vectors=vectors, interpolation=interpolation
        )
        error = tensor(surface, xi, table, VALUES, "spatial") - exact
        errors.append(np.sqrt(np.mean(error**2)))
    assert order(errors) == pytest.approx(expected, abs=0.3), errors


def test_scan_lines() -> None:
    """Points that are ten times as dense along lines as across are fitted across the lines too.

    The error is that of the distance of the lines, 0.1, to which the table above gives 4e-4 (16
    points per length); tolerance 2e-3.
    """
    surface, field, lower, upper = polar_case()
    lines = [np.linspace(a, b, n) for a, b, n in zip(lower, upper, (101, 11), strict=True)]
    x = surface.position(np.stack(np.meshgrid(*lines), axis=-1).reshape(-1, 2))
    table = make_directions("tabulated-points", points=x, vectors=sampled(surface, field)(x))
    xi = points_between(lower, upper)
    exact = tensor(surface, xi, field, VALUES, "spatial")
    error = tensor(surface, xi, table, VALUES, "spatial") - exact
    assert np.sqrt(np.mean(error**2)) < 2e-3


@pytest.mark.parametrize("kind", ["grid", "points"])
def test_a_direction_is_a_line(kind: str) -> None:
    """v and -v give the same tensor, bit for bit; source: requirement, v (x) v is even."""
    surface, field, lower, upper = polar_case()
    lines = [np.linspace(a, b, 9) for a, b in zip(lower, upper, strict=True)]
    xi = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
    e = field.axes(surface, xi)[0][:, 0]
    flipped = e * RNG.choice([-1.0, 1.0], len(e))[:, None]

    def table(v: Any) -> Any:
        if kind == "grid":
            return make_directions(
                "tabulated-grid", lower=lower, upper=upper, counts=(9, 9), vectors=v
            )
        return make_directions("tabulated-points", points=surface.position(xi), vectors=v)

    at = points_between(lower, upper)
    first, second = (tensor(surface, at, table(v), VALUES) for v in (e, flipped))
    assert np.array_equal(first, second)


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("interpolation", ["bicubic", "smooth"])
def test_orientation_of_the_table_is_kept(interpolation: str, sense: float) -> None:
    """Where the table has a sense, so has the axis; source: docs/theory/direction-fields.md."""
    surface, field, lower, upper = polar_case()

    def along(x: Any) -> Any:
        return sense * field.axes(surface, x[:, :2])[0][:, 0]

    xi = points_between(lower, upper)
    if interpolation == "smooth":
        x = surface.position(xi)
        table = make_directions("tabulated-points", points=x, vectors=along(x))
    else:
        table = from_callable(surface, along, lower=lower, upper=upper)
    e = table.axes(surface, xi)[0][:, 0]
    assert np.all(np.einsum("ni,ni->n", e, along(surface.position(xi))) > 0.99)


def test_two_directions() -> None:
    """Two vectors a node make axes that are not orthogonal, fourth order.

    Tolerance: 1e-5 with 65 nodes, as the one direction above.
    """
    surface = cylinder()
    field = make_directions("from-vectors", first=(0.3, 0.2, 1.0), second=(2.0, 1.0, 0.1))
    lower, upper = (0.8, -0.5), (1.8, 0.5)

    def f(x: Any) -> Any:
        e, _ = field.axes(surface, surface.project(x).xi)
        return e[:, 0], e[:, 1]

    table = from_callable(surface, f, lower=lower, upper=upper)
    xi = points_between(lower, upper)
    exact = tensor(surface, xi, field, VALUES, "spatial")
    assert np.abs(tensor(surface, xi, table, VALUES, "spatial") - exact).max() < 1e-5
    e, _ = table.axes(surface, xi)
    assert np.abs(np.einsum("ni,ni->n", e[:, 0], e[:, 1])).max() > 0.1


def test_derivative_converges_too() -> None:
    """dA_ij/dxi^k of a bicubic table goes to that of the field with third order.

    Tolerance: 0.3 in the order.
    """
    surface, field, lower, upper = polar_case()
    xi = points_between(lower, upper, margin=0.1)
    exact = tensor_derivative(surface, xi, field, VALUES)
    errors = []
    for n in (33, 65):
        table = from_callable(
            surface, sampled(surface, field), counts=(n, n), lower=lower, upper=upper
        )
        errors.append(np.abs(tensor_derivative(surface, xi, table, VALUES) - exact).max())
    assert order(errors) == pytest.approx(3.0, abs=0.3), errors


def test_slopes_are_continuous() -> None:
    """Across the borders of bicubic cells A_ij and its derivative have no jump.

    Tolerance: 1e-6, the distance of the two points of 1e-9 cells times the second derivative, and
    rounding of the slopes.
    """
    surface, field, lower, upper = polar_case()
    table = from_callable(surface, sampled(surface, field), counts=(9, 9), lower=lower, upper=upper)
    border = np.column_stack([np.repeat(0.5 + np.arange(1, 8) / 8, 50), RNG.uniform(0.6, 1.4, 350)])
    step = (1e-10, 0.0)
    for quantity in (tensor, tensor_derivative):
        left, right = (
            quantity(surface, border + s, table, VALUES) for s in (step, np.negative(step))
        )
        assert np.abs(left - right).max() < 1e-6


def test_reparametrisation() -> None:
    """(44)-(47): axes along the lines of polar coordinates, given by their Jacobian.

    alpha = (r, phi) of xi = (x, y). Tolerance: 2e-5 with 65 nodes, as the polar case above.
    """
    surface, _, lower, upper = polar_case()

    def jacobian(xi: Any) -> Any:
        x, y = xi.T
        r = np.hypot(x, y)
        return np.stack([x / r, y / r, -y / r**2, x / r**2], axis=-1).reshape(-1, 2, 2)

    table = from_reparametrisation(surface, jacobian, lower=lower, upper=upper)
    field = make_directions("polar", axis=((0, 0, 0), (0, 0, 1)))
    xi = points_between(lower, upper)
    exact = tensor(surface, xi, field, VALUES)
    assert np.abs(tensor(surface, xi, table, VALUES) - exact).max() < 2e-5


def test_no_direction_where_the_table_does_not_tell() -> None:
    """Around a pole that lies between the nodes the table has no direction, and says so.

    Source: requirement, never a silent axis.
    """
    surface = plane()
    table = from_callable(
        surface, lambda x: x * (1, 1, 0), lower=(-1, -1), upper=(1, 1), counts=(8, 8)
    )
    _, valid = table.axes(surface, [[0.0, 0.0], [0.01, 0.01], [0.5, 0.5], [1.0, 1.0], [1.01, 0.0]])
    assert valid.tolist() == [False, False, True, True, False]
    scattered = make_directions(
        "tabulated-points",
        points=[[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        vectors=np.eye(3)[[0, 0, 0]],
        radius=1.2,
    )
    _, valid = scattered.axes(surface, [[0.3, 0.3], [0.0, -1.0], [3.0, 3.0]])
    assert valid.tolist() == [True, False, False]  # three points, one in reach, none


@pytest.mark.parametrize("interpolation", ["bilinear", "bicubic"])
@pytest.mark.parametrize(("waves", "coarse"), [(10.0, False), (60.0, True), (200.0, True)])
def test_a_grid_that_is_too_coarse_is_told(interpolation: str, waves: float, coarse: bool) -> None:
    """Directions that turn by more than a right angle between two nodes.

    Requirement: the table is wrong by any angle between the nodes, all nodes being right, and a
    warning says so; one that follows is not warned of. Source: lines that turn by 90 degrees and
    more from node to node cannot be told from others: 60 and 200 radians on 64 cells of 1/32 are
    107 and 358 degrees a cell, 10 are 18.
    """
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))

    def turning(x: Any) -> Any:
        angle = waves * x[:, 0]
        return np.stack((np.cos(angle), np.sin(angle), 0.0 * angle), axis=1)

    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        from_callable(plane, turning, lower=(-1, -1), upper=(1, 1), interpolation=interpolation)
    assert [str(one.message).startswith("counts: (65, 65) given, too few") for one in given] == (
        [True] if coarse else []
    )
    assert all(one.filename == __file__ for one in given)


def test_poles_and_borders_of_textures_are_not_told_of() -> None:
    """Rays about a pole between nodes, and two textures side by side: few cells differ there."""
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    fields = (
        lambda x: x,
        lambda x: np.where(x[:, :1] > 0.01, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for f in fields:
            from_callable(plane, f, counts=(64, 64), lower=(-1, -1), upper=(1, 1))


def test_a_function_that_knows_the_nodes_alone() -> None:
    """An array that was made for the nodes is taken as it is."""
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    table = from_callable(
        plane, lambda _: np.ones((25, 3)), counts=(5, 5), lower=(-1, -1), upper=(1, 1)
    )
    assert table.axes(plane, [[0.1, 0.2]])[1].all()
