"""Why nothing holds a rigid body, and what to do about it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from anisocontact.contact import Contact
from anisocontact.interface import Response
from anisocontact.rigid import RigidBody

_SLIDES = "what touches it slides; load it less, give it a spring, or hold it there"
_LEFT = (
    "a correction leads it off what it touches; load it in more increments, give it a spring, or "
    "hold it there"
)
_APART = (
    "it touches nothing; bring it into contact by a prescribed motion first, give it a spring, or "
    "hold it there"
)


def unheld(body: RigidBody, named: Sequence[str], contacts: Sequence[Contact], comm: Any) -> str:
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
