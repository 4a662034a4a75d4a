"""Pressures on facet groups, which follow the surface where strains are finite."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import override

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.bulk import Material, small_strain
from anisocontact.contact import FacetQuadrature, facet_quadrature
from anisocontact.contact.quadrature import Couplings, Surfaced, inward
from anisocontact.mesh import Model
from anisocontact.solver.terms.prescribed_components import PrescribedComponents
from anisocontact.solver.terms.step import Step
from anisocontact.solver.terms.term import Term


class PressureLoads(Term):
    """Forces `-p n` on the area of now, n the outward normal of now.

    The force at node a is `-integral of N_a p (t_1 x t_2)` over the coordinates of the facet, with
    the tangents `t_i = d x / d xi_i`; its derivative is exact. On a body of linear material normal
    and area are those of the reference.

    Args:
        model: Mesh with named facets.
        materials: Body name -> material.
    """

    def __init__(self, model: Model, materials: Mapping[str, Material]) -> None:
        self._model = model
        self._materials = materials
        self._surfaces: dict[str, _Surface] = {}
        self._values: dict[str, PrescribedComponents] = {}
        self._now: dict[str, float] = {}

    @override
    def begin(self, step: Step, released: Floats) -> None:
        for one in self._values.values():
            one.begin(step.duration)
        for group, value in step.pressure.items():
            field = f"step {step.name!r}.pressure"
            body = self._model.body_of(group, field)
            if group not in self._surfaces:
                self._model.boundary(group, field)
                self._surfaces[group] = _Surface(
                    self._model, group, small_strain(self._materials[body])
                )
                self._values[group] = PrescribedComponents(1)
                self._values[group].begin(step.duration)
            self._values[group].prescribe(0, value)

    @override
    def end_at(self, factor: float) -> None:
        for one in self._values.values():
            one.stop(factor)

    def given(self, step: Step) -> Iterator[Given]:
        """Pressures of a step that has begun, other than zero, as they act in the reference."""
        rest = np.zeros((len(self._model.space.tabulate_dof_coordinates()), 3))
        for group, value in step.pressure.items():
            if value:
                force = np.zeros_like(rest)
                self._surfaces[group].add_force(1.0, rest, force)
                yield Given("pressure", group, "", force)

    @property
    def rest(self) -> bool:
        """Whether they stay as they are along the step."""
        return all(one.rests for one in self._values.values())

    @override
    def set_load_factor(self, factor: float, dt: float) -> None:
        self._now = {group: float(one.at(factor)[0]) for group, one in self._values.items()}

    @override
    def add_force(self, u: Floats, out: Floats) -> None:
        for group, value in self._now.items():
            self._surfaces[group].add_force(value, u, out)

    @override
    def blocks(self) -> list[Couplings]:
        surfaces = ((self._surfaces[group], value) for group, value in self._now.items())
        return [one.block(value) for one, value in surfaces if not one.fixed]


@dataclass(frozen=True)
class Given:
    """A load that a step gives.

    Attributes:
        kind: "traction", "force", "pressure" or "body_force".
        name: Facet group or body.
        axis: Axis it is along; empty for a pressure.
        force: Forces on the local nodes, (nodes, 3).
    """

    kind: str
    name: str
    axis: str
    force: Floats


class _Surface:
    """A facet group under pressure."""

    def __init__(self, model: Model, group: str, fixed: bool) -> None:
        facets = model.facets(group)
        # N_a and each of the tangents are of the order of the displacement.
        self._quadrature = facet_quadrature(
            model.space, facets, 3 * model.order, model.idealisation
        )
        self._sign = _sides(model, group, self._quadrature)
        self._rest = self._quadrature.at_rest
        self.fixed = fixed
        self._moved: Surfaced = self._rest

    def add_force(self, pressure: float, u: Floats, out: Floats) -> None:
        if not self.fixed:
            self._moved = self._quadrature.moved(u)
        push = -pressure * self._sign[:, None, None] * self._moved.vector_areas
        self._quadrature.to_nodes(push.reshape(-1, 3), out, np.ones(self._quadrature.count))

    def block(self, pressure: float) -> Couplings:
        change = self._moved.vector_area_matrices()
        nodes = self._quadrature.nodes
        return nodes, nodes, pressure * self._sign[:, None, None] * change


def outward(model: Model, group: str, quadrature: FacetQuadrature) -> Floats:
    """Outward unit normals at the points of a quadrature of a group, reference, (m q, 3)."""
    areas = quadrature.at_rest.vector_areas
    areas = _sides(model, group, quadrature)[:, None, None] * areas
    flat = areas.reshape(-1, 3)
    return np.asarray(flat / np.linalg.norm(flat, axis=1)[:, None])


def _sides(model: Model, group: str, quadrature: FacetQuadrature) -> Floats:
    """1 where the first tangent cross the second points out of the body, else -1, (m,)."""
    return np.where(inward(model.space, model.facets(group), quadrature), -1.0, 1.0)
