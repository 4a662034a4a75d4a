"""A hook on a slender beam goes under a catch: the ramp of a snap fit.

Source: with the ramp at the angle a and friction tan r the mating force is that which bends the
beam times tan(a + r) [Bayer, Snap-fit joints for plastics, 1996]. Bent by P at the length l the
beam turns the ramp by P l^2 / 2 E' I, E' = E / (1 - nu^2).

Requirement: the ratio of both forces, with the turn of the beam in every increment and with that of
the ramp itself at the end; no cut, at most 18 corrections in an increment and 45 in all six.
Tolerance: measured 2.7 % and 7e-6: triangles of order 1 are stiffer than the beam, and the ramp
bends; 15 and 38 corrections, where it took 31 and 112: a penalty of the material times the square
of a turn opens points that press a beam by next to nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.drawn import drawn

LENGTH, RAMP, FRICTION, E, NU = 20.0, float(np.radians(30.0)), 0.2, 2000.0, 0.35
TIP = 1.0 + 3.0 * float(np.tan(RAMP))
#: Of the ramp.
ENDS = ((6.0, 1.0), (3.0, TIP))

CASE = f"""
title = "Snap fit"
[idealisation]
kind = "plane-strain"
[mesh]
file = "snap.msh"
[material.hook]
model = "neo-hookean"
E = {E}
nu = {NU}
[material.catch]
model = "neo-hookean"
E = 3000
nu = 0.3
[[contact]]
slave = "hook.nose"
master = "catch.face"
friction = {{ coefficients = {FRICTION} }}
[[step]]
name = "in"
increments = 6
[step.displacement]
"hook.clamp" = {{ x = 0, y = 0 }}
"catch.top" = {{ x = -2.25, y = 0 }}
"""


def mesh(path: Path) -> None:
    """Triangles of gmsh, three across the beam; the catch has a rounded corner."""
    with drawn(path) as gmsh:
        geo = gmsh.model.geo

        def points(size: float, *places: tuple[float, float]) -> list[int]:
            return [geo.addPoint(x, y, 0.0, size) for x, y in places]

        def surface(lines: list[int]) -> int:
            return int(geo.addPlaneSurface([geo.addCurveLoop(lines)]))

        hook = points(1 / 3, (-LENGTH, 0), (6, 0), (6, 1), (3, TIP), (2, 1), (-LENGTH, 1))
        beam = [geo.addLine(*ends) for ends in pairwise([*hook, hook[0]])]
        corner, *rest = points(0.27, (6.7, 1.1), (9, 1.1), (9, 4), (6.2, 4), (6.2, 1.6))
        (middle,) = points(0.27, (6.7, 1.6))
        block = [geo.addLine(*ends) for ends in pairwise([corner, *rest])]
        block.append(geo.addCircleArc(rest[-1], middle, corner))
        geo.mesh.setTransfiniteCurve(block[-1], 5)
        bodies = [surface(beam), surface(block)]
        geo.synchronize()
        for dim, tags, name in (
            (2, bodies[:1], "hook"),
            (2, bodies[1:], "catch"),
            (1, beam[5:], "hook.clamp"),
            (1, beam[1:4], "hook.nose"),
            (1, [block[0], *block[3:]], "catch.face"),
            (1, block[2:3], "catch.top"),
        ):
            gmsh.model.addPhysicalGroup(dim, tags, name=name)


def test_ramp(tmp_path: Path, to_the_end: Callable[..., Any]) -> None:
    """Forces in every increment, and how the beam bends at the end."""
    mesh(tmp_path / "snap.msh")
    run = to_the_end(CASE)
    assert not run.cuts
    assert max(a.iterations for a in run.accepted) <= 18
    assert sum(a.iterations for a in run.accepted) <= 45
    (contact,) = run.problem.contacts
    pressed, mated = np.array([-a.resultants[contact.name][0][1::-1] for a in run.accepted])[1:].T
    arm = LENGTH + contact.points[contact.last.pressure > 0.0][0, 0]
    turned = pressed * arm**2 / (2.0 * E / (1.0 - NU**2) / 12.0)
    leads = np.tan(RAMP + turned + np.arctan(FRICTION))
    np.testing.assert_allclose(mated / pressed, leads, rtol=0.04)
    x, u = run.problem.model.space.tabulate_dof_coordinates(), run.problem.nodal
    (low,), (high,) = (np.flatnonzero(np.hypot(*(x[:, :2] - at).T) < 1e-6) for at in ENDS)
    across, up = (x + u)[low, :2] - (x + u)[high, :2]
    leads = np.tan(np.arctan2(-up, across) + np.arctan(FRICTION))
    assert mated[-1] / pressed[-1] == pytest.approx(leads, rel=1e-4)
