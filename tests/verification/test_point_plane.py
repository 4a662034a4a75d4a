"""The point driver on a plane against closed forms.

Sources: "Closed forms" of docs/theory (maximum dissipation, steady slip, dead load, stick).
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.point import DeadLoad, DraggingSpring, PrescribedPath, Push, drive
from anisocontact.surfaces import make_surface

MU = np.array([0.3, 0.1])
STIFFNESS = np.array([2e5, 5e4])
PENALTY, PRESSURE = 1e5, 10.0
E, N_ = np.array([1.0, 2.0, 2.0]) / 3.0, np.array([2.0, 1.0, -2.0]) / 3.0
ACROSS = np.cross(N_, E)


def _interface(**friction: object) -> Interface:
    """An oblique plane, its first friction axis along E."""
    plane = make_surface("plane", point=(0.1, -0.2, 0.3), normal=N_)
    marks = make_directions("constant", vector=E)
    return Interface(
        plane,
        NormalLaw(penalty=PENALTY),
        Adhesion(stiffness=STIFFNESS, directions=marks),
        Friction(coefficients=MU, directions=marks, **friction),
    )


START = np.array([0.1, -0.2, 0.3])


def _unit(angle: float) -> np.ndarray:
    return np.cos(angle) * E + np.sin(angle) * ACROSS


def _steady(q: float) -> np.ndarray:
    """T/N of steady slip at angle q to the first axis, in the friction axes."""
    c, s = np.cos(q), np.sin(q)
    return -np.array([MU[0] ** 2 * c, MU[1] ** 2 * s]) / np.hypot(MU[0] * c, MU[1] * s)


@pytest.mark.parametrize("degrees", [0.0, 15.0, 30.0, 45.0, 60.0, 90.0, 200.0, -75.0])
def test_steady_slip_on_a_prescribed_path(degrees: float) -> None:
    """T = -N (m1^2 cos q, m2^2 sin q)/h after a long straight path.

    The transient decays like exp(-slip/elastic length): after 500 elastic lengths it is rounding,
    and what is left are the equations of one step, solved to 1e-14.
    """
    q = np.radians(degrees)
    path = [START, START + 0.01 * _unit(q)]
    history = drive(_interface(), PrescribedPath(path, pressure=PRESSURE, increments=100))
    t = history.points["traction_principal"][-1, 0] / PRESSURE
    assert np.allclose(t, _steady(q), rtol=0.0, atol=1e-12)
    assert np.allclose(history.points["pressure"], PRESSURE, rtol=1e-13)


@pytest.mark.parametrize("degrees", [10.0, 30.0, 45.0, 80.0, 130.0])
def test_push_slips_normal_to_the_ellipse(degrees: float) -> None:
    """A force at angle f to the first axis slips at tan q = (m1/m2)^2 tan f, and its size is N
    over the friction norm of its direction.

    Both follow from equilibrium and normality without approximation in a step, so the tolerance
    is that of the solver.
    """
    f = np.radians(degrees)
    load = Push(_unit(f), [0.0, 0.01], START, pressure=PRESSURE, increments=50)
    history = drive(_interface(), load)
    slip = history.points["slip"][-1, 0]
    expected = np.array([np.cos(f) / MU[0] ** 2, np.sin(f) / MU[1] ** 2])
    expected /= np.linalg.norm(expected)
    direction = np.array([slip @ E, slip @ ACROSS]) / np.linalg.norm(slip)
    assert np.allclose(direction, expected, atol=1e-9)
    size = np.linalg.norm(history.steps["force"][-1] + PRESSURE * N_)
    limit = PRESSURE / np.hypot(np.cos(f) / MU[0], np.sin(f) / MU[1])
    assert size == pytest.approx(limit, rel=1e-10)


def test_dead_load_just_past_the_limit() -> None:
    """A dead load past the limit by a share d slips at tan q = (m1/m2)^2 tan f to first order in d.

    The dashpot carries the excess, so the contact force is the closest point of the ellipse to
    the load; the deviation must fall by 10 with d, and the direction at d = 1e-7 be right to 1e-6.
    """
    f = np.radians(30.0)
    limit = PRESSURE / np.hypot(np.cos(f) / MU[0], np.sin(f) / MU[1]) * _unit(f)
    errors = []
    for excess in (1e-3, 1e-4, 1e-7):
        knots = [0 * limit, limit * (1 - 1e-9), limit * (1 + excess), limit * (1 + excess)]
        load = DeadLoad(knots, START, pressure=PRESSURE, increments=[10, 10, 100])
        slip = drive(_interface(), load).points["slip"][-1, 0]
        ratio = (slip @ ACROSS) / (slip @ E)
        errors.append(abs(ratio / ((MU[0] / MU[1]) ** 2 * np.tan(f)) - 1.0))
    assert errors[2] < 1e-6
    assert errors[0] / errors[1] == pytest.approx(10.0, rel=0.05)


def test_stick_direction_of_a_dead_load() -> None:
    """Below the limit tan(angle of displacement) = (e1/e2) tan(angle of T).

    A dashpot of viscosity eta lets the force lag by eta/(e_i duration) of its change: 2e-8 here.
    """
    f = np.radians(20.0)
    knots = [0 * E, 0.5 * _unit(f)]
    load = DeadLoad(knots, START, pressure=PRESSURE, increments=10, viscosity=1e-3)
    history = drive(_interface(), load)
    moved = history.steps["reference"][-1] - history.steps["reference"][0]
    ratio = (moved @ ACROSS) / (moved @ E)
    assert ratio == pytest.approx(STIFFNESS[0] / STIFFNESS[1] * np.tan(f), rel=1e-7)
    assert (history.points["status"] == 1).all()


def test_spring_in_stick_is_two_springs_in_series() -> None:
    """Below the limit the point moves by K^-1 k u with K = S + k, exactly: a linear problem."""
    k, u = 1e4, 1e-4
    q = np.radians(40.0)
    load = DraggingSpring([START, START + u * _unit(q)], k, pressure=PRESSURE, increments=3)
    history = drive(_interface(), load)
    moved = history.steps["reference"][-1] - history.steps["reference"][0]
    expected = u * k / (STIFFNESS + k) * np.array([np.cos(q), np.sin(q)])
    assert np.allclose([moved @ E, moved @ ACROSS], expected, rtol=1e-10)
    assert (history.points["status"] == 1).all()


@pytest.mark.parametrize("load", ["path", "spring"])
@pytest.mark.parametrize(("end", "order"), [(PRESSURE, 2), (0.3 * PRESSURE, 1)])
def test_energy_balance_converges(load: str, end: float, order: int) -> None:
    """Work = energies + dissipation up to an error of first order in the step.

    The error of a slip step is dT.dxi_sl/2. With constant N the force moves along the ellipse,
    which is normal to the slip, so that the sum is even of second order; with falling N it is not.
    """
    knots = [START, START + 1e-3 * E, START + 1e-3 * (E + ACROSS)]
    errors = []
    for n in (100, 200, 400):
        pressure = [PRESSURE, 0.5 * (PRESSURE + end), end]
        if load == "path":
            given = PrescribedPath(knots, pressure=pressure, increments=n)
        else:
            given = DraggingSpring(knots, 1e4, pressure=pressure, increments=n)
        energy = drive(_interface(), given).steps["energy"][-1]
        errors.append(abs(energy["residual"]) / energy["external"])
    assert errors[0] < 5e-3
    assert errors[1] / errors[2] == pytest.approx(2.0**order, rel=0.15)


def test_push_over_a_surface_that_is_slippery_across() -> None:
    """Push at 30 degrees where one coefficient is far smaller than the other.

    Requirement: the force is along the push, of the size where the ellipse meets it,
    `N / sqrt((cos / mu_1)^2 + (sin / mu_2)^2)`, and the point has moved along it as asked.
    Source: yield condition. Iterates went off to 1e20, where rounding of the position hides any
    residual, and were taken for an equilibrium with a force that was not along the push.
    Tolerance: 1e-4 of the force, as slip is backward Euler and steady after 20 steps; rounding
    of the travel.
    """
    across, marks = 1e-3, make_directions("constant", vector=(1, 0, 0))
    plate = Interface(
        make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)),
        NormalLaw(penalty=1e5),
        Adhesion(stiffness=(1e5, 1e5)),
        Friction(coefficients=(0.3, across), directions=marks),
    )
    along = np.array([np.cos(np.pi / 6), np.sin(np.pi / 6), 0.0])
    push = Push(along, travel=[0, 1e-3], start=(0, 0, 0), pressure=10.0)
    history = drive(plate, push)
    force = -history.points["traction"][-1, 0] * [1, 1, 0]
    size = 10.0 / np.linalg.norm(along[:2] / [0.3, across])
    assert force == pytest.approx(size * along, rel=1e-4)
    assert history.points["position"][-1, 0] @ along == pytest.approx(1e-3, rel=1e-9)


@pytest.mark.parametrize("force", [1.0, 1e-3, 1e6])
def test_a_push_without_friction_goes_where_it_is_led(force: float) -> None:
    """A point without friction is moved along the push by the length that is given, not across it.

    Requirement: `Push`. Source: nothing resists along the plane, and of all positions that the
    equations allow the nearest is taken. Tolerance: 1e-10 of the travel, rounding of positions.
    """
    plane = make_surface("plane", point=(0.3, -0.2, 0.1), normal=N_)
    laws = NormalLaw(penalty=100.0 * force), Adhesion(stiffness=10.0 * force)
    slippery = Interface(plane, *laws, Friction(coefficients=0))
    push = Push(E, travel=[0.0, 0.02], start=START, pressure=15.0 * force, increments=3)
    x = drive(slippery, push).steps["reference"]
    assert np.allclose(x[-1] - x[0], 0.02 * E, rtol=0.0, atol=1e-10 * 0.02)


def test_a_dead_load_without_friction_needs_a_dashpot_of_its_own() -> None:
    """Requirement: no viscosity is made from a tangential stiffness that is rounding alone."""
    plane = make_surface("plane", point=(0.3, -0.2, 0.1), normal=N_)
    laws = NormalLaw(penalty=100.0), Adhesion(stiffness=10.0)
    slippery = Interface(plane, *laws, Friction(coefficients=0))
    load = {"start": START, "pressure": 15.0}
    with pytest.raises(InputError, match="viscosity: missing; without contact and friction"):
        drive(slippery, DeadLoad([0.0 * E, E], **load))
    held = drive(slippery, DeadLoad([E, E], viscosity=50.0, **load)).steps["reference"]
    assert np.allclose(held[-1] - held[0], 1.0 / 50.0 * E, rtol=0.0, atol=1e-9)
