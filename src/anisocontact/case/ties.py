"""Table of a tie: two facet groups that are glued together."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from anisocontact.case.quantity import number
from anisocontact.case.section import Section

__all__ = ["TieSection"]


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
