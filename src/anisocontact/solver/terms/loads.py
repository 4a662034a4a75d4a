"""Loads along the steps: dead ones, and pressures that follow the surface."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import override

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.compiled_forms import compiled
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.base.load_curve import PrescribedValue
from anisocontact.bulk import Material
from anisocontact.contact import facet_quadrature
from anisocontact.mesh import Model
from anisocontact.solver.terms.prescribed_components import PrescribedComponents
from anisocontact.solver.terms.pressure import Given, PressureLoads
from anisocontact.solver.terms.step import AXES, Step
from anisocontact.solver.terms.term import Term, TermGroup


class DeadLoads(Term):
    """Forces that do not depend on the displacement, and what released supports still carry.

    A load of a kind on a group or body is `share_a f` at node a: the integrals of the basis
    functions over it, which a force on the whole group is divided by the area of; a force on points
    and edges is shared equally by their nodes.
    """

    def __init__(self, model: Model) -> None:
        self._model = model
        self._shares: dict[tuple[str, str], Floats] = {}
        self._values: dict[tuple[str, str], PrescribedComponents] = {}
        index_map = model.space.dofmap.index_map
        self._released: Floats = np.zeros(3 * (index_map.size_local + index_map.num_ghosts))
        self._left = np.zeros_like(self._released)
        self._now = self._released.reshape(-1, 3)

    @override
    def begin(self, step: Step, released: Floats) -> None:
        self._released = released + self._left
        self._left = np.zeros_like(released)
        for one in self._values.values():
            one.begin(step.duration)
        for kind, share in _SHARES.items():
            loads: Mapping[str, Mapping[str, PrescribedValue]] = getattr(step, kind)
            for name, values in loads.items():
                if (kind, name) not in self._shares:
                    found = share(self._model, name, f"step {step.name!r}.{kind}")
                    self._shares[kind, name] = found
                    self._values[kind, name] = PrescribedComponents(3)
                    self._values[kind, name].begin(step.duration)
                for axis, value in values.items():
                    self._values[kind, name].prescribe(AXES.index(axis), value)

    @override
    def set_load_factor(self, factor: float, dt: float) -> None:
        force = (1.0 - factor) * self._released
        nodal = force.reshape(-1, 3)
        for key, one in self._values.items():
            nodal += self._shares[key][:, None] * one.at(factor)
        self._now = nodal

    @override
    def end_at(self, factor: float) -> None:
        self._left = (1.0 - factor) * self._released
        for one in self._values.values():
            one.stop(factor)

    @property
    def rest(self) -> bool:
        """Whether they stay as they are along the step, on this rank."""
        return not self._released.any() and all(one.rests for one in self._values.values())

    @override
    def add_force(self, u: Floats, out: Floats) -> None:
        out += self._now

    def given(self, step: Step) -> Iterator[Given]:
        """What a step that has begun gives other than zero, by components."""
        for kind in _SHARES:
            loads: Mapping[str, Mapping[str, PrescribedValue]] = getattr(step, kind)
            for name, values in loads.items():
                share = self._shares[kind, name]
                for axis, value in values.items():
                    if value:
                        unit = np.eye(3)[AXES.index(axis)]
                        yield Given(kind, name, axis, share[:, None] * unit)


def area_shares(model: Model, group: str, field: str) -> Floats:
    """Area of a facet group that belongs to each local node, (nodes,), length^2."""
    facets = model.boundary(group, field)
    quadrature = facet_quadrature(model.space, facets, 2 * model.order, model.idealisation)
    index_map = model.space.dofmap.index_map
    nodal = np.zeros((index_map.size_local + index_map.num_ghosts, 3))
    quadrature.to_nodes(np.ones((quadrature.count, 3)), nodal)
    return nodal[:, 0]


def mean_shares(model: Model, group: str, field: str) -> Floats:
    """The same over the area of the whole group: weights of a mean, (nodes,)."""
    shares = area_shares(model, group, field)
    return np.asarray(shares / model.mesh.comm.allreduce(shares.sum()))


def node_shares(model: Model, name: str, field: str) -> Floats:
    """Weights of the mean of a facet group, or of points and edges with a name, (nodes,)."""
    if name in model.facet_names():
        return mean_shares(model, name, field)
    index_map = model.space.dofmap.index_map
    shares = np.zeros(index_map.size_local + index_map.num_ghosts)
    shares[model.nodes(name, field)] = 1.0
    return np.asarray(shares / model.mesh.comm.allreduce(shares.sum()))


def _volume_shares(model: Model, body: str, field: str) -> Floats:
    """Integral of the basis function of each local node over a body, length^3."""
    cells = np.sort(model.cells(body, field))
    dx = ufl.Measure("dx", domain=model.mesh, subdomain_data=[(1, cells)])
    weight = model.idealisation.weight(model.mesh)
    form = compiled(weight * ufl.TestFunction(model.space)[0] * dx(1), model.mesh.comm)
    return np.array(fem.assemble_vector(form).array[::3])


# Kind of a dead load, a field of `Step` -> shares of the nodes.
_SHARES: dict[str, Callable[[Model, str, str], Floats]] = {
    "traction": area_shares,
    "force": node_shares,
    "body_force": _volume_shares,
}


class Loads(TermGroup):
    """All loads of a problem.

    Args:
        model: Mesh with named bodies and facets.
        materials: Body name -> material: pressures follow the surface of those at finite strain.
    """

    def __init__(self, model: Model, materials: Mapping[str, Material]) -> None:
        self._dead, self._pressures = DeadLoads(model), PressureLoads(model, materials)
        super().__init__([self._dead, self._pressures])

    @property
    def rest(self) -> bool:
        """Whether all of them stay as they are along the step, on this rank."""
        return self._dead.rest and self._pressures.rest

    def given(self, step: Step) -> Iterator[Given]:
        """What a step that has begun gives other than zero."""
        yield from self._dead.given(step)
        yield from self._pressures.given(step)

    def at_end(self, u: Floats) -> Floats:
        """Forces at the end of the step that has begun, at the displacement `u`, (nodes, 3)."""
        self.set_load_factor(1.0, 0.0)
        return self.force(u)
