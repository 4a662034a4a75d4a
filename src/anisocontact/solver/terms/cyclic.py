"""Cyclic symmetry: a sector whose cut faces move alike, turned about the axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed
from anisocontact.contact.beyond_cuts import Seam
from anisocontact.contact.tied_surfaces import WholeGroups
from anisocontact.contact.turning import Turning

if TYPE_CHECKING:
    from anisocontact.contact.tie_weights import TieConditions

#: Distance over the size of the cut face below which a node is on the axis, or on another node.
SAME_PLACE = 1e-6
#: Difference of prescribed displacements that counts as none, over the largest.
SAME = 1e-6


@typed
@dataclass(frozen=True)
class CyclicSymmetry:
    """Cyclic symmetry of two cut faces of a sector: `u_slave = Q u_master`, Q a rotation.

    The meshes of the faces need not match.

    Args:
        slave: Facet group "body.group" whose nodes follow.
        master: Facet group "body.group" that they follow; turned about the axis by 360 degrees over
            `sectors`, to either side, it lies on the slave.
        sectors: Number of sectors of the whole, >= 2.
        axis: Direction of the axis, of any length.
        point: A point of the axis, length.
        tolerance: Largest gap between the faces once turned, length; a tenth of the size of the
            facets of the master if not given.

    Raises:
        InputError: Fewer than two sectors, an axis that is no direction, or a negative tolerance.

    Example:
        >>> CyclicSymmetry("disc.start", "disc.end", sectors=12).sectors
        12
    """

    slave: str
    master: str
    sectors: int
    axis: Sequence[float] = (0.0, 0.0, 1.0)
    point: Sequence[float] = (0.0, 0.0, 0.0)
    tolerance: float | None = None

    def __post_init__(self) -> None:
        if not (self.sectors == int(self.sectors) and self.sectors >= 2):
            raise InputError(f"{self.sectors!r} given, a whole number >= 2 needed", "sectors")
        size = float(np.linalg.norm(self.axis))
        if len(self.axis) != 3 or not 0.0 < size < math.inf:
            text = f"{tuple(self.axis)!r} given, a direction of three numbers needed"
            raise InputError(text, "axis")
        if len(self.point) != 3:
            raise InputError(f"{tuple(self.point)!r} given, three numbers needed", "point")
        if self.tolerance is not None and not self.tolerance >= 0.0:
            raise InputError(f"{self.tolerance!r} given, must be >= 0", "tolerance")

    def turning(self, groups: WholeGroups) -> Turning:
        """The turn that brings the master to the slave: to which side, the meshes say.

        Args:
            groups: The cut faces, over all processes.

        Returns:
            The turn, by the angle of a sector.
        """
        a, b, c = np.asarray(self.axis, dtype=float) / np.linalg.norm(self.axis)
        axis, angle = (float(a), float(b), float(c)), 2.0 * math.pi / self.sectors
        x, y, z = map(float, self.point)
        count = len(groups.x)
        slave, master = (
            groups.x[np.unique(groups.groups[name].facets.nodes % count)].mean(axis=0)
            for name in (self.slave, self.master)
        )
        both = [Turning(axis, (x, y, z), sign * angle) for sign in (1.0, -1.0)]
        return min(both, key=lambda one: float(np.linalg.norm(one.of(master[None])[0] - slave)))


@dataclass(frozen=True)
class CutFaces:
    """Nodes of both cut faces of a sector.

    Attributes:
        name: What messages call the sector.
        turning: How the master is turned to the slave.
        slave: Nodes of the slave, numbers of the groups.
        master: Node of the master that is turned to each of these, -1 where there is none.
        sides: All nodes of the slave, and of the master.
        on_axis: Nodes on the axis.
    """

    name: str
    turning: Turning
    slave: Ints
    master: Ints
    sides: tuple[Ints, Ints]
    on_axis: Ints

    @classmethod
    def of(cls, name: str, groups: WholeGroups, sector: CyclicSymmetry) -> CutFaces:
        """Those of a sector."""
        turning, count = sector.turning(groups), len(groups.x)
        slave, master = (
            np.unique(groups.groups[face].facets.nodes % count).astype(np.int64)
            for face in (sector.slave, sector.master)
        )
        size = float(np.ptp(groups.x[master], axis=0).max())
        both = np.union1d(slave, master)
        on = both[turning.distance(groups.x[both]) <= SAME_PLACE * size]
        there = turning.of(groups.x[master])
        apart = np.linalg.norm(groups.x[slave][:, None] - there[None], axis=2)
        near = apart.argmin(axis=1)
        met = np.where(apart.min(axis=1) <= SAME_PLACE * size, master[near], -1)
        return cls(name, turning, slave, met, (slave, master), on)

    @property
    def seam(self) -> Seam:
        """Nodes off the axis that are one of the whole."""
        met = (self.master >= 0) & ~np.isin(self.slave, self.on_axis)
        return Seam(self.turning, self.master[met], self.slave[met])

    def check_whole(self, found: TieConditions) -> None:
        """Refuse a face of which some of the other has no place: not the sector that was said."""
        left = np.setdiff1d(np.setdiff1d(self.slave, self.on_axis), found.nodes[found.covered])
        if len(left):
            text = (
                f"{len(left)} of {len(self.slave)} nodes of the slave are off the master "
                f"{self.turning.text}: both faces have to cover each other"
            )
            raise InputError(text, self.name)

    def check_prescribed(self, values: Floats, step: str) -> None:
        """Refuse supports of the slave that are not those of the master; free nodes follow it.

        Args:
            values: Prescribed displacements of all nodes, NaN where there is none, (n, 3), length.
            step: Name of the step, for messages.
        """
        field = f"step {step!r}.displacement"
        off_axis = ~np.isin(self.slave, self.on_axis)
        free = np.isnan(values[self.slave[off_axis]][:, list(self.turning.mixed)])
        partly = free.any(axis=1) & ~free.all(axis=1)
        if partly.any():
            raise InputError(self._partly(int(partly.sum())), field)
        met = off_axis & (self.master >= 0)
        here, there = values[self.slave[met]], values[self.master[met]]
        turned = np.stack([self._turned(there, i) for i in range(3)], axis=1)
        scale = np.nanmax(np.abs(values), initial=0.0)
        differ = np.abs(np.nan_to_num(here - turned)) > SAME * scale
        off = ~np.isnan(here) & (np.isnan(turned) | differ)
        if off.any():
            text = (
                f"{int(off.any(axis=1).sum())} nodes on the cut faces of {self.name} have "
                "other prescribed motions on the slave than on the master: give the same motion in "
                "every sector, or leave the slave free, which follows the master"
            )
            raise InputError(text, field)

    def _partly(self, count: int) -> str:
        start = f"of {count} nodes on the slave of {self.name} only "
        if len(self.turning.mixed) == 2:
            return (
                f"{start}one component across the axis {self.turning.name} is held: hold both, "
                "none, or the one along the axis; what is free follows the master"
            )
        return (
            f"{start}some components are held, and the axis {self.turning.name} is none of space: "
            "hold all three or none, or take `cylindrical` with that axis"
        )

    def _turned(self, values: Floats, component: int) -> Floats:
        """A component of prescribed vectors after the turn, NaN where it is not all known."""
        row = self.turning.matrix[component]
        used = np.flatnonzero(row)
        return np.asarray(values[:, used] @ row[used])
