"""Facet groups of deformable bodies that move rigidly with a reference point."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import Mat, Vec, fem
from anisocontact.base.typed import typed
from anisocontact.bulk import Material, small_strain
from anisocontact.contact.facet_mesh import facet_nodes
from anisocontact.contact.quadrature import Couplings
from anisocontact.mesh import Model
from anisocontact.rigid import COMPONENTS, RigidBody
from anisocontact.rigid.rotation import skew
from anisocontact.solver.terms.constraint import Constraint
from anisocontact.solver.terms.handed_rows import HandedRows

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


class CoupledFaces:
    """All coupled faces of a problem, as a constraint of its unknowns.

    Args:
        specs: What is coupled.
        model: Mesh with the groups.
        materials: Body name -> material.
        tied: Nodes that follow from others.

    Attributes:
        faces: The faces.

    Raises:
        InputError: An unknown facet group, two that share nodes, or a reference point beside the
            axis of a body of revolution.
    """

    def __init__(
        self,
        specs: Sequence[CoupledFace],
        model: Model,
        materials: Mapping[str, Material],
        tied: Ints,
    ) -> None:
        self._model, self._comm = model, model.mesh.comm
        for one in specs:
            model.idealisation.check_reference(one.body.reference, f"coupled.{one.group}")
        self.faces = [
            FaceOnBody(one, model, small_strain(materials[model.body_of(one.group)]), tied)
            for one in specs
        ]
        for i, face in enumerate(self.faces):
            for other in self.faces[:i]:
                what = f"the coupled face {other.group!r}"
                advice = "; make one group of the two by [join]" if other.body is face.body else ""
                self._refuse_shared(other.nodes, face, what, advice=advice)
        self._places: dict[str, tuple[int, Floats]] = {}

    def __bool__(self) -> bool:
        return bool(self.faces)

    @property
    def whole(self) -> list[str]:
        """Deformable bodies all of whose nodes follow."""
        return [face.whole for face in self.faces if face.whole]

    @property
    def dependents(self) -> Ints:
        """Unknowns of this rank that follow from those of bodies, local numbers."""
        return np.concatenate([np.zeros(0, dtype=np.int64), *(f.unknowns for f in self.faces)])

    @property
    def links(self) -> list[tuple[str, str]]:
        """Pairs of faces that follow one rigid body, and each with itself."""
        pairs = ((a, b) for i, a in enumerate(self.faces) for b in self.faces[: i + 1])
        return [(a.group, b.group) for a, b in pairs if a.body is b.body]

    def number(self, bodies: Iterable[RigidBody], scales: Mapping[RigidBody, Floats]) -> None:
        """Take over where the unknowns of the free bodies are and what they are multiplied with."""
        first = 3 * self._model.space.dofmap.index_map.size_global
        for i, body in enumerate(bodies):
            self._places[body.name] = first + 6 * i, scales[body]

    def check(self, prescribed: Ints, step: str) -> None:
        """Refuse displacements of nodes that follow a body.

        Args:
            prescribed: Unknowns that a step prescribes, local numbers.
            step: Name of the step, for messages.

        Raises:
            InputError: Names the face.
        """
        for face in self.faces:
            text = f"step {step!r}.displacement"
            both = np.intersect1d(prescribed, face.unknowns)
            self._refuse_shared(both // 3, face, "a prescribed displacement", text)

    def check_planes(self, on: Ints) -> None:
        """Refuse symmetry planes at nodes that follow a body: nodes on planes, local numbers."""
        for face in self.faces:
            self._refuse_shared(on, face, "a symmetry plane")

    def violation(self, u: Floats) -> Floats:
        """How far unknowns are from where bodies have them, length; those of this rank.

        Args:
            u: Displacements this rank owns, (unknowns,), length.
        """
        out = np.zeros_like(u)
        for face in self.faces:
            at = face.unknowns
            out[at] = u[at] - face.displacements()[face.constrained]
        return out

    def transform(self, matrix: Mat, scale: float, like: Vec) -> None:
        """Make the tangent that of the constrained system, in place; see `Constraint`."""
        constraint = self._linearised(like, moments=True)
        constraint.transform(matrix, scale)
        constraint.close()

    def spread(self, columns: Mat, like: Vec) -> Mat:
        """Displacements in which faces follow their bodies; takes the matrix over."""
        constraint = self._linearised(like, moments=False)
        out = constraint.spread(columns)
        constraint.close()
        return out

    def involved(self, like: Vec) -> Flags:
        """Unknowns of this rank that follow from others, or others from them."""
        found = np.zeros(like.getLocalSize(), dtype=np.bool_)
        found[self.dependents] = True
        first, last = like.getOwnershipRange()
        for body_first, _ in self._places.values():
            if first <= body_first < last:
                found[body_first - first : body_first - first + 6] = True
        return found

    def room(self, couplings: Sequence[Couplings], first: int) -> list[Couplings]:
        """Places in the rows of bodies for all that their faces are coupled with.

        Args:
            couplings: Couplings of nodes beside those of cells.
            first: What `CoupledTangent` calls the first node beyond those of the mesh.
        """
        found: list[Couplings] = []
        cells = self._model.space.dofmap.list
        beyond = self._model.space.dofmap.index_map.size_global
        for face in self.faces:
            there = first + self._places[face.body.name][0] // 3 - beyond + np.arange(2)
            on = self._known(face, first) >= 0
            reached = [cells[on[cells].any(axis=1)].ravel(), face.nodes]
            if face.skin is not None:
                reached = [face.skin.ravel(), face.nodes]
                found += face.of_its_own(there.astype(np.int32))
            for rows, columns, _ in couplings:
                own = (rows >= 0) & (rows < first)
                reached.append(columns[(on[np.where(own, rows, 0)] & own).any(axis=1)].ravel())
            nodes = np.unique(np.concatenate(reached))
            nodes = nodes[nodes >= 0].astype(np.int32)[:, None]
            body = np.tile(there.astype(np.int32), (len(nodes), 1))
            none = np.zeros((len(nodes), 3, 6))
            found += [(nodes, body, none), (body, nodes, none.swapaxes(1, 2))]
        return found

    def handed_rows(self, first: int) -> list[HandedRows]:
        """Rows of bodies that follow as a whole, see `HandedRows`.

        Args:
            first: As of `room`.
        """
        found, total = [], self._model.space.dofmap.index_map.size_global
        for face in self.faces:
            if face.skin is None:
                continue
            at, scale = self._places[face.body.name]
            there = (first + at // 3 - total + np.arange(2)).astype(np.int32)
            place = np.full(first + 2 * len(self._places), -1, dtype=np.int64)
            place[:first] = self._known(face, first)
            gathering = face.gathering(face.everywhere[1]) / scale
            found.append(HandedRows(place, gathering, there))
        return found

    def _known(self, face: FaceOnBody, first: int) -> Ints:
        """Places in `everywhere` of all nodes that couplings can name, -1 of others, (first,)."""
        index_map = self._model.space.dofmap.index_map
        local = first - index_map.size_global
        numbers = np.full(index_map.size_global, -1, dtype=np.int64)
        numbers[face.everywhere[0]] = np.arange(len(face.everywhere[0]))
        names = index_map.local_to_global(np.arange(local, dtype=np.int32))
        return np.concatenate([numbers[names], numbers])

    def _linearised(self, like: Vec, moments: bool) -> Constraint:
        """The constraint where the bodies are.

        Args:
            like: A vector of the unknowns.
            moments: Whether it hands over moments; else what turns of the bodies work on.
        """
        none = np.zeros(0, dtype=np.int64)
        rows, columns, followed, handed = [none], [none], [np.zeros(0)], [np.zeros(0)]
        first, _ = like.getOwnershipRange()
        for face in self.faces:
            at, scale = self._places[face.body.name]
            rows.append(np.repeat(first + face.unknowns, 6))
            columns.append(np.tile(at + np.arange(6), len(face.unknowns)))
            followed.append((face.following()[face.constrained] / scale).reshape(-1))
            handed.append((face.gathering()[face.constrained] / scale).reshape(-1))
        return Constraint(
            like,
            np.concatenate(rows),
            np.concatenate(columns),
            np.concatenate(followed),
            np.concatenate(handed) if moments else None,
        )

    def _refuse_shared(
        self, nodes: Ints, face: FaceOnBody, what: str, field: str = "", advice: str = ""
    ) -> None:
        shared = self._comm.allreduce(len(np.intersect1d(nodes, face.nodes)))
        if shared:
            text = (
                f"{shared} nodes of {face.group!r}, which follows the rigid body "
                f"{face.body.name!r}, have {what} as well{advice}"
            )
            raise InputError(text, field or f"coupled.{face.group}")
