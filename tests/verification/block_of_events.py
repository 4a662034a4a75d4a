"""A block on or over a plane, whose steps end on events."""

from __future__ import annotations

from typing import Any

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.rigid import MovingSurface
from anisocontact.solver import Accepted, Problem, Solver, Step
from anisocontact.surfaces import make_surface

E, NU, PENALTY, MU = 1000.0, 0.3, 1e4, 0.3
PRESS = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}


def block(height: float = 0.0, nu: float = 0.0, **given: Any) -> Problem:
    """A block of 1 x 1 x 0.5 over a plane, or a rigid one that moves."""
    model = build_box({"block": BoxSpec((0, 0, height), (1, 1, 0.5), (2, 2, 1))})
    friction = Friction(coefficients=given.pop("mu", MU))
    laws = NormalLaw(penalty=PENALTY), Adhesion(stiffness=PENALTY), friction
    plane = Interface(make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)), *laws)
    body = given.pop("body", None)
    master = plane if body is None else MovingSurface(plane, body)
    contact = Contact(model, "block.bottom", master, mortar=False)
    elastic = make_material(given.pop("material", "linear-elastic"), E=E, nu=nu)
    return Problem(model, {"block": elastic}, [contact], **given)


def run(problem: Problem, *steps: Step, strategy: str = "direct") -> list[Accepted]:
    """All accepted sub-increments."""
    solver = Solver(problem, list(steps), options={"snes_rtol": 1e-12}, strategy=strategy)
    return list(solver.run())


def stiffness() -> float:
    """Force of the block per displacement of its top, block and penalty in series."""
    return 1.0 / (0.5 / E + 1.0 / PENALTY)
