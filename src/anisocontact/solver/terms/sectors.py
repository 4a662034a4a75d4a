"""The cut faces of all sectors of a problem, and what else may act on their nodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.contact.tied_surfaces import WholeGroups
from anisocontact.solver.terms.cyclic import CutFaces, CyclicSymmetry
from anisocontact.solver.terms.free_modes import SupportedFrame

#: Share of a direction along an axis that is all of it.
ALONG = 1.0 - 1e-9


class Sectors:
    """Cut faces of sectors that stand for a whole.

    Args:
        sectors: The sectors by name.
        groups: Their facet groups, whole on every process.

    Attributes:
        cuts: Cut faces by name of the sector.
    """

    def __init__(self, sectors: Mapping[str, CyclicSymmetry], groups: WholeGroups) -> None:
        self._groups, self._model, self._own = groups, groups.model, groups.own_nodes
        self._slaves = {name: one.slave for name, one in sectors.items()}
        self.cuts = {name: CutFaces.of(name, groups, one) for name, one in sectors.items()}

    def frames(self) -> list[SupportedFrame]:
        """Cut faces as nodes that move along and about the axis alone where nothing is strained."""
        found = []
        for cut in self.cuts.values():
            held = np.array([True, True, False] * 2)
            nodes = self._own(np.union1d(*cut.sides))
            found.append(
                SupportedFrame(nodes, np.array(cut.turning.point), held, cut.turning.frame)
            )
        return found

    def on_axes(self) -> list[tuple[str, Ints, Floats]]:
        """Name of each sector, nodes this rank owns on its axis, two directions across it."""
        cuts = self.cuts.items()
        return [(name, self._own(cut.on_axis), cut.turning.frame[:2]) for name, cut in cuts]

    def off_planes(self, group: str, nodes: Ints, normal: Floats) -> Ints:
        """Those of nodes on a symmetry plane that are not held there by themselves; collective.

        Slave nodes of a sector whose axis is normal to the plane are held as the master is.

        Args:
            group: Name of the plane.
            nodes: Nodes this rank owns.
            normal: Normal of the plane, (3,).

        Raises:
            InputError: The plane meets a slave at an angle, so that it would be another one there.
        """
        found = [np.zeros(0, dtype=np.int64)]
        for name, cut in self.cuts.items():
            slave = np.setdiff1d(np.intersect1d(self._own(cut.sides[0]), nodes), self.axial)
            if cut.turning.along(normal):
                found.append(slave)
            elif np.abs(normal).max() < ALONG and self._model.mesh.comm.allreduce(len(slave)):
                text = f"{group!r} has nodes on the slave of {name}, whose axis is not its normal"
                raise InputError(text, "symmetry")
        return np.unique(np.concatenate(found))

    def on_cuts(self) -> Ints:
        """Nodes this rank owns on the cut faces of sectors."""
        none = np.zeros(0, dtype=np.int64)
        sides = (side for cut in self.cuts.values() for side in cut.sides)
        return np.unique(np.concatenate([none, *(self._own(side) for side in sides)]))

    @property
    def axial(self) -> Ints:
        """Nodes this rank owns on the axes of sectors."""
        none = np.zeros(0, dtype=np.int64)
        return np.unique(np.concatenate([none, *(nodes for _, nodes, _ in self.on_axes())]))

    def repeated(self, nodes: Ints, axis: Sequence[float], point: Sequence[float]) -> Ints:
        """Those of nodes whose motion in cylinder coordinates a sector gives them; collective.

        Displacements prescribed in cylinder coordinates about the axis of a sector are
        alike in all sectors: slave nodes of its cut faces have them from the master.

        Args:
            nodes: Nodes this rank owns.
            axis: Direction of the axis of the coordinates.
            point: A point of it, length.

        Raises:
            InputError: The axis of the sector is another, or the master is not among the nodes.
        """
        found = [np.zeros(0, dtype=np.int64)]
        for name, cut in self.cuts.items():
            slave, master = (np.intersect1d(self._own(side), nodes) for side in cut.sides)
            counts = np.array([len(slave), len(master)])
            of_slave, of_master = self._model.mesh.comm.allreduce(counts)
            if not of_slave:
                continue
            if not cut.turning.about(axis, point):
                text = f"its nodes on the cut faces of {name} need the axis of that"
                raise InputError(text)
            if not of_master:
                text = f"it has nodes on the slave of {name} and none on the master"
                raise InputError(text)
            found.append(slave)
        return np.unique(np.concatenate(found))

    def cuts_of(self, body: str) -> list[CutFaces]:
        """Cut faces of a body."""
        cuts = self.cuts.items()
        return [cut for name, cut in cuts if self._model.body_of(self._slaves[name]) == body]

    def sides_of(self, cut: CutFaces) -> tuple[Ints, Ints]:
        """Nodes this rank owns on slave and master of cut faces, off the axis."""
        slave, master = (np.setdiff1d(side, cut.on_axis) for side in cut.sides)
        return self._own(slave), self._own(master)

    def check_prescribed(
        self, unknowns: Ints, values: Floats, planes: Sequence[tuple[Ints, Floats]], step: str
    ) -> None:
        """Refuse supports at cut faces that are not the same in every sector; collective.

        Args:
            unknowns: Prescribed unknowns that this rank owns, local numbers.
            values: Their values, length.
            planes: Nodes this rank owns on symmetry planes, and the normals.
            step: Name of the step, for messages.
        """
        if not self.cuts:
            return
        own = np.full((self._model.space.dofmap.index_map.size_local, 3), np.nan)
        for nodes, normal in planes:
            own[nodes] = np.where(np.abs(normal) > 1.0 - ALONG, 0.0, own[nodes])
        own.reshape(-1)[unknowns] = values
        values_everywhere = self._groups.everywhere(own, np.nan)
        for cut in self.cuts.values():
            cut.check_prescribed(values_everywhere, step)

    def hold_cuts(self, fixed: Floats) -> None:
        """Hold slave nodes of cut faces as what they follow is held, turned; collective.

        Args:
            fixed: Projections on held directions of the local nodes, which are changed,
                (nodes, 3, 3).
        """
        owned = self._model.space.dofmap.index_map.size_local
        everywhere = self._groups.everywhere(fixed[:owned], 0.0) if self.cuts else fixed
        for cut in self.cuts.values():
            seam, turn = cut.seam, cut.turning.matrix
            own = self._groups.owned()[seam.following]
            held = turn @ everywhere[seam.leading[own]] @ turn.T
            fixed[self._own(seam.following)] = held

    def check_dependents(self, dependents: Ints) -> None:
        """Refuse cut faces that follow a rigid body; collective.

        Args:
            dependents: Unknowns of this rank that follow rigid bodies, local numbers.
        """
        first = self._model.space.dofmap.index_map.local_range[0]
        for name, cut in self.cuts.items():
            nodes = self._groups.nodes[np.union1d(*cut.sides)] - first
            shared = len(np.intersect1d(nodes, dependents // 3))
            if self._model.mesh.comm.allreduce(shared):
                text = "faces of a rigid body share nodes with the cut faces: take a displacement"
                raise InputError(text, name)
