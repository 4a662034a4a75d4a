"""Rigid bodies of a problem: their motion along the steps, rows and columns of free ones."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, override

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.contact import Contact
from anisocontact.contact.quadrature import Couplings
from anisocontact.rigid import RigidBody
from anisocontact.solver.terms.face_loads import add_face_loads
from anisocontact.solver.terms.face_on_body import FaceOnBody
from anisocontact.solver.terms.faces import CoupledFaces
from anisocontact.solver.terms.free_modes import SupportedFrame
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.rigid_boundary_conditions import (
    RigidBoundaryConditions,
    check_known,
)
from anisocontact.solver.terms.step import Step
from anisocontact.solver.terms.term import Term
from anisocontact.solver.terms.unsupported_rigid_body import check_supported, overturned


class RigidBodies(Term):
    """The rigid bodies of the contacts.

    A free body adds six unknowns `(d, l v)`: translation and turn, the turn times a length of the
    body so that all are lengths; and six rows: forces, and moments about its reference point over
    the same length. Moments are those of space, and a moment that is applied does not turn with the
    body. A prescribed component has the row `s (unknown - value)`.

    Args:
        contacts: All contacts of the problem.
        comm: Communicator of the mesh.
        faces: Faces of deformable bodies that follow rigid ones.

    Attributes:
        bodies: The bodies in the order of their contacts.
        free: Those with unknowns.
        coupled: Facet groups that follow each of them.

    Raises:
        InputError: Two bodies of one name.
    """

    def __init__(
        self, contacts: Sequence[Contact], comm: Any, faces: CoupledFaces | None = None
    ) -> None:
        on_bodies = [contact for contact in contacts if contact.body is not None]
        self.faces = faces
        coupled = [] if faces is None else faces.faces
        self.bodies: list[RigidBody] = list(
            dict.fromkeys(
                [
                    *(contact.body for contact in on_bodies if contact.body is not None),
                    *(face.body for face in coupled),
                ]
            )
        )
        self._names = [body.name for body in self.bodies]
        for name in self._names:
            if self._names.count(name) > 1:
                raise InputError(f"two rigid bodies have the name {name!r}", "body")
        self.free = [body for body in self.bodies if body.free]
        self.contacts = {b: [one for one in on_bodies if one.body is b] for b in self.bodies}
        self.coupled = {b: [face for face in coupled if face.body is b] for b in self.bodies}
        self._comm, self._key = comm, object()
        self._bcs = {body: RigidBoundaryConditions(body) for body in self.bodies}
        self._scales = {body: self._scale(body) for body in self.bodies}
        zero = np.zeros((len(self.bodies), 6))
        self._outside, self._accepted_outside, self._accepted_load = zero, zero, zero
        #: What faces need from outside at the trial and in the accepted state, (bodies, 6).
        self._of_faces, self._accepted_of_faces = zero, zero
        self._load_factor = 0.0
        if faces is not None:
            faces.number(self.free, self._scales)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 6 * len(self.free)

    def check(self, steps: Iterable[Step]) -> None:
        """Go through the motions and loads of all steps without solving.

        Raises:
            InputError: See `begin`.
        """
        for _ in self.rehearsed(steps):
            pass

    def rehearsed(self, steps: Iterable[Step]) -> Iterator[list[SupportedFrame]]:
        """What each of the steps holds of the motion of faces, without solving.

        Raises:
            InputError: See `begin`.
        """
        bcs = {body: RigidBoundaryConditions(body) for body in self.bodies}
        for step in steps:
            check_known(step, self._names)
            for bc in bcs.values():
                bc.begin(step, bc.values(1.0), np.zeros(6))
            yield self._frames(bcs)

    @override
    def begin(self, step: Step, released: Floats) -> None:
        check_known(step, self._names)
        reactions = self._accepted_outside + self._accepted_of_faces - self._accepted_load
        for body, reaction in zip(self.bodies, reactions, strict=True):
            bc = self._bcs[body]
            bc.begin(step, body.accepted.values, reaction)
            body.turns_freely = not bc.prescribed[3:].all()

    def prescribed_turn(self, step: Step) -> float:
        """Largest rotation along the step that is prescribed of a body or facet group, radian."""
        turns = [bc.largest_turn() for bc in self._bcs.values()]
        return max([*turns, *(turn.fastest for turn in step.rotation.values())], default=0.0)

    @override
    def set_load_factor(self, factor: float, dt: float) -> None:
        for body in self.bodies:
            body.check_history(self._key, "rigid body")
        self._load_factor = factor

    @override
    def end_at(self, factor: float) -> None:
        for bc in self._bcs.values():
            bc.stop(factor)

    def place(self, unknowns: Floats) -> None:
        """Bring the bodies to their unknowns, (size,), and to what is prescribed."""
        for body in self.bodies:
            if not body.free:
                body.place(self._bcs[body].values(self._load_factor))
        for body, values in zip(self.free, unknowns.reshape(-1, 6), strict=True):
            body.place(values / self._scales[body])

    def unknowns(self) -> Floats:
        """Unknowns of the accepted state, (size,), length."""
        parts = [body.accepted.values * self._scales[body] for body in self.free]
        return np.concatenate([np.zeros(0), *parts])

    def values(self) -> Floats:
        """Unknowns with the values that are prescribed at this level, zero for others, (size,)."""
        parts = [
            np.where(self._bcs[b].prescribed, self._bcs[b].values(self._load_factor), 0.0)
            * self._scales[b]
            for b in self.free
        ]
        return np.concatenate([np.zeros(0), *parts])

    def take_faces(self, force: Floats) -> None:
        """Take over what the nodes of faces need from outside; collective.

        Args:
            force: Of the unknowns this rank owns, all but what holds them, force.
        """
        self._of_faces = self._wrenches([face.take(force) for face in self._faces()])

    def residual(self, unknowns: Floats, support_scale: float) -> Floats:
        """Rows of the free bodies at the trial of the contacts, (size,), force."""
        self._outside = self._forces()
        rows = np.zeros(self.size)
        for i, body in enumerate(self.free):
            bc, scale = self._bcs[body], self._scales[body]
            outside = (self._outside + self._of_faces)[self.bodies.index(body)]
            row = (outside - bc.load(self._load_factor)) / scale
            off = unknowns[6 * i : 6 * i + 6] - bc.values(self._load_factor) * scale
            rows[6 * i : 6 * i + 6] = np.where(bc.prescribed, support_scale * off, row)
        return rows

    def multiplier_residual(self, forces: Floats) -> Floats:
        """`Contacts.multiplier_residual` of the free bodies as the rows have it, (size,), force.

        Args:
            forces: That of the nodes this rank owns, (nodes, 3).
        """
        rows = np.zeros(self.size)
        on_faces = self._wrenches([face.wrench(forces[face.nodes]) for face in self._faces()])
        for i, body in enumerate(self.free):
            local = sum(
                (c.trials.multiplier_wrench(body.position) for c in self.contacts[body]),
                np.zeros(6),
            )
            row = on_faces[self.bodies.index(body)] - np.asarray(self._comm.allreduce(local))
            row = row / self._scales[body]
            rows[6 * i : 6 * i + 6] = np.where(self._bcs[body].prescribed, 0.0, row)
        return rows

    def loads(self) -> Floats:
        """Loads of the free bodies as the rows have them, (size,), force."""
        parts = [self._bcs[b].load(self._load_factor) / self._scales[b] for b in self.free]
        return np.concatenate([np.zeros(0), *parts])

    def add_face_loads(self, out: Floats) -> None:
        """Add loads on bodies with faces to the local nodes of these, (nodes, 3); collective."""
        for body, faces in self.coupled.items():
            if faces:
                add_face_loads(faces, self._bcs[body].load(self._load_factor), out, self._comm)

    def load(self, body: RigidBody, fraction: float) -> Floats:
        """Force and moment on a body at a fraction of the step, (6,)."""
        return self._bcs[body].load(fraction)

    def holds(self, body: RigidBody) -> Flags:
        """Which components the step prescribes, or springs hold, (6,)."""
        return np.asarray(self._bcs[body].prescribed | (body.springs > 0.0))

    def length_of_turns(self, body: RigidBody) -> float:
        """Length by which turns of a body are taken for lengths."""
        return float(self._scales[body][3])

    @property
    def rest(self) -> bool:
        """Whether no motion of them is prescribed along the step."""
        return all(bc.rests for bc in self._bcs.values())

    @property
    def loads_rest(self) -> bool:
        """Whether loads on them hardly change along the step, and no springs act."""
        sprung = any(body.springs.any() for body in self.bodies)
        rest = (bc.load_rests(self._scales[body]) for body, bc in self._bcs.items())
        return not sprung and all(rest)

    def spring_forces(self) -> Floats:
        """Forces of the springs at the trial as the rows have them, (size,), force.

        Forces of the contacts are those on the nodes; their moments about the reference point would
        make a body that flies off look balanced.
        """
        parts = [b.springs * b.trial.values / self._scales[b] for b in self.free]
        return np.concatenate([np.zeros(0), *parts])

    def prescribed(self) -> Flags:
        """Which of the unknowns are prescribed, (size,)."""
        own = [self._bcs[body].prescribed for body in self.free]
        return np.concatenate([np.zeros(0, dtype=bool), *own])

    def prescribed_of_faces(self) -> Ints:
        """Local numbers of the unknowns of faces that this step prescribes."""
        own = [face.prescribed(self._bcs[face.body].prescribed) for face in self._faces()]
        return np.concatenate([np.zeros(0, dtype=np.int64), *own])

    def body_couplings(self, first: int) -> list[Couplings]:
        """Blocks of the tangent in rows or columns of free bodies, of the contacts of this rank.

        Args:
            first: What `CoupledTangent` calls the first node beyond those of the mesh: the i-th
                body has the "nodes" `first + 2 i` of its translation and the next of its turn.

        Raises:
            SingularError: A motion of a body meets no stiffness at all.
        """
        found: list[Couplings] = []
        for i, body in enumerate(self.free):
            own = np.array([[first + 2 * i, first + 2 * i + 1]], dtype=np.int32)
            scale = self._scales[body]
            diagonal = np.diag(body.springs / scale**2) * (self._comm.rank == 0)
            stiff = [diagonal]
            for face in self.coupled[body]:
                diagonal = diagonal + face.stiffness() / np.outer(scale, scale)
            for contact in self.contacts[body]:
                blocks = contact.body_blocks()
                there = np.broadcast_to(own, (len(blocks.nodes), 2))
                found.append((blocks.nodes, there, blocks.node_body / scale))
                found.append((there, blocks.nodes, blocks.body_node / scale[:, None]))
                diagonal = diagonal + blocks.body / np.outer(scale, scale)
                stiff.append((blocks.held / scale).reshape(-1, 6))
            found.append((own, own, diagonal[None]))
            if not self.coupled[body]:  # else what holds the deformable body is looked at
                free, contacts = ~self._bcs[body].prescribed, self.contacts[body]
                check_supported(body, free, np.concatenate(stiff), contacts, self._comm)
        return found

    @override
    def accept(self, u: Floats) -> float:
        before = np.array([body.accepted.values for body in self.bodies]).reshape(-1, 6)
        now = np.array([body.trial.values for body in self.bodies]).reshape(-1, 6)
        work = float(np.sum(0.5 * (self._accepted_outside + self._outside) * (now - before)))
        for body in self.bodies:
            body.commit()
            body.history_of = self._key
        self._accepted_outside, self._accepted_of_faces = self._outside, self._of_faces
        self._accepted_load = np.array(
            [self._bcs[body].load(self._load_factor) for body in self.bodies]
        ).reshape(-1, 6)
        return work

    @override
    def roll_back(self) -> None:
        for body in self.bodies:
            body.trial = body.accepted

    @override
    def persistent(self) -> Arrays:
        poses = [body.accepted for body in self.bodies]
        return {
            "rigid.values": np.array([pose.values for pose in poses]).reshape(-1, 6),
            "rigid.rotation": np.array([pose.rotation for pose in poses]).reshape(-1, 3, 3),
            "rigid.outside": self._accepted_outside.copy(),
            "rigid.load": self._accepted_load.copy(),
            "rigid.last_load": self._last_loads(),
            "rigid.faces": self._accepted_of_faces.copy(),
        }

    def _last_loads(self) -> Floats:
        found = [self._bcs[body].last_load for body in self.bodies]
        return np.array(found).reshape(-1, 6)

    @override
    def restore(self, kept: Arrays) -> None:
        for body, load in zip(self.bodies, kept["rigid.last_load"], strict=True):
            self._bcs[body].last_load = load
        pairs = zip(self.bodies, kept["rigid.values"], kept["rigid.rotation"], strict=True)
        for body, values, rotation in pairs:
            body.go_on(values, rotation)
            body.history_of = self._key
        self._accepted_outside = kept["rigid.outside"].copy()
        self._accepted_load = kept["rigid.load"].copy()
        self._accepted_of_faces = kept["rigid.faces"].copy()

    @override
    def energies(self, u: Floats) -> dict[str, float]:
        sprung = [body for body in self.bodies if body.springs.any()]
        stored = sum(float(0.5 * b.springs @ b.accepted.values**2) for b in sprung)
        return {"springs": stored} if sprung else {}

    def support(self, body: RigidBody) -> Floats:
        """Force and moment of what prescribes the accepted motion of a body, (6,)."""
        i = self.bodies.index(body)
        reaction = self._accepted_outside[i] + self._accepted_of_faces[i] - self._accepted_load[i]
        return np.where(self._bcs[body].prescribed, reaction, 0.0)

    def contact_force(self, body: RigidBody) -> Floats:
        """Force of contacts and faces on a body, moment about its reference point, (6,)."""
        i = self.bodies.index(body)
        needed = self._accepted_outside[i] + self._accepted_of_faces[i]
        return np.asarray(body.springs * body.accepted.values - needed)

    def supported_frames(self) -> list[SupportedFrame]:
        """What this step prescribes, or springs hold, of the motion of faces."""
        return self._frames(self._bcs)

    def _frames(self, bcs: Mapping[RigidBody, RigidBoundaryConditions]) -> list[SupportedFrame]:
        return [
            SupportedFrame(face.nodes, body.reference, bcs[body].prescribed | (body.springs > 0.0))
            for body, faces in self.coupled.items()
            for face in faces
        ]

    def _faces(self) -> list[FaceOnBody]:
        return [] if self.faces is None else self.faces.faces

    def _wrenches(self, local: Sequence[Floats]) -> Floats:
        """Sums over ranks and faces of forces and moments on faces, (bodies, 6)."""
        sums = np.zeros((len(self.bodies), 6))
        for face, wrench in zip(self._faces(), local, strict=True):
            sums[self.bodies.index(face.body)] += wrench
        return np.asarray(self._comm.allreduce(sums)) if local else sums

    def _forces(self) -> Floats:
        """What contacts and springs need from outside at the trial, (bodies, 6)."""
        if not self.bodies:
            return np.zeros((0, 6))
        local = np.zeros((len(self.bodies), 6))
        for i, body in enumerate(self.bodies):
            for contact in self.contacts[body]:
                local[i] += contact.current.wrench(body.position)
        springs = [body.springs * body.trial.values for body in self.bodies]
        return np.asarray(self._comm.allreduce(local) + np.reshape(springs, local.shape))

    def _scale(self, body: RigidBody) -> Floats:
        """1 for translations, the distance to the farthest slave point for turns, (6,)."""
        local = [
            float(np.linalg.norm(c.points - body.reference, axis=1).max(initial=0.0))
            for c in self.contacts[body]
        ]
        local += [
            float(np.linalg.norm(face.arms, axis=1).max(initial=0.0)) for face in self.coupled[body]
        ]
        reach = max(self._comm.allgather(max(local)))
        return np.repeat([1.0, reach or 1.0], 3)

    def overturned(self) -> str:
        """Says which free body turns by half a turn or more in a sub-increment; empty if none."""
        found = (overturned(body, self.contacts[body], self._comm) for body in self.free)
        return next(filter(None, found), "")
