"""A hub that relaxes lets go the shaft that it carries, after a time.

Source: correspondence of elastic and viscoelastic bodies [E. H. Lee, Q. Appl. Math., 1955] of a
shrink fit [Lame]: a hub of radii a and b, whose bulk and shear modulus relax alike, on a stiff
shaft that is too large by d is pressed by

    p(t) = E(t) d / a (1 - nu^2) ((b^2 + a^2) / (b^2 - a^2) + nu / (1 - nu)) ,

in plane strain, and holds a dead load F along the shaft while `2 pi a L m p(t) >= F`. With grooves
that wind around the shaft, which is free to turn, m is 1 / sqrt(F_zz) of the friction tensor, as
traction is along the shaft.

Requirement: the mean pressure in every increment, and when the shaft is let go. Tolerance: measured
1e-5 and 2e-4 with multipliers; penalties give way by 0.3 to 1.3 %, and let go 1 to 3 % early.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.solver import StoppedError

YOUNG, NU, SHARE, TOO_LARGE, LENGTH = 1000.0, 0.3, 0.6, 1e-3, 1.0
CARRIED = 0.7  # of what friction holds at first
PRESSED = YOUNG * TOO_LARGE / (1.0 - NU**2) / (5.0 / 3.0 + NU / (1.0 - NU))

CASE = f"""
title = "Relaxing fit"
[idealisation]
kind = "axisymmetric"
lateral = {{lateral}}
[mesh.rectangle.hub]
origin = [1, 0]
size = [1, {LENGTH}]
cells = [{{cells}}, {{cells}}]
order = {{order}}
[material.hub]
model = "viscoelastic"
E = {YOUNG}
nu = {NU}
g = [{SHARE}]
tau = [1]
k = [{SHARE}]
[surface.shaft]
shape = "cylinder"
point = [0, 0, 0]
axis = [0, 1, 0]
radius = {1.0 + TOO_LARGE}
[rigid.shaft]
reference = [0, 0, 0]
[[contact]]
slave = "hub.left"
master = "shaft"
{{given}}
friction = {{{{ {{friction}} }}}}
[[step]]
name = "fit"
duration = 1e-6
increments = 1
displacement."hub.bottom" = {{{{ {{held}} }}}}
displacement."hub.top" = {{{{ {{held}} }}}}
[[step]]
name = "pull"
duration = 1e-6
increments = 1
motion.shaft = {{{{ y = "free" {{turns}} }}}}
load.shaft = {{{{ y = {{pull}} }}}}
[[step]]
name = "wait"
duration = 2
increments = 20
"""


@pytest.mark.parametrize(
    ("cells", "order", "angle", "given", "off", "late"),
    [
        (6, 1, None, 'method = "penalty"', 0.01, 0.02),
        pytest.param(6, 1, -50.0, 'pass = "single"', 0.01, 0.02, marks=pytest.mark.slow),
        pytest.param(4, 2, 30.0, 'method = "penalty"', 0.02, 0.04, marks=pytest.mark.slow),
        pytest.param(4, 2, 30.0, "", 1e-4, 1e-3, marks=pytest.mark.slow),
    ],
)
def test_relaxing_fit(
    tmp_path: Path,
    cells: int,
    order: int,
    angle: float | None,
    given: str,
    off: float,
    late: float,
) -> None:
    """Friction 0.2 all ways, or 0.3 and 0.1 along and across grooves, free to turn."""
    friction, m = "coefficients = 0.2", 0.2
    if angle is not None:
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        friction = (
            "coefficients = [0.3, 0.1], "
            f'directions = {{ kind = "coordinate-lines", angle_deg = {angle} }}'
        )
        m = ((s / 0.3) ** 2 + (c / 0.1) ** 2) ** -0.5
    pull = CARRIED * 2.0 * np.pi * LENGTH * m * PRESSED
    grooved = angle is not None
    text = CASE.format(
        lateral=str(grooved).lower(),
        cells=cells,
        order=order,
        given=given,
        friction=friction,
        held="y = 0, z = 0" if grooved else "y = 0",
        turns=', ry_deg = "free"' if grooved else "",
        pull=pull,
    )
    path = tmp_path / "case.toml"
    path.write_text(text)
    solver = build(load(path)).solver
    (contact,) = solver.problem.contacts
    mean, times = [], []
    with pytest.raises(StoppedError, match="nothing holds the rigid body 'shaft'"):
        for part in solver.run():
            mean.append(contact.last.pressure @ contact.areas / contact.areas.sum())
            times.append(part.time)
    left = 1.0 - SHARE + SHARE * np.exp(-np.array(times))
    np.testing.assert_allclose(mean, PRESSED * left, rtol=off)
    assert times[-1] == pytest.approx(-np.log((CARRIED - 1.0 + SHARE) / SHARE), rel=late)
