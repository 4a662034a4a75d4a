"""Time of one evaluation of a contact of two meshes, with points on facets and with mortar nodes.

Run: python benchmarks/mortar_rates.py [cells of a side of the slave] [of the master]

Two blocks of hexahedra, flat or wavy, are pressed together and slid. An evaluation holds what an
iteration of Newton's method asks of a contact: search, overlaps and weights of mortar nodes, laws,
forces on the nodes and, with tangent, the blocks of the matrix. Processor time of all threads, the
best of several, in ms.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box

EVALUATIONS = 9


def contact(cells: tuple[int, int], wavy: bool, mortar: bool) -> tuple[Contact, np.ndarray]:
    """A contact after an increment of sliding, and displacements on the way to the next one."""
    upper, lower = cells
    model = build_box(
        {
            "upper": BoxSpec((0.05, 0.05, 0.0), (0.9, 0.9, 0.1), (upper, upper, 1)),
            "lower": BoxSpec((0.0, 0.0, -0.1), (1.0, 1.0, 0.1), (lower, lower, 1)),
        }
    )
    x = model.mesh.geometry.x
    if wavy:
        x[:, 2] += 0.02 * np.sin(6.0 * x[:, 0]) * np.cos(5.0 * x[:, 1])
    friction = Friction(coefficients=(0.3, 0.3))
    law = ContactLaw(NormalLaw(penalty=1e3), Adhesion(stiffness=(400.0, 400.0)), friction)
    made = Contact(model, "upper.bottom", "lower.top", law, mortar=mortar)
    u = np.zeros_like(model.space.tabulate_dof_coordinates())
    block = np.unique(model.space.dofmap.list[model.cells("upper")])
    u[block] = np.array([0.0, 0.0, -5e-3]) / upper
    made.update(u, 1.0)
    made.commit()
    u[block] += np.array([0.03, 0.01, 0.0]) / upper
    return made, u


def evaluate(made: Contact, u: np.ndarray, tangent: bool) -> None:
    """One evaluation."""
    made.update(u, 1.0)
    made.add_force(np.zeros_like(u))
    if tangent:
        made.answer.couplings()


def best(made: Contact, u: np.ndarray, tangent: bool) -> float:
    """Least processor time of some evaluations, s."""
    times = []
    for k in range(EVALUATIONS):
        start = time.process_time()
        evaluate(made, u * (1.0 + 1e-3 * k), tangent)
        times.append(time.process_time() - start)
    return min(times)


def main(slave: int = 40, master: int = 30) -> None:
    """Print the table."""
    print("| facets | law at | forces | forces, tangent | over points |")
    print("|---|---|---|---|---|")
    for shape in ("flat", "wavy"):
        at_points = None
        for where in ("points", "nodes"):
            made, u = contact((slave, master), shape == "wavy", where == "nodes")
            found = [1e3 * best(made, u, tangent) for tangent in (False, True)]
            at_points = at_points or found[1]
            figures = f"{found[0]:.0f} | {found[1]:.0f} | {found[1] / at_points:.1f}"
            print(f"| {slave**2} on {master**2}, {shape} | {where} | {figures} |")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
