"""Graded bodies that stand for half-spaces, and what a Hertzian pressure looks like."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from anisocontact.base.array_types import Locals
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays
from anisocontact.mesh.merge import lift

Floats = npt.NDArray[np.float64]

#: Half-length and height of every body, in units of the contact radius, which is about one.
EXTENT = 10.0
FACES = {
    "left": (0, 0),
    "right": (0, 1),
    "front": (1, 0),
    "back": (1, 1),
    "z0": (2, 0),
    "z1": (2, 1),
}


def graded_line(n: int, fine: float, growth: float) -> Floats:
    """Points from 0 to `EXTENT`: n cells per unit length up to `fine`, then growing by a factor."""
    count = int(np.ceil(n * fine))
    x = list(np.arange(count + 1) / n)
    step = 1.0 / n
    while x[-1] < EXTENT:
        step *= growth
        x.append(x[-1] + step)
    out = np.array(x)
    tail = out[count:] - out[count]
    out[count:] = out[count] + tail * (EXTENT - out[count]) / tail[-1]
    return out


def _hexahedra(shape: tuple[int, int, int]) -> npt.NDArray[np.int64]:
    number = np.arange(np.prod(shape)).reshape(shape)
    ends = [(slice(None, -1), slice(1, None))] * 3
    corners = [
        number[ends[0][i], ends[1][j], ends[2][k]].reshape(-1)
        for k in (0, 1)
        for j in (0, 1)
        for i in (0, 1)
    ]
    return np.stack(corners, axis=1)


def _faces(shape: tuple[int, ...], cells: Locals) -> dict[str, Locals]:
    """Nodes of the facets on each face of a lattice of cells."""
    place = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, 3)
    sides = cells[:, CELL_FACETS["hexahedron"]].reshape(-1, 4)
    return {
        face: sides[np.all(place[sides, axis] == end * (shape[axis] - 1), axis=1)]
        for face, (axis, end) in FACES.items()
    }


def graded_body(
    name: str,
    n: int,
    *,
    upper: bool,
    radius: float = np.inf,
    growth: float = 1.7,
    fine: float = 1.15,
    both_sides: bool = False,
    patch: float | None = None,
    distorted: float = 0.0,
    order: int = 1,
) -> MeshArrays:
    """A quarter (or half, `both_sides` of x = 0) of a block above or below z = 0.

    Args:
        name: Name of the body; its groups are `name.contact` (at z = 0), `name.far` (opposite),
            `name.x` (symmetry plane x = 0), `name.y` (y = 0) and, if asked for, `name.patch`.
        n: Cells per unit length where it touches; to a depth of 0.4 and to `fine` along the
            surface.
        upper: Whether it lies above z = 0.
        radius: Radius of the sphere its surface is part of.
        growth: Ratio of neighbouring cells beyond.
        fine: Where that begins.
        both_sides: Whether x goes from -`EXTENT`.
        patch: Half-length of a square of the surface about the origin.
        distorted: Most that nodes near the contact are moved at random along each of x and y, over
            the size of a cell.
        order: Order of geometry and displacement.
    """
    h, depth = graded_line(n, fine, growth), graded_line(n, 0.4, growth)
    x = np.concatenate([-h[:0:-1], h]) if both_sides else h
    z = depth if upper else -depth[::-1]
    lattice = np.stack(np.meshgrid(x, h, z, indexing="ij"), axis=-1)
    shape = lattice.shape[:3]
    cells = _hexahedra(shape)
    faces = _faces(shape, cells)
    points = lattice.reshape(-1, 3)
    contact, far = ("z0", "z1") if upper else ("z1", "z0")
    groups = {"contact": faces[contact], "far": faces[far], "x": faces["left"], "y": faces["front"]}
    if patch is not None:
        middle = np.abs(points[faces[contact]].mean(axis=1)[:, :2]).max(axis=1)
        groups["patch"] = faces[contact][middle < patch]
    flat = MeshArrays(
        cell="hexahedron",
        degree=1,
        points=_distorted(points, distorted / n, seed=int(upper)) if distorted else points,
        cells=cells,
        bodies={name: np.arange(len(cells))},
        facets={f"{name}.{group}": nodes for group, nodes in groups.items()},
        order=1,
    )
    mesh = replace(lift(flat), order=2) if order == 2 else flat
    if np.isfinite(radius):
        sag = _sag(mesh.points, radius, upper)
        mesh = replace(mesh, points=mesh.points + np.outer(sag, [0.0, 0.0, 1.0]))
    return mesh


def _distorted(points: Floats, most: float, seed: int) -> Floats:
    """Points near the contact moved at random along x and y, but off x = 0 and y = 0."""
    out = points.copy()
    near = (np.abs(points[:, 2]) < 0.3) & (np.abs(points[:, :2]).max(axis=1) < 1.1)
    way = np.random.default_rng(seed).uniform(-most, most, (int(near.sum()), 2))
    out[near, :2] += np.where(np.abs(points[near, :2]) < 1e-9, 0.0, way)
    return out


def _sag(points: Floats, radius: float, upper: bool) -> Floats:
    """How far the sphere has left the plane, fading to zero at the far end."""
    sag = radius - np.sqrt(radius**2 - np.sum(points[:, :2] ** 2, axis=1))
    return (1.0 if upper else -1.0) * sag * (1.0 - np.abs(points[:, 2]) / EXTENT)


def hertz_fit(points: Floats, pressure: Floats) -> tuple[float, float]:
    """Radius and peak of a Hertzian pressure: p^2 = p0^2 (1 - r^2 / a^2) is a line in r^2.

    Fitted to the points with more than 0.3 of the largest pressure.
    """
    there = pressure > 0.3 * pressure.max()
    r2 = np.sum(points[there, :2] ** 2, axis=1)
    slope, top = np.polyfit(r2, pressure[there] ** 2, 1)
    return float(np.sqrt(-top / slope)), float(np.sqrt(top))


class HalfSpaces:
    """The functions of this file, for the tests beside it."""

    body = staticmethod(graded_body)
    fit = staticmethod(hertz_fit)


@pytest.fixture(scope="session")
def half_spaces() -> type[HalfSpaces]:
    """Graded bodies and the fit of a Hertzian pressure."""
    return HalfSpaces
