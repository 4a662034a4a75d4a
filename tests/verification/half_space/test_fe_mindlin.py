"""Cattaneo and Mindlin: two elastic spheres under constant normal and varying tangential load.

Requirement: radius of the stick region within a facet, tangential shift within 2 %, energy lost in
a cycle within 5 %, also where friction is orthotropic and the load is along a principal axis.
Source: Cattaneo 1938, Mindlin 1949, Mindlin Deresiewicz 1953, in K. L. Johnson, Contact Mechanics,
sections 7.2 and 7.4. With P, Q, the Hertzian radius a of P, the friction mu along the load and
K = (2 - nu_1) / G_1 + (2 - nu_2) / G_2,

    c = a (1 - Q / mu P)^(1/3)                                          radius of stick
    d(Q) = 3 mu P K / (16 a) (1 - (1 - Q / mu P)^(2/3))                 shift, first loading
    d = d(Q*) - 2 d'((Q* - Q) / 2)                                      after a turn at Q*
    loss = 9 mu^2 P^2 K / (10 a) (1 - s^(5/3) - 5 Q* / (6 mu P) (1 + s^(2/3))) , s = 1 - Q* / mu P

with d' = d at half of the change. (The loss is the area of the loop of d; checked here as well.)

Assumptions made true: both bodies have the same shape, material and mesh, so that normal and
tangential tractions do not couple, and P stays as it is while the far ends are held apart. Half of
the pair is computed, with y = 0 as plane of symmetry. The shift is that of the far ends. What
blocks of ten radii give way more or less than half-spaces do is a linear function of the force
alone; it is measured once on the same mesh without contact, as the difference to Cerruti's closed
form at the middle of a square under uniform shear, and taken off.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Model
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.merge import merge
from anisocontact.solver import Problem, Solver, Step

RADIUS, E, NU, MU = 80.0, 1000.0, 0.3, 0.4
SHEAR = 0.5 * E / (1.0 + NU)
K = 2.0 * (2.0 - NU) / SHEAR
#: Growth of the cells away from the contact, by facets across the radius.
GROWTH = {4: 2.0, 8: 3.0}
FIXED = {"x": 0.0, "y": 0.0, "z": 0.0}
#: Shift of the far ends at the turns, over that at which everything slips: Q* is 0.78 mu P.
TURN = 0.65
#: Approach of the far ends: the contact radius is about one.
APPROACH = 2.0 * 0.93 / RADIUS


@dataclass(frozen=True)
class Point:
    """The pair after an increment: forces, shift without the bodies' far field, loss, stick."""

    normal: float
    tangential: float
    shift: float
    loss: float
    stick: float

    @property
    def radius(self) -> float:
        """Hertzian radius."""
        reduced = 0.5 * E / (1.0 - NU**2)
        return float((0.75 * self.normal * 0.5 * RADIUS / reduced) ** (1.0 / 3.0))

    def first(self, force: float) -> float:
        """Shift of a first loading by a force."""
        share = force / (MU * self.normal)
        full = 3.0 * MU * self.normal * K / (16.0 * self.radius)
        return float(full * (1.0 - (1.0 - share) ** (2.0 / 3.0)))


def _steel() -> Any:
    return make_material("linear-elastic", E=E, nu=NU)


def _body(half_spaces: Any, name: str, n: int, **more: Any) -> MeshArrays:
    """Half of a graded body, y >= 0."""
    return half_spaces.body(
        name, n, upper=name == "ball", growth=GROWTH[n], fine=1.05, both_sides=True, **more
    )


def _far_field(half_spaces: Any, n: int) -> float:
    """Shift per force that one body adds to what a half-space has near the contact."""
    model = Model.from_arrays(_body(half_spaces, "base", n, patch=1.0))
    problem = Problem(model, {"base": _steel()}, [])
    held = {"base.far": FIXED, "base.y": {"y": 0.0}}
    for _ in Solver(problem, [Step("shear", 1, held, {"base.patch": {"x": 1.0}})]).run():
        pass
    middle = np.argmin(np.linalg.norm(model.space.tabulate_dof_coordinates(), axis=1))
    found = problem.u.x.array.reshape(-1, 3)[middle, 0]
    cerruti = (2.0 - NU) / (2.0 * np.pi * SHEAR) * 4.0 * np.log(1.0 + np.sqrt(2.0))
    return float((found - cerruti) / 4.0)  # the square has an area of 4


def _run(half_spaces: Any, n: int, legs: list[tuple[float, int]], across: float) -> list[Point]:
    """Press, then move the far ends along each other by shares of the full shift."""
    bodies = [_body(half_spaces, name, n, radius=RADIUS) for name in ("ball", "base")]
    model = Model.from_arrays(merge(bodies))
    law = ContactLaw(
        NormalLaw(penalty=4.0 * E * n),
        Adhesion(stiffness=(20.0 * E * n, 20.0 * E * n)),
        Friction(
            coefficients=(MU, across), directions=make_directions("constant", vector=(1, 0, 0))
        ),
    )
    contact = Contact(
        model, "ball.contact", "base.contact", law=law, current_area=False, mortar=False
    )
    problem = Problem(model, {"ball": _steel(), "base": _steel()}, [contact])
    symmetric = {"ball.y": {"y": 0.0}, "base.y": {"y": 0.0}, "base.far": FIXED}
    full = 3.0 * MU * K / 16.0 * 2.0 / 3.0 * E / (1.0 - NU**2) / (0.5 * RADIUS)
    steps = [Step("press", 1, {**symmetric, "ball.far": {**FIXED, "z": -APPROACH}})]
    steps += [
        Step(f"leg {i}", increments, {"ball.far": {"x": share * full}})
        for i, (share, increments) in enumerate(legs)
    ]
    given = 2.0 * _far_field(half_spaces, n)
    moved = [0.0] + [
        (start + (end - start) * (k + 1) / increments) * full
        for start, (end, increments) in zip([0.0, *(s for s, _ in legs)], legs, strict=False)
        for k in range(increments)
    ]
    points = []
    for accepted, shift in zip(Solver(problem, steps).run(), moved, strict=True):
        force = 2.0 * contact.resultant()[0]
        sticking = np.linalg.norm(contact.points[contact.last.status == 1][:, :2], axis=1)
        points.append(
            Point(
                normal=force[2],
                tangential=-force[0],
                shift=shift + given * force[0],
                loss=2.0 * accepted.energies["friction"],
                stick=sticking.max(initial=0.0),
            )
        )
    return points


def _check_point(p: Point, shift: float, change: float, n: int, scale: float) -> None:
    """Shift within 2 % of the largest, stick region within a facet, for a change of force."""
    assert abs(p.shift - shift) < 0.02 * scale
    stick = p.radius * (1.0 - change / (MU * p.normal)) ** (1.0 / 3.0)
    assert abs(p.stick - stick) < 1.0 / n


def test_first_loading(half_spaces: Any) -> None:
    """Shift and stick region on 4 facets across the radius.

    Measured: shift within 1.2 % of the largest, stick region within 0.4 of a facet; with 6 and 8
    facets the same, so that what is left of the shift is that of the finite bodies.
    """
    n = 4
    start, *points = _run(half_spaces, n, [(TURN, 3)], MU)
    largest = start.first(points[-1].tangential)
    for p in points:
        assert p.normal == pytest.approx(start.normal, rel=1e-3)
        _check_point(p, p.first(p.tangential), p.tangential, n, largest)


@pytest.mark.slow
@pytest.mark.parametrize("across", [MU, 0.375 * MU])
def test_load_cycle(half_spaces: Any, across: float) -> None:
    """A whole cycle on 8 facets across the radius, isotropic and orthotropic.

    Measured: shift within 1.6 % of the largest, stick region within 0.42 of a facet, loss +2.4 %
    (+15 % with 4 facets, +5.8 % with 6); orthotropic, loss +2.8 %.
    """
    n, k = 8, 3
    points = _run(half_spaces, n, [(TURN, k), (-TURN, 2 * k), (TURN, 2 * k)], across)
    turn = points[k]
    top, largest = turn.tangential, turn.first(turn.tangential)
    for i, p in enumerate(points[1:], 1):
        sign = -1.0 if k < i <= 3 * k else 1.0
        if i <= k:
            _check_point(p, p.first(p.tangential), p.tangential, n, largest)
            continue
        change = 0.5 * (top + sign * p.tangential)
        _check_point(p, sign * (2.0 * p.first(change) - largest), change, n, largest)
    share = top / (MU * turn.normal)
    left = 1.0 - share
    loss = 0.9 * (MU * turn.normal) ** 2 * K / turn.radius
    loss *= 1.0 - left ** (5 / 3) - 5 / 6 * share * (1.0 + left ** (2 / 3))
    assert _loop(turn, top) == pytest.approx(loss, rel=1e-6)
    assert points[-1].loss - points[k].loss == pytest.approx(loss, rel=0.05)


def _loop(p: Point, top: float) -> float:
    """Area between the branches of shift over force."""
    force = np.linspace(-top, top, 20001)
    upper = np.array([p.first(top) - 2.0 * p.first(0.5 * (top - f)) for f in force])
    lower = np.array([2.0 * p.first(0.5 * (top + f)) - p.first(top) for f in force])
    return float(np.trapezoid(upper - lower, force))
