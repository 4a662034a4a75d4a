"""An elastic ball in a conical seat with grooves that wind around it, pressed and turned.

Source: friction runs along the slip on axes of friction normal to the ellipse [R. Michalowski, Z.
Mroz, Arch. Mech. 30, 1978], here around the axis: of a ring of contact whose normal N is inclined
by the angle of the cone,

    M / N r = h ,   F_y / N = sin(alpha) + (mu1^2 - mu2^2) c s / h cos(alpha) ,
    h^2 = (mu1 c)^2 + (mu2 s)^2 ,

c and s of the angle of the grooves to the way: they draw the ball in or push it out. Across the
ring, far smaller than the ball, the contact is that of a cylinder on a half plane [K. L. Johnson,
Contact Mechanics, sec. 4.2 and 5.4], E* = E / (1 - nu^2), under N for each length of the ring.

Requirement: torque and axial force, with the pressures of the run; pressure within 0.85 of the
half-width, of the load of the run, over the largest; all slides; corrections. Tolerance: that of
the solver for the torque, measured 4e-7; 3.5e-4 for the axial force, as friction of pressing turns
around while the ball gives way; pressure 1.3, 0.8 % rms with facets of order 1 of a fifth of the
half-width, 3.4, 1.4 % with those of order 2 of two fifths; six corrections.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.drawn import drawn

RADIUS, INCLINED, E, NU = 10.0, float(np.radians(45.0)), 1000.0, 0.3

CASE = f"""
title = "Ball in a seat"
[idealisation]
kind = "axisymmetric"
lateral = true
[mesh]
file = "ball.msh"
[material.ball]
model = "neo-hookean"
E = {E}
nu = {NU}
[surface.seat]
shape = "cone"
apex = [0, {-RADIUS / float(np.sin(INCLINED))!r}, 0]
axis = [0, 1, 0]
angle_deg = 45
inside = true
[rigid.stem]
faces = ["ball.top"]
reference = [0, 0, 0]
[[contact]]
slave = "ball.skin"
master = "seat"
[contact.friction]
coefficients = [{{along}}, {{across}}]
directions = {{{{ kind = "coordinate-lines", angle_deg = {{angle}} }}}}
[[step]]
name = "press"
increments = 1
motion.stem = {{{{ y = -0.02 }}}}
[[step]]
name = "turn"
increments = 2
motion.stem = {{{{ ry_deg = 2 }}}}
"""


def mesh(path: Path, size: float, order: int) -> None:
    """Half a section of the lower half of the ball, fine where it touches."""
    with drawn(path, order) as gmsh:
        geo, at = gmsh.model.geo, RADIUS * np.sqrt(0.5)
        middle, lowest = geo.addPoint(0, 0, 0), geo.addPoint(0, -RADIUS, 0)
        touch, side = geo.addPoint(at, -at, 0), geo.addPoint(RADIUS, 0, 0)
        arcs = [geo.addCircleArc(lowest, middle, touch), geo.addCircleArc(touch, middle, side)]
        cuts = [geo.addLine(side, middle), geo.addLine(middle, lowest)]
        half = geo.addPlaneSurface([geo.addCurveLoop([*arcs, *cuts])])
        geo.synchronize()
        gmsh.model.addPhysicalGroup(2, [half], name="ball")
        gmsh.model.addPhysicalGroup(1, arcs, name="skin")
        gmsh.model.addPhysicalGroup(1, cuts[:1], name="top")
        field = gmsh.model.mesh.field
        away, grown = field.add("Distance"), field.add("Threshold")
        field.setNumbers(away, "PointsList", [touch])
        field.setNumber(grown, "InField", away)
        for key, value in (("SizeMin", size), ("SizeMax", 16 * size)):
            field.setNumber(grown, key, value)
        for key, value in (("DistMin", 8 * size), ("DistMax", 0.8 * RADIUS)):
            field.setNumber(grown, key, value)
        field.setAsBackgroundMesh(grown)
        for key in ("FromPoints", "ExtendFromBoundary"):
            gmsh.option.setNumber(f"Mesh.MeshSize{key}", 0)


@pytest.mark.parametrize(
    ("along", "across", "angle", "size", "order"),
    [(0.3, 0.3, 0.0, 0.05, 1), (0.3, 0.1, 30.0, 0.05, 1), (0.3, 0.1, -50.0, 0.1, 2)],
)
def test_ball_turned_in_its_seat(
    to_the_end: Callable[..., Any],
    tmp_path: Path,
    along: float,
    across: float,
    angle: float,
    size: float,
    order: int,
) -> None:
    """Torque, axial force and pressure."""
    mesh(tmp_path / "ball.msh", size, order)
    run = to_the_end(CASE.format(along=along, across=across, angle=angle), most=8000)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 7
    (contact,) = run.problem.contacts
    force, moment = run.accepted[-1].resultants[contact.name][:2]
    pressure = contact.last.pressure
    normal, radius = pressure * contact.areas, np.hypot(*contact.points[:, ::2].T)
    assert np.all(contact.last.status[pressure > 0.0] == 2)
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    h = np.hypot(along * c, across * s)
    side = (along**2 - across**2) * c * s / h
    around, axial = -moment[1] / (normal @ radius), force[1] / normal.sum()
    ring = (normal @ radius) / normal.sum()
    load = normal.sum() / (2.0 * np.pi * ring)
    a = np.sqrt(4.0 * load * RADIUS * (1.0 - NU**2) / (np.pi * E))
    # along the generators, which stand for arcs of the ball
    place = contact.points[:, 1] * np.cos(INCLINED) + radius * np.sin(INCLINED)
    place -= (normal @ place) / normal.sum()
    inside = np.abs(place) < 0.85 * a
    exact = 2.0 * load / (np.pi * a) * np.sqrt(1.0 - (place[inside] / a) ** 2)
    error = (pressure[inside] - exact) / exact.max()
    assert around == pytest.approx(h, abs=1e-6)
    assert axial == pytest.approx(np.sin(INCLINED) + side * np.cos(INCLINED), abs=1e-3)
    assert np.abs(error).max() < (0.02 if order == 1 else 0.045)
    assert np.sqrt(np.mean(error**2)) < (0.012 if order == 1 else 0.02)
