"""Symmetry planes: no displacement across a plane of any direction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI, Vec, fem
from anisocontact.contact import facet_quadrature
from anisocontact.mesh import Model
from anisocontact.solver.terms.constraint import Constraint
from anisocontact.solver.terms.pressure import outward

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

#: Largest difference of normals of a plane; roundings of mesh files are well below.
FLAT = 1e-6
#: Share of a normal that counts as none of it along an axis.
NO_SHARE = 1e-9
#: Prescribed displacement across a plane over the largest one that counts as none of it.
OUT = 1e-6


@dataclass(frozen=True)
class _Kind:
    """Nodes on the same planes with the same prescribed components.

    Attributes:
        nodes: The nodes.
        slaves: Components that follow from the others.
        follow: `u_slaves = follow u`, (slaves, 3); zero in the slaves themselves.
        planes: Planes that hold these nodes; the others are held by prescribed values.
        share: Force on the node -> normal forces of `planes`, (planes, 3).
    """

    nodes: Ints
    slaves: Ints
    follow: Floats
    planes: Ints
    share: Floats


class SymmetryPlanes:
    """Constraints `n . u = 0` at the nodes of flat facet groups, n the normal of the group.

    At a node one component for each plane follows from the others, `u_s = c . u`, a `Constraint`.

    Args:
        model: Mesh with named facets.
        groups: Facet groups, each in a plane.
        like: A vector of the unknowns.
        tied: Nodes that follow from others, which keep them in the planes.

    Attributes:
        constraint: The constraints of the step that has begun.

    Raises:
        InputError: An unknown facet group, or one that is not flat.
    """

    def __init__(self, model: Model, groups: Sequence[str], like: Vec, tied: Ints) -> None:
        if isinstance(groups, str):
            raise InputError(f"{groups!r} given, a list of facet groups needed", "symmetry")
        self._model = model
        #: The facet groups.
        self.groups = list(groups)
        self._like = like
        self._normals = np.array([_normal(model, group) for group in groups]).reshape(-1, 3)
        owned = model.space.dofmap.index_map.size_local
        on = np.zeros((owned, len(self.groups)), dtype=bool)
        dim = model.idealisation.dim - 1
        for i, group in enumerate(groups):
            nodes = fem.locate_dofs_topological(model.space, dim, model.facets(group))
            on[nodes[nodes < owned], i] = True
        on[tied] = False
        self._on = on
        self._kinds: list[_Kind] = []
        self.constraint: Constraint | None = None
        #: Unknowns that follow from others, local numbers.
        self.slaves: Ints = np.zeros(0, dtype=np.int64)

    def __bool__(self) -> bool:
        return bool(self.groups)

    def held(self) -> list[tuple[Ints, Floats]]:
        """Nodes this rank owns on each plane, and its normal."""
        return [(np.flatnonzero(on), n) for on, n in zip(self._on.T, self._normals, strict=True)]

    def begin(self, prescribed: Ints, values: Floats, step: str) -> None:
        """Take over the prescribed unknowns of a step.

        Args:
            prescribed: Their local numbers.
            values: Their values at the end of the step, length.
            step: Name of the step, for messages.

        Raises:
            InputError: A prescribed value leads a node out of its plane.
        """
        self._kinds = self._checked(prescribed, values, step)
        self._build()

    def check(self, prescribed: Ints, values: Floats, step: str) -> None:
        """The check of `begin` alone."""
        self._checked(prescribed, values, step)

    def _checked(self, prescribed: Ints, values: Floats, step: str) -> list[_Kind]:
        held = np.zeros(self._on.shape[0] * 3, dtype=bool)
        led = np.zeros(len(held))
        held[prescribed], led[prescribed] = True, values
        nodes = np.flatnonzero(self._on.any(axis=1))
        keys = np.hstack([self._on[nodes], held.reshape(-1, 3)[nodes]])
        found, which = np.unique(keys, axis=0, return_inverse=True)
        kinds = []
        for i, key in enumerate(found):
            planes = np.flatnonzero(key[:-3])
            kind = _kind(nodes[which.reshape(-1) == i], planes, self._normals, key[-3:])
            kinds.append(kind)
            loose = np.setdiff1d(planes, kind.planes)
            across = np.abs(led.reshape(-1, 3)[kind.nodes] @ self._normals[loose].T)
            if np.any(across > OUT * np.abs(led).max(initial=0.0)):
                group = self.groups[loose[int(np.argmax(across.max(axis=0)))]]
                text = f"leads nodes out of the symmetry plane {group!r}, by {across.max():.3g}"
                raise InputError(text, f"step {step!r}.displacement")
        return kinds

    def forces(self, supporting: Floats) -> tuple[dict[str, Floats], Floats]:
        """Forces of the planes on the bodies.

        Args:
            supporting: Force of all supports on the unknowns this rank owns.

        Returns:
            Facet group -> force, (3,), over all ranks; and what is left for prescribed unknowns.
        """
        rest = supporting.copy()
        nodal = rest.reshape(-1, 3)
        sums = np.zeros((len(self.groups), 3))
        for kind in self._kinds:
            across = nodal[kind.nodes] @ kind.share.T
            for column, plane in enumerate(kind.planes):
                force = across[:, column, None] * self._normals[plane]
                sums[plane] += force.sum(axis=0)
                nodal[kind.nodes] -= force
        total = self._model.mesh.comm.allreduce(sums)
        return dict(zip(self.groups, total, strict=True)), rest

    def _build(self) -> None:
        to, of, factor = [np.zeros(0, int)], [np.zeros(0, int)], [np.zeros(0)]
        for kind in self._kinds:
            for slave, follow in zip(kind.slaves, kind.follow, strict=True):
                for component in range(3):
                    to.append(3 * kind.nodes + component)
                    of.append(3 * kind.nodes + slave)
                    factor.append(np.full(len(kind.nodes), follow[component]))
        masters, slaves, factors = map(np.concatenate, (to, of, factor))
        self.slaves = np.unique(slaves)
        first, _ = self._like.getOwnershipRange()
        kept = factors != 0.0
        alone = np.setdiff1d(self.slaves, slaves[kept])
        if self.constraint is not None:
            self.constraint.close()
        self.constraint = Constraint(
            self._like,
            first + np.concatenate([slaves[kept], alone]),
            first + np.concatenate([masters[kept], alone]),
            np.concatenate([factors[kept], np.zeros(len(alone))]),
        )


def _normal(model: Model, group: str) -> Floats:
    """Unit normal of a flat facet group."""
    facets = model.facets(group, "symmetry")
    quadrature = facet_quadrature(model.space, facets, 2 * model.order, model.idealisation)
    normals = outward(model, group, quadrature)
    comm = model.mesh.comm
    total = np.asarray(comm.allreduce(quadrature.areas @ normals))
    normal = total / np.linalg.norm(total)
    off = comm.allreduce(float(np.abs(normals - normal).max(initial=0.0)), MPI.MAX)
    if not off < FLAT:
        text = f"{group!r} given, its normals differ by {off:.2g}; a symmetry plane must be flat"
        raise InputError(text, "symmetry")
    normal[np.abs(normal) < NO_SHARE] = 0.0
    return np.asarray(normal / np.linalg.norm(normal))


def _kind(nodes: Ints, planes: Ints, normals: Floats, held: npt.NDArray[np.bool_]) -> _Kind:
    """Which components follow from which: Gauss-Jordan elimination with the largest pivot."""
    rows = normals[planes].copy()
    used: list[int] = []
    slaves: list[int] = []
    open_rows = list(range(len(planes)))
    allowed = ~held
    while open_rows:
        share = np.abs(rows[open_rows]) * allowed
        row, slave = np.unravel_index(int(np.argmax(share)), share.shape)
        if share[row, slave] < NO_SHARE:
            break
        pivot = open_rows.pop(int(row))
        rows[pivot] /= rows[pivot, slave]
        for other in range(len(planes)):
            if other != pivot:
                rows[other] -= rows[other, slave] * rows[pivot]
        allowed[slave] = False
        used.append(pivot)
        slaves.append(int(slave))
    follow = -rows[used]
    follow[:, slaves] = 0.0
    directions = np.vstack([normals[planes[used]], np.eye(3)[held]])
    share = np.linalg.pinv(directions.T)[: len(used)]
    return _Kind(nodes, np.array(slaves, dtype=np.int64), follow, planes[used], share)
