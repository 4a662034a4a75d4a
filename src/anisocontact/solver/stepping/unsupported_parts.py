"""Parts of the mesh of a script that nothing holds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags
from anisocontact.base.errors import InputError
from anisocontact.base.shown import shown
from anisocontact.contact import Contact
from anisocontact.mesh.node_unknowns import NodeUnknowns
from anisocontact.solver.system.assembly import Assembly
from anisocontact.solver.terms.free_modes import connected_body
from anisocontact.solver.terms.unconstrained_modes import MeshPart, parts, unconstrained_modes

#: Gap over the facet size up to which a point counts as touching: rounding of a mesh.
NEAR = 1e-6


class UnsupportedParts:
    """Finds the connected parts of a mesh that can move as rigid bodies.

    Args:
        unknowns: Where the displacement is among the unknowns.
        contacts: The contacts.
        assembly: What acts on the mesh, and its conditions.
    """

    def __init__(
        self, unknowns: NodeUnknowns, contacts: Sequence[Contact], assembly: Assembly
    ) -> None:
        self._unknowns, self._contacts, self._assembly = unknowns, contacts, assembly
        self._parts = parts(unknowns.nodes)

    def bodies(self) -> list[Any]:
        """The connected parts as bodies."""
        nodes = self._unknowns.nodes
        return [connected_body(nodes, (), [part.nodes]) for part in self._parts]

    def untouched(self) -> list[MeshPart]:
        """Parts that no contact which touches somewhere acts on, now; collective."""
        nodes = [np.zeros(0, dtype=np.int32)]
        for contact in self._contacts:
            now = contact.current.response
            near = contact.master.located(now.state) & (now.gap <= NEAR * contact.facet_size)
            if self._any(near):
                nodes.append(contact.couplable())
        touched = np.concatenate(nodes)
        return [part for part in self._parts if not self._any(np.isin(part.nodes, touched))]

    def check(self, untouched: Sequence[MeshPart], field: str) -> None:
        """Refuse parts without contact that the form and the conditions leave free; collective.

        Args:
            untouched: The parts without contact.
            field: What could hold them, for messages.
        """
        if not untouched:
            return
        bodies, rows = self._assembly.bodies, self._assembly.conditions.unknowns
        stiffness = bodies.bulk.stiffness
        bodies.add_tangent(stiffness)
        for part in untouched:
            motions = unconstrained_modes(part, stiffness, bodies.scale, rows, self._unknowns)
            if motions:
                at = shown(part.middle)
                raise InputError(
                    f"nothing holds the body around {at}: {motions}; no condition does, and no "
                    "contact touches it: let it touch at the start, or move it there with "
                    "conditions",
                    field,
                )

    def _any(self, here: Flags) -> bool:
        return bool(self._unknowns.comm.allreduce(int(here.any())))
