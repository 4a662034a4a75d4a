"""How far bodies at small strain have turned: their strain takes a rotation for a deformation.

A body that only turns by the angle t has the displacement gradient `R - 1`, whose symmetric part
is `cos(t) - 1` in the plane of the turn: a strain that is not there. At 1 degree it is 1.5e-4, at
5 degrees 3.8e-3, and it makes stress as any strain does.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import astuple, dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Locals
from anisocontact.base.fenicsx import MPI, Vec, basix, scalar_element
from anisocontact.bulk import Material, small_strain
from anisocontact.mesh import Model

#: Angles beyond which a turn is worth a warning, and beyond which it is refused, radian.
WARNED, REFUSED = float(np.radians(1.0)), float(np.radians(5.0))
#: The same of cells in a body that does not turn as a whole: where it bends its parts are free to
#: take on the length that small strain gives them.
BENT = 2.0 * REFUSED
#: Mean strain of a body beyond which it is worth a warning that it is small strain.
STRAINED = 0.1
#: Share of the volume of a body from which on such cells are no matter of a corner alone.
PART = 0.1
#: What a body at small strain that turns further needs.
CURE = (
    'take a material at finite strain, model = "neo-hookean" or "st-venant-kirchhoff", '
    'or strain = "logarithmic" if it has that'
)
#: A turn that is not this many times the strain comes with it: simple shear turns by 0.7 of its
#: strain, and there the strain is the larger matter.
OF_STRAIN = 1.5
#: Beyond this angle the whole is refused whatever its strain.
ANY_STRAIN = 3.0 * REFUSED
#: What known displacements have to have grown by before all cells are looked at again.
GROWN = 1.25
#: Cells that are looked at together.
_CHUNK = 20_000


@dataclass(frozen=True)
class BodyRotation:
    """How far a body at small strain has turned from where it was made.

    Attributes:
        whole: Angle of the rotation of the mean deformation gradient, radian.
        largest: Largest angle of a cell that turns by more than it is strained, radian.
        stress: Stress that the larger of both makes of nothing, `E (1 - cos t)`.
        turns: Whether the whole turns by more than it is strained.
        bent: Share of the volume in cells that turn so and by more than ten degrees.
        strained: Largest principal value, in size, of the mean strain.
    """

    whole: float
    largest: float
    stress: float
    turns: bool = True
    bent: float = 0.0
    strained: float = 0.0

    @property
    def angle(self) -> float:
        """The larger angle, radian."""
        return max(self.whole, self.largest)

    @property
    def too_far(self) -> bool:
        """Whether small strain is no model of it."""
        bound = REFUSED if self.turns else ANY_STRAIN
        return self.whole > bound or self.bent > PART

    @property
    def strain(self) -> float:
        """Strain that it makes of nothing."""
        return spurious(self.angle)

    def __str__(self) -> str:
        """How far, and how wrong that is."""
        where = "" if self.whole >= self.largest else " in places"
        return (
            f"has turned by {np.degrees(self.angle):.3g} degrees{where}, which small strain takes "
            f"for a strain of {self.strain:.2g}, a stress of {self.stress:.3g}"
        )


def spurious(angle: float) -> float:
    """Strain that small strain makes of a rotation by an angle, radian."""
    return float(1.0 - np.cos(angle))


@dataclass(frozen=True)
class Kept:
    """What is known of a state without the interior.

    Attributes:
        nodes: Nodes whose displacement is, (nodes,).
        u: Displacements, true at these, (nodes, 3), length.
        along_loads: Mean displacement along all loads, length.
    """

    nodes: Flags
    u: Floats
    along_loads: float


class PartlyKnown(Protocol):
    """Displacements of which those of the interior take a solution; see `Condensed`."""

    def kept(self, x: Vec) -> Kept:
        """What is known of a trial state in equilibrium without the interior."""
        ...

    def mean(self, group: str, weights: Floats, x: Vec | None = None) -> Floats:
        """Sum of the displacements of all nodes times their weights, (3,) or (3, k), length.

        Args:
            group: Name under which the weights are known.
            weights: Weight of each node, (nodes,) or (nodes, k).
            x: All unknowns of a trial state in equilibrium; the accepted one if not given.
        """
        ...

    def displacement(self, x: Vec) -> Floats:
        """Displacement of all nodes in a trial state in equilibrium, (nodes, 3), length."""
        ...


class Rotations:
    """Rotations of the bodies at small strain of a model.

    Args:
        model: The mesh.
        materials: Body name -> material; those at small strain count.

    Attributes:
        accepted: Of every body after the accepted increment, by name; the same on every rank.
    """

    def __init__(self, model: Model, materials: Mapping[str, Material]) -> None:
        self._model = model
        self._young = {n: law.young for n, law in sorted(materials.items()) if small_strain(law)}
        self._looked: dict[str, float] = {}
        self._now: tuple[dict[str, BodyRotation], dict[str, float]] = ({}, {})
        self.accepted: dict[str, BodyRotation] = {}

    def __bool__(self) -> bool:
        return bool(self._young)

    @cached_property
    def _bodies(self) -> dict[str, _Cells]:
        return {name: _Cells(self._model, name) for name in self._young}

    def at(self, u: Floats) -> dict[str, BodyRotation]:
        """Rotation of every body in a state, kept as the trial.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
        """
        comm, found = self._model.mesh.comm, {}
        for name, cells in self._bodies.items():
            gradient = comm.allreduce(u.T @ cells.mean)
            largest, bent = cells.turned(u)
            local = comm.allreduce(largest, MPI.MAX), comm.allreduce(bent)
            found[name] = self._turned(name, gradient, *local)
        self._now = (found, {})
        return found

    def reduced(self, known: PartlyKnown, x: Vec, last: bool) -> dict[str, BodyRotation]:
        """Rotation of every body of which only some unknowns are kept up to date.

        The mean gradient is known without the interior. Rotations of cells need all
        displacements, a solution with the interior: they are looked at where what is known has
        moved so unevenly that cells may have turned otherwise than the whole, and only where
        that has grown since the last look or a step ends; and at the end of a step where facets
        have turned, as below a ball, where nothing moves far.

        Args:
            known: Who knows them.
            x: All unknowns of the state, true for what contacts need.
            last: Whether this is the end of a step.
        """
        found, looked = {}, dict(self._looked)
        kept = known.kept(x)
        u: Floats | None = None
        for name, cells in self._bodies.items():
            gradient = known.mean(f"gradient of {name}", cells.mean, x)
            moved = cells.uneven(kept, gradient)
            before = self.accepted.get(name)
            local = (before.largest, before.bent) if before else (0.0, 0.0)
            grown = moved > max(0.0 if last else GROWN * looked.get(name, 0.0), WARNED)
            if grown or (last and cells.surface(kept) > WARNED):
                u = known.displacement(x) if u is None else u
                local, looked[name] = cells.turned(u), moved
            found[name] = self._turned(name, gradient, *local)
        self._now = (found, looked)
        return found

    def commit(self) -> None:
        """Accept the trial."""
        self.accepted, self._looked = self._now

    def persistent(self) -> Floats:
        """What the next looks depend on: what is known of each body."""
        rows = [
            [*astuple(turned), self._looked.get(name, 0.0)]
            for name, turned in self.accepted.items()
        ]
        return np.array(rows, dtype=np.float64).reshape(-1, 7)

    def restore(self, kept: Floats) -> None:
        """Go on from what `persistent` gave."""
        for name, row in zip(self._young, kept.tolist(), strict=False):
            whole, largest, stress, turns, *rest, self._looked[name] = row
            self.accepted[name] = BodyRotation(whole, largest, stress, bool(turns), *rest)

    def _turned(self, name: str, gradient: Floats, largest: float, bent: float) -> BodyRotation:
        whole = polar_angle(gradient)
        strain = 0.5 * float(np.linalg.norm(gradient + gradient.T))
        stress = self._young[name] * spurious(max(whole, largest))
        principal = float(np.abs(np.linalg.eigvalsh(0.5 * (gradient + gradient.T))).max())
        return BodyRotation(whole, largest, stress, whole >= OF_STRAIN * strain, bent, principal)


class _Cells:
    """Cells of a body.

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


def polar_angle(gradient: Floats) -> float:
    """Angle of the rotation R of `1 + grad(u) = R U`, radian.

    Args:
        gradient: Gradient of a displacement, (3, 3).

    Example:
        >>> turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        >>> round(float(np.degrees(polar_angle(1.2 * turn - np.eye(3)))), 9)
        90.0
    """
    left, _, right = np.linalg.svd(np.eye(3) + gradient)
    return float(turn_angles((left @ right - np.eye(3))[None])[0])


def turn_angles(gradients: Floats) -> Floats:
    """Angles of rotations; with strain those whose plane and stretch across are those of R.

    Args:
        gradients: Gradients of displacements, (n, 3, 3).

    Returns:
        `atan2(|axial vector of F|, (tr F - 1) / 2)`, exact for rotations and for plane strain,
        (n,), radian.
    """
    i, j = np.array([2, 0, 1]), np.array([1, 2, 0])
    axial = 0.5 * (gradients[:, i, j] - gradients[:, j, i])
    trace = np.trace(gradients, axis1=1, axis2=2)
    return np.asarray(np.arctan2(np.linalg.norm(axial, axis=1), 1.0 + 0.5 * trace))
