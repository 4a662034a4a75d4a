"""Multipliers with the penalties of slender bodies, where bodies are none."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.contact.multiplier_schemes import SLENDER, USUAL
from anisocontact.interface import ContactLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, PlaneStrain, build_mesh, make_shape
from anisocontact.solver import Newton, Problem, Step
from anisocontact.surfaces import make_surface

YOUNG = 1000.0


def _corrections(scheme: str) -> tuple[int, np.ndarray]:
    """Corrections that press a cylinder into a block by a quarter of its facets; the force."""
    shape = make_shape("rectangle", origin=(-2, -1), size=(4, 1), cells=(16, 4))
    model = build_mesh([Body("block", shape)], idealisation=PlaneStrain())
    drum = make_surface("cylinder", point=[0.0, 3.0, 0.0], axis=[0, 0, 1], radius=3.0)
    friction = Friction(coefficients=0.3)
    law = ContactLaw(NormalLaw(penalty=YOUNG), Adhesion(stiffness=YOUNG), friction)
    contact = Contact(model, "block.top", drum, law, mortar=True, augmentation=Augmentation())
    problem = Problem(model, {"block": make_material("neo-hookean", E=YOUNG, nu=0.3)}, [contact])
    problem.begin(Step("press", 1, {"block.bottom": {"x": 0.02, "y": 0.06}}))
    problem.set_load_factor(1.0, 1.0)
    problem.contact_term.take_way(scheme)
    problem.contact_term.predict(0.0)
    newton = Newton(problem, "soft_penalties_", {}, lambda number, residual: None)
    x = problem.accepted()
    result = newton.solve(x)
    newton.close()
    assert not result.reason
    problem.commit(x)
    return result.iterations, contact.resultant()[0]


def test_soft_penalties_converge_as_stiff_ones_do() -> None:
    """Requirement: the forces of the usual penalties, in at most two corrections more.

    Penalties 3e-4 of what suits bodies keep those in contact that bend; a correction times 1e4 of
    them leaves half of a gap in a body that does not. Where no point changes its status corrections
    leave as little as the usual ones. Source: the semismooth Newton method converges
    superlinearly once it has the active set [Hintermueller, Ito, Kunisch 2002]. Tolerance: 1e-8 of
    the forces for Newton's residual; before, it took 11 corrections for 5, now 7.
    """
    usual, force = _corrections(USUAL)
    soft, same = _corrections(SLENDER)
    assert soft <= usual + 2
    assert same == pytest.approx(force, rel=1e-6, abs=1e-6 * np.abs(force).max())
