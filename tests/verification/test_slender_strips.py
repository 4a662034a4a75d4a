"""Slender strips: soft in bending, stiff along, and nothing but contact to hold them."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, PlaneStrain, build_mesh, make_shape
from anisocontact.solver import Cut, Problem, Solver, Step
from anisocontact.surfaces import make_surface

YOUNG, NU, LENGTH = 1000.0, 0.3, 6.0


def _lowered(gap: float, way: float, thick: float) -> tuple[Solver, Contact]:
    """A strip above the crown of a drum, free along itself, whose ends are lowered."""
    box = {"origin": (-LENGTH / 2.0, 0.0), "size": (LENGTH, thick), "cells": (60, 1), "order": 2}
    strip = Body("strip", make_shape("rectangle", **box))
    model = build_mesh([strip], idealisation=PlaneStrain())
    drum = make_surface("cylinder", point=[0.0, -1.0 - gap, 0.0], axis=[0, 0, 1], radius=1.0)
    law = ContactLaw(NormalLaw(penalty=2e5), Adhesion(stiffness=2e5), Friction(coefficients=0.2))
    contact = Contact(model, "strip.bottom", drum, law, mortar=True, augmentation=Augmentation())
    rubber = {"strip": make_material("neo-hookean", E=YOUNG, nu=NU)}
    ends = {"strip.left": {"y": -way}, "strip.right": {"y": -way}}
    return Solver(Problem(model, rubber, [contact]), [Step("lower", 1, ends)]), contact


def test_strip_that_touches_nothing_goes_with_its_ends() -> None:
    """Springs against its motion along itself must not hold its shape: it is soft in bending.

    Requirement: it moves as its ends do and stores no energy, without a cut. Source: a rigid
    motion meets no resistance. Tolerance: that of Newton's method, 1e-8 of the forces at work, over
    the softness in bending, 1e5 times that of a cell. Before, the springs kept their stiffness and
    no equilibrium without them was found.
    """
    solver, _ = _lowered(gap=0.5, way=0.1, thick=0.02)
    cuts: list[Cut] = []
    (accepted,) = solver.run(on_cut=cuts.append)
    assert not cuts
    moved = solver.problem.nodal
    np.testing.assert_allclose(moved[:, 1], -0.1, rtol=1e-3)
    np.testing.assert_allclose(moved[:, 0], 0.0, atol=1e-4)
    assert accepted.energies["elastic"] < 1e-8 * YOUNG * 0.02 * LENGTH * 0.1**2


def test_strip_bent_over_a_drum() -> None:
    """A strip that is lowered on a drum: bending in three points.

    Requirement: it comes to the drum and carries `P = 48 E I w / L^3`, E over 1 - nu^2 in plane
    strain, w what the ends are below the crown. Source: beam theory. Tolerance: 1 %, shear is
    (1 + nu) (t / L)^2 = 1e-4 of it, the second order of the slope, 3 w / L, and of ends that keep
    their thickness upright about 4e-3.
    """
    gap, way, thick = 1e-3, 0.02, 0.05
    solver, contact = _lowered(gap, way, thick)
    for _ in solver.run():
        pass
    bending = YOUNG / (1.0 - NU**2) * thick**3 / 12.0
    load = [0.0, 48.0 * bending * (way - gap) / LENGTH**3, 0.0]
    assert contact.resultant()[0] == pytest.approx(np.array(load), rel=1e-2, abs=1e-9)
