"""The point driver on curved surfaces and in fields of directions against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from anisocontact.anisotropy import make_directions
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.point import History, Push, drive
from anisocontact.point.foot import foot
from anisocontact.surfaces import make_surface

R, PITCH, PRESSURE = 10.0, 40.0, 10.0
MU = (0.1, 0.3)


def _screw() -> Interface:
    cylinder = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=R, start=(1, 0, 0))
    groove = make_directions("spiral", axis=((0, 0, 0), (0, 0, 1)), pitch=PITCH)
    return Interface(
        cylinder,
        NormalLaw(penalty=1e5),
        Adhesion(stiffness=(1e5, 1e5)),
        Friction(coefficients=MU, directions=groove),
    )


def _spiral_friction() -> np.ndarray:
    """f^ij of the spiral cylinder in xi = (angle, length), h = H/2 pi, d = R^2 + h^2."""
    h = PITCH / (2.0 * np.pi)
    d = R**2 + h**2
    a, b = 1.0 / MU[0] ** 2, 1.0 / MU[1] ** 2
    mixed = h * (a - b) / d
    return np.array(
        [[(R**2 * a + h**2 * b) / (R**2 * d), mixed], [mixed, (h**2 * a + R**2 * b) / d]]
    )


@pytest.mark.parametrize("along", ["axis", "circumference"])
def test_screw_slips_as_the_friction_tensor_says(along: str) -> None:
    """A push along one coordinate of the spiral cylinder slips along f^ij T_j, T.FT = N^2.

    The force in a step is along the push exactly, and the slip normal to the ellipse: every
    sliding step has the ratio, and the force its size, up to the 1e-11 of the solver. The position
    follows the same ratio up to the square of the angle of a step (chord for arc): measured 2e-5,
    and 1/16 of it with steps of a quarter.
    """
    k = 1 if along == "axis" else 0
    frame = [(1, 0), (0, 1)][k]
    load = Push(
        frame, [0, 12.0], (0.0, 0.0), frame="coordinates", pressure=PRESSURE, increments=120
    )
    history = drive(_screw(), load)
    f = _spiral_friction()
    points = history.points[:, 0]
    ratio = points["slip_contra"][2:, 1 - k] / points["slip_contra"][2:, k]
    assert np.allclose(ratio, f[1 - k, k] / f[k, k], rtol=1e-10)
    moved = points["xi"][-1] - points["xi"][0]
    assert moved[1 - k] / moved[k] == pytest.approx(f[1 - k, k] / f[k, k], rel=4e-5)
    force = points["traction_co"][-1]
    assert abs(force[k]) == pytest.approx(PRESSURE / np.sqrt(f[k, k]), rel=1e-10)
    assert force @ f @ force == pytest.approx(PRESSURE**2, rel=1e-10)


def _polar(n: int, mu: tuple[float, float] = (0.3, 0.2)) -> tuple[Interface, History]:
    """A radial push outwards on a plate whose marks run at 30 degrees to the rays."""
    axis = ((0, 0, 0), (0, 0, 1))
    rays = make_directions("polar", axis=axis)
    marks = make_directions("polar", axis=axis, angle=np.radians(30.0))
    plate = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))
    interface = Interface(
        plate,
        NormalLaw(penalty=1e5),
        Adhesion(stiffness=(1e6, 1e6), directions=rays),
        Friction(coefficients=mu, directions=marks),
    )
    load = Push((1, 0), [0, 20], (10, 0), frame="adhesion", pressure=PRESSURE, increments=n)
    return interface, drive(interface, load)


def _streamline(interface: Interface, to_radius: float) -> np.ndarray:
    """Path of the slip v ~ F e_r under a radial force, from (10, 0) to a radius."""
    friction, plate = interface.tangential.friction, interface.surface

    def slip(_: float, x: np.ndarray) -> np.ndarray:
        tensor = friction.tensor(plate, x[None], "spatial")[0, :2, :2]
        v = tensor @ x
        return v / np.linalg.norm(v)

    def arrived(_: float, x: np.ndarray) -> float:
        return float(np.linalg.norm(x) - to_radius)

    arrived.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(slip, (0, 200), [10.0, 0.0], events=arrived, rtol=1e-10, atol=1e-10)
    return np.asarray(found.y_events[0][0])


def test_radial_push_on_a_polar_plate_follows_the_streamline() -> None:
    """The driver's path tends to the solution of dx/ds = F e_r/|F e_r| (SciPy), at first order.

    The direction of the push and the tensors are constant within a step, so the angle at the end
    has an error of first order (measured 1e-3 at 400 steps); extrapolated to step 0 it is that of
    the streamline, up to the elastic displacement over the radius and the second order, both 1e-6.
    """
    angles, errors = [], []
    for n in (100, 200, 400):
        interface, history = _polar(n)
        x = history.points["position"][-1, 0, :2]
        expected = _streamline(interface, float(np.linalg.norm(x)))
        angles.append(np.arctan2(x[1], x[0]))
        errors.append(angles[-1] - np.arctan2(expected[1], expected[0]))
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.03)
    assert errors[1] / errors[2] == pytest.approx(2.0, rel=0.03)
    assert abs(2.0 * errors[2] - errors[1]) < 2e-6


def test_streamline_of_the_polar_plate_is_a_logarithmic_spiral() -> None:
    """theta = tan(delta) ln(r/r_0) with delta = q - f, tan q = (m1/m2)^2 tan f.

    Pins the streamline that the driver is compared with, to the tolerance of its integration.
    """
    interface, _ = _polar(2)
    f = -np.radians(30.0)
    delta = np.arctan2((0.3 / 0.2) ** 2 * np.sin(f), np.cos(f)) - f
    x = _streamline(interface, 25.0)
    assert np.arctan2(x[1], x[0]) == pytest.approx(np.tan(delta) * np.log(2.5), rel=1e-7)


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("degrees", [0.0, 23.79, 66.21, 90.0])
@pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane"])
def test_a_load_begins_on_a_surface_through_the_origin(
    kind: str, degrees: float, inside: bool
) -> None:
    """The origin on surfaces that are made of points and lengths far from it has a foot: itself.

    Requirement: a load may begin on the surface. Source: closest points are known to rounding of
    the lengths that a surface is made of, not to a share of their distance, which is 0 here.
    """
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    up = 0.845 if inside else -0.845
    round_one = {"axis": (c, s, 0.0), "radius": 0.845, "inside": inside}
    surface = {
        "cylinder": {"point": (0.3 * c, 0.3 * s, up), **round_one},
        "sphere": {"centre": (0.0, 0.0, up), **round_one},
        "plane": {"point": (0.3, 0.3 * c / (s + 1.0), 0.0), "normal": (0.0, 0.0, -up)},
    }[kind]
    made = make_surface(kind, **surface)
    assert foot(made, np.zeros(3)).reached
    assert foot(made, np.array([0.0, 0.0, 1e-13])).reached


def test_a_point_beyond_the_end_of_a_surface_has_no_foot() -> None:
    """Requirement: the end of a surface is told, however near it a point is but for rounding."""
    disc = make_surface("revolution", point=(0, 0, 0), axis=(0, 0, 1), profile=[0.0, 0, 1.0, 0])
    reached = [foot(disc, np.array([x, 0.0, 0.0])).reached for x in (0.999, 1.0, 1.000001, 1.1)]
    assert reached == [True, True, False, False]


@pytest.mark.parametrize("turned", [0.0, 0.3, 0.7, 1.1, 2.0])
@pytest.mark.parametrize("kind", ["cylinder", "sphere"])
def test_a_pressure_is_found_at_the_origin(kind: str, turned: float) -> None:
    """Pressed at the origin, on surfaces about a point farther off by 1e7 penetrations.

    Requirement: any given pressure is found. Source: penetrations are known to rounding of the
    lengths that a surface is made of. Tolerance: 1e-7, that rounding over the penetration.
    """
    c, s = np.cos(turned), np.sin(turned)
    lead = {"axis": (c, s, 0.1), "radius": np.hypot(0.3, 2.0), "start": (-s, c, 1.0)}
    if kind == "cylinder":
        made = make_surface(kind, point=(0.3 * s, -0.3 * c, -2.0), **lead)
    else:
        made = make_surface(kind, centre=(0.3 * s, -0.3 * c, -2.0), **lead)
    law = Interface(made, NormalLaw(penalty=3e5), Adhesion(stiffness=10.0), _ISOTROPIC)
    x = np.array(foot(made, np.zeros(3)).position)
    push = Push((1.0, 0.2, 0.0), travel=[0, 1e-6], start=x, pressure=0.06, increments=1)
    assert np.allclose(drive(law, push).points["pressure"], 0.06, rtol=1e-7)


_ISOTROPIC = Friction(coefficients=0.3)
