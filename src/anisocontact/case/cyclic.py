"""Table of a sector: two cut faces that move alike, turned about the axis."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from anisocontact.case.quantity import number
from anisocontact.case.section import Section


class CyclicSection(Section):
    """Cyclic symmetry: cut faces of a sector that stands for a whole; meshes need not match."""

    slave: str = Field(description='cut face whose nodes follow, "body.group"')
    master: str = Field(
        description='cut face that they follow, "body.group"; turned by 360 degrees over sectors, '
        "to either side, it lies on the slave"
    )
    sectors: Annotated[int, number("integer", "1", "number of sectors of the whole", "positive")]
    axis: Annotated[
        tuple[float, float, float],
        number("vector", "1", "direction of the axis"),
    ] = (0.0, 0.0, 1.0)
    point: Annotated[
        tuple[float, float, float], number("vector", "length", "a point of the axis")
    ] = (0.0, 0.0, 0.0)
    tolerance: Annotated[
        float | None,
        number(
            "scalar",
            "length",
            "largest gap between the faces once turned; a tenth of the size of the facets of the "
            "master if left out",
            "non-negative",
        ),
    ] = None
