"""Shallow ironing: a stiff half disc pressed into a softer slab and slid along it, finite strain.

Source: K. A. Fischer, P. Wriggers, Mortar based frictional contact formulation for higher order
interpolations using the moving friction cone, Comput. Methods Appl. Mech. Engng 195 (2006) 5020;
S. Hartmann et al., Int. J. Numer. Meth. Engng 80 (2009). Moduli ten to one, nu = 0.32, friction
0.3. There is no closed form: what is published are smooth curves of the forces, and here both sides
as the slave have to give the same ones.

Requirement: forces with slab and die as the slave within 1.5 % of each other in every increment of
the slide and 0.6 % root mean square, no cut, at most five iterations; drag over pressure is that of
friction and of the way that the die climbs in its groove, above friction by at most 8 %.
Tolerance: measured 1.1 and 0.5 %, each within 0.9 % of order 2 with facets of half the size.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

CASE = """
title = "Shallow ironing"
[idealisation]
kind = "plane-strain"
[mesh.rectangle.slab]
origin = [0, 0]
size = [12, 4]
cells = [32, 8]
[mesh.disc.die]
radius = 3
cells = [48, 4]
part = "half"
rotate = {{ axis = [0, 0, 1], angle_deg = -90 }}
move = [3.6, 7, 0]
[material.slab]
model = "neo-hookean"
E = 68.96
nu = 0.32
[material.die]
model = "neo-hookean"
E = 689.6
nu = 0.32
[[contact]]
slave = "{0}"
master = "{1}"
friction = {{ coefficients = 0.3 }}
[[step]]
name = "press"
increments = 10
displacement = {{ "slab.bottom" = {{ x = 0, y = 0 }}, "die.left" = {{ x = 0, y = -1 }} }}
[[step]]
name = "slide"
increments = 40
displacement = {{ "die.left" = {{ x = 4.8 }} }}
"""


@pytest.mark.parametrize("height", [7.0, 7.05])
def test_first_touch(to_the_end: Callable[..., Any], height: float) -> None:
    """The die comes to the slab from a gap, and its points stick from the touch on.

    Requirement: at most five corrections, the last of which leaves 3e-4 of the residual: they are
    exact but for the share of a violation that multipliers leave, 1e-4. Friction is divided by the
    way of the gap; with corrections in which a violation of no gap lengthens that, the last one
    leaves 2e-3 in the lower place, and it takes six.
    """
    text = CASE.format("slab.top", "die.outer").partition('[[step]]\nname = "slide"')[0]
    text = text.replace("increments = 10", "increments = 1").replace("y = -1 ", "y = -0.1 ")
    run = to_the_end(text.replace("3.6, 7, 0", f"3.6, {height}, 0"))
    (part,) = run.accepted
    assert part.iterations <= 5
    assert part.residuals[-1] <= 3e-4 * part.residuals[-2]


@pytest.mark.slow
def test_both_sides_give_the_same_forces(to_the_end: Callable[..., Any]) -> None:
    """Forces of every increment, iterations, friction over pressure."""
    found = []
    for sides in (("slab.top", "die.outer"), ("die.outer", "slab.top")):
        run = to_the_end(CASE.format(*sides))
        assert not run.cuts
        assert max(part.iterations for part in run.accepted) <= 5
        (contact,) = run.problem.contacts
        forces = np.array([part.resultants[contact.name][0][:2] for part in run.accepted])
        found.append(forces if sides[0] == "slab.top" else -forces)
    one, other = found
    apart = (np.linalg.norm(one - other, axis=1) / np.linalg.norm(one, axis=1))[10:]
    assert apart.max() < 0.015
    assert np.sqrt(np.mean(apart**2)) < 0.006
    for forces in found:
        ratio = -forces[25:, 0] / forces[25:, 1]
        np.testing.assert_allclose(ratio, 0.3, rtol=0.08)
