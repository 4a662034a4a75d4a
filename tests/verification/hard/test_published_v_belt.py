"""A V-belt in the groove of a pulley, which turns: Euler's equation for a wedge.

Source: the flanks of a groove of half-angle b press the belt by n / 2 sin b each where a flat drum
presses it by n, so that pulls grow by exp(f a / sin b) over the angle a [Shigley, ch. 17, from
memory]. Friction acts at the radius r of what presses the flanks, the pull at that of the middle
of the belt, R, so that the exponent is f a r / (R sin b). On grooves that wind around the pulley
friction has c across the slip, which is around the pulley, beside f along it, of the normal force:
inwards on one flank and outwards on the other. What presses both is different then, so that forces
along the axis are in balance, and f / sin b becomes f / (sin b (1 + c^2)). This was derived for
the test.

Requirement: half a turn around a rigid pulley, a surface of revolution whose groove is turned from
its profile; friction 0.1, friction 0.1 around the pulley and 0.3 across, and 0.15 and 0.05 along
and across axes that wind around at 30 and -50 degrees; a deck of C3D8, neo-Hookean. Pulls within
0.1 %, no force along the axis, at most 6 corrections once all slides. Tolerance: measured 0.04 %
with 36 facets around, without r / R 0.5 %.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

RADIUS, THICK, WIDTH, WEDGE = 10.0, 0.2, 1.0, np.radians(20.0)
ACROSS, AROUND = 4, 36

CASE = """
title = "V-belt"
[mesh]
file = "belt.inp"
[material.belt]
model = "neo-hookean"
E = 1e4
nu = 0.3
[surface.pulley]
shape = "revolution"
point = [0, 0, 0]
axis = [0, 0, 1]
profile = {profile}
[rigid.pulley]
reference = [0, 0, 0]
[[contact]]
slave = "belt.flanks"
master = "pulley"
friction = {{ coefficients = {friction} }}
[[step]]
name = "tighten"
increments = 2
displacement = {{ "belt.first" = {{ y = 0 }} }}
traction = {{ "belt.last" = {{ y = -1 }} }}
[[step]]
name = "turn"
increments = 3
motion = {{ pulley = {{ rz_deg = 6 }} }}
"""


def _half_width(radius: float) -> float:
    return float(0.5 * WIDTH + (radius - RADIUS) * np.tan(WEDGE))


def deck(path: Path) -> None:
    """One layer of cells from angle 0 to 180, with its ends and flanks as surfaces."""
    nodes, cells = ["*NODE"], ["*ELEMENT, TYPE=C3D8, ELSET=BELT"]
    sides: dict[str, list[str]] = {"FIRST": [], "LAST": [], "FLANKS": []}

    def node(out: int, j: int, k: int) -> int:
        return 1 + j + (ACROSS + 1) * (out + 2 * k)

    for k in range(AROUND + 1):
        angle = np.pi * k / AROUND
        for radius in (RADIUS, RADIUS + THICK):
            x, y = radius * np.cos(angle), radius * np.sin(angle)
            for j in range(ACROSS + 1):
                z = _half_width(radius) * (2.0 * j / ACROSS - 1.0)
                nodes.append(f"{len(nodes)}, {x:.12g}, {y:.12g}, {z:.12g}")
    for k in range(AROUND):
        for j in range(ACROSS):
            number = len(cells)
            ring = [(0, j), (0, j + 1), (1, j + 1), (1, j)]
            corners = [node(*place, k + after) for after in (0, 1) for place in ring]
            cells.append(", ".join(map(str, [number, *corners])))
            sides["FIRST"] += [f"{number}, S1"] if k == 0 else []
            sides["LAST"] += [f"{number}, S2"] if k == AROUND - 1 else []
            sides["FLANKS"] += [f"{number}, S4"] if j == ACROSS - 1 else []
            sides["FLANKS"] += [f"{number}, S6"] if j == 0 else []
    lines = [*nodes, *cells]
    for name, faces in sides.items():
        lines += [f"*SURFACE, NAME={name}, TYPE=ELEMENT", *faces]
    path.write_text("\n".join([*lines, "*SOLID SECTION, ELSET=BELT, MATERIAL=M", ""]))


@pytest.mark.parametrize(
    ("around", "across", "angle"),
    [(0.1, 0.1, 0.0), (0.1, 0.3, 0.0), (0.15, 0.05, 30.0), (0.15, 0.05, -50.0)],
)
def test_v_belt(
    around: float, across: float, angle: float, tmp_path: Path, to_the_end: Callable[..., Any]
) -> None:
    """Pull of the end that is held over that of the other."""
    deck(tmp_path / "belt.inp")
    rims = [(11.0, -1.0), (9.5, -1.0), (9.5, 1.0), (11.0, 1.0)]
    grooves = f'{{ kind = "coordinate-lines", angle_deg = {angle} }}'
    text = CASE.format(
        profile=[[radius, side * _half_width(radius)] for radius, side in rims],
        friction=f"[{around}, {across}], directions = {grooves}",
    )
    run = to_the_end(text)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted[3:]) <= 6
    slip = np.array([np.cos(np.radians(angle)), -np.sin(np.radians(angle))])
    force = np.array([around, across]) ** 2 * slip
    force /= np.sqrt(force @ slip)
    drag, aside = force @ slip, force @ [-slip[1], slip[0]]
    (contact,) = run.problem.contacts
    pressed = contact.last.pressure * contact.areas
    rubbed = pressed @ np.hypot(*contact.points[:, :2].T) / pressed.sum()
    wide, more = 0.5 * WIDTH, _half_width(RADIUS + THICK)
    middle = RADIUS + THICK / 3.0 * (wide + 2.0 * more) / (wide + more)
    exponent = drag * np.pi * rubbed / middle / (np.sin(WEDGE) * (1.0 + aside**2))
    total = contact.resultant()[0]
    dead = THICK * (wide + more)
    assert total[1] / dead - 1.0 == pytest.approx(np.exp(exponent), rel=1e-3)
    assert abs(total[2]) < 1e-6 * dead
