"""This code with the strategy `direct`: `python -m finite_strain.ours kind n`.

What a contact does in an evaluation (search, laws, forces), in the tangent (blocks, insertion into
the matrix) and at the end of an increment is counted as contact.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.solver import Problem
from finite_strain.problem import (
    ALONG,
    DOWN,
    DRAGS,
    FRICTION,
    KINDS,
    PENALTY,
    POISSON,
    PRESSES,
    SOFTER,
    YOUNG,
    Clock,
    show,
)

from petsc4py import PETSc

#: Events of PETSc that are the linear solver.
LINEAR = ("MatLUFactorSym", "MatLUFactorNum", "MatSolve")
CONTACT = ("update", "add_force", "add_tangent", "couplings", "lever", "commit", "improve")


def case_text(kind: str, n: int) -> str:
    """The case file."""
    pair = kind == KINDS[1]
    boxes = [("block", [0, 0, 0], [1, 1, 0.5], [n, n, n // 2], YOUNG)]
    if pair:
        m = 4 * n // 3
        boxes.append(("base", [-0.5, -0.25, -0.5], [2, 1.5, 0.5], [m, m, max(1, n // 3)], SOFTER))
    bodies = "".join(
        f"[mesh.box.{name}]\norigin = {at}\nsize = {size}\ncells = {cells}\n"
        f'[material.{name}]\nmodel = "neo-hookean"\nE = {young}\nnu = {POISSON}\n'
        for name, at, size, cells, young in boxes
    )
    plane = '[surface.plane]\nshape = "plane"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n'
    clamp = ', "base.bottom" = { x = 0, y = 0, z = 0 }' if pair else ""
    return f"""{bodies}{"" if pair else plane}
[[contact]]
slave = "block.bottom"
master = "{"base.top" if pair else "plane"}"
normal = {{ penalty = {PENALTY} }}
adhesion = {{ stiffness = [{PENALTY}, {PENALTY}] }}
friction = {{ coefficients = [{FRICTION}, {FRICTION}] }}

[[step]]
name = "press"
increments = {PRESSES}
displacement = {{ "block.top" = {{ x = 0, y = 0, z = {-DOWN} }}{clamp} }}

[[step]]
name = "drag"
increments = {DRAGS}
displacement = {{ "block.top" = {{ x = {ALONG} }} }}

[solver]
strategy = "direct"
"""


def count(problem: Problem, clock: Clock) -> None:
    """Count what contacts and bulk do."""
    for contact in problem.contacts:
        for method in CONTACT:
            if hasattr(contact, method):
                clock.count(contact, method, "contact")
    coupled = problem._tangent.coupled
    if coupled is not None:
        for method in ("make_room", "add"):
            clock.count(coupled, method, "contact")
    for method in ("force", "tangent"):
        clock.count(problem.bulk, method, "assembly")


def main(kind: str, n: int) -> None:
    """Solve and print."""
    with tempfile.TemporaryDirectory() as there:
        file = Path(there) / "case.toml"
        file.write_text(case_text(kind, n))
        built = build(load(file))
    clock = Clock()
    count(built.problem, clock)
    PETSc.Log.begin()
    start = time.perf_counter()
    iterations, forces = 0, []
    for accepted in built.solver.run():
        iterations += accepted.iterations
        force = built.problem.contacts[0].resultant()[0]
        forces.append((-force[0], force[2]))
    solving = time.perf_counter() - start
    events = [PETSc.Log.Event(name).getPerfInfo() for name in LINEAR]
    clock.seconds["linear"] = sum(event["time"] for event in events)
    if built.problem.comm.rank == 0:
        show(clock, solving, iterations, forces, built.problem.unknowns)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
