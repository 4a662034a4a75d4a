"""A roll of curved cells that only its contact holds."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, Placement, PlaneStrain, build_mesh, make_shape
from anisocontact.solver import Problem, Solver, Step


@pytest.mark.parametrize(("order", "gap", "most"), [(1, 1e-3, 16), (2, 1e-3, 22), (2, 0.1, 22)])
def test_a_roll_of_curved_cells_comes_to_its_contact(order: int, gap: float, most: int) -> None:
    """A half roll above a block, in plane strain, pressed by a force with multipliers.

    Requirement: a free body that nothing touches at first comes to its contact without being
    thrown into it, across whatever gap; what the springs have done closes the balance of energy.
    Sources: equilibrium, the contact force is the load; the balance. Tolerances: 0.2 % of the load,
    the area of a polygon of 96 sides; corrections of the first increment, of which 13, 19 and 18
    are needed (52 and 54 at order 2 where the roll may fall by a facet at once); 5 % of the work.
    """
    disc = make_shape("disc", radius=50.0, cells=(96, 24), part="half", order=order)
    box = {"origin": (0.0, -50.0), "size": (50.0, 50.0), "cells": (24, 12), "order": order}
    rectangle = make_shape("rectangle", **box, ratio=(8.0, 0.1))
    up = Placement(move=(0.0, 50.0 + gap, 0.0))
    bodies = [Body("roll", disc, up), Body("block", rectangle)]
    model = build_mesh(bodies, idealisation=PlaneStrain())
    law = ContactLaw(NormalLaw(penalty=3e5), Adhesion(stiffness=3e5), Friction(coefficients=0.1))
    exactly = Augmentation()
    contact = Contact(model, "block.top", "roll.outer", law, mortar=True, augmentation=exactly)
    hard, soft = (make_material("linear-elastic", E=young, nu=0.3) for young in (210e3, 70e3))
    problem = Problem(model, {"roll": hard, "block": soft}, [contact])
    held = {"block.bottom": {"x": 0.0, "y": 0.0}}
    held |= {group: {"x": 0.0} for group in ("block.left", "roll.left")}
    weight = 2.0 * 3500.0 / (np.pi * 50.0**2)
    step = Step("press", 1, held, body_force={"roll": {"y": -weight}})
    (accepted,) = Solver(problem, [step]).run()
    assert contact.resultant()[0][1] == pytest.approx(-3500.0, rel=2e-3)
    assert accepted.iterations <= most
    assert abs(accepted.energies["residual"]) < 0.05 * accepted.energies["external"]
