"""What bodies are attached to for a whole run: elastic supports and springs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import override

import numpy as np

from anisocontact.base import registry
from anisocontact.base.array_types import Floats, Locals
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Parameter
from anisocontact.base.typed import typed
from anisocontact.contact import facet_quadrature
from anisocontact.contact.quadrature import Couplings
from anisocontact.mesh import Model
from anisocontact.solver.terms.loads import mean_shares
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.prescribed_components import PrescribedComponents
from anisocontact.solver.terms.pressure import outward
from anisocontact.solver.terms.step import AXES, Step
from anisocontact.solver.terms.term import Term

#: Nodes of the groups of a spring: each moves all others, so that the matrix gets their square.
MOST_NODES = 2000


class Attached(Term):
    """Something elastic that holds a body.

    Attributes:
        name: Name in reactions and messages.
        nodes: Local nodes of the bodies that it acts on.
    """

    name: str
    nodes: Locals

    def reaction(self, u: Floats, trial: bool = False) -> Floats:
        """Force on the body, over all ranks, (3,), force; collective.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            trial: Whether this is a trial at the load factor of now; else the accepted state.
        """
        raise NotImplementedError

    def way(self) -> float:
        """How far it can carry what it holds from the accepted state on, length."""
        return 0.0


@typed
@dataclass(frozen=True)
class ElasticSupport:
    """A bed of springs between a facet group and ground.

    The force per reference area is `-(k_n n n + k_t (1 - n n)) u`, n the reference normal.

    Attributes:
        group: Facet group, "body.group".
        normal: k_n, >= 0, stress/length.
        tangential: k_t, >= 0, stress/length.

    Raises:
        InputError: A stiffness is negative, or both are zero.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> bed = ElasticSupport("a.bottom", normal=50.0)
        >>> on = bed.on(build_box({"a": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))}))
        >>> on.reaction(np.tile([0.0, 0.0, -0.1], (8, 1))).round(12).tolist()  # of a unit area
        [0.0, 0.0, 5.0]
    """

    group: str
    normal: float
    tangential: float = 0.0

    def __post_init__(self) -> None:
        for name in ("normal", "tangential"):
            parameter = Parameter(name, "scalar", "stress/length", "", "non-negative")
            registry.check(parameter, getattr(self, name), f"elastic_support.{self.group}.{name}")
        if self.normal == self.tangential == 0.0:
            raise InputError("both stiffnesses are 0", f"elastic_support.{self.group}")

    @property
    def groups(self) -> list[str]:
        """Facet groups that are held."""
        return [self.group]

    def on(self, model: Model) -> Attached:
        """The support on a model.

        Args:
            model: Mesh with the group.

        Returns:
            Its forces and blocks.

        Raises:
            InputError: The group is unknown.
        """
        return _SupportTerm(self, model)


@typed
@dataclass(frozen=True)
class Spring:
    """A spring between a facet group and ground, or another facet group.

    It sees the mean displacement of a group over its area, and its force is a uniform traction:
    `f = -k (mean u - anchor)`, or with the mean of the other group in the place of the anchor.

    Attributes:
        name: Name of the spring.
        group: Facet group, "body.group".
        stiffness: k along x, y and z, >= 0, force/length.
        to: The other facet group; ground if None.

    Raises:
        InputError: A stiffness is negative, or all are zero.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> pull = Spring("pull", "a.right", stiffness=(2e3, 0.0, 0.0))
        >>> on = pull.on(build_box({"a": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))}))
        >>> (on.reaction(np.tile([0.001, 0.0, 0.0], (8, 1))) + 0.0).round(12).tolist()
        [-2.0, 0.0, 0.0]
    """

    name: str
    group: str
    stiffness: tuple[float, float, float]
    to: str | None = None

    def __post_init__(self) -> None:
        field = f"spring.{self.name}"
        parameter = Parameter("stiffness", "vector", "force/length", "", "non-negative")
        registry.check(parameter, self.stiffness, f"{field}.stiffness")
        if not any(self.stiffness):
            raise InputError("all components are 0", f"{field}.stiffness")
        if self.to == self.group:
            raise InputError(f"{self.to!r} given, the group itself", f"{field}.to")

    @property
    def groups(self) -> list[str]:
        """Facet groups that are held."""
        return [self.group] if self.to is None else [self.group, self.to]

    def on(self, model: Model) -> Attached:
        """The spring on a model.

        Args:
            model: Mesh with the groups.

        Returns:
            Its forces and blocks.

        Raises:
            InputError: A group is unknown.
        """
        return _SpringTerm(self, model)


class _SupportTerm(Attached):
    """An elastic support on a model."""

    def __init__(self, spec: ElasticSupport, model: Model) -> None:
        self.name = spec.group
        self._comm = model.mesh.comm
        facets = model.facets(spec.group, f"elastic_support.{spec.group}")
        self._quadrature = facet_quadrature(
            model.space, facets, 2 * model.order, model.idealisation
        )
        n = outward(model, spec.group, self._quadrature)
        along = n[:, :, None] * n[:, None, :]
        stiffness = spec.normal * along + spec.tangential * (np.eye(3) - along)
        self._stiffness: Floats = stiffness
        nodes = self._quadrature.nodes
        self._blocks = (nodes, nodes, self._quadrature.facet_matrices(stiffness))
        self.nodes = np.unique(nodes)

    @override
    def add_force(self, u: Floats, out: Floats) -> None:
        self._quadrature.to_nodes(self._traction(u), out)

    @override
    def blocks(self) -> list[Couplings]:
        return [self._blocks]

    @override
    def energies(self, u: Floats) -> dict[str, float]:
        moved = self._quadrature.at_points(u)
        density = -0.5 * np.einsum("ni,ni->n", self._traction(u), moved)
        return {"springs": float(self._comm.allreduce(self._quadrature.areas @ density))}

    @override
    def reaction(self, u: Floats, trial: bool = False) -> Floats:
        local = self._quadrature.areas @ self._traction(u)
        return np.asarray(self._comm.allreduce(local))

    def _traction(self, u: Floats) -> Floats:
        moved = self._quadrature.at_points(u)
        return np.asarray(-np.einsum("nij,nj->ni", self._stiffness, moved))


class _SpringTerm(Attached):
    """A spring on a model; its anchor is moved by the steps."""

    def __init__(self, spec: Spring, model: Model) -> None:
        self.name = spec.name
        field = f"spring.{spec.name}"
        weights = mean_shares(model, spec.group, f"{field}.group")
        if spec.to is not None:
            weights = weights - mean_shares(model, spec.to, f"{field}.to")
        if model.mesh.comm.size > 1:
            raise InputError("springs of facet groups need one process", field)
        self.nodes = np.flatnonzero(weights).astype(np.int32)
        if len(self.nodes) > MOST_NODES:
            text = f"{len(self.nodes)} nodes in its groups, at most {MOST_NODES} allowed"
            raise InputError(text, field)
        self._weights = weights[self.nodes]
        self._stiffness = np.asarray(spec.stiffness, dtype=float)
        self._prescribed, self._anchor = PrescribedComponents(3), np.zeros(3)
        #: Anchor and force in the accepted state, (2, 3), length and force.
        self._accepted: Floats = np.zeros((2, 3))

    @override
    def begin(self, step: Step, released: Floats) -> None:
        self._prescribed.begin(step.duration)
        for axis, value in step.anchor.get(self.name, {}).items():
            self._prescribed.prescribe(AXES.index(axis), value)

    @override
    def end_at(self, factor: float) -> None:
        self._prescribed.stop(factor)

    @override
    def set_load_factor(self, factor: float, dt: float) -> None:
        self._anchor = self._prescribed.at(factor)

    @override
    def add_force(self, u: Floats, out: Floats) -> None:
        out[self.nodes] += self._weights[:, None] * self._force(u, self._anchor)

    @override
    def couplings(self) -> list[Couplings]:
        pairs = np.einsum("a,ij,b->aibj", self._weights, np.diag(self._stiffness), self._weights)
        size = 3 * len(self.nodes)
        nodes = self.nodes[None]
        return [(nodes, nodes, pairs.reshape(1, size, size))]

    @override
    def energies(self, u: Floats) -> dict[str, float]:
        anchor, _ = self._accepted
        return {"springs": -0.5 * float(self._force(u, anchor) @ self._stretch(u, anchor))}

    @override
    def reaction(self, u: Floats, trial: bool = False) -> Floats:
        return self._force(u, self._anchor if trial else self._accepted[0])

    @override
    def way(self) -> float:
        before, force = self._accepted
        stiff = self._stiffness > 0.0
        stretch = force[stiff] / self._stiffness[stiff]
        return float(np.linalg.norm(self._anchor - before) + np.linalg.norm(stretch))

    @override
    def accept(self, u: Floats) -> float:
        before, force = self._accepted
        self._accepted = np.stack([self._anchor, self._force(u, self._anchor)])
        return float(0.5 * (force + self._accepted[1]) @ (self._anchor - before))

    @override
    def persistent(self) -> Arrays:
        return {f"spring.{self.name}": self._accepted.copy()}

    @override
    def restore(self, kept: Arrays) -> None:
        self._accepted = kept[f"spring.{self.name}"].copy()

    def _force(self, u: Floats, anchor: Floats) -> Floats:
        return np.asarray(-self._stiffness * self._stretch(u, anchor))

    def _stretch(self, u: Floats, anchor: Floats) -> Floats:
        return np.asarray(self._weights @ u[self.nodes] - anchor)
