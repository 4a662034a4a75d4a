"""Ellipses that are thin: numbers, or one line.

Requirement: a force and its derivatives are numbers for every friction ellipse that is taken, down
to a ratio of 1e-6 of the coefficients, and thinner ones are refused. Source: F has 1/mu^2 of both
axes in each of its components, of whose digits rounding leaves four then.
"""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

Z = ((0, 0, 0), (0, 0, 1))
POLAR = make_directions("polar", axis=Z, angle=0.5)
OBLIQUE = make_directions("from-vectors", first=(1, 0, 0.1), second=(0.8, 0.6, 0.3))
RULES = ("maximum-dissipation", "linear", "coaxial", "radial")


@pytest.mark.parametrize("sliding_rule", RULES)
@pytest.mark.parametrize("thinness", [1e-5, 1.001e-6])
def test_all_that_is_answered_is_a_number(sliding_rule, thinness):
    """On a sphere, whose basis turns from point to point against the axes; a point that has no
    answer says so, which is at most one in a hundred."""
    rng = np.random.default_rng(0)
    sphere, count = make_surface("sphere", centre=(0, 0, 0), radius=1.0), 400
    for axes, stiffness, turned in itertools.product(
        (POLAR, OBLIQUE), ((1e4, 1.0), (1.0, 1e4), (1.0, 1.0)), (False, True)
    ):
        coefficients = (thinness, 1.0) if turned else (1.0, thinness)
        interface = Interface(
            sphere,
            NormalLaw(penalty=1e3),
            Adhesion(stiffness=stiffness, directions=POLAR),
            Friction(coefficients=coefficients, directions=axes, sliding_rule=sliding_rule),
        )
        x = rng.normal(size=(count, 3))
        x /= np.linalg.norm(x, axis=1)[:, None]
        state = interface.initial_state(x)
        for _ in range(6):
            x += rng.normal(size=x.shape) * 0.03
            x *= (rng.uniform(0.97, 0.995, count) / np.linalg.norm(x, axis=1))[:, None]
            found = interface.update(state, x)
            told = ~found.failed
            assert np.isfinite(found.traction[told]).all()
            assert np.isfinite(found.tangent[told]).all()
            assert found.failed.sum() <= count // 100
            state = found.state


@pytest.mark.parametrize(
    ("given", "field"),
    [
        ({"coefficients": (0.3, 1e-7)}, "coefficients: 0.3 and 1e-07 given"),
        ({"coefficients": (1e-9, 0.1)}, "coefficients: 1e-09 and 0.1 given"),
        (
            {"coefficients": 0.3, "sliding_rule": "slip-ellipse", "slip_axes": (1.0, 1e7)},
            "slip_axes: 1 and 1e.07 given",
        ),
        (
            {"model": "he-curnier", "alpha": (1e-8, 0.1, 0.2), "directions_second": POLAR},
            "alpha: coefficients along the axes: 1e-08 and 0.3 given",
        ),
    ],
)
def test_a_thinner_one_is_refused(given, field):
    """Requirement: one line that says what may be. Source: the limit of the page on the model."""
    with pytest.raises(InputError, match=rf"{field}, one must be at least 1e-06 of the other"):
        Interface(
            make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)),
            NormalLaw(penalty=1e3),
            Adhesion(stiffness=1.0),
            Friction(directions=POLAR, **given),
        )
