"""The flank of a screw: closest points against a fine scan, places without one, the torque of a
thread."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.anisotropy import make_directions
from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, build_mesh, make_shape
from anisocontact.rigid import RigidBody
from anisocontact.solver import CoupledFace, Problem, Solver, Step
from anisocontact.surfaces import PROJECTION_STATUS, Surface, make_surface

PI = np.pi


def flank(**parameters: Any) -> Surface:
    """A flank about the third axis whose angle is zero along the first."""
    usual = {"lead": 6.0, "inner": 8.0, "outer": 10.0, "point": (0, 0, 0)}
    placed = {"axis": (0, 0, 1), "start": (1, 0, 0)}
    return make_surface("helicoid", **(usual | placed | parameters))


def scanned(x: Floats, lead: float, radii: tuple[float, float], slope: float) -> Floats:
    """Distances of points (n, 3) to a flank, the least over 8,000 generators, (n,).

    The nearest point of a generator, a segment, is that of its line cut off at the ends.
    """
    rise, (inner, outer) = lead / (2 * PI), radii
    high = x[:, 2] - 0.5 * slope * (outer - inner)
    half = 1.1 * PI + 0.5 * abs(slope * (outer - inner) / rise)
    angle = (high / rise)[:, None] + np.linspace(-half, half, 8_001)
    along = x[:, :1] * np.cos(angle) + x[:, 1:2] * np.sin(angle)
    across = x[:, 1:2] * np.cos(angle) - x[:, :1] * np.sin(angle)
    up = x[:, 2:] - rise * angle
    r = np.clip((along + slope * (up + slope * inner)) / (1 + slope**2), inner, outer)
    out = (along - r) ** 2 + across**2 + (up - slope * (r - inner)) ** 2
    return np.sqrt(out.min(axis=1))


def test_closest_points_are_the_nearest_of_a_scan() -> None:
    """Requirement: no other point is nearer, wherever a point is and whatever the flank. Source: a
    scan in NumPy over the angle, which finds no distance below the least one. Tolerance:
    rounding.

    Leads from a tenth to ten times the radius, generators as steep as 74 degrees, flanks from a
    hundredth of the radius: among these the nearest point goes from edge to edge within a few
    degrees, where a search with fixed steps alone misses it.
    """
    r = np.random.default_rng(4)
    for case in range(30):
        lead = float(r.choice([-1, 1]) * 10 ** r.uniform(-1, 1))
        inner, angle = float(10 ** r.uniform(-1, 0)), float(r.uniform(-1.3, 1.3))
        outer = inner + float(10 ** r.uniform(-2, 0))
        if (outer - inner) * abs(np.tan(angle)) > 19 * abs(lead):
            continue
        surface = flank(lead=lead, inner=inner, outer=outer, flank=angle, below=bool(case % 2))
        x = r.normal(size=(40, 3)) * outer * r.choice([0.3, 1.0, 3.0], (40, 1))
        x[:2, :2] = 0.0
        p = surface.project(x)
        found = np.linalg.norm(surface.position(p.xi) - x, axis=1)
        assert (found <= scanned(x, lead, (inner, outer), np.tan(angle)) * (1 + 1e-12)).all(), case


@pytest.mark.parametrize("radius", [7.0, 9.0, 12.0])
def test_between_two_turns_two_points_are_as_near(radius: float) -> None:
    """A flank without slope is its own image under half a turn about a ray midway between two
    turns: on the ray there are two closest points, and one of them, always the same, is given."""
    x = np.array([[radius, 0.0, 3.0]])
    p = flank().project(x)
    assert PROJECTION_STATUS[int(p.status[0])] == "ambiguous"
    again = flank().project(x + np.array([0.0, 0.0, 1e-16]))
    np.testing.assert_array_equal(p.xi, again.xi)
    beside = flank().project(x + np.array([[0, 0, 1e-9], [0, 0, -1e-9]]))
    assert not (beside.status == PROJECTION_STATUS.index("ambiguous")).any()
    np.testing.assert_allclose(beside.xi[:, 0].sum(), 2 * PI, rtol=1e-6)


def test_centre_of_curvature_of_an_edge() -> None:
    """Opposite to a point of the inner edge, a distance `c^2 / r` from the axis, the edge is a
    helix about its centre of curvature: the closest point is there, and has no derivative."""
    rise, inner = 60.0 / (2 * PI), 8.0
    out = rise**2 / inner
    x = np.array([-out * np.cos(0.4), -out * np.sin(0.4), 0.4 * rise])
    p = flank(lead=60.0).project(x[None])
    assert PROJECTION_STATUS[int(p.status[0])] == "ambiguous"
    np.testing.assert_allclose(p.xi, [[0.4, 2.0]], atol=1e-4)
    nearer = flank(lead=60.0).project(0.99 * x[None] + [0.0, 0.0, 0.01 * x[2]])
    assert PROJECTION_STATUS[int(nearer.status[0])] == "edge"


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"lead": 0.0}, "lead"),
        ({"inner": 0.0}, "inner"),
        ({"outer": 8.0}, "outer must be more than inner"),
        ({"flank": PI / 2}, "flank must be less than a right angle"),
        ({"flank": 1.5, "lead": 0.01}, "flank rises by more than 20 leads between inner and outer"),
    ],
)
def test_what_is_no_flank(given: dict[str, float], told: str) -> None:
    """One line that names what is wrong."""
    with pytest.raises(InputError, match=told):
        flank(**given)


@pytest.mark.parametrize("angle", [0.0, PI / 6, -PI / 12])
@pytest.mark.parametrize("lead", [6.0, -15.0])
@pytest.mark.parametrize("below", [False, True])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_torque_of_a_thread_at_a_point(
    angle: float, lead: float, below: bool, sense: float
) -> None:
    """A point that is turned along a flank has the moment and the axial force of a thread.

    Source: `M / F = r tan(lambda + phi')`, with `tan lambda = c / r` and `tan phi' = mu /
    cos(alpha_n)`, `tan alpha_n = tan(alpha) cos(lambda)`, the flank in the section normal to the
    thread [Shigley, ch. 8]; with the hand of the thread, the side of the flank and the sense of the
    turn it is `M / F = r (c + s mu r k) / (r - s mu c k)`, k = 1 / cos(alpha_n). Tolerance: the
    elastic slip, 1e-5 of the radius, by which the force lags on its circle.
    """
    radius, mu, pressure = 9.0, 0.2, 10.0
    law = Interface(
        flank(lead=lead, flank=angle, below=below),
        NormalLaw(penalty=1e4),
        Adhesion(stiffness=(1e5, 1e5)),
        Friction(coefficients=(mu, mu)),
    )
    side, rise = (-1.0 if below else 1.0), lead / (2 * PI)
    alphas = sense * np.linspace(0.0, 0.02, 41)[1:]
    surface = law.surface
    xi = np.column_stack([side * np.append(0.0, alphas), np.full(41, 10.0 - radius)])
    path = surface.position(xi) - pressure / 1e4 * surface.geometry(xi).normal
    state = law.initial_state(path[:1])
    for x in path:
        answer = law.update(state, x[None])
        state = answer.state
    force, moment = answer.traction[0], np.cross(path[-1], answer.traction[0])[2]
    k = np.sqrt(1 + (np.tan(angle) * radius) ** 2 / (radius**2 + rise**2))
    slips = side * sense * mu * k
    expected = -radius * (rise + slips * radius) / (radius - slips * rise)
    assert np.sign(force[2]) == side
    np.testing.assert_allclose(moment / force[2], expected, atol=2e-5 * radius)


def _moment_over_force(coefficients: tuple[float, float], turn: float) -> tuple[float, list[int]]:
    """M / F of a part of a nut at the end of a turn on a rigid flank, and its corrections."""
    nut = make_shape(
        "ring", inner=8.75, outer=9.25, length=0.5, cells=(1, 8, 1), start=0.5, end=2.0
    )
    model = build_mesh([Body("nut", nut)])
    x = model.mesh.geometry.x
    x[:, 2] += 6.0 * np.arctan2(x[:, 1], x[:, 0]) / (2.0 * PI)
    grooves = make_directions("coordinate-lines")
    friction = Friction(coefficients=coefficients, directions=grooves)
    contact = Contact(model, "nut.bottom", flank(), friction)
    hand = RigidBody("hand", (0.0, 0.0, 0.0), free=True)
    steel = {"nut": make_material("neo-hookean", E=1e4, nu=0.3)}
    problem = Problem(model, steel, [contact], coupled=[CoupledFace("nut.top", hand)])
    load = {"hand": {"z": -20.0}}
    steps = [
        Step("touch", 1, motion={"hand": {"z": -0.001}}),
        Step("load", 1, motion={"hand": {"z": None}}, load=load),
        Step("turn", 3, motion={"hand": {"z": None, "rz": turn}}, load=load),
    ]
    run = list(Solver(problem, steps).run())
    force, moment = run[-1].resultants[contact.name]
    np.testing.assert_allclose(force[2], 20.0, rtol=1e-8)
    return float(-moment[2] / force[2]), [one.iterations for one in run if one.step == "turn"]


@pytest.mark.parametrize("coefficients", [(0.05, 0.3), (0.3, 0.05)])
def test_torque_of_an_elastic_nut(coefficients: tuple[float, float]) -> None:
    """A nut with grooves along the square thread and across, turned up and down under an axial
    force.

    Source: `M / F = r tan(lambda +- phi)` with the friction along the thread, which is the first
    coordinate line [Shigley, ch. 8]. Tolerance: 1e-4 of the larger of both; measured 1e-5, by the
    width of the ring, where facets in the place of the flank leave 1e-3.
    """
    radius, lead, angle = 9.0, np.arctan(6.0 / (18.0 * PI)), np.arctan(coefficients[0])
    expected = radius * np.tan(lead + np.array([angle, -angle]))
    (up, first), (down, second) = (
        _moment_over_force(coefficients, np.radians(turn)) for turn in (6.0, -6.0)
    )
    np.testing.assert_allclose([up, down], expected, atol=1e-4 * expected[0])
    assert max(first[1:] + second[1:]) <= 3
