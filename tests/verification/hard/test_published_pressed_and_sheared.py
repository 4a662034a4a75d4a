"""A cylinder pressed and sheared in proportion, without slip; a blunt wedge pressed, then sheared.

Source: R. D. Mindlin, H. Deresiewicz, J. Appl. Mech. 20 (1953) 327; J. Jaeger, Arch. Appl. Mech. 63
(1993); Ciavarella, Int. J. Solids Struct. 35 (1998) 2349. With p(P) the pressure under a force P,
bodies equal and plane strain, a force Q that grows with P from P0 on by less than friction carries
sticks all over, and one that grows at a constant P leaves the pressure of a smaller force P* that
sticks,

    q = Q / (P - P0) (p(P) - p(P0)) ,    q = mu (p(P) - p(P*)) ,  Q = mu (P - P*) .

Cylinder: p(P) of Hertz. Wedge [Truman, Sackfield, Hills, Int. J. Mech. Sci. 37 (1995) 261; Johnson,
Contact Mechanics (1985) sec. 5.2] of the slope s: P = a s E*, p = s E* / pi arcosh(a / |x|).

Requirement: at every node within 0.85 a, over mu p in the middle (of the wedge s E* / pi, farther
than 1.5 facets from its edge, and the shear than half a facet from the end of stick, where it has a
peak), either side as the slave, all of Q in one increment; iterations. Tolerance: measured, largest
and root mean square, 3.5 to 8.2 and 2.3 to 3.7 % of the cylinder, with eight facets of order 1
across a; as if it had been pressed first 15 %. Wedge 4.2 to 7.2 and 1.9 to 2.5 %, its shear 5.5 to
7.9 and 3.1 to 4.3 %.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.case_texts import pad_touches_block
from tests.verification.hard.drawn import drawn, fine_at
from tests.verification.hard.test_published_fretting import MU, RADIUS, REDUCED, E
from tests.verification.hard.test_published_fretting import mesh as cylinder

SLOPE = 0.01

HELD = '{ "block.bottom" = { x = 0, y = 0 } }'
FREE = 'motion = { head = { x = "free", y = "free" } }'
SIDES = [("pad.nose", "block.top"), ("block.top", "pad.nose")]


def touching(sides: tuple[str, str]) -> str:
    """The bodies, and the increment in which they meet."""
    return pad_touches_block(sides, E, 0.3, MU, held=HELD, touch=0.002)


def step(name: str, load: str, free: str = "") -> str:
    """A step of one increment."""
    return f'[[step]]\nname = "{name}"\nincrements = 1\nload = {{ head = {{ {load} }} }}\n{free}\n'


def wedge(path: Path) -> None:
    """Triangles of gmsh, 0.125 and 0.1 long where they touch."""
    upper = [(-12, 12 * SLOPE), (0, 0), (12, 12 * SLOPE), (12, 12), (-12, 12)]
    lower = [(-24, 0), (-24, -24), (24, -24), (24, 0), (0, 0)]
    pad, block = {"nose": [0, 1], "top": [3]}, {"bottom": [1], "top": [3, 4]}
    with drawn(path) as gmsh:
        geo, fine = gmsh.model.geo, []
        for name, corners, groups, tip, size in (
            ("pad", upper, pad, 1, 0.125),
            ("block", lower, block, 4, 0.1),
        ):
            points = [geo.addPoint(x, y, 0) for x, y in corners]
            lines = [geo.addLine(points[i], points[(i + 1) % 5]) for i in range(5)]
            body = geo.addPlaneSurface([geo.addCurveLoop(lines)])
            geo.synchronize()
            gmsh.model.addPhysicalGroup(2, [body], name=name)
            for group, edges in groups.items():
                gmsh.model.addPhysicalGroup(1, [lines[i] for i in edges], name=f"{name}.{group}")
            fine.append((body, points[tip], size, 4, 20))
        fine_at(gmsh, fine)


def shear_of(run: Any, pad_is_slave: bool) -> tuple[Any, Any, Any]:
    """Places of slave nodes, pressure, and shear on the block."""
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 8
    (contact,) = run.problem.contacts
    sign = -1.0 if pad_is_slave else 1.0
    return contact.points[:, 0], contact.last.pressure, sign * contact.last.traction[:, 0]


def largest(error: Any, where: Any) -> tuple[float, float]:
    """Largest error, and its root mean square."""
    return float(np.abs(error[where]).max()), float(np.sqrt(np.mean(error[where] ** 2)))


@pytest.mark.parametrize("sides", SIDES)
def test_pressed_and_sheared_at_once(
    tmp_path: Path, to_the_end: Callable[..., Any], sides: tuple[str, str]
) -> None:
    """Shear at every node, and as if the cylinder had been pressed first."""
    cylinder(tmp_path / "bodies.msh")
    force, share = 4.31, 0.7
    loads = step("both", f"y = -{force}, x = {share * MU * force}", FREE)
    run = to_the_end(touching(sides) + loads, most=8000)
    x, _, found = shear_of(run, sides[0] == "pad.nose")

    def hertz(load: float) -> Any:
        a2 = 4.0 * load * RADIUS / (np.pi * REDUCED)
        return 2.0 * load / (np.pi * np.sqrt(a2)) * np.sqrt(np.maximum(1.0 - x**2 / a2, 0.0))

    first = abs(float(run.force("touch")[1]))
    inside = np.abs(x) < 0.85
    peak = MU * hertz(force).max()
    sticks = share * MU * force / (force - first) * (hertz(force) - hertz(first))
    most, mean = largest((found - sticks) / peak, inside)
    assert most < 0.1
    assert mean < 0.05
    slid = MU * (hertz(force) - hertz((1.0 - share) * force))
    assert largest((found - slid) / peak, inside)[1] > 0.12


@pytest.mark.parametrize("sides", SIDES)
def test_wedge(tmp_path: Path, to_the_end: Callable[..., Any], sides: tuple[str, str]) -> None:
    """Pressure, and shear after half of what friction carries."""
    wedge(tmp_path / "bodies.msh")
    force = REDUCED * SLOPE
    loads = step("press", f"y = -{force}", FREE) + step("shear", f"x = {0.5 * MU * force}")
    run = to_the_end(touching(sides) + loads, most=8000)
    x, pressure, found = shear_of(run, sides[0] == "pad.nose")
    away = np.maximum(np.abs(x), 1e-9)
    whole, stuck = (np.arccosh(np.maximum(half / away, 1.0)) for half in (1.0, 0.5))
    unit = REDUCED * SLOPE / np.pi
    inside = (away > 0.19) & (away < 0.85)
    most, mean = largest(pressure / unit - whole, inside)
    assert most < 0.08
    assert mean < 0.03
    # at the end of stick the shear has a peak without a bound on its slope
    inside &= np.abs(away - 0.5) > 0.06
    most, mean = largest(found / (MU * unit) - (whole - stuck), inside)
    assert most < 0.1
    assert mean < 0.06
