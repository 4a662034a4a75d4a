"""Time of meshes of two dimensions against slices and sectors in space: same results, less time.

Run: python benchmarks/plane_rates.py [cells along the contact]

A block of rubber is pressed by a rigid roll and dragged in plane strain; a ring of rubber is
pressed on a plate and turned, axisymmetric with twist. In space the first is a slice, the second a
sector of 15 degrees with cyclic symmetry, each with one layer of cells or with cells as long across
as along. Processor time of the steps, of all threads, forms compiled before; force of the contact,
and of the ring its torque, against those in the plane.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Axisymmetric, Body, PlaneStrain, build_mesh, make_shape
from anisocontact.solver import CyclicSymmetry, Problem, Solver, Step, Turn
from anisocontact.surfaces import make_surface

RUBBER = make_material("neo-hookean", E=1000.0, nu=0.3)
LAW = ContactLaw(NormalLaw(penalty=1e5), Adhesion(stiffness=1e5), Friction(coefficients=0.3))
SECTORS = 24
WIDTH = 0.5


def block(cells: int, layers: int) -> tuple[Problem, Contact, list[Step]]:
    """A block under a roll, in plane strain without layers or as a slice of so many."""
    size, names = (2.0, 1.0), {"bottom": "b.bottom", "top": "b.top"}
    numbers, planes = (cells, cells // 2), {}
    if layers:
        shape = make_shape("box", origin=(0, 0, 0), size=(*size, WIDTH), cells=(*numbers, layers))
        planes = {side: {"z": 0.0} for side in names.values()}
        names = {"bottom": "b.front", "top": "b.back"}
        model = build_mesh([Body("b", shape)])
    else:
        shape = make_shape("rectangle", origin=(0, 0), size=size, cells=numbers)
        model = build_mesh([Body("b", shape)], idealisation=PlaneStrain(thickness=WIDTH))
    roll = make_surface("cylinder", point=(1.0, 3.0, 0.0), axis=(0, 0, 1), radius=2.0)
    contact = Contact(model, names["top"], roll, LAW, mortar=False)
    ways = {"press": {"x": 0.0, "y": 0.05}, "drag": {"x": 0.1, "y": 0.05}}
    steps = [Step(name, 4, planes | {names["bottom"]: way}) for name, way in ways.items()]
    return Problem(model, {"b": RUBBER}, [contact]), contact, steps


def ring(cells: int, layers: int) -> tuple[Problem, Contact, list[Step]]:
    """A ring on a plate, axisymmetric without layers or as a sector of so many."""
    numbers, cuts = (cells, cells), []
    if layers:
        shape = make_shape(
            "ring",
            inner=1.0,
            outer=2.0,
            length=1.0,
            cells=(cells, layers, cells),
            end=2.0 * math.pi / SECTORS,
        )
        model = build_mesh([Body("b", shape)])
        cuts = [CyclicSymmetry("b.start", "b.end", SECTORS)]
    else:
        shape = make_shape("rectangle", origin=(1, 0), size=(1, 1), cells=numbers)
        model = build_mesh([Body("b", shape)], idealisation=Axisymmetric(lateral=True))
    axis, way = ((0, 0, 1), "z") if layers else ((0, 1, 0), "y")
    plate = make_surface("plane", point=(0, 0, 0), normal=axis)
    contact = Contact(model, "b.bottom", plate, LAW, mortar=False)
    pressed = dict.fromkeys("xyz", 0.0) | {way: -0.02}
    steps = [
        Step("press", 4, {"b.top": pressed}),
        Step("turn", 4, rotation={"b.top": Turn(axis=axis, angle=0.04)}),
    ]
    return Problem(model, {"b": RUBBER}, [contact], cyclic=cuts), contact, steps


type Made = Callable[[int, int], tuple[Problem, Contact, list[Step]]]


def solved(make: Made, cells: int, layers: int) -> tuple[float, np.ndarray, int]:
    """Processor time of the steps, s, what the whole contact carries, and the unknowns."""
    problem, contact, steps = make(cells, layers)
    start = time.process_time()
    for _ in Solver(problem, steps, strategy="direct").run():
        pass
    spent = time.process_time() - start
    force, moment = contact.resultant()
    if make is block:
        return spent, force[:2], problem.unknowns
    up = 2 if layers else 1
    return spent, (SECTORS if layers else 1) * np.array([force[up], moment[up]]), problem.unknowns


def main(cells: int = 24) -> None:
    """Print the table."""
    print("| body | mesh | unknowns | time, s | over the plane | resultant |")
    print("|---|---|---|---|---|---|")
    cases: list[tuple[str, Any, str, int]] = [
        ("block under a roll", block, "slice", max(round(WIDTH * cells / 2.0), 1)),
        ("ring that turns", ring, "sector", max(round(3.0 * math.pi / SECTORS * cells), 1)),
    ]
    for body, make, kind, layers in cases:
        for each in (0, 1, layers):
            solved(make, 4, each)  # compiles the forms
        plane, exact, unknowns = solved(make, cells, 0)
        print(f"| {body} | in the plane | {unknowns} | {plane:.2f} | 1 | |")
        for each in (1, layers):
            spent, found, unknowns = solved(make, cells, each)
            off = np.abs(found - exact).max() / np.abs(exact).max()
            name = f"{kind} of {each} layer" + ("s" if each > 1 else "")
            print(
                f"| {body} | {name} | {unknowns} | {spent:.2f} | {spent / plane:.1f} | {off:.1e} |"
            )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
