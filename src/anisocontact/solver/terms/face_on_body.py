"""A facet group of a deformable body that moves rigidly with a reference point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem
from anisocontact.base.typed import typed
from anisocontact.contact.facet_mesh import facet_nodes
from anisocontact.contact.quadrature import Couplings
from anisocontact.mesh import Model
from anisocontact.rigid import COMPONENTS, RigidBody
from anisocontact.rigid.rotation import skew

#: Way per angle of a turn, over the largest distance from the reference point, that is none.
ROUNDING = 1e-9


@typed
@dataclass(frozen=True)
class CoupledFace:
    """A facet group whose nodes move with a rigid body.

    `x_a = c + d + R (X_a - c)`; on a body at small strain `u_a = d + v x (X_a - c)`, v the turn.
    What the nodes carry goes to the reference point c as force and moment.

    Attributes:
        group: Facet group, "body.group".
        body: The rigid body, made with `free=True`. Components that no step frees are held.

    Raises:
        InputError: The body was not made free.

    Example:
        >>> CoupledFace("pin.top", RigidBody("head", (0, 0, 5), free=True)).body.name
        'head'
    """

    group: str
    body: RigidBody

    def __post_init__(self) -> None:
        if not self.body.free:
            text = f"rigid body {self.body.name!r} was not made with free=True"
            raise InputError(text, f"coupled.{self.group}")


class FaceOnBody:
    """The nodes of a coupled face that this rank owns.

    Args:
        spec: What is coupled.
        model: Mesh with the group.
        linear: Whether the body is at small strain.
        tied: Nodes that follow from others, which are coupled; those of a body that follows as a
            whole do all the same.

    Attributes:
        group: Facet group.
        body: The rigid body.
        nodes: Local numbers of the nodes, (n,).
        arms: Their places in the first configuration from the reference point, (n, 3), length.
        constrained: Which of their components follow; others are held by what the mesh is taken
            for, (n, 3).
        skin: Nodes of the facets of this rank where the group is the whole boundary of its body,
            which then follows with all of its nodes, (m, k); else None.
    """

    def __init__(self, spec: CoupledFace, model: Model, linear: bool, tied: Ints) -> None:
        space = model.space
        facets = model.facets(spec.group, "coupled")
        self.skin: Ints | None = None
        if model.encloses(spec.group):
            self.skin = facet_nodes(space, facets).astype(np.int64)
            nodes = np.unique(space.dofmap.list[model.cells(model.body_of(spec.group))])
        else:
            nodes = fem.locate_dofs_topological(space, model.idealisation.dim - 1, facets)
        owned = nodes[nodes < space.dofmap.index_map.size_local].astype(np.int64)
        self.group, self.body, self._linear = spec.group, spec.body, linear
        self.nodes: Ints = np.setdiff1d(owned, tied) if self.skin is None else owned
        x = np.asarray(space.tabulate_dof_coordinates())[self.nodes]
        self.arms: Floats = x - spec.body.reference
        self.constrained: Flags = np.ones((len(self.nodes), 3), dtype=np.bool_)
        for held, axis in model.idealisation.held(x):
            self.constrained[held, axis] = False
        #: Components of force and moment that have a meaning, (6,).
        self._known = np.isin(COMPONENTS, model.idealisation.motions)
        self._force = np.zeros((len(self.nodes), 3))
        #: The same of all ranks: numbers in the whole mesh, and arms.
        self.everywhere = _of_all_ranks(space, self.nodes, self.arms)
        #: Body that has no strain, as all of it follows; empty where one face alone does.
        self.whole = "" if self.skin is None else model.body_of(spec.group)

    def of_its_own(self, there: Locals) -> list[Couplings]:
        """Places for the rows of a body that has no stiffness, and for what acts on its skin.

        Args:
            there: What couplings call the two nodes of the rigid body.
        """
        skin = np.zeros((0, 0), dtype=np.int64) if self.skin is None else self.skin
        nodes, width = self.nodes.astype(np.int32)[:, None], 3 * skin.shape[1]
        facets = skin.astype(np.int32)
        on_body = np.tile(there, (len(nodes), 1))
        return [
            (nodes, on_body, np.zeros((len(nodes), 3, 6))),
            (nodes, nodes, np.zeros((len(nodes), 3, 3))),
            (facets, facets, np.zeros((len(facets), width, width))),
        ]

    @property
    def unknowns(self) -> Ints:
        """Local numbers of the unknowns that follow."""
        return np.asarray((3 * self.nodes[:, None] + np.arange(3))[self.constrained])

    def prescribed(self, components: Flags) -> Ints:
        """Local numbers of the unknowns that are prescribed where these motions of the body are.

        Args:
            components: Components of its translation and turn that are prescribed, (6,).
        """
        still = np.tile(components[:3], (len(self.nodes), 1))
        nothing = ROUNDING * float(np.abs(self.everywhere[1]).max(initial=0.0))
        for axis in np.eye(3)[~components[3:]]:
            way = np.cross(axis, self.arms)
            # at finite strain nodes leave the place where a turn does not move them
            still &= np.abs(way) <= nothing if self._linear else axis > 0.0
        return np.asarray((3 * self.nodes[:, None] + np.arange(3))[self.constrained & still])

    def displacements(self) -> Floats:
        """Where the trial of the body has the nodes, (n, 3), length."""
        pose = self.body.trial
        if self._linear:
            return np.asarray(pose.translation + np.cross(pose.turn, self.arms))
        return np.asarray(pose.translation + self._turned() - self.arms)

    def wrench(self, force: Floats) -> Floats:
        """Force and moment about the reference point of forces on these nodes, (6,).

        In the plane, and of a body of revolution, those that the whole has: others cancel.
        """
        force = np.where(self.constrained, force, 0.0)
        moment = np.cross(self._turned(), force).sum(axis=0)
        return np.where(self._known, np.concatenate([force.sum(axis=0), moment]), 0.0)

    def take(self, force: Floats) -> Floats:
        """The same of what the nodes need from outside, which is kept for `stiffness`."""
        self._force = np.where(self.constrained, force[self.nodes], 0.0)
        return self.wrench(self._force)

    def gathering(self, arms: Floats | None = None) -> Floats:
        """From the force on each node to force and moment, transposed, (n, 3, 6).

        Args:
            arms: As the attribute; of other nodes if they are given.
        """
        arms = self._turned(arms)
        shift = np.broadcast_to(np.eye(3), (len(arms), 3, 3))
        return np.concatenate([shift, -skew(arms)], axis=2)

    def following(self) -> Floats:
        """Motion of each node with translation and turn of the body, (n, 3, 6)."""
        slopes = self.gathering()
        if not self._linear:
            slopes[:, :, 3:] = slopes[:, :, 3:] @ self.body.trial.spin
        return slopes

    def stiffness(self) -> Floats:
        """Change of the moment with the turn at the forces of `take`, of this rank, (6, 6).

        `d(r x f) = (w x r) x f` with `w = J d(turn)`; none where arms do not turn.
        """
        out = np.zeros((6, 6))
        if not self._linear:
            by_spin = skew(self._force) @ skew(self._turned())
            out[3:, 3:] = by_spin.sum(axis=0) @ self.body.trial.spin
        return out

    def _turned(self, given: Floats | None = None) -> Floats:
        arms = self.arms if given is None else given
        return arms if self._linear else np.asarray(arms @ self.body.trial.rotation.T)


def _of_all_ranks(space: Any, nodes: Ints, arms: Floats) -> tuple[Ints, Floats]:
    """Nodes that ranks own, with their arms, together; numbers in the whole mesh."""
    numbers = space.dofmap.index_map.local_to_global(nodes.astype(np.int32))
    parts = zip(*space.mesh.comm.allgather((numbers, arms)), strict=True)
    every, lengths = (np.concatenate(part) for part in parts)
    return np.asarray(every, dtype=np.int64), np.asarray(lengths)
