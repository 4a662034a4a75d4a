"""Histories with unloading, reversal, loss and return of contact, viscosity, groups, own laws."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.interface import Interface, LawKinematics, LawResult, LawState, PythonLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.point import (
    DeadLoad,
    DraggingSpring,
    Group,
    PrescribedPath,
    Push,
    StoppedError,
    drive,
)
from anisocontact.surfaces import make_surface

PLANE = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))
MARKS = make_directions("constant", vector=(1, 0, 0))
X, Y, Z = np.eye(3)


def _interface(adhesion: Adhesion | None = None, **friction: object) -> Interface:
    laws = {"coefficients": (0.3, 0.1), "directions": MARKS} | friction
    return Interface(
        PLANE,
        NormalLaw(penalty=1e5),
        adhesion or Adhesion(stiffness=(2e5, 5e4), directions=MARKS),
        Friction(**laws),
    )


def test_reversal_has_the_stick_of_twice_the_limit() -> None:
    """Along an axis the force goes from -mu N to +mu N elastically: 2 mu N/eps of path.

    Closed form of the one-dimensional law; the loop is traced exactly, 1e-12.
    """
    load = PrescribedPath([0 * X, 1e-3 * X, 0 * X], pressure=10.0, increments=1000)
    points = drive(_interface(), load).points[:, 0]
    force, x = points["traction"][:, 0], points["position"][:, 0]
    back = slice(1000, None)
    expected = np.minimum(-3.0 + 2e5 * (1e-3 - x[back]), 3.0)
    assert np.allclose(force[back], expected, rtol=0, atol=1e-10)
    assert (points["status"][1001:1030] == 1).all()
    assert (points["status"][1031:] == 2).all()


def test_falling_pressure_starts_slip_and_shrinks_the_force() -> None:
    """Held in place while N falls, the force stays until it meets the ellipse, then shrinks with N.

    T.FT = N^2 in slip and T unchanged in stick: exact.
    """
    load = PrescribedPath(
        [0 * X, 1e-5 * (X + Y), 1e-5 * (X + Y)], pressure=[10.0, 10.0, 1.0], increments=[10, 90]
    )
    points = drive(_interface(), load).points[:, 0]
    t, n = points["traction_principal"], points["pressure"]
    norm = np.hypot(t[:, 0] / 0.3, t[:, 1] / 0.1)
    slip = points["status"] == 2
    assert slip[-1] and not slip[10] and (np.diff(slip.astype(int)) >= 0).all()
    assert np.allclose(norm[slip], n[slip], rtol=1e-12)
    assert np.allclose(t[10:][~slip[10:]], t[10], rtol=1e-12)


@pytest.mark.parametrize("how", ["pressure", "gap"])
def test_a_contact_that_returns_has_forgotten(how: str) -> None:
    """After loss of contact the point starts anew where it comes back [eq. (101)].

    Compared with a drive that begins there: the same forces, up to rounding of the position.
    """
    knots = np.array([[0, 0, 0], [1e-3, 0, 0], [1e-3, 0, 0], [1e-3, 1e-3, 0]])
    given = {
        "pressure": {"pressure": [10.0, 10.0, 0.0, 10.0]},
        "gap": {"gap": [-1e-4, -1e-4, 1e-4, -1e-4]},
    }[how]
    points = drive(_interface(), PrescribedPath(knots, increments=20, **given)).points[:, 0]
    lost = np.flatnonzero(points["status"] == 0)
    assert lost.size > 0 and (points["traction"][lost] == 0.0).all()
    last = lost[-1]
    after = {
        "pressure": {"pressure": [0.0, 10.0]},
        "gap": {"gap": [float(points["gap"][last]), -1e-4]},
    }[how]
    start = points["position"][last] * [1, 1, 0]
    again = drive(
        _interface(),
        PrescribedPath([start, knots[-1]], increments=len(points) - 1 - last, **after),
    ).points[:, 0]
    assert np.allclose(points["traction"][last + 1 :], again["traction"][1:], rtol=1e-9, atol=1e-9)
    assert points["slip_accumulated"][-1] > again["slip_accumulated"][-1]


def test_turning_dead_load_keeps_its_dashpot_balance() -> None:
    """F + T = eta dx/dt at every step of a dead load whose direction turns past the limit.

    Equilibrium of the stated regularisation, up to the solver's tolerance; and its loss is
    eta |dx/dt|^2 summed up.
    """
    angles = np.linspace(0.0, np.pi, 13)
    force = 3.5 * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    eta = 5e3
    load = DeadLoad(force, (0, 0), viscosity=eta, pressure=10.0, increments=5)
    history = drive(_interface(), load)
    x, t = history.steps["reference"], history.steps["time"]
    speed = np.diff(x, axis=0)[:, :2] / np.diff(t)[:, None]
    given = np.stack([load.force(v) for v in t[1:]])[:, :2]
    contact = history.points["traction"][1:, 0, :2]
    assert np.allclose(given + contact, eta * speed, atol=1e-9)
    lost = eta * (speed**2).sum(axis=1) @ np.diff(t)
    assert history.steps["energy"]["regularisation"][-1] == pytest.approx(lost, rel=1e-12)
    assert (history.points["status"][-20:] == 2).all()


@pytest.mark.parametrize("steps", [200, 400])
def test_relaxation_of_a_standard_linear_solid(steps: int) -> None:
    """Held at u, T = u (k + k_1 exp(-t/tau)).

    Backward Euler: relative error below half a step over tau.
    """
    k, k1, tau, u, jump = 5e4, 1e5, 0.7, 1e-5, 1e-6
    solid = Adhesion(
        "standard-linear-solid",
        stiffness=(k, k),
        stiffness_maxwell=(k1, k1),
        relaxation_time=(tau, tau),
    )
    load = PrescribedPath(
        [0 * X, u * X, u * X], times=[0, jump, 3.0], increments=[1, steps], pressure=10.0
    )
    history = drive(_interface(solid), load)
    t = history.steps["time"][1:] - jump
    expected = -u * (k + k1 * np.exp(-t / tau))
    error = np.abs(history.points["traction"][1:, 0, 0] / expected - 1.0).max()
    assert error < 0.5 * (3.0 / steps) / tau


def test_creep_of_a_kelvin_voigt_interface_under_a_dead_load() -> None:
    """Under a constant force u = F/k (1 - exp(-t k/eta)).

    The error halves with the step: backward Euler.
    """
    k, eta, force = 1e5, 5e4, 1.0
    solid = Adhesion("kelvin-voigt", stiffness=(k, k), viscosity=(eta, eta))
    errors = []
    for n in (100, 200):
        load = DeadLoad(
            [0 * X, force * X, force * X],
            (0, 0),
            times=[0, 1e-9, 2.0],
            increments=[1, n],
            viscosity=1e-6,
            pressure=10.0,
        )
        history = drive(_interface(solid), load)
        expected = force / k * (1.0 - np.exp(-2.0 * k / eta))
        errors.append(history.steps["reference"][-1, 0] / expected - 1.0)
        assert (history.points["status"] == 1).all()
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.03)
    assert abs(errors[1]) < 2e-3


def test_held_group_is_its_points_side_by_side() -> None:
    """On a plane a group that keeps its orientation moves as one point; the forces add up.

    Requirement of a rigid link in translation; the moment is that of equal forces at the points.
    """
    arms = np.array([[1.0, 0, 0], [0, 2.0, 0], [-3.0, 1.0, 0]])
    path = [0 * X, 1e-2 * X, 1e-2 * (X + Y)]
    one = drive(_interface(), DraggingSpring(path, 100.0, pressure=10.0))
    many = drive(
        _interface(),
        DraggingSpring(path, 600.0, pressure=10.0),
        Group(arms, areas=2.0),
    )
    assert np.allclose(one.steps["reference"], many.steps["reference"], rtol=0, atol=1e-12)
    assert np.allclose(6.0 * one.steps["force"], many.steps["force"], atol=1e-8)
    moment = np.cross(2.0 * arms.sum(axis=0), one.steps["force"])
    assert np.allclose(many.steps["moment"], moment, atol=1e-8)


def test_free_group_trails_behind_its_reference() -> None:
    """Dragged by its front on an isotropic plate, a free group ends up straight behind it.

    The moment about the reference is zero in every step; in the end that of the friction forces is
    zero only with the centre in line. The angle decays like exp(-path/arm), e^-25 here.
    """
    isotropic = Interface(
        PLANE,
        NormalLaw(penalty=1e5),
        Adhesion(stiffness=(1e5, 1e5)),
        Friction(coefficients=(0.3, 0.3)),
    )
    load = DraggingSpring([0 * X, 50 * X], 50.0, pressure=10.0, increments=500)
    group = Group([[0, -2, 0]], orientation="free")
    history = drive(isotropic, load, group)
    arm = history.points["position"][-1, 0] - history.steps["reference"][-1]
    assert np.allclose(arm[:2], [-2.0, 0.0], atol=1e-8)
    scale = np.linalg.norm(history.steps["force"], axis=1) * 2.0
    assert (np.abs(history.steps["moment"][:, 2]) <= 1e-9 * scale).all()


class Coulomb:
    """Isotropic Coulomb friction by radial return, in Python."""

    internal = 0

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        n, k, mu = len(kinematics.pressure), 2e5, 0.3
        eye = np.tile(np.eye(2), (n, 1, 1))
        trial = state.traction - k * kinematics.increment
        size = np.linalg.norm(trial, axis=1)
        limit = mu * kinematics.pressure
        slides = size > limit
        unit = trial / np.maximum(size, 1e-300)[:, None]
        scale = np.where(slides, limit / np.maximum(size, 1e-300), 1.0)
        traction = scale[:, None] * trial
        d_trial = scale[:, None, None] * (
            eye - slides[:, None, None] * np.einsum("ni,nj->nij", unit, unit)
        )
        slip = (traction - trial) / k
        return LawResult(
            traction=traction,
            slip=slip,
            d_increment=-k * d_trial,
            d_pressure=mu * slides[:, None] * unit,
            d_traction=d_trial,
            d_elastic=0.0 * eye,
            internal=state.internal,
            dissipation=-np.einsum("ni,ni->n", traction, slip),
            energy=0.5 / k * np.einsum("ni,ni->n", traction, traction),
        )


def test_a_law_written_in_python_drives_as_the_built_in_one() -> None:
    """The driver needs no more than `surface`, `initial_state` and `update` of an interface."""
    sphere = make_surface("sphere", centre=(0, 0, 0), radius=1.0)
    own = Interface(sphere, NormalLaw(penalty=1e5), PythonLaw(Coulomb()))
    built_in = Interface(
        sphere,
        NormalLaw(penalty=1e5),
        Adhesion(stiffness=(2e5, 2e5)),
        Friction(coefficients=(0.3, 0.3)),
    )
    for load in (
        DraggingSpring([(1, 0, 0), (1, 0.02, 0.01)], 5e3, pressure=10.0),
        Push((0, 1, 1), [0, 1e-3], (1, 0, 0), pressure=10.0),
    ):
        a, b = drive(own, load), drive(built_in, load)
        assert np.allclose(a.points["traction"], b.points["traction"], atol=1e-8)
        residual = b.steps["energy"]["residual"]
        assert np.allclose(a.steps["energy"]["residual"], residual, atol=1e-12)
        assert (b.points["status"][-1] == 2).all()


def test_stopped_drive_keeps_what_converged() -> None:
    """A pole of the directions on the path: a message that names step, time and cause."""
    rays = make_directions("polar", axis=((0, 0, 0), (0, 0, 1)))
    load = PrescribedPath([(-1, 0, 0), (1, 0, 0)], pressure=10.0, increments=4)
    with pytest.raises(StoppedError) as caught:
        drive(_interface(directions=rays), load)
    place = "stopped in step 2, at time 0.5: point (0, 0, -0.0001): the direction field"
    assert str(caught.value).startswith(place)
    history = caught.value.history
    assert len(history) == 2
    assert np.allclose(history.points["position"][-1, 0], [-0.5, 0, -1e-4])
