"""This code: `python -m finite_strain.ours kind n strategy`.

What a contact does in an evaluation (search, laws, forces), in the tangent (blocks, insertion into
the matrix) and at the end of an increment is counted as contact.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from case_text import PLANE, box, coulomb, press_and_drag

import finite_strain.problem as given
from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.solver import Problem
from anisocontact.solver.strategies.condensed.lagged import LaggedFactor
from finite_strain.problem import KINDS, Clock, show

from petsc4py import PETSc

#: Events of PETSc that are the linear solver.
LINEAR = ("MatLUFactorSym", "MatLUFactorNum", "MatSolve")
CONTACT = ("update", "add_force", "add_tangent", "couplings", "lever", "commit", "improve")


def case_text(kind: str, n: int, strategy: str = "direct") -> str:
    """The case file.

    Raises:
        ValueError: There is no such kind.
    """
    if kind not in KINDS:
        raise ValueError(f"kind {kind!r} given, must be one of {', '.join(KINDS)}")
    pair = kind == KINDS[1]
    elastic = f'model = "neo-hookean"\nnu = {given.POISSON}\nE = '
    bodies = box("block", (0, 0, 0), (1, 1, 0.5), (n, n, n // 2), f"{elastic}{given.YOUNG}")
    if pair:
        m, softer = 4 * n // 3, f"{elastic}{given.SOFTER}"
        cells = (m, m, max(1, n // 3))
        bodies += box("base", (-0.5, -0.25, -0.5), (2, 1.5, 0.5), cells, softer)
    surface = "" if pair else PLANE
    # the script's history is of first order in time
    below = coulomb(pair, given.PENALTY, given.FRICTION, 'evolution = "backward-euler"\n')
    way = press_and_drag(pair, given.DOWN, given.ALONG, given.PRESSES, given.DRAGS)
    return f'{bodies}{surface}{below}{way}\n[solver]\nstrategy = "{strategy}"\n'


def count(problem: Problem, clock: Clock) -> None:
    """Count what contacts and bulk do."""
    for contact in problem.contacts:
        for method in CONTACT:
            if hasattr(contact, method):
                clock.count(contact, method, "contact")
    coupled = problem._tangent.coupled
    if coupled is not None:
        for method in ("new_matrix", "make_room", "add"):
            clock.count(coupled, method, "contact")
    for method in ("force", "tangent"):
        clock.count(problem.bulk, method, "assembly")


def remembered(owner: type) -> list[Any]:
    """The instances of a class that are made from now on."""
    found: list[Any] = []
    begin = owner.__init__  # type: ignore[misc]

    def made(self: Any, *arguments: Any, **named: Any) -> None:
        begin(self, *arguments, **named)
        found.append(self)

    owner.__init__ = made  # type: ignore[misc]
    return found


def main(kind: str, n: int, strategy: str) -> None:
    """Solve and print."""
    with tempfile.TemporaryDirectory() as there:
        file = Path(there) / "case.toml"
        file.write_text(case_text(kind, n, strategy))
        built = build(load(file))
    clock = Clock()
    count(built.problem, clock)
    clock.count(LaggedFactor, "solve", "linear")
    lagged = remembered(LaggedFactor)
    PETSc.Log.begin()
    start = time.perf_counter()
    iterations, forces = 0, []
    for accepted in built.solver.run():
        iterations += accepted.iterations
        force = built.problem.contacts[0].resultant()[0]
        forces.append((-force[0], force[2]))
    solving = time.perf_counter() - start
    factors = sum(one.factors for one in lagged)
    if strategy == "direct":
        events = [PETSc.Log.Event(name).getPerfInfo() for name in LINEAR]
        clock.seconds["linear"] = sum(event["time"] for event in events)
        factors = events[1]["count"]
    show(clock, solving, iterations, forces, built.problem.unknowns, factors)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), sys.argv[3])
