"""How far bodies have moved in an attempt, and how far what is prescribed can have moved them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact import Contact
from anisocontact.solver.terms.attachments import Attachments
from anisocontact.solver.terms.free_body import FreeBody
from anisocontact.solver.terms.free_modes import Supported, SupportedFrame


class BodyMotion:
    """Motion of bodies since an attempt began.

    Args:
        contacts: The contacts, some of which have rigid bodies.
        attached: Springs and elastic supports; none if left out.
        comm: Communicator of the mesh.

    Attributes:
        held: Nodes and directions that the step holds.
        frames: What it holds of faces that follow rigid bodies.
        begun: Displacement of the local nodes where the attempt began, (nodes, 3), length.
    """

    def __init__(
        self, contacts: Sequence[Contact], attached: Attachments | None, comm: Any
    ) -> None:
        self._contacts, self._attached, self._comm = list(contacts), attached, comm
        self.held: list[Supported] = []
        self.frames: list[SupportedFrame] = []
        self.begun: Floats = np.zeros((0, 3))

    def far(self, free: FreeBody, u: Floats, explained: float = 0.0) -> bool:
        """Whether a body has moved by more than a facet beyond what is explained; collective.

        Args:
            free: The body.
            u: Displacement of the local nodes, (nodes, 3), length.
            explained: Way that something else explains, length.
        """
        nodes = free.nodes
        way = np.linalg.norm(u[nodes] - self.begun[nodes], axis=1).max(initial=0.0)
        return bool(max(self._comm.allgather(float(way))) > free.size + explained)

    def prescribed(self, u: Floats) -> float:
        """Farthest that supports, rigid bodies and springs can have moved a body, length.

        Springs by what their anchors have moved and by their stretch. Collective.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
        """
        moved = u - self.begun
        ways = [np.abs((moved[n] * e).sum(axis=1)).max(initial=0.0) for n, e in self.held]
        for frame in self.frames:
            ways.append(np.abs(moved[frame.nodes]).max(initial=0.0))
        for contact in self._contacts:
            if contact.body is not None:
                ways.append(contact.body.farthest(contact.current.points))
        if self._attached is not None:
            ways.append(self._attached.way())
        return float(np.sqrt(3.0) * max(self._comm.allgather(float(max(ways, default=0.0)))))
