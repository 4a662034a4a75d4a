"""What a run goes on from."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy.typing as npt

#: Arrays by name.
type Arrays = dict[str, npt.NDArray[Any]]


@dataclass(frozen=True)
class Persistent:
    """State of a problem, or of a run, on one rank.

    Attributes:
        nodal: Values at the nodes this rank owns, (nodes, 3) each.
        points: For each pass over slave points its values at them, (points, ...) each; "reference"
            are their positions in the reference configuration.
        common: What all ranks have in common.
    """

    nodal: Arrays
    points: list[Arrays]
    common: Arrays = field(default_factory=dict)
