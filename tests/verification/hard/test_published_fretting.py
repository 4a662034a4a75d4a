"""A cylinder pressed on a block that is stretched while the cylinder is sheared: fretting.

Source: D. Nowell, D. A. Hills, Mechanics of fretting fatigue tests, Int. J. Mech. Sci. 29 (1987)
355; Hills, Nowell, Mechanics of Fretting Fatigue (1994). Equal bodies in plane strain; with forces
P and Q and a stress s along the block the zone of stick is off the middle,

    q / mu p0 = sqrt(1 - x^2 / a^2) - c / a sqrt(1 - (x - e)^2 / c^2) ,

    c = a sqrt(1 - Q / mu P) ,  e = s a / (4 mu p0) ,  a^2 = 4 P R / (pi E*) ,

as long as e + c <= a. Here Q / mu P = 0.52, e / a = 0.23 and c / a = 0.69.

Requirement: within 0.85 a shear at every node within 6 % of mu p0 and 3 % root mean square, with
eight facets across a and either side as the slave, small and finite strain; without the stretch the
root mean square would be 23 %. Tolerance: measured 3.3 to 3.8 and 1.8 %; four facets have 8 and 4.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.case_texts import pad_touches_block, then_pressed
from tests.verification.hard.drawn import drawn, fine_at

RADIUS, E, NU, MU = 100.0, 1000.0, 0.3, 0.4
REDUCED = 0.5 * E / (1.0 - NU**2)
PRESSED, SHEARED, STRETCH = 4.31, 0.9, 1.0

HELD = '{ "block.bottom" = { y = 0 }, "block.middle" = { x = 0 } }'
SHEARED_THEN = f"""
[[step]]
name = "shear"
increments = 4
load = {{ head = {{ x = {SHEARED} }} }}
traction = {{ "block.right" = {{ x = {STRETCH} }}, "block.left" = {{ x = -{STRETCH} }} }}
"""


def mesh(path: Path) -> None:
    """Triangles of gmsh, 0.125 long on the cylinder and 0.1 on the block where they touch."""
    with drawn(path) as gmsh:
        geo = gmsh.model.geo

        def points(*places: tuple[float, float]) -> list[int]:
            return [geo.addPoint(x, y, 0.0) for x, y in places]

        def ring(corners: list[int], *first: int) -> list[int]:
            rest = corners[len(first) :]
            ends = [*rest[1:], corners[0]]
            return [*first, *(geo.addLine(*pair) for pair in zip(rest, ends, strict=True))]

        end = RADIUS - np.sqrt(RADIUS**2 - 144.0)
        lower = points((-24, -24), (0, -24), (24, -24), (24, 0), (0, 0), (-24, 0))
        upper = points((-12, end), (0, 0), (12, end), (12, 12), (-12, 12))
        (centre,) = points((0, RADIUS))
        nose = [geo.addCircleArc(upper[i], centre, upper[i + 1]) for i in range(2)]
        around, above = ring(lower), ring(upper, *nose)
        block, pad = (geo.addPlaneSurface([geo.addCurveLoop(one)]) for one in (around, above))
        geo.synchronize()
        for dim, tags, name in (
            (2, [block], "block"),
            (2, [pad], "pad"),
            (1, around[:2], "block.bottom"),
            (1, around[2:3], "block.right"),
            (1, around[3:5], "block.top"),
            (1, around[5:], "block.left"),
            (0, lower[1:2], "block.middle"),
            (1, nose, "pad.nose"),
            (1, above[3:4], "pad.top"),
        ):
            gmsh.model.addPhysicalGroup(dim, tags, name=name)
        fine_at(gmsh, [(pad, upper[1], 0.125, 2, 12), (block, lower[4], 0.1, 4, 24)])


def shear(x: Any, eccentric: float) -> Any:
    """Shear over mu p0 at places x over a."""
    c = np.sqrt(1.0 - SHEARED / (MU * PRESSED))
    sticks = np.sqrt(np.maximum(1.0 - ((x - eccentric) / c) ** 2, 0.0))
    return np.sqrt(np.maximum(1.0 - x**2, 0.0)) - c * sticks


@pytest.mark.parametrize(
    ("model", "sides"),
    [
        ("linear-elastic", ("pad.nose", "block.top")),
        ("linear-elastic", ("block.top", "pad.nose")),
        ("neo-hookean", ("pad.nose", "block.top")),
    ],
)
def test_fretting(
    tmp_path: Path, to_the_end: Callable[..., Any], model: str, sides: tuple[str, str]
) -> None:
    """Shear at every node, and what it would be without the stretch."""
    mesh(tmp_path / "bodies.msh")
    text = pad_touches_block(sides, E, NU, MU, held=HELD, touch=0.02, model=model) + then_pressed(
        PRESSED
    )
    run = to_the_end(text + SHEARED_THEN, most=8000)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 10
    (contact,) = run.problem.contacts
    a = np.sqrt(4.0 * PRESSED * RADIUS / (np.pi * REDUCED))
    peak = 2.0 * PRESSED / (np.pi * a)
    np.testing.assert_allclose(np.abs(contact.resultant()[0][:2]), [SHEARED, PRESSED], rtol=1e-4)
    x = contact.points[:, 0] / a
    inside = np.abs(x) <= 0.85
    # on the pad the shear is against the force on it
    sign = -1.0 if sides[0] == "pad.nose" else 1.0
    found = sign * contact.last.traction[:, 0] / (MU * peak)
    off = [found - shear(x, e) for e in (STRETCH * a / (4.0 * MU * peak), 0.0)]
    stretched, alone = (np.sqrt(np.mean(one[inside] ** 2)) for one in off)
    assert np.abs(off[0][inside]).max() < 0.06
    assert stretched < 0.03
    assert alone > 0.2
