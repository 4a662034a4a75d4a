"""What the next steps of a script depend on, as arrays, and what tells its problem from others."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.contact import Contact
from anisocontact.mesh.node_unknowns import NodeUnknowns
from anisocontact.rigid import RigidBody
from anisocontact.solver.stepping.same_problem import (
    as_array,
    check_described,
    check_histories,
    check_positions,
    described_contacts,
    numbering,
    size_of,
)
from anisocontact.solver.terms.persistent import Arrays, under
from anisocontact.solver.terms.term import Term


class ScriptState:
    """The state of a `ContactProblem`.

    Args:
        u: Its unknown, a DOLFINx function.
        unknowns: Where the displacement is among the unknowns.
        contacts: Its contacts.
        bodies: Rigid bodies that carry their surfaces.
        terms: What acts.
    """

    def __init__(
        self,
        u: Any,
        unknowns: NodeUnknowns,
        contacts: Sequence[Contact],
        bodies: Sequence[RigidBody],
        terms: Term,
    ) -> None:
        self._u, self._unknowns, self._bodies, self._terms = u, unknowns, bodies, terms
        self._made_of = described_contacts(contacts)

    def arrays(self) -> Arrays:
        """All of it, of this rank."""
        poses = [body.accepted for body in self._bodies]
        found = {
            **self._origin(),
            "u": self._u.x.array.copy(),
            "poses": np.array([pose.values for pose in poses]).reshape(-1, 6),
            "rotations": np.array([pose.rotation for pose in poses]).reshape(-1, 3, 3),
        }
        for i, history in enumerate(self._terms.histories()):
            found |= {f"{i}/{name}": values for name, values in history.items()}
        return found

    def take(self, kept: Arrays) -> None:
        """Go on from what `arrays` gave.

        Raises:
            InputError: It is that of another problem.
        """
        histories = self._checked(kept)
        self._u.x.array[:] = kept["u"]
        poses = zip(self._bodies, kept["poses"], kept["rotations"], strict=True)
        for body, values, rotation in poses:
            body.go_on(values, rotation)
        nodal = self._unknowns.nodal(self._u.x.array)
        self._terms.take_histories(iter(histories), nodal)

    def _origin(self) -> Arrays:
        """What tells the problem from others."""
        return {
            "problem": as_array(self._made_of),
            "position": np.asarray(self._unknowns.nodes.tabulate_dof_coordinates()),
            "numbering": numbering(self._u.function_space),
        }

    def _checked(self, kept: Arrays) -> list[Arrays]:
        """Histories of the contacts, of a state of this problem."""
        own, now = self._origin(), self._terms.histories()
        if missing := sorted({*own, "u", "poses", "rotations"} - set(kept)):
            raise InputError(f"no state of a problem of this version: it has no {missing[0]!r}")
        check_described(kept["problem"], self._made_of)
        size = size_of(own["position"])
        check_positions(kept["position"], own["position"], "node", size)
        if not np.array_equal(kept["numbering"], own["numbering"]):
            raise InputError("the state is that of a mesh with other cells, or on other processes")
        histories = [under(f"{i}/", kept) for i in range(len(now))]
        for one, given in zip(now, histories, strict=True):
            check_histories(given, one, size)
        return histories
