"""Input and output of `anisocontact.laws.slide`, and the parameters of the sliding rules."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.base import registry
from anisocontact.base.errors import InputError
from anisocontact.laws import Friction, slide

S, F, T, N = np.eye(2)[None] * 50.0, np.eye(2)[None] / 0.09, [[1.0, 0.5]], [1.0]


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"stiffness": np.eye(2)}, "stiffness: an array of shape (2, 2) given, (1, 2, 2) needed"),
        ({"friction": np.ones((1, 3))}, "friction: an array of shape (1, 3) given"),
        ({"trial": [1.0, 0.5]}, "trial: an array of shape (2,) given, (1, 2) needed"),
        ({"pressure": [[1.0]]}, "pressure: an array of shape (1, 1) given, (1,) needed"),
        ({"trial": [["a", "b"]]}, "trial: [['a', 'b']] given, an array of numbers needed"),
        ({"metric": np.eye(2)}, "metric: an array of shape (2, 2) given"),
        ({"axes": [[1.0, 0.0]]}, "axes: an array of shape (1, 2) given"),
        ({"increment": [0.0, 0.0]}, "increment: an array of shape (2,) given"),
        ({"sliding_rule": "maximum-disipation"}, "did you mean 'maximum-dissipation'?"),
        (
            {"sliding_rule": "slip-ellipse"},
            "slip_axes: sliding rule 'slip-ellipse' needs slip_axes",
        ),
        ({"sliding_rule": "slip-ellipse", "slip_axes": (1.0, 0.0)}, "must be > 0"),
        ({"sliding_rule": "slip-ellipse", "slip_axes": "2"}, "one or two numbers are needed"),
        ({"sliding_rule": "explicit", "history": "center"}, "centre, incremental, kuhn-tucker"),
        ({"history": "centre"}, "has no parameter 'history'"),
    ],
)
def test_mistake_gives_one_line(change, line):
    arguments = {"stiffness": S, "friction": F, "trial": T, "pressure": N} | change
    with pytest.raises(InputError) as error:
        slide(**arguments)
    assert line in str(error.value) and "\n" not in str(error.value)


def test_shapes_and_defaults():
    r = slide(S, F, T, N)
    assert r.traction.shape == r.stored.shape == r.slip.shape == r.d_pressure.shape == (1, 2)
    assert r.d_trial.shape == (1, 2, 2) and r.slides.tolist() == r.converged.tolist() == [True]
    plain = slide(S, F, T, N, metric=np.eye(2)[None], axes=np.eye(2)[None])
    np.testing.assert_array_equal(plain.traction, r.traction)
    increment = slide(S, F, T, N, "explicit", history="kuhn-tucker")
    given = -np.linalg.solve(S[0], T[0])[None]
    same = slide(S, F, T, N, "explicit", history="kuhn-tucker", increment=given)
    np.testing.assert_array_equal(same.stored, increment.stored)


def test_empty_batch():
    r = slide(np.empty((0, 2, 2)), np.empty((0, 2, 2)), np.empty((0, 2)), [])
    assert r.traction.shape == (0, 2) and r.d_trial.shape == (0, 2, 2)


def test_default_history_is_centre():
    default = Friction(coefficients=(0.3, 0.3), sliding_rule="explicit").rule
    assert (
        default == Friction(coefficients=(0.3, 0.3), sliding_rule="explicit", history="centre").rule
    )


def test_slip_ellipse_needs_directions():
    """Its axes start at the first friction axis, even where friction is isotropic."""
    with pytest.raises(InputError, match=r"friction\.directions"):
        Friction(coefficients=(0.3, 0.3), sliding_rule="slip-ellipse", slip_axes=(2.0, 1.0))
    Friction(coefficients=(0.3, 0.3), sliding_rule="slip-ellipse", slip_axes=(2.0, 2.0))


def test_angles_are_marked_as_such():
    (angle,) = (
        p
        for p in registry.entry(registry.sliding_rules(), "slip-ellipse").parameters
        if p.name == "slip_angle"
    )
    assert angle.unit == "angle" and not angle.required and angle.default == (0.0,)
