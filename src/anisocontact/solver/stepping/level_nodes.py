"""Nodes of faces on rigid bodies that no small motion takes off what they touch."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from anisocontact.base.array_types import Flags
from anisocontact.contact import Contact
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.face_on_body import FaceOnBody

#: Motion of a node along the normal over its way in a turn below which it moves across alone.
LEVEL = 0.1


def level_nodes(problem: Problem) -> str:
    """What is told of a run that stops while such nodes touch, if they do; collective.

    A node that is level with the reference point of its face, seen along the normal of the contact,
    is moved along that by no turn but a large one. Where the step prescribes the translation of the
    body along the normal, the multiplier there has next to no lever.

    Args:
        problem: The problem, in its accepted state.
    """
    said = []
    for face, free in _led(problem):
        for contact in problem.contacts:
            count = problem.comm.allreduce(_count(face, free, contact))
            if count:
                points = "1 slave point" if count == 1 else f"{count} slave points"
                said.append(
                    f"contact {contact.name!r}: {points} of {face.group!r} can leave the master by "
                    f"nothing but a large turn of rigid body {face.body.name!r}, being level with "
                    "its reference point: leave the translation of the body along the normal free, "
                    "hold the turn, or take the edge out of the slave"
                )
    return "; ".join(said)


def _led(problem: Problem) -> Iterator[tuple[FaceOnBody, Flags]]:
    """Faces on rigid bodies that may turn, with the components of these that are free."""
    frames = iter(problem.rigid.supported_frames())
    for faces in problem.rigid.coupled.values():
        for face in faces:
            free = ~next(frames).supported
            if free[3:].any():
                yield face, free


def _count(face: FaceOnBody, free: Flags, contact: Contact) -> int:
    """How many points of a contact touch at nodes of a face on this rank that are level."""
    points = contact.slave_points
    if not (points.at_nodes and contact.trials.augmented):
        return 0
    touching = np.flatnonzero(contact.meeting() & ~contact.trials.immovable)
    nodes = points.nodes[touching, 0]
    mine = np.isin(nodes, face.nodes)
    slopes = face.following()[np.searchsorted(face.nodes, nodes[mine])][:, :, free]
    along = np.abs(np.einsum("ni,nij->nj", contact.last.normal[touching[mine]], slopes))
    return int(np.count_nonzero((along <= LEVEL * np.linalg.norm(slopes, axis=1)).all(axis=1)))
