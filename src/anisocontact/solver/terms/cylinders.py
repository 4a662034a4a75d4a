"""Cylindrical supports along the steps, and what inclined supports have in common."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError, within
from anisocontact.base.load_curve import Held, TimeHistory, history_of
from anisocontact.mesh import Model
from anisocontact.solver.terms.cylindrical import COMPONENTS, NO_SHARE, Cylindrical
from anisocontact.solver.terms.sectors import Sectors
from anisocontact.solver.terms.step import Step

#: Component of nodes that stay on the axis of a sector.
ACROSS = "across"


@dataclass(frozen=True)
class InclinedSupport:
    """Nodes of a group whose displacement along directions is known.

    Attributes:
        group: Name of the group.
        component: What the direction is called.
        kind: Field of a step or case that asks for it.
        nodes: Nodes this rank owns, (n,).
        direction: Unit vector, or one for each node, (3,) or (n, 3).
        at: Share of the step -> displacement along it, (n,), length.
    """

    group: str
    component: str
    kind: str
    nodes: Ints
    direction: Floats
    at: Callable[[float], Floats]

    @property
    def directions(self) -> Floats:
        """The direction at each node, (n, 3)."""
        return np.broadcast_to(self.direction, (len(self.nodes), 3))

    def contradicted(self, off: float) -> str:
        """What to say where other supports move nodes elsewhere, by a length."""
        if self.component in COMPONENTS:
            return (
                f"{self.group!r} and another support prescribe different displacements of shared "
                f"nodes along {self.component}, by {off:.3g}"
            )
        if self.component == ACROSS:
            return f"moves nodes off {self.group}, by {off:.3g}"
        return f"moves nodes out of the symmetry plane {self.group!r}, by {off:.3g}"


type _Key = tuple[str, str]


class Cylinders:
    """What the steps so far prescribe along directions of cylinder coordinates.

    Args:
        model: Mesh with named facets and nodes.
        tied: Nodes that follow from others, which keep them where they have to be.
        sectors: Cut faces of sectors, if there are any.
    """

    def __init__(self, model: Model, tied: Ints, sectors: Sectors | None = None) -> None:
        self._model, self._tied, self._sectors = model, tied, sectors
        self._systems: dict[str, Cylindrical] = {}
        self._histories: dict[_Key, TimeHistory] = {}
        self._supports: list[InclinedSupport] = []

    @property
    def unknowns(self) -> Ints:
        """Local numbers of all unknowns of nodes with prescribed displacements."""
        nodes = np.unique(
            np.concatenate([np.zeros(0, np.int64), *(g.nodes for g in self._supports)])
        )
        return (3 * nodes[:, None] + np.arange(3)).reshape(-1)

    def resting(self) -> list[tuple[Ints, Floats]]:
        """Nodes that are held where they are along one direction; collective."""
        comm = self._model.mesh.comm
        found: list[tuple[Ints, Floats]] = []
        for support in self._supports:
            if not self._histories[support.group, support.component].linear:
                continue
            e, moved = support.directions, np.abs(support.at(1.0) - support.at(0.0))
            local = [e.max(axis=0, initial=-2.0), -e.min(axis=0, initial=2.0)]
            local.append(np.full(3, moved.max(initial=0.0)))
            ends = np.max(comm.allgather(local), axis=0)
            if np.all(ends[0] + ends[1] <= NO_SHARE) and not ends[2].any():
                found.append((support.nodes, 0.5 * (ends[0] - ends[1])))
        return found

    def supports(self) -> list[InclinedSupport]:
        """Those of the step that has begun."""
        return self._supports

    def begin(self, step: Step, u: Floats) -> None:
        """Take over a step.

        Args:
            step: The step.
            u: Local unknowns at its beginning, length.

        Raises:
            InputError: An unknown group, or a node on the axis.
        """
        self._histories = {
            key: history if history.linear else Held()
            for key, history in self._histories.items()
            if not self._taken(key, step)
        }
        for group, given in step.cylindrical.items():
            self._systems[group] = given
            for name, value in given.values.items():
                self._histories.pop((group, name), None)
                if value is not None:
                    self._histories[group, name] = history_of(value)
        self._supports = [self._support(step, *key, one, u) for key, one in self._histories.items()]

    def stop(self) -> None:
        """The step ends where it is: prescribed values stay there."""
        self._histories = dict.fromkeys(self._histories, Held())

    def lets_go(self, support: InclinedSupport, step: Step) -> bool:
        """Whether a step that has not begun yet ends a support of these."""
        key = support.group, support.component
        if key not in self._histories:
            return False
        given = step.cylindrical.get(support.group)
        freed = given is not None and given.values.get(support.component, 0.0) is None
        return freed or self._taken(key, step)

    def _taken(self, key: _Key, step: Step) -> bool:
        """Whether something else of a step takes the group over."""
        group, _ = key
        given = step.cylindrical.get(group)
        other = given is not None and given.system != self._systems[group].system
        return other or group in step.displacement or group in step.rotation

    def _support(
        self, step: Step, group: str, name: str, history: TimeHistory, u: Floats
    ) -> InclinedSupport:
        field = f"step {step.name!r}.cylindrical"
        nodes = np.setdiff1d(self._model.nodes(group, field).astype(np.int64), self._tied)
        if self._sectors is not None:
            system = self._systems[group]
            with within(field):
                repeated = self._sectors.repeated(nodes, system.axis, system.point)
            if name == "axial":  # what is on the axis follows nothing along it
                repeated = np.setdiff1d(repeated, self._sectors.axial)
            nodes = np.setdiff1d(nodes, repeated)
        x = np.asarray(self._model.space.tabulate_dof_coordinates())[nodes]
        directions = self._systems[group].directions(x)[name]
        lost = int(self._model.mesh.comm.allreduce(int(np.isnan(directions[:, 0]).sum())))
        if lost:
            text = f"{lost} nodes of {group!r} are on the axis, where nothing is {name}"
            raise InputError(text, field)
        start = np.einsum("ni,ni->n", directions, u.reshape(-1, 3)[nodes])

        def at(share: float) -> Floats:
            return np.asarray(history.at(share, step.duration, start))

        return InclinedSupport(group, name, "cylindrical", nodes, directions, at)
