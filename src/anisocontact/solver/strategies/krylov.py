"""Whether Krylov iterations take less than a factorisation of all unknowns."""

from __future__ import annotations

from collections.abc import Iterator

from anisocontact.solver.strategies.condensed.analysis import whole_factor
from anisocontact.solver.strategies.condensed.work import coupled_nodes
from anisocontact.solver.strategies.costs import factorisation_cost
from anisocontact.solver.strategies.iterative.defaults import MIXED
from anisocontact.solver.strategies.strategy import Task

#: Entries of the stiffness that a correction by Krylov iterations reads, in so many times: with
#: levels that stay where bodies are linear, with those made anew for every tangent.
PASSES_LINEAR, PASSES = 150.0, 250.0
#: Unknowns from which on they take less on several processes, with linear bodies and with others.
#: Two processes, block on block, `direct` over `iterative`: 1.12 at 3,200 unknowns, 1.27 at 9,000;
#: 2.6 to 3.3 at 17,000 to 21,000 (nu = 0.49, soft master, order 2, thin slave). At finite strain
#: 1.01 at 2,300, 1.12 at 7,900 and 1.38 at 10,800.
ON_SEVERAL_LINEAR, ON_SEVERAL = 5_000, 8_000


def krylov_pays(task: Task) -> Iterator[str]:
    """Why Krylov iterations take less, in a line; nothing where they do not.

    On one process the work of a factorisation is known before. Runs with a face that follows
    a rigid body, which nothing can condense, take with `iterative`, over what they take with
    `direct`: 0.56 to 0.82 times where this finds the work of a factorisation to be 150 to 380
    entries of a linear stiffness (blocks on a plane and on each other, hexahedra and tetrahedra,
    6,600 to 23,000 unknowns, nu = 0.3; 0.95 at nu = 0.45), 0.74 to 1.0 for 276 to 390 at finite
    strain. Below they take 0.6 to 1.33 times, 1.6 times where pressures are solved for too.

    Args:
        task: What is to be solved.
    """
    problem = task.problem
    if problem.bulk.hardness >= MIXED:
        return
    if problem.comm.size > 1:
        if problem.unknowns > (ON_SEVERAL_LINEAR if problem.linear else ON_SEVERAL):
            yield f"{problem.unknowns} unknowns on several processes: Krylov iterations are faster"
        return
    factor = whole_factor(coupled_nodes(problem, task.steps), problem.unknowns)
    entries = problem.bulk.stiffness.getInfo()["nz_used"]
    passes = factorisation_cost(*factor) / entries
    if passes > (PASSES_LINEAR if problem.linear else PASSES):
        yield (
            f"a factorisation of {problem.unknowns} unknowns takes the time of {passes:.0f} "
            "products with the stiffness: Krylov iterations are faster"
        )
