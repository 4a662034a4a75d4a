"""Table of a tie: two facet groups that are glued together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from anisocontact.base.errors import within
from anisocontact.case.quantity import number
from anisocontact.case.section import Section

if TYPE_CHECKING:
    from anisocontact.mesh import Model


class TieSection(Section):
    """Two facet groups glued together (tie, bonded contact); their meshes need not match."""

    slave: str = Field(description='facets whose nodes follow, "body.group"; the finer mesh')
    master: str = Field(description='facets that they follow, "body.group"')
    tolerance: Annotated[
        float | None,
        number(
            "scalar",
            "length",
            "facets with nodes farther from the master than this are not tied; a tenth of the size "
            "of its facets if left out",
            "non-negative",
        ),
    ] = None
    adjust: bool = Field(
        False,
        description="whether slave nodes within the tolerance are moved onto the master in the "
        "mesh, without strain, before anything else",
    )

    def given(self) -> dict[str, Any]:
        """What makes a tie of the mesh as it is then."""
        return {name: value for name, value in self if name != "adjust"}


def close_gaps_of(ties: Sequence[TieSection], model: Model) -> list[str]:
    """Close the gaps of the ties that ask for it in the mesh; a line for each. Collective."""
    from anisocontact.contact import close_gaps

    lines = []
    for i, tie in enumerate(ties):
        if tie.adjust:
            with within(f"tie[{i}]"):
                count, far = close_gaps(model, tie.slave, tie.master, tie.tolerance)
            lines.append(f"{count} nodes of {tie.slave} moved onto {tie.master}, {far:.3g} at most")
    return lines
