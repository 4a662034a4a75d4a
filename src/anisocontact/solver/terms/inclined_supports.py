"""Inclined supports (skew boundary conditions): planes and cylinders along no axes of space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import Vec
from anisocontact.mesh import Model
from anisocontact.solver.terms.constraint import Constraint
from anisocontact.solver.terms.cylinders import ACROSS, Cylinders, InclinedSupport
from anisocontact.solver.terms.elimination import Elimination, eliminated
from anisocontact.solver.terms.sectors import Sectors
from anisocontact.solver.terms.step import Step
from anisocontact.solver.terms.symmetry import SymmetryPlanes

#: What cannot be met of the displacements over the largest one that counts as nothing.
OUT = 1e-6


@dataclass(frozen=True)
class _NodalConditions:
    """The conditions `e . u = g` of all nodes that have some, up to R each.

    Attributes:
        nodes: The nodes, (m,).
        directions: Their unit vectors, zero where a node has fewer than R, (m, R, 3).
        supports: Number of the support of each, -1 where there is none, (m, R).
        places: Place of the node in that support, (m, R).
    """

    nodes: Ints
    directions: Floats
    supports: Ints
    places: Ints

    @classmethod
    def of(cls, supports: Sequence[InclinedSupport]) -> _NodalConditions:
        """Those of some supports."""
        nodes = np.unique(np.concatenate([np.zeros(0, np.int64), *(g.nodes for g in supports)]))
        at = [np.searchsorted(nodes, support.nodes) for support in supports]
        count = np.zeros(len(nodes), dtype=np.int64)
        for here in at:
            count[here] += 1
        shape = len(nodes), int(count.max(initial=0))
        directions = np.zeros((*shape, 3))
        which, places = np.full(shape, -1), np.zeros(shape, dtype=np.int64)
        count[:] = 0
        for i, (support, here) in enumerate(zip(supports, at, strict=True)):
            directions[here, count[here]] = support.directions
            which[here, count[here]] = i
            places[here, count[here]] = np.arange(len(here))
            count[here] += 1
        return cls(nodes, directions, which, places)

    def values(self, supports: Sequence[InclinedSupport], share: float) -> Floats:
        """The g at a share of the step, (m, R), length."""
        out = np.zeros(self.supports.shape)
        for i, support in enumerate(supports):
            there = self.supports == i
            out[there] = support.at(share)[self.places[there]]
        return out


class InclinedSupports:
    """Conditions `e . u = g` at nodes, with directions e that are no axes of space.

    Symmetry planes hold all along the run, g = 0; steps prescribe g of cylindrical supports. At a
    node one component for each condition follows from the others, `u_s = c . u + d`: a
    `Constraint`.

    Args:
        model: Mesh with named facets.
        planes: Symmetry planes.
        like: A vector of the unknowns.
        tied: Nodes that follow from others, which keep them where they have to be.
        sectors: Cut faces of sectors, if there are any.

    Attributes:
        constraint: The constraints of the step that has begun.
        slaves: Unknowns that follow from others, local numbers.
    """

    def __init__(
        self,
        model: Model,
        planes: SymmetryPlanes,
        like: Vec,
        tied: Ints,
        sectors: Sectors | None = None,
    ) -> None:
        self._model, self._like, self._tied, self._sectors = model, like, tied, sectors
        self._planes = planes
        self._still = self._of_run()
        self._cylinders = Cylinders(model, tied, sectors)
        self.constraint: Constraint | None = None
        self.slaves: Ints = np.zeros(0, dtype=np.int64)
        self._take(self._still)

    @property
    def groups(self) -> list[str]:
        """The symmetry planes."""
        return self._planes.groups

    @property
    def cylinders(self) -> Cylinders:
        """The cylindrical supports."""
        return self._cylinders

    def __bool__(self) -> bool:
        return bool(self._supports)

    def fresh(self) -> InclinedSupports:
        """The same before the first step, to go through the steps without solving."""
        return InclinedSupports(self._model, self._planes, self._like, self._tied, self._sectors)

    def supported(self) -> list[tuple[Ints, Floats]]:
        """Nodes this rank owns that have a support, and the directions, (3,) or (nodes, 3)."""
        return [(support.nodes, support.direction) for support in self._supports]

    def of_planes(self) -> list[tuple[Ints, Floats]]:
        """Nodes this rank owns on each symmetry plane, and its normal, (3,)."""
        planes = [support for support in self._still if support.component != ACROSS]
        return [(support.nodes, support.direction) for support in planes]

    def resting(self) -> list[tuple[Ints, Floats]]:
        """Nodes that are held where they are all along the step, and the direction, (3,)."""
        still = [(support.nodes, support.direction) for support in self._still]
        return still + self._cylinders.resting()

    def begin(self, step: Step, u: Floats, prescribed: Ints, values: Floats) -> None:
        """Take over a step.

        Args:
            step: The step.
            u: Local unknowns at its beginning, length.
            prescribed: Local numbers of the unknowns that supports prescribe in it.
            values: Their values at the end of the step, length.

        Raises:
            InputError: Some of what is prescribed contradicts the rest.
        """
        self.take_over(step, u)
        self._found = self.check(prescribed, values, step.name)
        self._build(self._found)
        self.set_load_factor(0.0)

    def take_over(self, step: Step, u: Floats) -> None:
        """Take over what a step prescribes, without constraints."""
        self._cylinders.begin(step, u)
        self._take(self._still + self._cylinders.supports())

    def stop(self) -> None:
        """The step ends where it is: prescribed values stay there."""
        self._cylinders.stop()

    def set_load_factor(self, factor: float) -> None:
        """Go to a fraction of the step."""
        if self.constraint is None:
            return
        values = self._rows.values(self._supports, factor)
        offsets = np.einsum("msr,mr->ms", self._found.gain, values)
        offset = np.zeros(self._like.getLocalSize())
        node, component = np.nonzero(self._found.slave)
        offset[3 * self._rows.nodes[node] + component] = offsets[node, component]
        self.constraint.offset = offset

    def check(self, prescribed: Ints, values: Floats, step: str, share: float = 1.0) -> Elimination:
        """Which unknowns follow from which, and that nothing contradicts.

        Args:
            prescribed: Local numbers of the unknowns that supports prescribe.
            values: Their values, length.
            step: Name of the step, for messages.
            share: Share of the step at which they have these.

        Raises:
            InputError: Some of what is prescribed contradicts the rest.
        """
        owned = self._model.space.dofmap.index_map.size_local
        supported, ends = np.zeros(3 * owned, dtype=bool), np.zeros(3 * owned)
        supported[prescribed], ends[prescribed] = True, values
        rows = self._rows
        found = eliminated(rows.directions, supported.reshape(-1, 3)[rows.nodes])
        given = rows.values(self._supports, share)
        largest = max(np.abs(ends).max(initial=0.0), np.abs(given).max(initial=0.0))
        off = np.abs(found.left(ends.reshape(-1, 3)[rows.nodes], given))
        if np.any(off > OUT * largest):
            node, row = np.unravel_index(int(np.argmax(off)), off.shape)
            support = self._supports[rows.supports[node, row]]
            raise InputError(
                support.contradicted(float(off.max())), f"step {step!r}.{support.kind}"
            )
        return found

    def forces(self, supporting: Floats) -> tuple[dict[str, Floats], Floats]:
        """Forces of planes and cylindrical supports on the bodies.

        Args:
            supporting: Force of all supports on the unknowns this rank owns.

        Returns:
            Group -> force, (3,), over all ranks; and what is left for prescribed unknowns.
        """
        rest, rows = supporting.copy(), self._rows
        nodal = rest.reshape(-1, 3)
        own = [support for support in self._supports if support.component != ACROSS]
        names = list(dict.fromkeys(support.group for support in own))
        sums = np.zeros((len(names), 3))
        if self.constraint is not None:
            of_rows = self._of_rows(nodal)
            nodal[rows.nodes] -= of_rows.sum(axis=1)
            for i, support in enumerate(self._supports):
                if support.component == ACROSS:  # not of one sector alone
                    continue
                sums[names.index(support.group)] += of_rows[rows.supports == i].sum(axis=0)
        total = self._model.mesh.comm.allreduce(sums)
        return dict(zip(names, total, strict=True)), rest

    def released(self, supporting: Floats, step: Step) -> Floats:
        """Forces of the cylindrical supports that a step lets go, (owned unknowns,), force.

        Args:
            supporting: Force of all supports on the unknowns this rank owns, before the step.
            step: The step, not begun yet.
        """
        out = np.zeros_like(supporting)
        gone = [self._cylinders.lets_go(support, step) for support in self._supports]
        if self.constraint is not None and any(gone):
            of_rows = self._of_rows(supporting.reshape(-1, 3))
            for i in np.flatnonzero(gone):
                node, row = np.nonzero(self._rows.supports == i)
                out.reshape(-1, 3)[self._rows.nodes[node]] += of_rows[node, row]
        return out

    def _of_rows(self, nodal: Floats) -> Floats:
        """Force of each condition on its node, (m, R, 3)."""
        along = np.einsum("mri,mi->mr", self._found.share, nodal[self._rows.nodes])
        return np.asarray(along[..., None] * self._rows.directions)

    def _of_run(self) -> list[InclinedSupport]:
        """Symmetry planes, and what keeps nodes on the axes of sectors."""
        if self._sectors is None:
            return self._planes.supports()
        found = []
        for plane in self._planes.supports():
            off = self._sectors.off_planes(plane.group, plane.nodes, plane.direction)
            nodes = np.setdiff1d(plane.nodes, off)
            found.append(_still(plane.group, plane.component, nodes, plane.direction))
        for name, on_axis, across in self._sectors.on_axes():
            nodes = np.setdiff1d(on_axis, self._tied)
            found += [_still(f"the axis of {name}", ACROSS, nodes, one) for one in across]
        return found

    def _take(self, supports: Sequence[InclinedSupport]) -> None:
        self._supports = list(supports)
        self._rows = _NodalConditions.of(self._supports)

    def _build(self, found: Elimination) -> None:
        node, slave, component = np.nonzero(
            np.broadcast_to(found.slave[:, :, None], (len(self._rows.nodes), 3, 3))
        )
        slaves = 3 * self._rows.nodes[node] + slave
        masters = 3 * self._rows.nodes[node] + component
        factors = found.follow[node, slave, component]
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


def _still(group: str, component: str, nodes: Ints, direction: Floats) -> InclinedSupport:
    """Nodes that stay where they are along a direction."""
    count = len(nodes)
    return InclinedSupport(
        group, component, "displacement", nodes, direction, lambda share: np.zeros(count)
    )
