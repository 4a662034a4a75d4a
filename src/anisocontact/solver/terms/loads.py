"""Loads along the steps: dead ones, and pressures that follow the surface."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from anisocontact.base.fenicsx import Mat, body_shares
from anisocontact.bulk import Material
from anisocontact.contact import facet_quadrature
from anisocontact.mesh import Model
from anisocontact.solver.stepping.steps import AXES, Step
from anisocontact.solver.system.layout import Layout
from anisocontact.solver.terms.pressure import Pressures
from anisocontact.solver.terms.supports import Supports
from anisocontact.solver.terms.swallowed import Given, check_swallowed
from anisocontact.solver.terms.symmetry import SymmetryPlanes

Floats = npt.NDArray[np.float64]


class DeadLoads:
    """Forces that do not depend on the displacement, and what released supports still carry.

    A load of a kind on a group or body is `share_a f` at node a: the integrals of the basis
    functions over it, which a force on the whole group is divided by the area of.
    """

    def __init__(self, model: Model) -> None:
        self._model = model
        self._shares: dict[tuple[str, str], Floats] = {}
        self._start: dict[tuple[str, str], Floats] = {}
        self._end: dict[tuple[str, str], Floats] = {}
        index_map = model.space.dofmap.index_map
        self._released: Floats = np.zeros(3 * (index_map.size_local + index_map.num_ghosts))

    def begin(self, step: Step, released: Floats) -> None:
        """Take over the loads of a step.

        Args:
            step: The step.
            released: Forces on the local unknowns that fade out along the step.

        Raises:
            InputError: An unknown facet group or body.
        """
        self._released = released
        self._start = {key: value.copy() for key, value in self._end.items()}
        for kind, share in _SHARES.items():
            loads: Mapping[str, Mapping[str, float]] = getattr(step, kind)
            for name, values in loads.items():
                if (kind, name) not in self._shares:
                    found = share(self._model, name, f"step {step.name!r}.{kind}")
                    self._shares[kind, name] = found
                end = self._end.setdefault((kind, name), np.zeros(3))
                for axis, value in values.items():
                    end[AXES.index(axis)] = value

    def at(self, fraction: float) -> Floats:
        """Forces on the local unknowns at a fraction of the step."""
        force = (1.0 - fraction) * self._released
        nodal = force.reshape(-1, 3)
        for key, end in self._end.items():
            start = self._start.get(key, np.zeros(3))
            nodal += self._shares[key][:, None] * ((1.0 - fraction) * start + fraction * end)
        return force

    def given(self, step: Step) -> Iterator[Given]:
        """What a step that has begun gives other than zero, by components."""
        for kind in _SHARES:
            loads: Mapping[str, Mapping[str, float]] = getattr(step, kind)
            for name, values in loads.items():
                share = self._shares[kind, name]
                for axis, value in values.items():
                    if value:
                        unit = np.eye(3)[AXES.index(axis)]
                        yield Given(kind, name, axis, share[:, None] * unit)


def area_shares(model: Model, group: str, field: str) -> Floats:
    """Area of a facet group that belongs to each local node, (nodes,), length^2."""
    quadrature = facet_quadrature(model.space, model.boundary(group, field), 2 * model.order)
    index_map = model.space.dofmap.index_map
    nodal = np.zeros((index_map.size_local + index_map.num_ghosts, 3))
    quadrature.to_nodes(np.ones((quadrature.count, 3)), nodal)
    return nodal[:, 0]


def mean_shares(model: Model, group: str, field: str) -> Floats:
    """The same over the area of the whole group: weights of a mean, (nodes,)."""
    shares = area_shares(model, group, field)
    return np.asarray(shares / model.mesh.comm.allreduce(shares.sum()))


def _volume_shares(model: Model, body: str, field: str) -> Floats:
    return body_shares(model.space, model.cells(body, field))


# Kind of a dead load, a field of `Step` -> shares of the nodes.
_SHARES: dict[str, Callable[[Model, str, str], Floats]] = {
    "traction": area_shares,
    "force": mean_shares,
    "body_force": _volume_shares,
}


class Loads:
    """All loads of a problem.

    Args:
        model: Mesh with named bodies and facets.
        materials: Body name -> material: pressures follow the surface of those at finite strain.
    """

    def __init__(self, model: Model, materials: Mapping[str, Material]) -> None:
        self._dead = DeadLoads(model)
        self._pressures = Pressures(model, materials)
        self._constant: Floats = np.zeros(0)

    def begin(self, step: Step, released: Floats) -> None:
        """Take over the loads of a step; see `DeadLoads.begin`."""
        self._dead.begin(step, released)
        self._pressures.begin(step)

    def given(self, step: Step) -> Iterator[Given]:
        """What a step that has begun gives other than zero."""
        yield from self._dead.given(step)
        yield from self._pressures.given(step)

    def set_level(self, fraction: float) -> None:
        """Go to a fraction of the step."""
        self._constant = self._dead.at(fraction)
        self._pressures.set_level(fraction)

    def force(self, u: Floats) -> Floats:
        """Forces on the local unknowns, (3 nodes,), at the displacement `u`, (nodes, 3)."""
        force = self._constant.copy()
        self._pressures.add_force(u, force.reshape(-1, 3))
        return force

    def add_tangent(self, matrix: Mat) -> None:
        """Add `-d force / d u` of the last `force` to the matrix of the system."""
        self._pressures.add_tangent(matrix)


def check_steps(
    model: Model,
    materials: Mapping[str, Material],
    steps: Sequence[Step],
    planes: SymmetryPlanes | None = None,
) -> None:
    """Go through the loads of all steps without solving.

    Raises:
        InputError: See `Supports.begin`, `DeadLoads.begin`, `SymmetryPlanes.begin` and
            `check_swallowed`.
    """
    layout = Layout(model.space, 0)
    supports, loads = Supports(model), Loads(model, materials)
    index_map = model.space.dofmap.index_map
    nothing = np.zeros(3 * (index_map.size_local + index_map.num_ghosts))
    turned = False
    for step in steps:
        supports.begin(step, nothing)
        loads.begin(step, nothing)
        # Where a turn ends is not known before it has been.
        turned = turned or bool(step.rotation)
        if planes is not None and not turned:
            planes.check(supports.unknowns, supports.end, step.name)
        held = [*supports.held(), *(planes.held() if planes is not None else [])]
        check_swallowed(layout, step, loads.given(step), held)
