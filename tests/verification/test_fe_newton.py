"""Newton's method on the assembled system."""

from itertools import pairwise

import numpy as np
import pytest


@pytest.mark.parametrize("rule", ["maximum-dissipation", "radial", "explicit"])
@pytest.mark.parametrize("start_degrees", [0.0, 40.0])
def test_quadratic_tail(fe, rule, start_degrees):
    """In a slide that turns, the last corrections square the residual.

    Requirement: quadratic tail. Source: Newton's method with the exact tangent of a residual that
    is smooth where no point changes its status. Tolerance: for residuals between 1e-13 (round-off)
    and 1e-2, log r_(k+1) / log r_k tends to 2 as the constant of the quadratic law
    loses its weight. 1.8 separates it from linear convergence, where it is nearly 1.
    """
    from anisocontact.solver import Step

    block = fe.block(fe.interface(angle=np.radians(start_degrees), rule=rule))
    steps = [
        Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}),
        Step("along x", 4, {"block.top": {"x": 0.04}}),
        Step("along y", 8, {"block.top": {"y": 0.08}}),
    ]
    orders = []
    for accepted in block.run(*steps, snes_rtol=1e-12):
        if accepted.step == "along y" and accepted.contacts["block.bottom"]["slip"] == 36:
            r = [v for v in accepted.residuals if 1e-13 < v < 1e-2]
            orders += [np.log(b) / np.log(a) for a, b in pairwise(r) if a < 1e-3]
    assert len(orders) >= 3
    assert min(orders) > 1.8


def test_what_pushed_bodies_apart_is_not_extrapolated():
    """A belt that overlaps its drum at the start: the second increment of its tension is easy.

    Requirement: at most ten iterations, 5 are measured, 2 where the belt just touches. Source: what
    takes the overlap away is no answer to the tension; taken once more it lifts the belt off the
    drum, which alone holds it, and 92 iterations follow.
    """
    from anisocontact.bulk import make_material
    from anisocontact.contact import Contact
    from anisocontact.laws import Friction
    from anisocontact.mesh import Body, PlaneStrain, build_mesh, make_shape
    from anisocontact.solver import Problem, Solver, Step
    from anisocontact.surfaces import make_surface

    quarter = {"inner": 10.0, "outer": 10.1, "start_deg": 0.0, "end_deg": 90.0}
    belt = Body("belt", make_shape("annulus", cells=(1, 12), **quarter))
    model = build_mesh([belt], idealisation=PlaneStrain())
    drum = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=10.0005)
    contact = Contact(model, "belt.inner", drum, Friction(coefficients=(0.3, 0.3)), mortar=True)
    problem = Problem(model, {"belt": make_material("linear-elastic", E=1e4, nu=0.0)}, [contact])
    tension = {"belt.start": {"y": -10.0}}
    step = Step("tighten", 2, {"belt.end": {"x": 0.0}}, traction=tension)
    _, second = Solver(problem, [step], strategy="direct").run()
    assert second.iterations <= 10
