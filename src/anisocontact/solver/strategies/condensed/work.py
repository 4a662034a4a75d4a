"""What a correction takes: dense, of contact unknowns that change, or sparse, of all unknowns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from anisocontact.base.array_types import Flags
from anisocontact.solver.strategies.condensed.analysis import node_graph, whole_factor
from anisocontact.solver.strategies.costs import factorisation_cost, operation_cost
from anisocontact.solver.system.prediction import ContactPrediction
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.step import Step

#: Solutions with an old factor for a correction of bodies that are not linear: six to eight with
#: nu = 0.3, eleven at 0.499.
_SOLUTIONS = 7.0


@dataclass(frozen=True)
class Work:
    """Time of a correction, in entries of a factor in double precision that a solution reads.

    Attributes:
        dense: With bodies that are condensed, in single precision.
        sparse: With a factorisation of all unknowns.

    Example:
        >>> Work(dense=6e7, sparse=2e7).pays
        False
    """

    dense: float
    sparse: float

    @property
    def pays(self) -> bool:
        """Whether it takes less with bodies that are condensed."""
        return self.dense <= self.sparse


def work(problem: Problem, steps: Sequence[Step], touched: Flags) -> Work:
    """What a correction will take.

    A factorisation of all unknowns has, beside the bodies, what contacts couple on the way that is
    prescribed: two bodies that touch all over have two to six times the operations of both alone.
    Where bodies are condensed the unknowns of slave nodes are factorised, masters are eliminated
    once for many corrections; at points a contact changes both sides.

    Runs with bodies that are linear take, over what they take with `direct`: 0.6 and 0.9 times
    where this says 0.9 (rods, a sheet on a block), 0.7 where it says 0.6 (a sheet of 20 x 20 x 3
    hexahedra), 1.1 to 1.4 at 1.35 (20 x 20 x 2), 2.0 at 3.4 (20 x 20 x 1), 3.3 at 22 (36 x 36 x 1).
    At finite strain: 0.8 where this says 0.2 (a round end on a sheet), 1.0 at 0.9 (a rod on a
    block) and 1.4 at 1.5 and 3.7 (a strip of 30 x 6 x 2, a sheet of 26 x 26 x 2).

    Args:
        problem: The problem, on one process.
        steps: What will be done.
        touched: Whether a node can be touched, (nodes,).
    """
    count = 3.0 * np.count_nonzero(touched & _changing(problem, len(touched)))
    dense = operation_cost(count**3 / 3.0)  # two thirds, twice as fast in single precision
    entries, operations = whole_factor(coupled_nodes(problem, steps), problem.unknowns)
    if not problem.linear:
        dense += _SOLUTIONS * (entries + count**2) / 2.0
    return Work(dense, factorisation_cost(entries, operations))


def elimination(problem: Problem, touched: Flags) -> float:
    """Time of the elimination of masters, in entries of a factor that a solution reads.

    It is made once for many corrections, and anew where slave nodes have gone on to other facets.

    Args:
        problem: The problem, on one process.
        touched: Whether a node can be touched, (nodes,).
    """
    changing = touched & _changing(problem, len(touched))
    stay, rest = 3.0 * np.count_nonzero(changing), 3.0 * np.count_nonzero(touched & ~changing)
    # twice as many, twice as fast in single precision
    return operation_cost(rest * (rest**2 / 3.0 + rest * stay + stay**2))


def _changing(problem: Problem, nodes: int) -> Flags:
    """Nodes whose rows of the dense matrix are other ones for every correction, (nodes,)."""
    found = np.zeros(nodes, dtype=np.bool_)
    found[problem.attached.nodes] = True
    for contact in problem.contacts:
        slaves = contact.master.local_names(contact.slave_points.nodes)
        found[slaves if contact.slave_points.at_nodes else contact.couplable()] = True
    return found


def coupled_nodes(problem: Problem, steps: Sequence[Step]) -> scipy.sparse.csr_array:
    """Which nodes are coupled in the tangent of all, by bodies and by contacts, (nodes, nodes).

    Args:
        problem: The problem, on one process.
        steps: What will be done: tells what will touch.
    """
    graph = node_graph(problem.bulk.stiffness)
    meshed = [contact for contact in problem.contacts if contact.meshed]
    for rows, columns in ContactPrediction(meshed, steps).pairs(None, 0.0):
        row, column = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
        there = (row >= 0) & (column >= 0)
        entries = (np.ones(np.count_nonzero(there)), (row[there], column[there]))
        graph = graph + scipy.sparse.csr_array(entries, shape=graph.shape)
    return graph.tocsr()
