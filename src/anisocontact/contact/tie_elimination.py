"""Slave nodes of ties in terms of the nodes that they follow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.errors import InputError
from anisocontact.contact.tie_weights import TieConditions

Flags = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
type Sparse = scipy.sparse.csr_array

#: Share of a node that is rounding.
NO_SHARE = 1e-13
#: Columns that are solved for at once.
_COLUMNS = 512


def eliminated(
    ties: Sequence[TieConditions], held: Flags, of_corners: Sparse
) -> tuple[Sparse, Sparse, Sparse]:
    """What each node follows, for the three components.

    A component that is held besides does not follow, nor does that of a node which an earlier tie
    has. Their dual functions go to the slave nodes beside them: the functions that are left sum to
    one, so that constant tractions are handed over [Puso Laursen 2003].

    Args:
        ties: Conditions of the ties.
        held: Components that cannot follow, (n, 3).
        of_corners: The displacement of each node by those that do not follow corners, (n, n).

    Returns:
        `u = F u`, with empty rows where a node does not follow, (n, n) each.

    Raises:
        InputError: All slave nodes at a place are held, or a node would follow itself.
    """
    known: dict[bytes, Sparse] = {}
    found = []
    for component in range(3):
        key = held[:, component].tobytes()
        if key not in known:
            known[key] = _one(ties, held[:, component], of_corners)
        found.append(known[key])
    return found[0], found[1], found[2]


def _one(ties: Sequence[TieConditions], held: Flags, of_corners: Sparse) -> Sparse:
    """That of one component, (n, n)."""
    taken, total = held.copy(), scipy.sparse.csr_array(of_corners.shape)
    for i, tie in enumerate(ties):
        free = tie.covered & ~taken[tie.nodes]
        rows = _rows(tie, free, held, f"tie[{i}]") @ of_corners
        nodes = tie.nodes[free]
        taken[nodes] = True
        total = total + _solved(rows, nodes)
    return _chained(total, len(ties))


def _rows(tie: TieConditions, free: Flags, held: Flags, field: str) -> Sparse:
    """Conditions of the nodes that are free, with their shares of those that are not."""
    conditions = (tie.own - tie.other).tocsr()
    given = np.flatnonzero(~free & (tie.weight > 0.0))
    beside = (tie.beside[np.flatnonzero(free)][:, given] > 0.0).multiply(tie.weight[free][:, None])
    sums = np.asarray(beside.sum(axis=0)).ravel()
    left = conditions[given[(sums == 0.0) & tie.covered[given]]].tocoo()
    scale = tie.weight.max(initial=0.0)
    if np.any(~held[left.coords[1]] & (np.abs(left.data) > NO_SHARE * scale)):
        text = (
            "its slave nodes are held by supports, symmetry planes, rigid bodies or an earlier "
            "tie, so that nothing can follow the master: swap slave and master, or release them"
        )
        raise InputError(text, field)
    shares = beside @ scipy.sparse.diags_array(1.0 / np.where(sums > 0.0, sums, 1.0))
    return (conditions[np.flatnonzero(free)] + shares @ conditions[given]).tocsr()


def _solved(rows: Sparse, nodes: Ints) -> Sparse:
    """Conditions solved for the displacements of as many nodes, (n, n)."""
    n = rows.shape[1]
    if not len(nodes):
        return scipy.sparse.csr_array((n, n))
    columns = np.setdiff1d(np.unique(rows.indices), nodes)
    factor = scipy.sparse.linalg.splu(rows[:, nodes].tocsc())
    parts = []
    for first in range(0, len(columns), _COLUMNS):
        part = -factor.solve(rows[:, columns[first : first + _COLUMNS]].toarray())
        part[np.abs(part) < NO_SHARE] = 0.0
        parts.append(scipy.sparse.csr_array(part))
    found = scipy.sparse.hstack(parts, format="coo")
    at = nodes[found.coords[0]], columns[found.coords[1]]
    return scipy.sparse.csr_array((found.data, at), shape=(n, n))


def _chained(follow: Sparse, ties: int) -> Sparse:
    """The same by nodes that follow nothing themselves."""
    followers = (np.diff(follow.indptr) > 0).astype(float)
    for _ in range(ties):
        on = follow @ scipy.sparse.diags_array(followers)
        on.eliminate_zeros()
        if not on.nnz:
            return follow
        follow = (follow - on + on @ follow).tocsr()
        follow.eliminate_zeros()
    raise InputError(
        "given in a circle: nodes would follow themselves; swap slave and master", "tie"
    )
