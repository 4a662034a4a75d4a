"""Facet groups that a mesh lacks, named by where their facets are: in a box, on a plane ..."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from anisocontact.base import registry
from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.arrays import connected
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import facet_nodes
from anisocontact.base.python_file import called
from anisocontact.base.registry import Entry, Parameter
from anisocontact.base.typed import typed
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays
from anisocontact.mesh.split import Route

#: Share of the size of a body that files round places to.
ROUNDED = 1e-5
#: Share of the radius by which nodes may miss a cylinder.
ROUGH = 1e-3
#: Places along each side of a facet that are looked at for the one nearest to a point.
PLACES = 5
#: Corners of the edges of a facet by how many corners it has, quadrilaterals as DOLFINx has them.
_EDGES = {
    2: ((0,), (1,)),
    3: ((0, 1), (1, 2), (2, 0)),
    4: ((0, 1), (1, 3), (3, 2), (2, 0)),
}


@dataclass(frozen=True)
class Boundary:
    """Facets at the boundary of bodies, on every process those of all.

    Attributes:
        corners: Places of their corners, (facets, 3 or 4, 3), length.
        vertices: Numbers of these nodes, (facets, 3 or 4).
        nodes: Numbers of all of their nodes, vertices first, (facets, nodes).
        normals: Outward unit normals, (facets, 3).
        bodies: Number of the body of each, (facets,).
    """

    corners: Floats
    vertices: Ints
    nodes: Ints
    normals: Floats
    bodies: Ints

    @classmethod
    def of(cls, mesh: MeshArrays) -> Boundary:
        """The boundary of a mesh."""
        local, full = CELL_FACETS[mesh.cell], facet_nodes(mesh.cell, mesh.degree)
        vertices = mesh.cells[:, local].reshape(-1, local.shape[1])
        # A facet is counted on the process that has its lowest vertex.
        keys = np.sort(vertices, axis=1)
        route = Route(mesh.comm, mesh.node_split.owner(keys[:, 0]))
        _, row, count = np.unique(
            route.there(keys), axis=0, return_inverse=True, return_counts=True
        )
        free = route.back(count[row.reshape(-1)]) == 1
        here = mesh.with_points()
        places = here.points[here.cells[:, local]]
        middles = here.points[here.cells[:, np.unique(local)]].mean(axis=1)
        normals = _normals(places.reshape(-1, *places.shape[2:]), np.repeat(middles, len(local), 0))
        gathered: Any = [
            np.concatenate(mesh.comm.allgather(part[free]))
            for part in (
                places.reshape(-1, *places.shape[2:]),
                vertices,
                mesh.cells[:, full].reshape(-1, full.shape[1]),
                normals,
                np.repeat(mesh.labels, len(local)),
            )
        ]
        return cls(*gathered)

    @cached_property
    def size(self) -> float:
        """Longest side of the box around the facets, length."""
        return float(np.ptp(self.corners.reshape(-1, 3), axis=0).max())

    def of_bodies(self, chosen: Flags) -> Boundary:
        """Some of the facets."""
        parts: Any = (self.corners, self.vertices, self.nodes, self.normals, self.bodies)
        return Boundary(*(part[chosen] for part in parts))


#: Says which facets are in a group, (facets,).
type Selector = Callable[[Boundary], Flags]

_SELECTORS: dict[str, tuple[Entry, Callable[..., Flags]]] = {}


@typed
def register_selector(
    name: str, doc: str, *parameters: Parameter
) -> Callable[[Callable[..., Flags]], Callable[..., Flags]]:
    """Let a function choose the facets of groups; `by` in `[group.<name>]` has its name then.

    Args:
        name: Its name.
        doc: One line.
        parameters: What it takes beside the `Boundary`, by name; angles in radian.

    Returns:
        A decorator.

    Example:
        >>> @register_selector("upwards-doctest", "Facets that look upwards.")
        ... def upwards(boundary):
        ...     return boundary.normals[:, 2] > 0.9
        >>> _ = _SELECTORS.pop("upwards-doctest")
    """

    def register(select: Callable[..., Flags]) -> Callable[..., Flags]:
        _SELECTORS[name] = Entry(name, "group selector", doc, parameters), select
        return select

    return register


def selectors() -> tuple[Entry, ...]:
    """The registered selectors of facets.

    Returns:
        An entry for each.

    Example:
        >>> "plane" in [entry.name for entry in selectors()]
        True
    """
    return tuple(entry for entry, _ in _SELECTORS.values())


@typed
def make_selector(name: str, **parameters: Any) -> Selector:
    """A selector of facets by name.

    Args:
        name: Name of a registered selector.
        **parameters: Its parameters; angles in radian, or in degrees by `<name>_deg`.

    Returns:
        The selector.

    Raises:
        InputError: Unknown name or parameter, a parameter missing or out of range.

    Example:
        >>> from anisocontact.mesh import Body, build_mesh, make_shape
        >>> box = make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(2, 2, 2))
        >>> low = make_selector("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> build_mesh([Body("block", box)], {"block.seat": [low]}).count_facets("block.seat")
        4
    """
    entry = registry.entry(selectors(), name, "by")
    values = registry.arguments(entry, registry.values(entry, parameters))
    return partial(_SELECTORS[name][1], **values)


def with_groups(mesh: MeshArrays, groups: Mapping[str, Sequence[Selector]]) -> MeshArrays:
    """A mesh with further facet groups; collective.

    Args:
        mesh: The mesh.
        groups: "body.group", or "group" for one in each body that has such facets -> selectors,
            all of which have to choose a facet.

    Raises:
        InputError: A group has no facet or is there already, or there is no such body.
    """
    if not groups:
        return mesh
    boundary, names = Boundary.of(mesh), list(mesh.bodies)
    facets = dict(mesh.facets)
    for name, chosen in groups.items():
        body, dot, group = name.rpartition(".")
        if not group:
            raise InputError(f'{name!r} given, "body.group" or "group" needed', name)
        if not chosen:
            raise InputError("no selector given, one or more needed", name)
        if dot and body not in names:
            raise InputError(f"no body {body!r}; there are: {', '.join(names)}", name)
        found = {}
        for number, own in enumerate(names):
            part = boundary.of_bodies(boundary.bodies == number)
            if (not dot or own == body) and len(part.nodes):
                mask = np.logical_and.reduce([_flags(select, part, name) for select in chosen])
                found[f"{own}.{group}"] = part.nodes[mask]
        found = {full: rows for full, rows in found.items() if len(rows)}
        if not found:
            text = "no facet at the boundary is chosen"
            raise InputError(f"{text}, which lies {_between(boundary, names, body)}", name)
        for full, rows in found.items():
            if full in facets:
                raise InputError(f"{full!r} is a group already", name)
            facets[full] = np.array_split(rows, mesh.comm.size)[mesh.comm.rank]
    return replace(mesh, facets=facets)


def _between(boundary: Boundary, names: Sequence[str], body: str) -> str:
    """Between which corners facets lie: those of a body, or all where none is named."""
    own = boundary.bodies == names.index(body) if body else slice(None)
    places = boundary.corners[own].reshape(-1, 3) + 0.0  # no -0
    low, high = (", ".join(f"{x:.4g}" for x in f(axis=0)) for f in (places.min, places.max))
    return f"between ({low}) and ({high})"


def _flags(select: Selector, boundary: Boundary, group: str) -> Flags:
    """Which facets a selector chooses, which may be a function of a user's."""
    function = select.func if isinstance(select, partial) else select
    who = f"the selector {getattr(function, '__name__', type(function).__name__)}"
    found = np.asarray(called(select, boundary, who=who, field=group))
    if found.shape != (len(boundary.nodes),) or found.dtype != bool:
        text = f"{who} returned an array of {found.dtype} of shape {found.shape}"
        raise InputError(f"{text}, {len(boundary.nodes)} flags true or false needed", group)
    return found


def _normals(corners: Floats, middles: Floats) -> Floats:
    """Outward unit normals of facets of cells around some middles, (facets, 3)."""
    if corners.shape[1] == 2:  # of cells in a plane
        along = corners[:, 1] - corners[:, 0]
        across = np.column_stack([along[:, 1], -along[:, 0], 0.0 * along[:, 0]])
    else:  # of quadrilaterals in the order of DOLFINx too: the last corner is opposite of the first
        first = corners[:, -1] - corners[:, 0]
        across = np.cross(first, corners[:, 2] - corners[:, 1])
    inwards = np.einsum("fi,fi->f", across, corners.mean(axis=1) - middles) < 0.0
    across[inwards] *= -1.0
    return np.asarray(across / np.linalg.norm(across, axis=1, keepdims=True))


@register_selector("all", "All facets at the boundary of the body.")
def _all(boundary: Boundary) -> Flags:
    return np.ones(len(boundary.nodes), dtype=bool)


@register_selector(
    "box",
    "Facets that lie in a box along the axes with all of their corners.",
    Parameter("low", "vector", "length", "lowest corner of the box"),
    Parameter("high", "vector", "length", "highest corner of the box"),
)
def _box(boundary: Boundary, low: Sequence[float], high: Sequence[float]) -> Flags:
    slack = ROUNDED * boundary.size
    inside = (boundary.corners >= np.array(low) - slack) & (
        boundary.corners <= np.array(high) + slack
    )
    return np.asarray(inside.all(axis=(1, 2)))


@register_selector(
    "plane",
    "Facets that lie in a plane with all of their corners.",
    Parameter("point", "vector", "length", "a point of the plane"),
    Parameter("normal", "vector", "1", "normal of the plane", "nonzero"),
)
def _plane(boundary: Boundary, point: Sequence[float], normal: Sequence[float]) -> Flags:
    unit = np.array(normal) / np.linalg.norm(normal)
    off = np.abs((boundary.corners - np.array(point)) @ unit)
    return np.asarray((off <= ROUNDED * boundary.size).all(axis=1))


@register_selector(
    "cylinder",
    "Facets whose corners lie on a cylinder without end: a bore, a shaft.",
    Parameter("point", "vector", "length", "a point of the axis"),
    Parameter("axis", "vector", "1", "direction of the axis", "nonzero"),
    Parameter("radius", "scalar", "length", "radius", "positive"),
)
def _cylinder(
    boundary: Boundary, point: Sequence[float], axis: Sequence[float], radius: float
) -> Flags:
    unit = np.array(axis) / np.linalg.norm(axis)
    away = boundary.corners - np.array(point)
    off = np.linalg.norm(away - (away @ unit)[..., None] * unit, axis=2) - radius
    return np.asarray((np.abs(off) <= ROUGH * radius).all(axis=1))


@register_selector(
    "normal",
    "Facets whose outward normal is within an angle of a direction.",
    Parameter("direction", "vector", "1", "the direction", "nonzero"),
    Parameter(
        "angle", "scalar", "angle", "largest angle", "positive", default=(math.radians(10.0),)
    ),
)
def _normal(boundary: Boundary, direction: Sequence[float], angle: float) -> Flags:
    unit = np.array(direction) / np.linalg.norm(direction)
    return np.asarray(boundary.normals @ unit >= _least_cosine(angle))


@register_selector(
    "nearest",
    "The face at a point: the facet nearest to it, and those around it as long as no edge comes.",
    Parameter("point", "vector", "length", "the point"),
    Parameter(
        "angle",
        "scalar",
        "angle",
        "neighbouring facets whose normals differ by more have an edge between them",
        "positive",
        default=(math.radians(30.0),),
    ),
)
def _nearest(boundary: Boundary, point: Sequence[float], angle: float) -> Flags:
    local = np.array(_EDGES[boundary.vertices.shape[1]])
    edges = np.sort(boundary.vertices[:, local], axis=2).reshape(-1, local.shape[1])
    facet = np.repeat(np.arange(len(boundary.vertices)), len(local))
    rank = np.lexsort(edges.T)
    same = np.all(edges[rank][1:] == edges[rank][:-1], axis=1)
    pairs = np.column_stack([facet[rank][:-1], facet[rank][1:]])[same]
    smooth = np.einsum("pi,pi->p", *boundary.normals[pairs.T]) >= _least_cosine(angle)
    part = connected(len(boundary.vertices), pairs[smooth])
    return np.asarray(part == part[_facet_at(boundary, np.array(point))])


def _least_cosine(angle: float) -> float:
    """Cosine of a largest angle between directions, which differ by half a turn at most."""
    return math.cos(min(angle, math.pi))


def _facet_at(boundary: Boundary, point: Floats) -> int:
    """The facet nearest to a point, by places that are spread over each."""
    s, t = np.meshgrid(*[np.linspace(0.0, 1.0, PLACES)] * 2)
    corners = boundary.corners
    kind = corners.shape[1]
    first, second = (corners[:, k] - corners[:, 0] for k in (1, min(2, kind - 1)))
    if kind == 3:
        s = s * (1.0 - t)
    off = corners[:, 0] - point
    s, t = s.reshape(-1, 1), t.reshape(-1, 1)
    places = off[:, None] + s * first[:, None] + t * second[:, None]
    if kind == 4:
        twist = corners[:, 3] - corners[:, 2] - first
        places += s * t * twist[:, None]
    return int(np.argmin(np.linalg.norm(places, axis=2).min(axis=1)))
