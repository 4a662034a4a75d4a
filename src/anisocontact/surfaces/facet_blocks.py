"""What describes the facets of a mesh, checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Flags, Floats, Locals
from anisocontact.base.errors import InputError

#: Number of nodes of each topology. Nodes are in the order of DOLFINx: vertices (0,0), (1,0), (0,1)
#: of a triangle and (0,0), (1,0), (0,1), (1,1) of a quadrilateral, then edges, then the interior.
TOPOLOGIES = {"tri3": 3, "tri6": 6, "quad4": 4, "quad8": 8, "quad9": 9}


@dataclass(frozen=True)
class FacetBlocks:
    """Blocks of facets of one topology each, as the core takes them.

    Args:
        topologies: Name of the topology of each block.
        counts: Number of facets of each block.
        nodes: Points of the facets, one facet after the other.
        flip: Facets whose normal is turned round, (number of facets,).
    """

    topologies: list[str]
    counts: Locals
    nodes: Locals
    flip: Flags

    @classmethod
    def of(
        cls,
        connectivity: npt.ArrayLike | Sequence[npt.ArrayLike],
        topology: str | Sequence[str],
        flip: npt.ArrayLike | None,
    ) -> FacetBlocks:
        """Blocks from one array and one name, or from a list of each.

        Args:
            connectivity: Points of each facet, (k, nodes) of integers, or a list of such arrays.
            topology: Name of the topology, or one for each array.
            flip: Facets to be turned round, (number of facets,), or None.

        Raises:
            InputError: Unknown topology, or arrays of another shape or type.
        """
        names = [topology] if isinstance(topology, str) else list(topology)
        given = (
            [cast(npt.ArrayLike, connectivity)]
            if isinstance(topology, str)
            else list(cast(Sequence[npt.ArrayLike], connectivity))
        )
        if len(names) != len(given):
            raise InputError(f"{len(names)} given for {len(given)} blocks", field="topology")
        blocks = [_block(b, t) for b, t in zip(given, names, strict=True)]
        counts = np.array([b.shape[0] for b in blocks], dtype=np.int32)
        count = int(counts.sum())
        turned = np.zeros(count, dtype=np.bool_) if flip is None else np.asarray(flip, np.bool_)
        if turned.shape != (count,):
            raise InputError(f"shape {turned.shape} given, ({count},) needed", field="flip")
        nodes = np.concatenate([np.zeros(0, np.int32), *(b.ravel() for b in blocks)])
        return cls(names, counts, nodes, np.ascontiguousarray(turned))


def _block(connectivity: npt.ArrayLike, topology: str) -> Locals:
    if topology not in TOPOLOGIES:
        raise InputError(f"given {topology!r}, allowed: {', '.join(TOPOLOGIES)}", field="topology")
    b = np.asarray(connectivity)
    n = TOPOLOGIES[topology]
    if b.ndim != 2 or b.shape[1] != n or not np.issubdtype(b.dtype, np.integer):
        raise InputError(
            f"array of {b.dtype} of shape {b.shape} given, integers of shape (k, {n}) needed for "
            f"{topology}",
            field="connectivity",
        )
    return np.ascontiguousarray(b, dtype=np.int32)


def finite(x: Floats) -> Floats:
    """`x` if every point of it is finite.

    Args:
        x: Points, (n, 3).

    Raises:
        InputError: A point is not finite.
    """
    bad = np.flatnonzero(~np.isfinite(x).all(axis=1))
    if bad.size:
        raise InputError(f"point {bad[0]} is not finite", field="coordinates")
    return x
