"""The examples of the point driver end where theory says they should."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from anisocontact.case.trace import Trace, load_trace
from anisocontact.cli import main
from anisocontact.point import History, drive
from anisocontact.point.history import ENERGY, POINT, STEP

FOLDER = Path(__file__).parents[2] / "examples" / "point"
CASES = sorted(path.stem for path in FOLDER.glob("*.toml"))


def driven(name: str) -> tuple[Trace, History]:
    trace = load_trace(FOLDER / f"{name}.toml")
    return trace, drive(trace.interface, trace.load, trace.group)


def steady_slip(mu: tuple[float, float], q: float) -> np.ndarray:
    """T/N along the axes in steady slip at the angle q to the first: maximum dissipation."""
    m, e = np.array(mu), np.array([np.cos(q), np.sin(q)])
    return -(m**2) * e / np.linalg.norm(m * e)


def test_every_example_has_a_test() -> None:
    tests = Path(__file__).read_text()
    assert [name for name in CASES if f'"{name}"' not in tests] == []


def test_orthotropic_plane() -> None:
    """Steady slip along x and then along y, marks at 30 degrees: closed form.

    The path is 10 to 20 elastic lengths long in each direction: what is left of the turn of the
    force is e^-10, 5e-5.
    """
    _, history = driven("orthotropic_plane")
    t = history.points["traction_principal"][:, 0] / 10.0
    assert np.allclose(t[80], steady_slip((0.3, 0.1), np.radians(-30)), atol=1e-4)
    assert np.allclose(t[160], steady_slip((0.3, 0.1), np.radians(60)), atol=1e-4)


def test_polar_plate() -> None:
    """The drift is a logarithmic spiral: theta = tan(q - f) ln(r/r_0), tan q = (m1/m2)^2 tan f.

    At every radius within the first order of the step, which is 0.05 over a radius from 10 on;
    measured 1e-3 of an angle of 0.5.
    """
    _, history = driven("polar_plate")
    f = np.radians(-30)
    q = np.arctan2((0.3 / 0.2) ** 2 * np.sin(f), np.cos(f))
    x, y, _ = history.points["position"][:, 0].T
    expected = np.tan(q - f) * np.log(np.hypot(x, y) / 10.0)
    assert np.allclose(np.arctan2(y, x), expected, atol=2e-3)
    assert expected[-1] == pytest.approx(-0.4535, abs=1e-3)
    # The force is along the ray.
    force = history.steps["force"][-1]
    assert force[1] / force[0] == pytest.approx(y[-2] / x[-2], rel=1e-6)


def test_screw_cylinder() -> None:
    """d(angle)/d(length) = f^12/f^22 of the spiral cylinder; the size of the force N/sqrt(f^22)."""
    _, history = driven("screw_cylinder")
    radius, h = 10.0, 40.0 / (2.0 * np.pi)
    a, b, d = 1 / 0.1**2, 1 / 0.3**2, 10.0**2 + h**2
    f12, f22 = h * (a - b) / d, (h**2 * a + radius**2 * b) / d
    slip = history.points["slip_contra"][-1, 0]
    assert slip[0] / slip[1] == pytest.approx(f12 / f22, rel=1e-9)
    angle, length = history.points["xi"][-1, 0] - history.points["xi"][0, 0]
    # The coordinate has the period 2 pi; chord for arc in a step of 0.01.
    assert angle % (2 * np.pi) == pytest.approx(f12 / f22 * length % (2 * np.pi), rel=1e-4)
    assert history.steps["force"][-1, 2] == pytest.approx(10.0 / np.sqrt(f22), rel=1e-9)


def test_rules() -> None:
    """Every implicit rule ends its first leg in the steady slip of its slip ellipse.

    T = -N v/|v|_F with v = K^-1 e for slip along e: K^-1 has the squares of the semi-axes.
    The explicit and the radial rule have v = S F S e and v = S e, S isotropic.
    """
    trace, first = driven("rules")
    runs = {"maximum-dissipation": trace.interface} | dict(trace.compared)
    mu = np.array([0.3, 0.1])
    powers = {
        "maximum-dissipation": mu**2,
        "linear": mu,
        "coaxial": np.ones(2),
        "slip ellipse 2 : 1": np.array([4.0, 1.0]),
        "radial": np.ones(2),
        "explicit, centre": mu**-2.0,
        "explicit, kuhn-tucker": mu**-2.0,
    }
    assert set(powers) == set(runs)
    e = np.array([np.cos(np.radians(-45)), np.sin(np.radians(-45))])
    for label, interface in runs.items():
        history = first if interface is trace.interface else drive(interface, trace.load)
        v = powers[label] * e
        expected = -10.0 * v / np.linalg.norm(v / mu)
        assert np.allclose(history.points["traction_principal"][60, 0], expected, atol=2e-3), label


def test_relaxation() -> None:
    """T_i = -u (k_i + k1_i r exp(-t/tau_i)) while the point is held, r of the ramp before it.

    Backward Euler with 0.005 s against relaxation times of 1 and 0.3 s: below 1 %.
    """
    _, history = driven("relaxation")
    assert (history.points["status"] == 1).all()
    t, u = history.steps["time"][10:] - 0.01, 2e-5
    force = history.points["traction_principal"][10:, 0]
    for i, (k, k1, tau) in enumerate(((5e4, 1e5, 1.0), (2e4, 8e4, 0.3))):
        ramp = tau / 0.01 * (1.0 - np.exp(-0.01 / tau))
        assert np.allclose(force[:, i], -u * (k + k1 * ramp * np.exp(-t / tau)), rtol=1e-2)


def test_creep() -> None:
    """u = F/k (1 - exp(-t k/eta)), and back after the load is gone; all work is lost in the end.

    Backward Euler with 0.01 s against 0.5 s.
    """
    _, history = driven("creep")
    t, u = history.steps["time"], history.steps["reference"][:, 0]
    loaded = (t >= 0.01) & (t <= 4.0)
    assert np.allclose(u[loaded], 1e-5 * (1.0 - np.exp(-(t[loaded] - 0.005) / 0.5)), atol=1e-7)
    free = t >= 4.01
    assert np.allclose(u[free], 1e-5 * np.exp(-(t[free] - 4.005) / 0.5), atol=1e-7)
    energy = history.steps["energy"]
    work = energy["external"][-1] - energy["external"][0]
    assert energy["viscous"][-1] == pytest.approx(work, rel=1e-2)


def test_sledge() -> None:
    """Dragged along x the sledge ends in steady slip: force and moment of the closed form.

    All three runners slip along x, so all have the same force; its line passes through the
    reference, where the spring is, only if the centre of the runners does.
    """
    _, history = driven("sledge")
    points = history.points[-1]
    expected = 10.0 * steady_slip((0.3, 0.1), np.radians(-40))
    assert np.allclose(points["traction_principal"], expected, rtol=1e-3)
    arms = points["position"] - history.steps["reference"][-1]
    force = history.traction_t[-1, 0]
    centre = arms.mean(axis=0)
    sine = np.cross(centre, force)[2] / np.linalg.norm(centre) / np.linalg.norm(force)
    assert abs(sine) < 1e-3
    # ... and behind the spring, not in front of it.
    assert centre @ force > 0.0


def test_example_runs_from_the_command(tmp_path: Path) -> None:
    """As it stands, with pictures."""
    assert main(["trace", str(FOLDER / "screw_cylinder.toml"), "-o", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out" / "pictures" / "path.png").stat().st_size > 20_000


def test_recipes_of_the_guide() -> None:
    """The fragments of the page on loads are valid, given what its reader has at hand."""
    page = Path(__file__).parents[2] / "docs" / "howto" / "point-loads.md"
    names = (
        "import numpy as np\n"
        "from anisocontact.anisotropy import make_directions\n"
        "from anisocontact.laws import Adhesion\n"
        "from anisocontact.point import PrescribedPath, Push\n"
    )
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)
    assert len(blocks) == 2
    exec(compile(names + "\n".join(blocks), str(page), "exec"), {})


def test_guide_names_every_column() -> None:
    page = (Path(__file__).parents[2] / "docs" / "howto" / "point-loads.md").read_text()
    names = [*POINT.names, *STEP.names, *ENERGY.names]
    assert [name for name in names if f"`{name}`" not in page] == []
