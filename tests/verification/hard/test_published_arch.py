"""An arch of voussoirs whose springings give way: hinges, and the thrust of three of them.

Source: J. Heyman, The Stone Skeleton (1995), ch. 2; Y. Kooharian, ACI J. 49 (1952) 317: an arch on
springings that move apart cracks into two pieces on three hinges, at the back of the joint at its
crown and at the inner edge of a joint at each haunch, and thrusts with the least force that keeps
the line of thrust within it; where they move together, with the largest, the edges exchanged. So
the thrust is the largest (smallest) over the joint of the haunch of

    H = sum_i W_i (x_A - x_i) / (y_B - y_A) ,

A and B being the hinges of haunch and crown, and i the voussoirs between them. A moves by as much
as its springing and B on the vertical, which turns the piece: that is part of the closed form.

Half a ring of twelve voussoirs, ten of which nothing holds but their neighbours: the weight in one
increment, springings by 0.05 each in one, a two-hundredth of the radius, plane strain, gmsh.

Requirement: the thrust, orders 1 and 2, either side as slave, at small strain against that of no
turn; no cut; corrections. Tolerance: measured 5e-5 at small strain, else 4e-4 of the thrust where
springings move apart and 0.5 % where they move together, as voussoirs give way; corrections 6 under
the weight, 17 and, at small strain, 44 then, in which up to eleven joints open.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog
from tests.verification.hard.drawn import drawn

COUNT, RADIUS, THICK, WAY = 12, 10.0, 1.6, 0.05
INNER, OUTER, WIDE = RADIUS - THICK / 2.0, RADIUS + THICK / 2.0, np.pi / COUNT


def mesh(path: Path, facets: tuple[int, int], order: int) -> None:
    """Voussoirs with so many facets over the thickness, one and the other in turn."""
    with drawn(path, order) as gmsh:
        geo = gmsh.model.geo
        for k in range(COUNT):
            across, centre = facets[k % 2], geo.addPoint(0, 0, 0)
            points = [
                geo.addPoint(r * np.cos(angle), r * np.sin(angle), 0)
                for angle, radii in ((k * WIDE, (INNER, OUTER)), ((k + 1) * WIDE, (OUTER, INNER)))
                for r in radii
            ]
            lines = [
                geo.addLine(points[0], points[1]),
                geo.addCircleArc(points[1], centre, points[2]),
                geo.addLine(points[2], points[3]),
                geo.addCircleArc(points[3], centre, points[0]),
            ]
            along = round(across * RADIUS * WIDE / THICK)
            for line, count in zip(lines, (across, along) * 2, strict=True):
                geo.mesh.setTransfiniteCurve(line, count + 1)
            body = geo.addPlaneSurface([geo.addCurveLoop(lines)])
            geo.mesh.setTransfiniteSurface(body)
            geo.mesh.setRecombine(2, body)
            geo.synchronize()
            gmsh.model.addPhysicalGroup(2, [body], name=f"v{k}")
            for line, name in zip(lines, ("start", "back", "end", "inner"), strict=True):
                gmsh.model.addPhysicalGroup(1, [line], name=f"v{k}.{name}")


def case(model: str, way: float, swapped: bool) -> str:
    """Voussoirs from right to left, the first and the last one on the springings."""
    text = 'title = "Arch"\n[idealisation]\nkind = "plane-strain"\n[mesh]\nfile = "arch.msh"\n'
    for k in range(COUNT):
        text += f'[material.v{k}]\nmodel = "{model}"\nE = 1e5\nnu = 0.2\n'
    for k in range(COUNT - 1):
        sides = [f"v{k}.end", f"v{k + 1}.start"][:: -1 if swapped else 1]
        text += f'[[contact]]\nslave = "{sides[0]}"\nmaster = "{sides[1]}"\n'
        text += "friction = { coefficients = 0.7 }\n"
    first, last = '"v0.start"', f'"v{COUNT - 1}.end"'
    weight = ", ".join(f"v{k} = {{ y = -1 }}" for k in range(COUNT))
    return f"""{text}
[[step]]
name = "weight"
increments = 1
body_force = {{ {weight} }}
displacement = {{ {first} = {{ x = 0, y = 0 }}, {last} = {{ x = 0, y = 0 }} }}
[[step]]
name = "give"
increments = 1
displacement = {{ {first} = {{ x = {way} }}, {last} = {{ x = {-way} }} }}
"""


def thrust(way: float, apart: bool) -> float:
    """Of three hinges, the right half of the arch; joint 0 is no joint, as it is held."""
    area = 0.5 * (OUTER**2 - INNER**2) * WIDE
    far = 2.0 / 3.0 * (OUTER**3 - INNER**3) / area * np.sin(WIDE / 2.0)
    middles = (np.arange(COUNT // 2) + 0.5) * WIDE
    haunch, crown = (INNER, OUTER) if apart else (OUTER, INNER)
    found = []
    for joint in range(1, COUNT // 2):
        hinge = haunch * np.exp(1j * joint * WIDE)
        if hinge.imag >= crown:  # in the line of thrust it could only be above
            continue
        piece = 1j * crown - hinge
        over = hinge.real + way
        turned = complex(-over, np.sqrt(abs(piece) ** 2 - over**2))
        centres = hinge + way + (far * np.exp(1j * middles[joint:]) - hinge) * turned / piece
        found.append(area * float(np.sum(over - centres.real)) / turned.imag)
    return max(found) if apart else min(found)


def test_least_thrust() -> None:
    """By the theorem of the safe line of thrust: a linear programme over its place and force."""
    area, count = 0.5 * (OUTER**2 - INNER**2) * WIDE, COUNT
    far = 2.0 / 3.0 * (OUTER**3 - INNER**3) / area * np.sin(WIDE / 2.0)
    moments = area * far * np.cumsum(np.cos((np.arange(count) + 0.5) * WIDE))
    rows, sides = [], []
    for joint in range(1, count):  # unknown are the thrust and its moment about the centre
        angle, shear = joint * WIDE, area * (count / 2.0 - joint)
        for sign, radius in ((1.0, INNER), (-1.0, OUTER)):
            rows.append([sign * radius * np.sin(angle), -sign])
            sides.append(-sign * (moments[joint - 1] + radius * np.cos(angle) * shear))
    for sign in (1.0, -1.0):
        found = linprog([sign, 0.0], rows, sides, bounds=[(0.0, None), (None, None)])
        assert found.x[0] == pytest.approx(thrust(0.0, sign > 0.0), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "way", "facets", "order", "swapped", "error", "corrections"),
    [
        ("neo-hookean", WAY, (4, 5), 1, False, 1e-3, 22),
        ("neo-hookean", WAY, (4, 5), 1, True, 1e-3, 22),
        ("neo-hookean", -WAY, (4, 5), 1, False, 8e-3, 16),
        ("neo-hookean", WAY, (3, 2), 2, False, 1e-3, 22),
        ("linear-elastic", WAY, (4, 5), 1, False, 2e-4, 55),
    ],
)
def test_thrust(
    to_the_end: Callable[..., Any],
    tmp_path: Path,
    model: str,
    way: float,
    facets: tuple[int, int],
    order: int,
    swapped: bool,
    error: float,
    corrections: int,
) -> None:
    """Thrust on both springings."""
    mesh(tmp_path / "arch.msh", facets, order)
    run = to_the_end(case(model, way, swapped))
    assert not run.cuts
    assert run.ends["weight"].iterations <= 8
    assert run.ends["give"].iterations <= corrections
    sought = thrust(0.0 if model == "linear-elastic" else way, way > 0.0)
    for group, sign in (("v0.start", -1.0), (f"v{COUNT - 1}.end", 1.0)):
        force = run.ends["give"].reactions[group]
        assert force[0] == pytest.approx(sign * sought, rel=error)
        assert force[1] == pytest.approx(COUNT * (OUTER**2 - INNER**2) * WIDE / 4.0, rel=1e-3)
