"""Slave nodes of ties in terms of the nodes that they follow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Ints, Sparse
from anisocontact.base.errors import InputError

if TYPE_CHECKING:
    from anisocontact.contact.tie_weights import TieConditions

#: Share of a node that is rounding.
NO_SHARE = 1e-13
#: Columns that are solved for at once.
_COLUMNS = 512


def eliminated(ties: Mapping[str, TieConditions], held: Flags, of_corners: Sparse) -> Sparse:
    """What each unknown follows.

    A component that is held besides does not follow, nor does that of a node which an earlier tie
    has. Their dual functions go to the slave nodes beside them: the functions that are left sum to
    one, so that constant tractions are handed over [Puso Laursen 2003].

    Args:
        ties: Conditions of the ties, by their names in messages.
        held: Components that cannot follow, (n, 3).
        of_corners: The displacement of each node by those that do not follow corners, (n, n).

    Returns:
        `u = F u` of the displacements along x, then y, then z of all nodes, with empty rows where
        one does not follow, (3 n, 3 n).

    Raises:
        InputError: All slave nodes at a place are held, or a node would follow itself.
    """
    none = scipy.sparse.csr_array(of_corners.shape)
    blocks = [[none] * 3 for _ in range(3)]
    taken = held.copy()
    for name, tie in ties.items():
        known: dict[bytes, tuple[Sparse, Sparse]] = {}
        turn = np.eye(3) if tie.turning is None else tie.turning.matrix
        for c in range(3):
            free = tie.covered & ~taken[tie.nodes, c]
            key = free.tobytes() + held[:, c].tobytes()
            if key not in known:
                known[key] = _one(tie, free, held[:, c], of_corners, name)
            own, other = known[key]
            blocks[c][c] = blocks[c][c] + own
            for k in np.flatnonzero(turn[c]):
                blocks[c][k] = blocks[c][k] + turn[c, k] * other
            taken[tie.nodes[free], c] = True
    return _chained(scipy.sparse.csr_array(scipy.sparse.block_array(blocks)), len(ties))


def _one(
    tie: TieConditions, free: Flags, held: Flags, of_corners: Sparse, field: str
) -> tuple[Sparse, Sparse]:
    """What the nodes that are free follow, without a turn and with it, (n, n) each."""
    own, other = tie.own, tie.other
    if tie.turning is None:  # a node may be one of the master as well
        own, other = (own - other).tocsr(), scipy.sparse.csr_array(other.shape)
        _check_left(tie, own, free, held, field)
    handed = _handed(tie, free)
    return _solved(
        (handed @ own @ of_corners).tocsr(), handed @ other @ of_corners, tie.nodes[free]
    )


def _handed(tie: TieConditions, free: Flags) -> Sparse:
    """Conditions of the nodes that are free, with shares of those that are not, (f, s)."""
    given, beside = _beside(tie, free)
    sums = np.asarray(beside.sum(axis=0)).ravel()
    shares = beside @ scipy.sparse.diags_array(1.0 / np.where(sums > 0.0, sums, 1.0))
    all_ = scipy.sparse.eye_array(len(free), format="csr")
    return (all_[np.flatnonzero(free)] + shares @ all_[given]).tocsr()


def _beside(tie: TieConditions, free: Flags) -> tuple[Ints, Sparse]:
    """Nodes that are not free, and what those beside them that are take of them, (f, given)."""
    given = np.flatnonzero(~free & (tie.weight > 0.0))
    there = tie.beside[np.flatnonzero(free)][:, given] > 0.0
    return given, there.multiply(tie.weight[free][:, None])


def _check_left(
    tie: TieConditions, conditions: Sparse, free: Flags, held: Flags, field: str
) -> None:
    """Refuse nodes that are held where none beside them could take over."""
    given, beside = _beside(tie, free)
    sums = np.asarray(beside.sum(axis=0)).ravel()
    left = conditions[given[(sums == 0.0) & tie.covered[given]]].tocoo()
    scale = tie.weight.max(initial=0.0)
    if np.any(~held[left.coords[1]] & (np.abs(left.data) > NO_SHARE * scale)):
        text = (
            "its slave nodes are held by supports, symmetry planes, rigid bodies or an earlier "
            "tie, so that nothing can follow the master: swap slave and master, or release them"
        )
        raise InputError(text, field)


def _solved(own: Sparse, other: Sparse, nodes: Ints) -> tuple[Sparse, Sparse]:
    """Conditions `own u - other v = 0` solved for as many nodes: u by the others, and by v."""
    n = own.shape[1]
    if not len(nodes):
        return scipy.sparse.csr_array((n, n)), scipy.sparse.csr_array((n, n))
    rest = np.setdiff1d(np.unique(own.indices), nodes)
    factor = scipy.sparse.linalg.splu(own[:, nodes].tocsc())
    by = np.unique(scipy.sparse.csr_array(other).indices)
    return (
        _right(factor, -own[:, rest], nodes, rest, n),
        _right(factor, other[:, by], nodes, by, n),
    )


def _right(factor: Any, sides: Sparse, nodes: Ints, columns: Ints, n: int) -> Sparse:
    """Right-hand sides solved for, as rows of these nodes, (n, n)."""
    if not len(columns):
        return scipy.sparse.csr_array((n, n))
    parts = []
    for first in range(0, len(columns), _COLUMNS):
        part = factor.solve(sides[:, first : first + _COLUMNS].toarray())
        part[np.abs(part) < NO_SHARE] = 0.0
        parts.append(scipy.sparse.csr_array(part))
    found = scipy.sparse.hstack(parts, format="coo")
    at = nodes[found.coords[0]], columns[found.coords[1]]
    return scipy.sparse.csr_array((found.data, at), shape=(n, n))


def _chained(follow: Sparse, ties: int) -> Sparse:
    """The same by nodes that follow nothing themselves."""
    dependents = (np.diff(follow.indptr) > 0).astype(float)
    for _ in range(ties):
        on = follow @ scipy.sparse.diags_array(dependents)
        on.eliminate_zeros()
        if not on.nnz:
            return follow
        follow = (follow - on + on @ follow).tocsr()
        follow.eliminate_zeros()
    raise InputError(
        "given in a circle: nodes would follow themselves; swap slave and master", "tie"
    )
