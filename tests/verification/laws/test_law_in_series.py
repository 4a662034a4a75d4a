"""A compliant layer in series with the tangential law."""

from __future__ import annotations

import numpy as np
import pytest
from tests.verification.laws_in_python import RadialReturn

from anisocontact.anisotropy import make_directions
from anisocontact.interface import Interface, LawInSeries, LawKinematics, LawState
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

MARKS = make_directions("constant", vector=(1, 0, 0), angle=0.5)
MODELS = [
    ("elastic", {"stiffness": (50.0, 2.0)}),
    ("maxwell", {"stiffness": (50.0, 2.0), "relaxation_time": (0.3, 1.0)}),
    ("kelvin-voigt", {"stiffness": (5.0, 2.0), "viscosity": (10.0, 3.0)}),
    (
        "standard-linear-solid",
        {"stiffness": (5.0, 2.0), "stiffness_maxwell": (40.0, 1.0), "relaxation_time": (0.3, 1.0)},
    ),
]
COMPLIANCE, DT = 0.1, 0.2


def _interface(adhesion: Adhesion) -> Interface:
    return Interface(
        make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)),
        NormalLaw(penalty=1e3),
        adhesion,
        Friction(coefficients=(50.0, 50.0)),
    )


@pytest.mark.parametrize(("model", "values"), MODELS)
def test_layer_gives_way_by_its_compliance(model, values):
    """Every adhesion model, after an increment that left force and elastic slip.

    Requirement: slip of model and layer add, `T_c(d) = T(d + c T_c)`, with the response of the
    model by itself at the larger slip as the independent computation. Tolerance: round-off.
    """
    law = _interface(Adhesion(model, directions=MARKS, **values))
    state = law.initial_state([[0.0, 0.0, 0.0]])
    before = law.update(state, [[0.02, -0.01, -0.1]], DT).state
    soft, history = law.in_series(COMPLIANCE, DT)
    start = before.copy()
    axes = law.update(before, [[0.02, -0.01, -0.1]], DT).directions_adhesion[0]
    frame = law.surface.jet(before["xi"]).d1[0] @ axes.T
    force = np.linalg.solve(frame, before["stored"][0])
    slip = frame.T @ before["elastic"][0]
    start["stored"][0] = frame @ (history.keeps @ force - history.recovers @ slip)
    there = np.array([[0.05, 0.03, -0.1]])
    found = soft.update(start, there, DT).traction_t
    wanted = law.update(before, there + COMPLIANCE * found, DT).traction_t
    assert np.abs(found).max() > 0.1
    assert np.allclose(found, wanted, rtol=1e-11, atol=0.0)


def test_law_in_python_gives_way_by_the_compliance_of_its_layer():
    """A law in Python with a layer behind it, sticking and sliding, and its tangent.

    Requirement: `T_c(d) = T(d + c T_c)`; the blocks are the derivatives, by central differences.
    """
    law = RadialReturn((50.0, 2.0), (0.3, 0.2))
    soft = LawInSeries(law, COMPLIANCE)
    state = LawState(
        np.array([[0.1, -0.2], [0.2, 0.1]]), np.zeros((2, 2)), np.zeros((2, law.internal))
    )

    def now(increment):
        return LawKinematics(increment, np.array([5.0, 1.0]), np.zeros(2), np.zeros((2, 2)), DT)

    increment = np.array([[0.01, 0.02], [0.5, -0.3]])
    found = soft.update(state, now(increment))
    wanted = law.update(state, now(increment + COMPLIANCE * found.traction))
    assert np.allclose(found.traction, wanted.traction, rtol=1e-10, atol=0.0)
    assert not found.slip[0].any()
    assert found.slip[1].any()
    for i in range(2):
        step = np.zeros((2, 2))
        step[:, i] = 1e-6
        up, down = (soft.update(state, now(increment + s * step)).traction for s in (1, -1))
        slope = (up - down) / 2e-6
        assert np.allclose(found.d_increment[:, :, i], slope, rtol=1e-6, atol=1e-7)
