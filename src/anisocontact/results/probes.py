"""Values at points, along lines and on facet groups: a table for each, a row a point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import closest_cells, fem, reference_place, scalar_element
from anisocontact.results.history import HistoryTable
from anisocontact.results.paraview import BodyGrid
from anisocontact.results.quantities import NODE, quantities

#: Distance over the size of the mesh by which a point may lie outside of all bodies.
OUTSIDE = 1e-6


@dataclass(frozen=True)
class Probe:
    """Where values are wanted, in the reference configuration: points, or the nodes of a group.

    Args:
        points: The points, (n, 3), length.
        group: A facet group, "body.group", in the place of points.
        quantities: Names of those of a node.
    """

    points: tuple[tuple[float, float, float], ...] = ()
    group: str = ""
    quantities: Sequence[str] = ("displacement", "stress")

    @classmethod
    def along(
        cls, start: Sequence[float], end: Sequence[float], count: int, names: Sequence[str]
    ) -> Probe:
        """Points at equal distances on a line, both ends among them."""
        places = np.linspace(start, end, count)
        return cls(tuple((x, y, z) for x, y, z in places.tolist()), quantities=names)

    def places(self, model: Any, field: str) -> ProbedPoints:
        """Where the points are in a mesh; collective.

        Raises:
            InputError: A point lies in no body, or there is no such group or quantity.
        """
        known = [q.name for q in quantities(NODE)]
        for name in self.quantities:
            if name not in known:
                text = f"{name!r} given, those of a node are {', '.join(known)}"
                raise InputError(text, f"{field}.quantities")
        points = np.array(self.points, dtype=float).reshape(-1, 3)
        if self.group:
            points = _nodes_of(model, self.group, f"{field}.group")
        return ProbedPoints(points, *_interpolation(model, points, field))


@dataclass(frozen=True)
class ProbedPoints:
    """Points in a mesh.

    Attributes:
        points: All of them, (n, 3), length.
        nodes: Nodes of the cells of those that this process has, (m, k).
        weights: Values of their shape functions, (m, k).
        mine: Which these are, (m,).
    """

    points: Floats
    nodes: Locals
    weights: Floats
    mine: Ints


class ProbeValues:
    """What is at the points of a probe; all ranks call it.

    Args:
        probe: Where.
        bodies: The bodies.
        field: Where the probe was written, for messages.

    Raises:
        InputError: A point lies in no body, or there is no such group or quantity.
    """

    def __init__(self, probe: Probe, bodies: BodyGrid, field: str) -> None:
        self._bodies, self._comm = bodies, bodies.problem.comm
        self._places = probe.places(bodies.problem.model, field)
        self._quantities = [q for q in quantities(NODE) if q.name in probe.quantities]

    def values(self, trial: bool = False) -> dict[str, Floats]:
        """The quantities at all points, (points, ...); collective.

        Args:
            trial: Whether the state is the last trial; else the accepted one.
        """
        now, found, places = self._bodies.now(trial), {}, self._places
        for q in self._quantities:
            at_nodes = np.asarray(q.values(now), dtype=float)
            own = np.zeros((len(places.points), *at_nodes.shape[1:]))
            own[places.mine] = np.einsum("pk,pk...->p...", places.weights, at_nodes[places.nodes])
            found[q.name] = np.asarray(self._comm.allreduce(own))
        return found


class ProbeTable(ProbeValues):
    """Writes the values of a probe after each accepted increment; all ranks call it.

    Args:
        path: The table.
        probe: Where.
        bodies: The bodies.
        name: Name of the probe, for messages.

    Raises:
        InputError: A point lies in no body, or there is no such group or quantity.
    """

    def __init__(self, path: Path, probe: Probe, bodies: BodyGrid, name: str) -> None:
        super().__init__(probe, bodies, f"output.probe.{name}")
        self.history = HistoryTable(path)

    def rows(self, when: Mapping[str, Any], values: Mapping[str, Floats]) -> list[dict[str, Any]]:
        """The rows of an increment."""
        return [
            {
                **when,
                "point": number,
                "position": place.tolist(),
                **{name: _named(name, column[number]) for name, column in values.items()},
            }
            for number, place in enumerate(self._places.points)
        ]


class Peak:
    """Largest value at the points of a probe, whatever its sign, as `Until` takes it.

    Args:
        probe: Where.
        quantity: Name of a quantity of nodes.
        component: Of a vector "x", "y" or "z", of a stress "XX" to "XZ", of principal stresses "1"
            to "3", the largest first; none of a number.
        field: Where the event was written, for messages.

    Raises:
        InputError: A point lies in no body, or there is no such group, quantity or component; when
            it is called.

    Example:
        >>> Peak(Probe(((0.0, 0.0, 0.0),)), "von_mises").quantity
        'von_mises'
    """

    def __init__(
        self, probe: Probe, quantity: str, component: str | None = None, field: str = "until"
    ) -> None:
        self._probe = replace(probe, quantities=(quantity,))
        self.quantity, self._component, self._field = quantity, component, field
        self._values: dict[int, ProbeValues] = {}

    def __call__(self, problem: Any, trial: bool) -> float:
        """The value in a state of the problem; collective."""
        if id(problem) not in self._values:
            self._values = {id(problem): ProbeValues(self._probe, BodyGrid(problem), self._field)}
        values = self._values[id(problem)].values(trial)[self.quantity]
        names = _components(self.quantity, values.shape[1:])
        found = [i for i, name in enumerate(names) if name == self._component]
        if bool(names or self._component) != bool(found):
            allowed = ", ".join(names) or "none, it is a number"
            text = f"component {self._component!r} given, of {self.quantity!r} there are: {allowed}"
            raise InputError(text, self._field)
        column = values[:, found[0]] if found else values
        return float(column[np.argmax(np.nan_to_num(np.abs(column)))])


def _components(name: str, shape: tuple[int, ...]) -> list[str]:
    """Names of the components of a quantity; none of a number."""
    if not shape:
        return []
    if name.startswith("principal"):
        return ["1", "2", "3"]
    return ["XX", "YY", "ZZ", "XY", "YZ", "XZ"] if shape == (6,) else ["x", "y", "z"]


def _named(name: str, value: Any) -> Any:
    """A value with the names of its components, as `history.csv` has them."""
    if np.ndim(value) == 0:
        return float(value)
    if len(value) == 6:
        return dict(zip(_components(name, (6,)), value.tolist(), strict=True))
    if name.startswith("principal"):
        return {str(k + 1): v for k, v in enumerate(value.tolist())}
    return value.tolist()


def _nodes_of(model: Any, group: str, field: str) -> Floats:
    """Places of the nodes of a facet group, of all processes and in order."""
    space, dim = model.space, model.idealisation.dim - 1
    nodes = fem.locate_dofs_topological(space, dim, model.facets(group, field))
    own = nodes[nodes < space.dofmap.index_map.size_local]
    places = np.concatenate(model.mesh.comm.allgather(space.tabulate_dof_coordinates()[own]))
    return np.asarray(places[np.lexsort(places.T[::-1])])


def _interpolation(model: Any, points: Floats, field: str) -> tuple[Locals, Floats, Ints]:
    """Nodes and weights of the points that this process has, and which these are."""
    comm, mesh = model.mesh.comm, model.mesh
    cells, distance = closest_cells(mesh, points)
    away = np.array(comm.allgather(distance))
    # not all processes have nodes
    corners = (
        mesh.geometry.x.min(axis=0, initial=np.inf),
        mesh.geometry.x.max(axis=0, initial=-np.inf),
    )
    low, high = np.array(comm.allgather(corners)).swapaxes(0, 1)
    reach = OUTSIDE * float((high.max(axis=0) - low.min(axis=0)).max())
    for point in points[away.min(axis=0) > reach]:
        shown = ", ".join(f"{v:g}" for v in point)
        raise InputError(f"({shown}) given, which is in no body", field)
    mine = np.flatnonzero(away.argmin(axis=0) == comm.rank)
    nodes = model.space.dofmap.list[cells[mine]]
    weights = np.zeros(nodes.shape)
    element = scalar_element(model.space)
    for row, number in enumerate(mine):
        place = reference_place(mesh, cells[number], points[number])
        weights[row] = element.tabulate(0, place)[0, 0, :, 0]
    return nodes, weights, mine
