"""A law written in Python gives what the same law in the core gives.

Requirement: an open interface; source: `anisocontact.Interface` with isotropic friction, and order
of convergence of the tangent.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.base.errors import InputError
from anisocontact.interface import (
    Interface,
    LawKinematics,
    LawResult,
    LawState,
    PythonLaw,
    SlaveSurface,
)
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import Surface, make_surface

STIFFNESS, MU = 2e3, 0.3

SURFACES = {
    "plane": make_surface("plane", point=(0, 0, 0), normal=(0.1, 0.2, 1)),
    "cylinder": make_surface("cylinder", point=(0, 0, 0), axis=(0, 0.3, 1), radius=1.5),
    "torus": make_surface("torus", centre=(0, 0, 0), axis=(0.2, 0, 1), radius=2.0, tube=0.7),
}


class Coulomb:
    """Isotropic Coulomb friction by radial return; remembers the largest pressure."""

    internal = 1

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        n = len(kinematics.pressure)
        eye = np.tile(np.eye(2), (n, 1, 1))
        trial = state.traction - STIFFNESS * kinematics.increment
        size = np.linalg.norm(trial, axis=1)
        limit = MU * kinematics.pressure
        slides = size > limit
        unit = trial / np.where(size > 0, size, 1.0)[:, None]
        scale = np.where(slides, limit / np.where(size > 0, size, 1.0), 1.0)
        traction = scale[:, None] * trial
        d_trial = scale[:, None, None] * (
            eye - slides[:, None, None] * np.einsum("ni,nj->nij", unit, unit)
        )
        slip = (traction - trial) / STIFFNESS
        return LawResult(
            traction=traction,
            slip=slip,
            d_increment=-STIFFNESS * d_trial,
            d_pressure=MU * slides[:, None] * unit,
            d_traction=d_trial,
            d_elastic=0.0 * eye,
            internal=np.maximum(state.internal, kinematics.pressure[:, None]),
            dissipation=-np.einsum("ni,ni->n", traction, slip),
            energy=0.5 / STIFFNESS * np.einsum("ni,ni->n", traction, traction),
        )


def _pair(surface: Surface) -> tuple[Interface, Interface]:
    normal = NormalLaw(penalty=1e3)
    built_in = Interface(
        surface,
        normal,
        Adhesion(stiffness=(STIFFNESS, STIFFNESS)),
        Friction(coefficients=(MU, MU)),
    )
    return Interface(surface, normal, PythonLaw(Coulomb())), built_in


def _path(surface: Surface, rng: np.random.Generator) -> list[np.ndarray]:
    """Positions of 60 points: approach, press, drag in random directions."""
    xi = rng.uniform(-1.0, 1.0, (60, 2))
    jet, normal = surface.jet(xi), surface.geometry(xi).normal
    path, along = [], np.zeros((60, 3))
    for depth in (0.01, -0.004, -0.01, -0.008, 0.002):
        along = along + np.einsum("ni,nij->nj", rng.normal(0, 0.004, (60, 2)), jet.d1)
        path.append(jet.position + along + (depth + rng.normal(0, 0.002, 60))[:, None] * normal)
    return path


def _slaves(x: np.ndarray, steps: int, rng: np.random.Generator) -> list[SlaveSurface]:
    """Slaves that turn and stretch at random, by 0.4 at most entry by entry, from step to step."""
    start = rng.normal(0.0, 1.0, (len(x), 2, 3))
    change = rng.uniform(-0.2, 0.2, (steps, len(x), 3, 3)) + np.eye(3)
    return [SlaveSurface(x, start, start @ one) for one in change]


@pytest.mark.parametrize("turning", [False, True], ids=["points", "turning"])
@pytest.mark.parametrize("name", SURFACES)
def test_same_as_the_core(name: str, turning: bool) -> None:
    """Forces, states and tangents agree along a path with contact, stick, slip and loss.

    Also where the slave turns, with the tangent by the tangents of the slave. Tolerance 1e-10
    relative: rounding of two orders of the same operations over five steps. The angle of `turn`
    comes from a cosine in the core, 1e-7.
    """
    python, core = _pair(SURFACES[name])
    path = _path(SURFACES[name], np.random.default_rng(3))
    a, b = python.initial_state(path[0]), core.initial_state(path[0])
    seen = set()
    slaves = _slaves(path[0], len(path), np.random.default_rng(4))
    for x, each in zip(path, slaves, strict=True):
        slave = each if turning else None
        ra, rb = python.update(a, x, slave=slave), core.update(b, x, slave=slave)
        scale = np.abs(rb.traction).max() or 1.0
        assert np.abs(ra.traction - rb.traction).max() <= 1e-10 * scale
        assert np.abs(ra.tangent - rb.tangent).max() <= 1e-10 * max(np.abs(rb.tangent).max(), 1.0)
        assert ra.tangent_slave.shape == rb.tangent_slave.shape
        np.testing.assert_allclose(ra.tangent_slave, rb.tangent_slave, rtol=0, atol=1e-10)
        np.testing.assert_array_equal(ra.status, rb.status)
        np.testing.assert_allclose(ra.state["turn"], rb.state["turn"], rtol=0, atol=1e-7)
        for f in ("slave", "spin"):
            np.testing.assert_allclose(ra.state[f], rb.state[f], rtol=0, atol=1e-10)
        for f in ("traction", "elastic", "dissipation", "slip_accumulated", "energy_adhesion"):
            assert np.abs(ra.state[f] - rb.state[f]).max() <= 1e-10 * max(
                np.abs(rb.state[f]).max(), 1e-3
            )
        seen |= set(rb.status.tolist())
        a, b = ra.state, rb.state
    assert seen == {0, 1, 2}
    assert (np.abs(a["spin"]).max() > 0.1) == turning
    assert a["internal"].max() > 0.0


@pytest.mark.parametrize("name", ["cylinder", "torus"])
def test_history_turns_as_in_the_core(name: str) -> None:
    """A force of before, turned by up to half a radian with the normal: the one of the core.

    Points that stuck are led far along the surface in one step. What a wrong turn changes goes
    with the fourth power of the angle, so that small steps do not see it. Tolerance: rounding.
    """
    surface = SURFACES[name]
    python, core = _pair(surface)
    rng = np.random.default_rng(8)
    xi = rng.uniform(-1.0, 1.0, (60, 2))
    a, b = (itf.initial_state(surface.position(xi)) for itf in (python, core))
    for step in (0.01, 0.25):
        xi = xi + rng.uniform(-step, step, xi.shape)
        x = surface.position(xi) - 0.3 * surface.geometry(xi).normal
        ra, rb = python.update(a, x), core.update(b, x)
        a, b = ra.state, rb.state
        assert np.abs(ra.traction - rb.traction).max() <= 1e-10 * np.abs(rb.traction).max()


def test_state_is_not_changed() -> None:
    """`update` is pure: the committed state is the same after it."""
    python, _ = _pair(SURFACES["plane"])
    x = _path(SURFACES["plane"], np.random.default_rng(5))
    state = python.initial_state(x[0])
    copy = state.copy()
    python.update(state, x[2])
    assert state.tobytes() == copy.tobytes()


def test_wrong_shape_is_said() -> None:
    """A law that returns the wrong shape is told which array."""

    class Wrong(Coulomb):
        def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
            r = super().update(state, kinematics)
            return LawResult(**{**vars(r), "traction": r.traction[:, :1]})

    itf = Interface(SURFACES["plane"], NormalLaw(penalty=1e3), PythonLaw(Wrong()))
    x = [[0.0, 0.0, -0.01]]
    with pytest.raises(InputError, match=r"traction: the law returned an array of shape \(1, 1\)"):
        itf.update(itf.initial_state([[0.0, 0.0, 0.1]]), x)


@pytest.mark.parametrize("count", [-1, 1.5, None, True, "2", 10**9])
def test_a_number_of_variables_that_is_none_is_one_line(count: object) -> None:
    """As in a case file."""
    law = Coulomb()
    law.internal = count
    says = rf"^law: Coulomb\.internal is {count!r}, the number of its own .* 0 to 1000000$"
    with pytest.raises(InputError, match=says):
        PythonLaw(law)


def test_in_a_finite_element_contact(fe) -> None:
    """A block pressed and dragged with the law in Python: the forces of the law in the core.

    Tolerance 1e-9 relative: both are solved to a residual of 1e-12.
    """
    from anisocontact.solver import Step

    forces = []
    for interface in _pair(make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))):
        block = fe.block(interface, cells=(2, 2, 1))
        steps = [
            Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}),
            Step("drag", 3, {"block.top": {"x": 0.02}}),
        ]
        accepted = block.run(*steps, snes_rtol=1e-12)
        forces.append(np.array([a.resultants["block.bottom"][0] for a in accepted]))
    assert np.abs(forces[0] - forces[1]).max() < 1e-9 * np.abs(forces[1]).max()
    assert accepted[-1].contacts["block.bottom"]["slip"] > 0
