"""Free rigid bodies with motions that neither contacts nor springs hold: why, and what to do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.contact import Contact
from anisocontact.interface import Response
from anisocontact.rigid import RigidBody
from anisocontact.solver.terms.term import SingularError

#: Share of the stiffness of a body's contacts and springs below which a motion counts as free.
_NOTHING = 1e-12
#: Share of a component in the square of a free motion from which on it is named.
_NAMED = 0.01
_NAMES = ("along x", "along y", "along z", "about x", "about y", "about z")
_SLIDES = "what touches it slides; load it less, give it a spring, or hold it there"
_LEFT = (
    "a correction leads it off what it touches; load it in more increments, give it a spring, or "
    "hold it there"
)
_APART = (
    "it touches nothing; bring it into contact by a prescribed motion first, give it a spring, or "
    "hold it there"
)


def check_supported(
    body: RigidBody, free: Flags, stiffness: Floats, contacts: Sequence[Contact], comm: Any
) -> None:
    """Refuse a tangent in which a free motion of a body meets no stiffness; collective.

    Args:
        body: The body, at a trial.
        free: Which components of its motion are not prescribed, (6,).
        stiffness: Change of the forces of its springs and at the slave points of this rank, a row
            each, with its motion, turns as lengths, (n, 6), force/length.
        contacts: Its contacts, at a trial.
        comm: Communicator of the mesh.

    Raises:
        SingularError: A motion meets none, or the body turns by half a turn or more.
    """
    if told := overturned(body, contacts, comm):
        raise SingularError(told)
    # The triangles of all ranks have the singular values of all rows.
    triangles = comm.allgather(np.linalg.qr(stiffness, mode="r"))
    everything = np.concatenate(triangles)
    _, sizes, axes = np.linalg.svd(everything[:, free], full_matrices=True)
    sizes = np.append(sizes, np.zeros(len(axes) - len(sizes)))
    loose = axes[sizes <= _NOTHING * float(np.linalg.norm(everything))]
    if len(loose):
        part = (loose**2).sum(axis=0)
        named = [_NAMES[i] for i, p in zip(np.flatnonzero(free), part, strict=True) if p > _NAMED]
        raise SingularError(without_support(body, named, contacts, comm))


def overturned(body: RigidBody, contacts: Sequence[Contact], comm: Any) -> str:
    """Whether a free body turns by half a turn or more in a sub-increment, in a line; else empty.

    Next to nothing holds it then, and friction would be that of a turn the other way, or of none.
    Collective.

    Args:
        body: The body, at a trial.
        contacts: Its contacts, at a trial.
        comm: Communicator of the mesh.
    """
    turn = np.abs(body.trial.turn - body.accepted.turn)
    if not float(np.linalg.norm(turn)) >= np.pi:
        return ""
    named = _NAMES[3 + int(np.argmax(turn))]
    return without_support(body, [named], contacts, comm)


def flown(
    body: RigidBody, held: Flags, contacts: Sequence[Contact], extent: float, comm: Any
) -> str:
    """Whether loads move a free body farther in this sub-increment than all is long; empty if not.

    A correction has thrown it then: nothing that it touched is where it is now, and that it rests
    there on something is chance. Collective.

    Args:
        body: The body, at a trial at which nothing is moved but by loads.
        held: Which of its components something else than contact holds, (6,).
        contacts: Its contacts, at a trial.
        extent: Longest edge of a box around all bodies that deform, length.
        comm: Communicator of the mesh.
    """
    way = np.where(held, 0.0, np.abs(body.trial.values - body.accepted.values))[:3]
    if not float(np.linalg.norm(way)) > extent:
        return ""
    return without_support(body, [_NAMES[int(np.argmax(way))]], contacts, comm)


def without_support(
    body: RigidBody, named: Sequence[str], contacts: Sequence[Contact], comm: Any
) -> str:
    """What nothing holds, and why; collective.

    Args:
        body: The body.
        named: Components of its motion that nothing holds.
        contacts: Its contacts, at a trial.
        comm: Communicator of the mesh.
    """
    if _touch((one.trial for one in contacts), comm):
        why = _SLIDES
    elif _touch((one.last for one in contacts), comm):
        why = _LEFT
    else:
        why = _APART
    return f"nothing holds the rigid body {body.name!r} {', '.join(named)}: {why}"


def _touch(answers: Iterable[Response], comm: Any) -> bool:
    local = sum(int(np.count_nonzero(answer.status)) for answer in answers)
    return bool(comm.allreduce(local) > 0)
