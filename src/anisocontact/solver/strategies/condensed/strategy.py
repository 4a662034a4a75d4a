"""Bodies condensed on what can be touched: linear ones for good, others to precondition."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags
from anisocontact.base.strategies import CONDENSED, strategy_entry
from anisocontact.contact import Contact
from anisocontact.solver.strategies.condensed import bordered
from anisocontact.solver.strategies.condensed.analysis import (
    factor_entries,
    most_entries,
    node_graph,
)
from anisocontact.solver.strategies.condensed.condensed import Condensed
from anisocontact.solver.strategies.condensed.lagged_newton import LaggedNewton
from anisocontact.solver.strategies.condensed.newton import CondensedNewton
from anisocontact.solver.strategies.condensed.reach import touched_nodes
from anisocontact.solver.strategies.condensed.work import elimination, work
from anisocontact.solver.strategies.costs import (
    Condensable,
    Part,
    condensing_bytes,
    factor_bytes,
    too_large,
)
from anisocontact.solver.strategies.iterative.defaults import MIXED
from anisocontact.solver.strategies.krylov import PASSES, PASSES_LINEAR, krylov_pays
from anisocontact.solver.strategies.strategy import Task
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.supports import Supports

#: Contact unknowns beyond which their dense matrix costs more than it saves.
MOST_CONTACT = 8000
#: Contact unknowns of n up to which few change at once, over n^(2/3), whatever `Work` says: a die
#: on a block takes with `condensed` 0.7 times the time of `direct` at 4.0 where that says 1.6, a
#: linear milled block 0.6 times at 4.8. Linear sheets take 1.1 to 2 times from 5.3 on, strips and
#: sheets at finite strain 1.2 to 1.4 times from 4.2 on.
WIDE_LINEAR, WIDE, POWER = 5.0, 4.1, 2.0 / 3.0
#: Elimination of masters over products with the stiffness of a correction by Krylov iterations up
#: to which it pays. A ball pressed on a block, and dragged over it where bodies are linear, takes
#: over `iterative`: 1.9 times at 2.9, 1.5 at 2.2, 1.2 at 1.4 (tetrahedra of order 2), 1.0 at 1.9
#: and 1.2 (order 1); block on block, n = 36, 0.8 at 0.9. At finite strain: 2.0 times at 1.7, 1.6 at
#: 1.3, 1.3 at 0.8 (order 2), 1.2 at 1.2 (order 1).
MOST_ELIMINATED_LINEAR, MOST_ELIMINATED = 2.0, 1.0
#: Contact unknowns of linear bodies on several processes beyond which the first process, which has
#: their dense matrix, keeps the others waiting. Two processes, block on block, over `iterative`:
#: 1.0 at 870 contact unknowns, 0.8 to 1.1 at 1,200 to 1,500, 1.2 at 1,850, 1.4 and 1.7 at 3,000.
MOST_ON_SEVERAL = 2000
#: Unknowns up to which a factorisation of bodies that are not linear is as cheap.
LEAST_LAGGED = 2000
#: Displacements of a node in space; bytes of an entry of a dense matrix in single precision.
AXES_OF_NODES, DENSE = 3, 4
#: Nodes opposite to the facets that meet at a slave node, over those of a facet: 16 for 4 where
#: facets are of about the same size.
_OPPOSITE = 4
#: Gap over the facet size up to which a contact holds what it is about to hold.
CLOSED = 0.1


class CondensedStrategy:
    """Static condensation: of linear bodies for good, of others as a preconditioner."""

    entry = strategy_entry(CONDENSED)
    merit = "bodies change little, linear ones not at all, while contact changes at once"
    reduces = True

    def obstacles(self, task: Task) -> Iterator[str]:
        """What it cannot do."""
        problem = task.problem
        if problem.comm.size > 1:
            yield from _not_on_several(problem)
        if not problem.contacts:
            yield "there is no contact"
        if lagged(problem) and not bordered.reachable():
            yield from _no_mumps(problem)
        if problem.rigid.faces:
            yield "a face follows a rigid body"
        for step in task.steps:
            if step.cylindrical:
                yield f"step {step.name!r} prescribes displacements along cylindrical directions"
            if step.until is not None and step.until.measure is not None:
                yield f"the event that ends step {step.name!r} needs all displacements"
        yield from task.asked_solver()

    def costs(self, task: Task) -> Iterator[str]:
        """Why it would not pay."""
        problem = task.problem
        if lagged(problem) and problem.unknowns < LEAST_LAGGED * problem.comm.size:
            yield f"{problem.unknowns} unknowns: a factorisation costs no more than iterations"
        if problem.comm.size > 1:
            yield from _costs_on_several(task)
            return
        if problem.linear and problem.check_supported(task.steps) and not _touches(problem):
            yield "contact alone will hold a body, and does not touch it yet"
        touched = touched_nodes(problem, task.steps)
        count = 3 * int(touched.sum())
        if count > MOST_CONTACT:
            yield (
                f"{count} contact unknowns, more than {MOST_CONTACT}: their dense matrix does not "
                "pay"
            )
        yield from _lack(task, touched, f"condensing on {count} contact unknowns")
        wide = WIDE_LINEAR if problem.linear else WIDE
        many = count > wide * problem.unknowns**POWER
        if many and not work(problem, task.steps, touched).pays:
            yield (
                f"{count} of {problem.unknowns} unknowns are contact unknowns: a factorisation of "
                "all costs less than their dense matrix"
            )
        yield from _costs_of_masters(task, touched)

    def solver(
        self,
        task: Task,
        on_iteration: Callable[[int, float], None],
        note: Callable[[str], None],
        kept: Arrays,
    ) -> CondensedNewton | LaggedNewton:
        """Newton's method on the contact unknowns; on all of them where bodies are not linear."""
        if lagged(task.problem):
            task.problem.predict_contact(task.steps)
            return LaggedNewton(task.problem, task.prefix, task.options, on_iteration, note, kept)
        condensed = Condensed(task.problem, task.steps, note, kept)
        return CondensedNewton(condensed, task.prefix, task.options, on_iteration)


def lagged(problem: Problem) -> bool:
    """Whether corrections are those of a `LaggedNewton`."""
    return not problem.linear or bool(problem.comm.size > 1)


def _not_on_several(problem: Problem) -> Iterator[str]:
    """What keeps several processes from it."""
    if problem.layout.unknowns.block != AXES_OF_NODES:
        yield "with several processes all unknowns have to be displacements in space"
    if problem.constraints:
        yield (
            "nodes follow other nodes (ties, symmetry planes, middle nodes), which it can only "
            "take on one process"
        )
    if problem.bulk.volume is not None:
        yield "changes of volume are kept apart, which it can only take on one process"


def _no_mumps(problem: Problem) -> Iterator[str]:
    names = [name for name, law in problem.materials.items() if not law.linear]
    why = f"material.{names[0]} is not linear" if names else "there are several processes"
    yield f"{why}, and this PETSc has no MUMPS for that"


def _costs_of_masters(task: Task, touched: Flags) -> Iterator[str]:
    """Why masters that are eliminated anew as slave nodes go on would not pay."""
    problem, passes, most = task.problem, PASSES, MOST_ELIMINATED
    if problem.linear:
        passes, most = PASSES_LINEAR, MOST_ELIMINATED_LINEAR
    iterations = passes * problem.bulk.stiffness.getInfo()["nz_used"]
    if elimination(problem, touched) > most * iterations and any(krylov_pays(task)):
        yield (
            f"{3 * int(touched.sum())} contact unknowns, most of them of masters: Krylov "
            "iterations are faster than to eliminate these"
        )


def _costs_on_several(task: Task) -> Iterator[str]:
    """Why it would not pay or not fit on several processes: the dense matrix is on the first."""
    problem = task.problem
    touched = touched_nodes(problem, task.steps)
    own = problem.layout.unknowns.nodes.dofmap.index_map.size_local
    count = 3 * int(problem.comm.allreduce(np.count_nonzero(touched[:own])))
    if count > MOST_CONTACT:
        yield f"{count} contact unknowns, more than {MOST_CONTACT}: their dense matrix does not pay"
    if problem.linear and count > MOST_ON_SEVERAL and problem.bulk.hardness < MIXED:
        yield (
            f"{count} contact unknowns of linear bodies on several processes: Krylov iterations "
            "are faster"
        )
    if count > WIDE * problem.unknowns**POWER:
        yield (
            f"{count} of {problem.unknowns} unknowns are contact unknowns: a factorisation of "
            "all costs less than their dense matrix"
        )
    needed = factor_bytes(problem.unknowns) + 2.0 * DENSE * count**2
    lack = list(too_large(f"condensing on {count} contact unknowns", needed))
    yield from problem.comm.bcast(lack)


def _lack(task: Task, touched: Flags, what: str) -> Iterator[str]:
    """Why there is too little memory; factors are analysed where guesses do not say enough."""
    for most in (True, False):
        lack = list(too_large(what, condensing_bytes(_condensable(task, touched, most))))
        if not lack:
            return
    yield from lack


def _condensable(task: Task, touched: Flags, most: bool = False) -> Condensable:
    """The bodies of a task, with what its first step prescribes.

    Args:
        task: The task.
        touched: Whether a node can be touched, (nodes,).
        most: Whether more entries of the factors will do than there are.
    """
    problem, model = task.problem, task.problem.model
    free = np.ones((len(touched), 3), dtype=np.bool_)
    supports = Supports(model)
    for step in task.steps[:1]:
        supports.begin(step, np.zeros(free.size))
    free.reshape(-1)[supports.unknowns] = False
    graph = None if most else node_graph(problem.bulk.stiffness)
    parts = []
    for name in model.body_names():
        nodes = np.unique(model.space.dofmap.list[model.cells(name)])
        nodes = nodes[free[nodes].any(axis=1)]
        unknowns, border = int(free[nodes].sum()), int(free[nodes[touched[nodes]]].sum())
        if graph is None:
            entries = most_entries(border, unknowns)
        else:
            own = graph[nodes][:, nodes].tocsr()
            entries = factor_entries(own, touched[nodes], unknowns)
        parts.append(Part(unknowns, border, entries))
    return Condensable(
        parts,
        problem.bulk.stiffness.getInfo()["nz_used"],
        sum(map(_blocks, problem.contacts)),
        changing=not problem.linear,
    )


def _blocks(contact: Contact) -> float:
    """Blocks of the tangent of a contact: each point couples nodes around it and opposite to it."""
    around = np.sort(contact.quadrature.nodes, axis=1)  # rows of fewer name one again
    nodes = 1.0 + np.count_nonzero(np.diff(around, axis=1)) / max(len(around), 1)
    if contact.meshed:
        master: Any = contact.master
        nodes += master.facets.shape[1] * (_OPPOSITE if contact.slave_points.at_nodes else 1)
    return float(len(contact.points) * nodes**2)


def _touches(problem: Problem) -> bool:
    """Whether a contact is closed where the bodies are, or next to it."""
    return any(
        (c.state["gap"][c.master.located(c.state)] <= CLOSED * c.facet_size).any()
        for c in problem.contacts
    )
