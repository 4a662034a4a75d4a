"""What a problem goes on from: the state of its bodies and the history of its contacts."""

from __future__ import annotations

from anisocontact.solver.system.accepted import AcceptedState
from anisocontact.solver.system.configuration import Configuration
from anisocontact.solver.terms.persistent import Arrays, Persistent
from anisocontact.solver.terms.term import Term

#: In front of the names of what was when the step began.
BEGUN = "begun_"


class RestartState:
    """The accepted state now and as it was when the step began.

    What a step prescribes goes on from the state in which it began, so both are needed.

    Args:
        terms: All terms; those with a history of points keep it themselves.
        accepted: Accepted state.
        bodies: Where the bodies are.
    """

    def __init__(self, terms: Term, accepted: AcceptedState, bodies: Configuration) -> None:
        self._terms, self._accepted, self._bodies = terms, accepted, bodies
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
        nodal, common = (
            {n.removeprefix(prefix): v for n, v in values.items() if n.startswith(prefix)}
            for values in (kept.nodal, kept.common)
        )
        self._accepted.restore(nodal, common)
        self._terms.restore(common)
        self._bodies.take(self._accepted.x)
        self._terms.roll_back()
        self._bodies.forget()

    def _now(self) -> tuple[Arrays, Arrays]:
        nodal, common = self._accepted.persistent()
        return nodal, common | self._terms.persistent()
