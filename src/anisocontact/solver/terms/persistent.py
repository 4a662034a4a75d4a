"""What a run goes on from."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy.typing as npt

#: Arrays by name.
type Arrays = dict[str, npt.NDArray[Any]]


def under(prefix: str, arrays: Arrays) -> Arrays:
    """Arrays whose names begin with a prefix, which is taken off.

    Example:
        >>> import numpy as np
        >>> values = np.zeros(1)
        >>> list(under("a/", {"a/x": values, "b/x": values}))
        ['x']
    """
    return {n.removeprefix(prefix): v for n, v in arrays.items() if n.startswith(prefix)}


@dataclass(frozen=True)
class Persistent:
    """State of a problem, or of a run, on one rank.

    Attributes:
        nodal: Values at the nodes this rank owns, (nodes, 3) each.
        points: For each pass over slave points, and each body whose material has a history, the
            values at its points, (points, ...) each; "reference" are positions in the reference
            configuration by which they are found again, no two the same.
        common: What all ranks have in common.
        strategy: What the strategy keeps from one increment to the next; where it keeps anything
            there is one rank, and the arrays have its numbering of the unknowns.
    """

    nodal: Arrays
    points: list[Arrays]
    common: Arrays = field(default_factory=dict)
    strategy: Arrays = field(default_factory=dict)
