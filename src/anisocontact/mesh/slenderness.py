"""How slender the bodies of a mesh are: their length over their thickness."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import basix, facet_sides, geometry
from anisocontact.mesh.model import Model


def slenderness(model: Model, bodies: Iterable[str]) -> float:
    """Largest length over thickness of some bodies, 0 of none; collective.

    The length is the diagonal of a body's box, the thickness twice its volume over its surface:
    that of a plate or ring, a third of the side of a cube. Cells count with straight edges.

    Args:
        model: The mesh.
        bodies: Names of the bodies.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> bar = build_box({"bar": BoxSpec((0, 0, 0), (12, 1, 1), (12, 1, 1))})
        >>> round(slenderness(bar, ["bar"]), 2)
        25.17
    """
    comm, dim = model.mesh.comm, model.idealisation.dim
    owned = model.mesh.topology.index_map(dim).size_local
    _, nodes, x = geometry(model.mesh)
    volumes, areas = _volumes(model)[:owned], _areas(model)[:owned]
    most = 0.0
    for name in sorted(set(bodies)):
        own = model.cells(name)
        own = own[own < owned]
        volume, area = comm.allreduce(np.array([volumes[own].sum(), areas[own].sum()]))
        points = x[nodes[own]].reshape(-1, 3)
        low = np.min(comm.allgather(points.min(axis=0, initial=np.inf)), axis=0)
        high = np.max(comm.allgather(points.max(axis=0, initial=-np.inf)), axis=0)
        most = max(most, float(np.linalg.norm(high - low) * area / (2.0 * volume)))
    return most


def _volumes(model: Model) -> Floats:
    """Volume of each local cell, its area in the plane: by the derivative at its middle."""
    element, nodes, x = geometry(model.mesh)
    dim = model.idealisation.dim
    rule: tuple[Floats, Floats]
    rule = basix.make_quadrature(element.cell_type, 1)  # type: ignore[assignment]
    points, weights = rule
    middle = (weights @ points / weights.sum())[None]
    gradients = element.tabulate(1, middle)[1:, 0, :, 0]
    jacobians = np.einsum("ik,ckj->cij", gradients, x[nodes][..., :dim])
    return np.asarray(np.abs(np.linalg.det(jacobians)) * weights.sum())


def _areas(model: Model) -> Floats:
    """Area of the surface of its body that each local cell has, its length in the plane."""
    mesh, dim = model.mesh, model.idealisation.dim
    element, nodes, x = geometry(mesh)
    mesh.topology.create_connectivity(dim - 1, dim)
    beside = np.diff(mesh.topology.connectivity(dim - 1, dim).offsets)
    owned = np.arange(mesh.topology.index_map(dim - 1).size_local, dtype=np.int32)
    cells, local = facet_sides(mesh, owned[beside[: len(owned)] == 1])
    corners = np.array(basix.topology(element.cell_type)[dim - 1])[local]
    at = x[np.take_along_axis(nodes[cells], corners, axis=1)]
    edges = at[:, 1:] - at[:, :1]
    if dim == 2:
        sizes = np.linalg.norm(edges[:, 0], axis=1)
    else:  # of a quadrilateral, two triangles beside the diagonal between its middle corners
        sizes = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
        if edges.shape[1] == 3:
            other = np.cross(at[:, 1] - at[:, 3], at[:, 2] - at[:, 3])
            sizes += 0.5 * np.linalg.norm(other, axis=1)
    found = np.zeros(len(nodes))
    np.add.at(found, cells, sizes)
    return found
