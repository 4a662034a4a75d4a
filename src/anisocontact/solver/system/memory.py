"""What a problem goes on from: the state of its bodies and the history of its contacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from anisocontact.bulk.history import BodyHistory
from anisocontact.contact import AnyContact
from anisocontact.solver.system.accepted import AcceptedState
from anisocontact.solver.system.configuration import Configuration
from anisocontact.solver.system.parts import Parts
from anisocontact.solver.system.persistent import Arrays, Persistent

#: In front of the names of what was when the step began.
BEGUN = "begun_"


class Memory:
    """The accepted state now and as it was when the step began.

    What a step prescribes goes on from the state in which it began, so both are needed.

    Args:
        parts: Parts of the problem.
        accepted: Accepted state.
        bodies: Where the bodies are.
    """

    def __init__(self, parts: Parts, accepted: AcceptedState, bodies: Configuration) -> None:
        self._parts, self._accepted, self._bodies = parts, accepted, bodies
        self.begin()

    def begin(self) -> None:
        """A step begins here."""
        self._begun = self._now()

    def persistent(self) -> tuple[Arrays, Arrays]:
        """Values at the nodes this rank owns, and what all ranks have in common."""
        now, begun = self._now(), self._begun
        nodal, common = (
            a | {f"{BEGUN}{name}": values for name, values in b.items()}
            for a, b in zip(now, begun, strict=True)
        )
        return nodal, common

    def restore(self, kept: Persistent, prefix: str = "") -> None:
        """Go on from what `persistent` gave, or with `BEGUN` from where the step began."""
        parts, stabilisation = self._parts, self._parts.stabilisation
        nodal, common = (
            {n.removeprefix(prefix): v for n, v in values.items() if n.startswith(prefix)}
            for values in (kept.nodal, kept.common)
        )
        self._accepted.restore(nodal, common)
        springs, released, careful = common["stabilisation"]
        stabilisation.energy, stabilisation.released = float(springs), float(released)
        stabilisation.careful = bool(careful)
        parts.rigid.restore(common)
        parts.attached.restore(common["springs"])
        self._bodies.take(self._accepted.x)
        parts.rigid.roll_back()
        self._bodies.forget()

    def _now(self) -> tuple[Arrays, Arrays]:
        parts, held = self._parts, self._parts.stabilisation
        nodal, common = self._accepted.persistent()
        own = {
            "springs": parts.attached.persistent(),
            "stabilisation": np.array([held.energy, held.released, held.careful]),
        }
        return nodal, common | own | parts.rigid.persistent()


def persistent_points(
    contacts: Sequence[AnyContact], histories: Mapping[str, BodyHistory]
) -> list[Arrays]:
    """History of every pass over slave points, and of every body whose material has one."""
    passes = [part.persistent() for contact in contacts for part in contact.parts]
    return passes + [history.persistent() for history in histories.values()]


def restore_points(
    contacts: Sequence[AnyContact],
    histories: Mapping[str, BodyHistory],
    kept: Sequence[Arrays],
    nodal: npt.NDArray[np.float64],
) -> None:
    """Go on from what `persistent_points` gave.

    Args:
        contacts: The contacts.
        histories: Bodies whose material has a history, by name.
        kept: What was kept of them.
        nodal: Displacement of the local nodes in that state, (nodes, 3), length.
    """
    points = iter(kept)
    for contact in contacts:
        for part in contact.parts:
            part.restore(next(points), nodal)
        contact.rejoin()
    for history in histories.values():
        history.restore(next(points))
