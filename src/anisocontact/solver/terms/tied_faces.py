"""Facets that are tied to others on meshes that need not match: bonded contact, cut faces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats, Ints, Sparse
from anisocontact.base.errors import InputError, within
from anisocontact.base.fenicsx import Vec
from anisocontact.base.shown import shown
from anisocontact.base.typed import typed
from anisocontact.contact import facet_size
from anisocontact.contact.reachable import NodePairs
from anisocontact.contact.sides import check_sides
from anisocontact.contact.tie_elimination import NO_SHARE, eliminated
from anisocontact.contact.tied_surfaces import WholeGroups
from anisocontact.mesh import Model
from anisocontact.solver.terms.constraint import Constraint
from anisocontact.solver.terms.cyclic import CyclicSymmetry
from anisocontact.solver.terms.midside_nodes import shares_of_corners
from anisocontact.solver.terms.sectors import ALONG, Sectors
from anisocontact.solver.terms.step import AXES

if TYPE_CHECKING:
    from anisocontact.contact.tie_weights import TieConditions

#: Gap up to which nodes are tied, over the size of the facets of the master, if none is given.
TOLERANCE = 0.1
#: How far supports may part the sides of a tie, over the largest value that is prescribed there:
#: turns of curved faces whose meshes do not match do so a little.
APART = 0.05


@typed
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
        ties: The ties.
        model: Mesh with the groups.
        like: A vector of the unknowns.
        sectors: Cut faces of sectors; ties and these are one at least.

    Attributes:
        sectors: Their cut faces.
        constraint: The constraint of the step that has begun; None before the first.

    Raises:
        InputError: An unknown facet group, one within a body, or none of its facets near the other.
    """

    def __init__(
        self,
        ties: Sequence[Tie],
        model: Model,
        like: Vec,
        sectors: Sequence[CyclicSymmetry] = (),
    ) -> None:
        self._ties, self._model, self._like = list(ties), model, like
        cyclic = {f"cyclic[{i}]": one for i, one in enumerate(sectors)}
        # of two pairs with the same slave node the first has it
        pairs = cyclic | {f"tie[{i}]": one for i, one in enumerate(ties)}
        self._pairs: dict[str, Tie | CyclicSymmetry] = pairs
        for name, pair in pairs.items():
            with within(name):
                check_sides(model, pair.slave, pair.master, None)
        both = {group for pair in pairs.values() for group in (pair.slave, pair.master)}
        self._groups = groups = WholeGroups(model, both)
        self.sectors = Sectors(cyclic, groups)
        self._conditions = {name: self._found(name, pair) for name, pair in pairs.items()}
        self._middle, self._of_corners = self._corners()
        self._held: Flags | None = None
        self._pattern = scipy.sparse.csr_array(self._of_corners.shape)
        self.constraint: Constraint | None = None

    @property
    def links(self) -> list[tuple[str, str]]:
        """Facet groups that are tied, of a sector its cut faces."""
        return [(pair.slave, pair.master) for pair in self._pairs.values()]

    def begin(self, held: Sequence[tuple[Ints, Floats]], dependents: Ints) -> None:
        """Take over what else holds the nodes in a step.

        Args:
            held: Nodes this rank owns that are held along directions.
            dependents: Unknowns of this rank that follow rigid bodies, local numbers.

        Raises:
            InputError: All that could be tied is held.
        """
        flags = self._flags(held, dependents)
        if self._held is not None and np.array_equal(flags, self._held):
            return
        found = eliminated(self._conditions, flags, self._of_corners)
        self._held = flags
        if self.constraint is not None:
            self.constraint.close()
        self.constraint = self._constraint(found)
        self._pattern = _closed(found)

    def check(self, held: Sequence[tuple[Ints, Floats]], dependents: Ints) -> None:
        """The check of `begin` alone, and that no cut face follows a rigid body; collective."""
        self.sectors.check_dependents(dependents)
        eliminated(self._conditions, self._flags(held, dependents), self._of_corners)

    def check_prescribed(self, unknowns: Ints, values: Floats, step: str) -> None:
        """Refuse supports of both sides of a tie that part them; collective.

        Args:
            unknowns: Prescribed unknowns that this rank owns, local numbers.
            values: Their values, length.
            step: Name of the step, for messages.
        """
        own = np.full((self._model.space.dofmap.index_map.size_local, 3), np.nan)
        own.reshape(-1)[unknowns] = values
        prescribed = self._groups.everywhere(own, np.nan)
        largest = float(np.abs(np.nan_to_num(prescribed)).max(initial=0.0))
        for i, tie in enumerate(self._ties):
            axis, off = _parted(self._conditions[f"tie[{i}]"], prescribed)
            if off > APART * largest:
                text = (
                    f"parts {tie.slave!r} from {tie.master!r}, to which tie[{i}] glues it, by "
                    f"{off:.3g} along {AXES[axis]}; prescribe one side, or the same of both"
                )
                raise InputError(text, f"step {step!r}.displacement")

    def left_out(self) -> list[str]:
        """A line for each tie with nodes that are not tied."""
        lines, groups = [], self._groups
        for i, tie in enumerate(self._ties):
            one = self._conditions[f"tie[{i}]"]
            nodes = np.unique(groups.groups[tie.slave].facets.nodes % len(groups.x))
            off = np.setdiff1d(nodes, one.nodes[one.covered])
            if len(off):
                at = shown(groups.x[off[0]])
                lines.append(
                    f"tie[{i}]: {len(off)} of {len(nodes)} nodes of {tie.slave!r} are not tied: "
                    f"beside {tie.master!r} or farther off than the tolerance, the first at {at}"
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
        for one in self._conditions.values():
            row, column = (one.own + one.other).tocoo().coords
            found.append(self._groups.nodes[np.column_stack([one.nodes[row], column])])
        return np.concatenate(found)

    def _found(self, name: str, tie: Tie | CyclicSymmetry) -> TieConditions:
        """Conditions of a pair in the first configuration."""
        from anisocontact.contact.tie_weights import tie_conditions  # of ties alone

        size, cut = facet_size(self._model, tie.master), self.sectors.cuts.get(name)
        tolerance = TOLERANCE * size if tie.tolerance is None else tie.tolerance
        turning = None if cut is None else cut.turning
        with within(name):
            found = tie_conditions(self._groups, tie.slave, tie.master, tolerance, size, turning)
        if cut is not None:
            cut.check_whole(found)
        return found

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

    def _flags(self, held: Sequence[tuple[Ints, Floats]], dependents: Ints) -> Flags:
        """Components of all nodes that do not follow in a step, (n, 3).

        A plane that is not along the axes takes all three: its own constraint has them.
        """
        index_map = self._model.space.dofmap.index_map
        own = np.zeros((index_map.size_local, 3), dtype=bool)
        for nodes, direction in held:
            axis = np.abs(np.broadcast_to(direction, (len(nodes), 3))) > ALONG
            own[nodes] |= axis | ~axis.any(axis=1, keepdims=True)
        own.reshape(-1)[dependents] = True
        flags = self._groups.everywhere(own, False)
        for cut in self.sectors.cuts.values():
            flags[cut.on_axis] = True
        return np.asarray(flags | self._middle[:, None])

    def _constraint(self, found: Sparse) -> Constraint:
        """The constraint of what each unknown follows."""
        nodes, owned, count = self._groups.nodes, self._groups.owned(), len(self._groups.nodes)
        entries = found.tocoo()
        row, column = entries.coords
        kept = owned[row % count]
        to, of = (3 * nodes[at[kept] % count] + at[kept] // count for at in (row, column))
        return Constraint(self._like, to, of, entries.data[kept])


def _parted(tie: TieConditions, prescribed: Floats) -> tuple[int, float]:
    """Where supports hold both sides: the axis along which they part them most, and how far.

    Args:
        tie: Conditions of the tie.
        prescribed: Displacements, NaN where none is prescribed, (n, 3), length.
    """
    apart = (tie.own - tie.other).tocsr()
    free = abs(apart) @ np.isnan(prescribed).astype(float)
    known = (free <= NO_SHARE * tie.weight.max(initial=0.0)) & tie.covered[:, None]
    weight = np.where(tie.weight > 0.0, tie.weight, np.inf)[:, None]
    off = np.where(known, np.abs(apart @ np.nan_to_num(prescribed)) / weight, 0.0).max(axis=0)
    return int(off.argmax()), float(off.max())


def _by_nodes(found: Sparse) -> Sparse:
    """Which nodes follow which in any component, from the unknowns, (n, n)."""
    entries, count = abs(found).tocoo(), found.shape[0] // 3
    row, column = entries.coords
    shape = (count, count)
    return scipy.sparse.csr_array((entries.data, (row % count, column % count)), shape=shape)


def _closed(found: Sparse) -> Sparse:
    """Which nodes hand forces on to which, themselves among them, over any number of others.

    A node that is held in one direction is followed there by those beside it, and follows others.
    """
    pattern = _by_nodes(found)
    closed = (pattern + scipy.sparse.diags_array(1.0 * (np.diff(pattern.indptr) > 0))).tocsr()
    while True:
        more = (closed @ closed).tocsr()
        more.data[:] = 1.0
        if more.nnz == closed.nnz:
            return more
        closed = more
