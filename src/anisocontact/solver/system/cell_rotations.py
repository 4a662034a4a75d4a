"""How far cells of a body turn by displacements, all of them or those that are known."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.base.fenicsx import basix, scalar_element
from anisocontact.mesh import Model
from anisocontact.solver.system.angles import turn_angles
from anisocontact.solver.system.partly_known import Kept

#: Angle of cells beyond which small strain is no model of them, radian: where a body bends its
#: parts are free to take on the length that it gives them, so that it is twice that of a whole.
BENT = float(np.radians(10.0))
#: A turn that is not this many times the strain comes with it: simple shear turns by 0.7 of its
#: strain, and there the strain is the larger matter.
OF_STRAIN = 1.5
#: Cells that are looked at together.
_CHUNK = 20_000


class CellRotations:
    """Cells of a body, how far they turn, and its mean gradient.

    Args:
        model: The mesh.
        name: Name of the body.

    Attributes:
        mean: Weights of the displacements in the mean of their gradient, `du_i/dx_j = u_ai w_aj`,
            of the cells this rank owns, (nodes, 3), 1/length.
    """

    def __init__(self, model: Model, name: str) -> None:
        comm = model.mesh.comm
        cells = np.sort(model.cells(name))
        cells = cells[cells < model.mesh.topology.index_map(model.idealisation.dim).size_local]
        self._nodes = model.space.dofmap.list[cells]
        self._flat = model.idealisation.dim == 2
        self._reference = np.asarray(model.space.tabulate_dof_coordinates())
        element = scalar_element(model.space)
        rule: tuple[Floats, Floats]
        rule = basix.make_quadrature(element.cell_type, 2 * element.degree)  # type: ignore[assignment]
        points, weights = rule
        self._middle = _gradients(element, points.T @ weights[:, None] / weights.sum())[0]
        self._reference_volume = float(weights.sum())
        self.mean, volume = self._means(_gradients(element, points), weights)
        self._volume = float(comm.allreduce(volume))
        self.mean /= self._volume
        self._facets = _facets(element)
        self._own = np.unique(self._nodes)
        own = self._reference[self._own]
        lowest = np.min(comm.allgather(own.min(axis=0, initial=np.inf)), axis=0)
        highest = np.max(comm.allgather(own.max(axis=0, initial=-np.inf)), axis=0)
        self._size = float((highest - lowest)[: model.idealisation.dim].min())

    def turned(self, u: Floats) -> tuple[float, float]:
        """Cells of this rank that turn by more than they are strained.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.

        Returns:
            Largest angle, radian, and share of the volume of those with more than ten degrees.
        """
        largest = bent = 0.0
        for nodes, inverse, volumes in zip(self._chunks(), *self._middles, strict=True):
            gradient = np.swapaxes(u[nodes], 1, 2) @ self._middle @ inverse
            angles = turn_angles(gradient)
            strain = np.linalg.norm(gradient + np.swapaxes(gradient, 1, 2), axis=(1, 2)) / 2.0
            angles[angles < OF_STRAIN * strain] = 0.0
            largest = max(largest, float(angles.max(initial=0.0)))
            bent += float(volumes[angles > BENT].sum())
        return largest, bent / self._volume

    def uneven(self, kept: Kept, gradient: Floats) -> float:
        """Known displacements beyond their mean gradient, or along loads, over the least extent."""
        nodes = self._own[kept.nodes[self._own]]
        beyond = kept.u[nodes] - self._reference[nodes] @ gradient.T
        ranges = np.ptp(beyond, axis=0) if len(nodes) else np.zeros(3)
        return max(float(np.linalg.norm(ranges)), abs(kept.along_loads)) / self._size

    def surface(self, kept: Kept) -> float:
        """Largest angle by which the normal of a facet turns all of whose nodes are known, radian.

        Args:
            kept: What is known.
        """
        largest = 0.0
        for closure, along in self._facets:
            nodes = self._nodes[:, closure]
            nodes = nodes[kept.nodes[nodes].all(axis=1)]
            before = np.swapaxes(self._reference[nodes], 1, 2) @ along
            after = before + np.swapaxes(kept.u[nodes], 1, 2) @ along
            largest = max(largest, float(_between(*map(_normals, (before, after))).max(initial=0)))
        return largest

    @cached_property
    def _middles(self) -> tuple[list[Floats], list[Floats]]:
        """Inverse of the Jacobian in the middle of each cell, and volumes there, by chunks."""
        found = [self._jacobian(nodes, self._middle) for nodes in self._chunks()]
        volumes = [self._reference_volume * np.abs(np.linalg.det(j)) for j in found]
        return [np.linalg.inv(j) for j in found], volumes

    def _chunks(self) -> Iterator[Locals]:
        for start in range(0, len(self._nodes), _CHUNK):
            yield self._nodes[start : start + _CHUNK]

    def _jacobian(self, nodes: Locals, gradients: Floats) -> Floats:
        jacobian = np.asarray(np.swapaxes(self._reference[nodes], 1, 2) @ gradients)
        if self._flat:  # what is across the plane stays
            jacobian[:, 2, 2] = 1.0
        return jacobian

    def _means(self, gradients: Floats, weights: Floats) -> tuple[Floats, float]:
        """Integral of the gradient of the basis of each node, and the volume, of this rank."""
        sums, volume = np.zeros_like(self._reference), 0.0
        for nodes in self._chunks():
            for at, weight in zip(gradients, weights, strict=True):
                jacobian = self._jacobian(nodes, at)
                size = weight * np.abs(np.linalg.det(jacobian))
                parts = size[:, None, None] * (at @ np.linalg.inv(jacobian))
                np.add.at(sums, nodes.reshape(-1), parts.reshape(-1, 3))
                volume += float(size.sum())
        return sums, volume


def _gradients(element: Any, points: Floats) -> Floats:
    """Gradients of the basis in the reference cell, (points, nodes, 3), none across a plane."""
    dim = len(basix.geometry(element.cell_type)[0])
    table: Floats = element.tabulate(1, np.ascontiguousarray(points.reshape(-1, dim)))
    gradients = np.zeros((*table.shape[1:3], 3))
    gradients[..., :dim] = np.moveaxis(table[1:, :, :, 0], 0, -1)
    return gradients


def _facets(element: Any) -> list[tuple[Locals, Floats]]:
    """For each facet of the reference cell its nodes, and derivatives of their basis along it.

    They are those in its middle along two directions, of an edge along one, (nodes, 2 or 1).
    """
    corners, topology = basix.geometry(element.cell_type), basix.topology(element.cell_type)
    found = []
    for vertices, closure in zip(topology[-2], element.entity_closure_dofs[-2], strict=True):
        ends = corners[vertices]
        ways = np.zeros((3, min(2, len(ends) - 1)))
        ways[: ends.shape[1]] = (ends[1:3] - ends[0]).T
        along = _gradients(element, ends.mean(axis=0))[0] @ ways
        found.append((np.array(closure), along[closure]))
    return found


def _normals(tangents: Floats) -> Floats:
    """Normals of facets from their tangents, (n, 3, 2); of edges in a plane from one, (n, 3, 1)."""
    second = tangents[..., 1] if tangents.shape[2] == 2 else np.array([0.0, 0.0, 1.0])
    return np.cross(tangents[..., 0], second)


def _between(before: Floats, after: Floats) -> Floats:
    """Angles between vectors, (n, 3) each, radian."""
    across = np.linalg.norm(np.cross(before, after), axis=1)
    return np.asarray(np.arctan2(across, np.einsum("ni,ni->n", before, after)))
