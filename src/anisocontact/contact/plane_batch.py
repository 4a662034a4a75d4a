"""Slave nodes and their contact planes as points and facets, which the core takes."""

from __future__ import annotations

from functools import lru_cache
from typing import TypedDict, cast

import numpy as np

from anisocontact.base.array_types import Codes, Flags, Floats, Locals
from anisocontact.contact.contact_planes import NODES
from anisocontact.contact.facet_answer import OFF
from anisocontact.contact.mortar_answer import MortarState
from anisocontact.interface.contact_law import FacetBatch
from anisocontact.surfaces import TOPOLOGIES


def plane_batch(
    at: MortarState, located: Flags, near: Flags, tangent: bool, threads: int
) -> FacetBatch:
    """Each slave node as a point of a triangle, and its planes of now and then as two others.

    Args:
        at: Slave nodes and planes.
        located: Nodes that have a master opposite, (n,).
        near: Nodes whose tangent is wanted, (n,).
        tangent: Whether any is.
        threads: Threads that evaluate them.

    Returns:
        The batch; facets of now come before those of the accepted increment.
    """
    return {
        **_triangles(len(located)),
        "current_area": False,
        "now": at.planes.nodes(),
        "reference": _reference_nodes(at),
        "xi": np.where(located[:, None], at.planes.xi, 0.0),
        "feature": np.where(located, np.int8(0), np.int8(OFF)),
        "held": at.planes.held,
        "near": near,
        "tangent": tangent,
        "threads": threads,
    }


class _Triangles(TypedDict):
    """Part of `FacetBatch`."""

    slave_nodes: Locals
    slave_shape: Floats
    slave_gradient: Floats
    weight: Floats
    connectivity: Locals
    topology: Codes
    flip: Flags
    facet: Locals
    edge: Floats


@lru_cache(maxsize=8)
def _triangles(n: int) -> _Triangles:
    """What is the same of so many slave nodes wherever they are, for all contacts: read only."""
    first = NODES * np.arange(n, dtype=np.int32)[:, None]
    three = np.arange(3, dtype=np.int32)
    found: _Triangles = {
        "slave_nodes": first + three,
        "slave_shape": np.tile([1.0, 0.0, 0.0], (n, 1)),
        "slave_gradient": np.tile([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]], (n, 1, 1)),
        "weight": np.ones(n),
        "connectivity": np.concatenate([first + 3 + three, first + 6 + three]),
        "topology": np.full(2 * n, list(TOPOLOGIES).index("tri3"), dtype=np.int8),
        "flip": np.zeros(2 * n, dtype=bool),
        "facet": np.arange(n, dtype=np.int32),
        "edge": np.zeros((n, 2)),
    }
    for one in found.values():
        cast(np.ndarray, one).setflags(write=False)
    return found


def _reference_nodes(at: MortarState) -> Floats:
    """The nodes of slave and planes in the reference configuration, where directions are."""
    opposite = at.opposite[0]
    parts = (
        (at.quadrature.reference, at.quadrature.tangents[:, 0]),
        (opposite.mean(at.reference), opposite.tangents(at.reference)),
    )
    found = [np.concatenate([p[:, None], p[:, None] + t], axis=1) for p, t in parts]
    found.append(np.zeros_like(found[0]))
    return np.ascontiguousarray(np.concatenate(found, axis=1).reshape(-1, 3))
