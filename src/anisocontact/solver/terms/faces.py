"""Coupled faces of a problem: facet groups that follow rigid bodies, as a constraint."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import Mat, Vec
from anisocontact.bulk import Material, small_strain
from anisocontact.contact.quadrature import Couplings
from anisocontact.mesh import Model
from anisocontact.rigid import RigidBody
from anisocontact.solver.terms.constraint import Constraint
from anisocontact.solver.terms.face_on_body import CoupledFace, FaceOnBody
from anisocontact.solver.terms.handed_rows import HandedRows


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
