"""Facets that are tied to others on a mesh that does not match: bonded contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.errors import InputError, within
from anisocontact.base.fenicsx import Vec
from anisocontact.contact import facet_size
from anisocontact.contact.reachable import NodePairs
from anisocontact.contact.sides import check_sides
from anisocontact.contact.tie_elimination import eliminated
from anisocontact.contact.tie_weights import TieConditions, tie_conditions
from anisocontact.contact.tied_surfaces import WholeGroups
from anisocontact.mesh import Model
from anisocontact.solver.terms.constraint import Constraint
from anisocontact.solver.terms.middles import shares_of_corners

Flags = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
type Sparse = scipy.sparse.csr_array

#: Gap up to which nodes are tied, over the size of the facets of the master, if none is given.
TOLERANCE = 0.1
#: Share of a direction along an axis that is all of it.
ALONG = 1.0 - 1e-9


@dataclass(frozen=True)
class Tie:
    """Two facet groups glued together; their meshes need not match.

    Args:
        slave: Facet group "body.group" whose nodes follow.
        master: Facet group "body.group" that they follow.
        tolerance: Facets with nodes farther from the master are not tied, length; a tenth of the
            size of the facets of the master if not given.

    Raises:
        InputError: The tolerance is negative.

    Example:
        >>> Tie("pad.lower", "plate.upper").slave
        'pad.lower'
    """

    slave: str
    master: str
    tolerance: float | None = None

    def __post_init__(self) -> None:
        if self.tolerance is not None and not self.tolerance >= 0.0:
            raise InputError(f"{self.tolerance!r} given, must be >= 0", "tolerance")


class TiedFaces:
    """All ties of a problem as a constraint of its unknowns.

    Args:
        ties: The ties; there is at least one.
        model: Mesh with the groups.
        like: A vector of the unknowns.

    Attributes:
        constraint: The constraint of the step that has begun; None before the first.

    Raises:
        InputError: An unknown facet group, one within a body, or none of its facets near the other.
    """

    def __init__(self, ties: Sequence[Tie], model: Model, like: Vec) -> None:
        self._ties, self._model, self._like = list(ties), model, like
        for i, tie in enumerate(ties):
            with within(f"tie[{i}]"):
                check_sides(model, tie.slave, tie.master, None)
        self._groups = WholeGroups(model, {g for tie in ties for g in (tie.slave, tie.master)})
        self._conditions = [self._found(i, tie) for i, tie in enumerate(ties)]
        self._middle, self._of_corners = self._corners()
        self._held: Flags | None = None
        self._pattern = scipy.sparse.csr_array(self._of_corners.shape)
        self.constraint: Constraint | None = None

    @property
    def links(self) -> list[tuple[str, str]]:
        """Pairs of bodies that are tied."""
        of = self._model.body_of
        return [(of(tie.slave), of(tie.master)) for tie in self._ties]

    def begin(self, held: Sequence[tuple[Ints, Floats]], followers: Ints) -> None:
        """Take over what else holds the nodes in a step.

        Args:
            held: Nodes this rank owns that are held along directions.
            followers: Unknowns of this rank that follow rigid bodies, local numbers.

        Raises:
            InputError: All that could be tied is held.
        """
        flags = self._flags(held, followers)
        if self._held is not None and np.array_equal(flags, self._held):
            return
        found = eliminated(self._conditions, flags, self._of_corners)
        self._held = flags
        if self.constraint is not None:
            self.constraint.close()
        self.constraint = self._constraint(found)
        self._pattern = _closed(found)

    def check(self, held: Sequence[tuple[Ints, Floats]], followers: Ints) -> None:
        """The check of `begin` alone."""
        eliminated(self._conditions, self._flags(held, followers), self._of_corners)

    def left_out(self) -> list[str]:
        """A line for each tie with nodes that are not tied."""
        lines, groups = [], self._groups
        for i, (tie, one) in enumerate(zip(self._ties, self._conditions, strict=True)):
            nodes = np.unique(groups.groups[tie.slave].facets.nodes % len(groups.x))
            off = np.setdiff1d(nodes, one.nodes[one.covered])
            if len(off):
                at = ", ".join(f"{v:.4g}" for v in groups.x[off[0]])
                lines.append(
                    f"tie[{i}]: {len(off)} of {len(nodes)} nodes of {tie.slave!r} are not tied: "
                    f"beside {tie.master!r} or farther off than the tolerance, the first at ({at})"
                )
        return lines

    def room(self, pairs: Sequence[NodePairs]) -> list[NodePairs]:
        """Nodes that are coupled where followers hand their forces on, beside those of `pairs`.

        Args:
            pairs: Nodes that are coupled, beside those of cells, numbered as `CoupledTangent` has
                them.
        """
        groups, index_map = self._groups, self._model.space.dofmap.index_map
        local = groups.local()
        count = index_map.size_local + index_map.num_ghosts
        names = np.where(local >= 0, local, count + groups.nodes)
        place = np.full(count + index_map.size_global + 1, -1)
        place[names] = place[count + groups.nodes] = np.arange(len(names))
        place[:-1][np.isin(place[:-1], np.flatnonzero(np.diff(self._pattern.indptr) == 0))] = -1
        cells = self._model.space.dofmap.list
        around = cells[(place[cells] >= 0).any(axis=1)]
        follow = self._pattern[np.flatnonzero(groups.owned())].tocoo()
        to = [np.flatnonzero(groups.owned())[follow.coords[0]]]
        columns = [names[follow.coords[1]]]
        for row, column in [*pairs, (around, around)]:
            at = place[np.where(row < len(place), row, -1)]
            which, entry = np.nonzero(at >= 0)
            reached = column[which]
            to.append(np.repeat(at[which, entry], reached.shape[1])[reached.ravel() >= 0])
            columns.append(reached[reached >= 0])
        by_name = np.concatenate(columns)
        reach = scipy.sparse.csr_array(
            (np.ones(len(by_name)), (np.concatenate(to), by_name)),
            shape=(len(names), int(by_name.max(initial=0)) + 1),
        )
        found = (self._pattern.T @ reach).tocoo()
        rows, reached = names[found.coords[0]], found.coords[1]
        return [(rows.astype(np.int32)[:, None], reached.astype(np.int32)[:, None])]

    def connected(self) -> Ints:
        """Slave nodes and what they can follow, numbers in the whole mesh, (k, 2)."""
        found = []
        for one in self._conditions:
            row, column = (one.own + one.other).tocoo().coords
            found.append(self._groups.nodes[np.column_stack([one.nodes[row], column])])
        return np.concatenate(found)

    def _found(self, i: int, tie: Tie) -> TieConditions:
        """Conditions of a tie in the first configuration."""
        size = facet_size(self._model, tie.master)
        tolerance = TOLERANCE * size if tie.tolerance is None else tie.tolerance
        with within(f"tie[{i}]"):
            return tie_conditions(self._groups, tie.slave, tie.master, tolerance, size)

    def _corners(self) -> tuple[Flags, Sparse]:
        """Nodes that follow from corners; displacements of all by those that do not, (n, n)."""
        groups, comm = self._groups, self._model.mesh.comm
        globally = self._model.space.dofmap.index_map.local_to_global
        middle, corner, share = shares_of_corners(self._model)
        own = (globally(middle.astype(np.int32)), globally(corner.astype(np.int32)), share)
        parts = [np.concatenate(one) for one in zip(*comm.allgather(own), strict=True)]
        rows, columns = groups.placed(parts[0]), groups.placed(parts[1])
        there = (rows >= 0) & (columns >= 0)
        flags = np.zeros(len(groups.nodes), dtype=bool)
        flags[rows[there]] = True
        shape = (len(flags), len(flags))
        entries = (parts[2][there], (rows[there], columns[there]))
        alone = scipy.sparse.diags_array(1.0 * ~flags)
        return flags, (scipy.sparse.csr_array(entries, shape=shape) + alone).tocsr()

    def _flags(self, held: Sequence[tuple[Ints, Floats]], followers: Ints) -> Flags:
        """Components of all nodes that do not follow in a step, (n, 3).

        A plane that is not along the axes takes all three: its own constraint has them.
        """
        groups = self._groups
        index_map = self._model.space.dofmap.index_map
        own = np.zeros((index_map.size_local, 3), dtype=bool)
        for nodes, direction in held:
            axis = np.abs(direction) > ALONG
            own[nodes] |= axis if axis.any() else True
        own.reshape(-1)[followers] = True
        flags = np.zeros((len(groups.nodes), 3), dtype=bool)
        here = groups.owned()
        flags[here] = own[groups.nodes[here] - index_map.local_range[0]]
        flags = np.any(self._model.mesh.comm.allgather(flags), axis=0)
        return np.asarray(flags | self._middle[:, None])

    def _constraint(self, found: Sequence[Sparse]) -> Constraint:
        """The constraint of what each node follows, for the components."""
        nodes, owned = self._groups.nodes, self._groups.owned()
        slaves, masters, factors = [], [], []
        for component, one in enumerate(found):
            entries = one.tocoo()
            row, column = entries.coords
            kept = owned[row]
            slaves.append(3 * nodes[row[kept]] + component)
            masters.append(3 * nodes[column[kept]] + component)
            factors.append(entries.data[kept])
        return Constraint(self._like, *map(np.concatenate, (slaves, masters, factors)))


def _closed(found: Sequence[Sparse]) -> Sparse:
    """Which nodes hand forces on to which, themselves among them, over any number of others.

    A node that is held in one direction is followed there by those beside it, and follows others.
    """
    pattern = sum((abs(one) for one in found[1:]), abs(found[0]))
    closed = (pattern + scipy.sparse.diags_array(1.0 * (np.diff(pattern.indptr) > 0))).tocsr()
    while True:
        more = (closed @ closed).tocsr()
        more.data[:] = 1.0
        if more.nnz == closed.nnz:
            return more
        closed = more
