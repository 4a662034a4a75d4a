"""Places that keep an increment from converging."""

from __future__ import annotations

from dataclasses import dataclass

from anisocontact.base.shown import shown


@dataclass(frozen=True)
class Culprit:
    """A place that kept an increment from converging.

    Attributes:
        kind: "law" (a slave point whose law fails), "chattering" (a slave point whose
            status alternates), "alternating facets" (one whose closest facet alternates),
            "inverted" (an inverted cell), "behind" (a body behind its master) or "residual" (the
            node that is farthest from equilibrium).
        position: Where it is, (x, y, z), length.
        why: What is wrong with it.
        contact: Name of the contact of a slave point.
        point: Number of the slave point in its contact, from 0; -1 for cells and nodes.
        facet: Number of its facet in the facet group, from 0; -1 for cells and nodes.
        statuses: Status of a slave point in the last Newton iterations, the latest at the end.
        border: Whether a slave point went over the border of the master and came back in these.

    Example:
        >>> node = Culprit("residual", (0.0, 0.5, 1.0), "the largest residual, 1e-3")
        >>> node.point
        -1
    """

    kind: str
    position: tuple[float, float, float]
    why: str
    contact: str = ""
    point: int = -1
    facet: int = -1
    statuses: tuple[str, ...] = ()
    border: bool = False

    def __str__(self) -> str:
        """One line."""
        at = shown(self.position, 6)
        slave = f"{self.contact}, facet {self.facet}, " if self.contact else ""
        history = f"; status {' '.join(self.statuses)}" if self.statuses else ""
        return f"{slave}{at}: {self.why}{history}"


class LostError(RuntimeError):
    """Equilibrium is lost, and what comes of it is a state that cannot be.

    Args:
        culprit: A body that is where it cannot be.
    """

    def __init__(self, culprit: Culprit) -> None:
        super().__init__(
            f"contact {culprit.contact!r}: equilibrium is lost, and viscous regularisation goes "
            f"on until {culprit.why}"
        )
        self.culprit = culprit
