"""A beam without weight on a bed that does not pull: it lifts off, and how far off is no matter.

Source: Y. Weitsman, J. Appl. Mech. 37 (1970) 1019, who has plates too; M. Hetenyi, Beams on Elastic
Foundation (1946), for a beam as long as the contact, whose ends do not go down: with the penalty k
of a layer, l = (k / 4 EI)^(1/4) and the force 2 P in the middle, in half of the beam

    b = pi / 2 l ,   w(0) = P l / k (cosh pi + 1) / sinh pi ,

whatever the force, as in any contact that recedes.

Requirement: depth in the middle, half-length of the contact, forces of 1e-12 and 1e-7 of the
modulus, all in one increment, the law at nodes and at integration points, order 1 and 2; at most 11
corrections. Tolerance: measured 0.05 % of the depth, and less than the distance of points; of order
1 2.8 %, as two bilinear cells over the height bend by 12 % less than they should, 0.7 % with four;
9 corrections, 10 with order 1.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

HIGH, LONG, YOUNG, PENALTY = 0.1, 10.0, 1000.0, 0.05
STEEP = (PENALTY / (YOUNG * HIGH**3 / 3.0)) ** 0.25

CASE = f"""
title = "Beam on a bed"
symmetry = ["beam.left"]
[idealisation]
kind = "plane-stress"
[mesh.rectangle.beam]
origin = [0, 0]
size = [{LONG}, {HIGH}]
cells = {{cells}}
order = {{order}}
[material.beam]
model = "linear-elastic"
E = {YOUNG}
nu = 0
[surface.bed]
shape = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
[nodes."beam.middle"]
near = [0, {HIGH}, 0]
[[contact]]
slave = "beam.bottom"
master = "bed"
normal = {{{{ penalty = {PENALTY} }}}}
physical_penalty = true
friction = {{{{ coefficients = 0 }}}}
{{contact}}
[[step]]
name = "press"
increments = 1
force = {{{{ "beam.middle" = {{{{ y = -{{force}} }}}} }}}}
"""


@pytest.mark.parametrize(
    ("cells", "order", "contact", "force", "accuracy"),
    [
        ([60, 1], 2, "", 1e-4, 1e-3),
        ([60, 1], 2, "", 1e-9, 1e-3),
        ([60, 1], 2, 'pass = "single"', 1e-4, 1e-3),
        ([200, 2], 1, "", 1e-4, 0.035),
    ],
)
@pytest.mark.filterwarnings("ignore:.*at small strain")
def test_lifts_off(
    to_the_end: Callable[..., Any],
    cells: list[int],
    order: int,
    contact: str,
    force: float,
    accuracy: float,
) -> None:
    """Depth where the force is, and where contact ends."""
    run = to_the_end(CASE.format(cells=cells, order=order, contact=contact, force=force))
    assert not run.cuts
    (only,) = run.accepted
    assert only.iterations <= 11
    (bed,) = run.problem.contacts
    pressure, place = bed.last.pressure, bed.points[:, 0]
    depth = pressure[np.argmin(place)] / PENALTY
    exact = force * STEEP / PENALTY * (np.cosh(np.pi) + 1.0) / np.sinh(np.pi)
    assert depth == pytest.approx(exact, rel=accuracy)
    spacing = LONG / cells[0] / order
    ends = place[pressure > 0.0].max() + 0.5 * spacing
    half = np.pi / 2.0 / STEEP
    assert ends == pytest.approx(half, abs=spacing + accuracy * half)
