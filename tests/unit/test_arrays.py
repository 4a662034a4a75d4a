"""Arrays that scripts give: what is no array of real numbers of the shape needed is one line."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from anisocontact.base.errors import InputError
from anisocontact.bulk import from_mandel, slope_from_mandel, to_mandel
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface


def _interface() -> Interface:
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    laws = NormalLaw(penalty=1e3), Adhesion(stiffness=(1e3, 1e3)), Friction(coefficients=0.3)
    return Interface(plane, *laws)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (np.full((1, 3), 1j), "an array of real numbers needed"),
        ([["1", "2", "3"]], "an array of real numbers needed"),
        ([[1.0, 2.0]], r"an array of shape \(1, 2\) given, \(n, 3\) needed"),
        (np.zeros((1, 1, 3)), r"an array of shape \(1, 1, 3\) given, \(n, 3\) needed"),
    ],
)
def test_points_that_are_none_are_one_line(given: Any, says: str) -> None:
    """Parts of complex numbers are not dropped, texts not read."""
    with pytest.raises(InputError, match=f"^x: .*{says}$"):
        _interface().initial_state(given)


@pytest.mark.parametrize("dt", [-1.0, 0.0, math.nan, math.inf])
def test_a_time_step_that_is_none_is_one_line(dt: float) -> None:
    """With NaN, or in no time at all, a point in contact was open, without a word."""
    interface = _interface()
    with pytest.raises(InputError, match=r"^dt: .* given, (must be > 0|a number needed)$"):
        interface.update(interface.initial_state([[0, 0, 0]]), [[0, 0, -1e-3]], dt=dt)


@pytest.mark.parametrize(
    ("function", "given", "says"),
    [
        (to_mandel, np.eye(3), r"tensors: .*\(3, 3\) given, \(n, 3, 3\) needed"),
        (from_mandel, np.zeros(6), r"vectors: .*\(6,\) given, \(n, 6\) needed"),
        (slope_from_mandel, np.eye(6), r"matrices: .*\(6, 6\) given, \(n, 6, 6\) needed"),
        (to_mandel, "strain", "tensors: 'strain' given, an array of real numbers needed"),
    ],
)
def test_tensors_of_another_shape_are_one_line(function: Any, given: Any, says: str) -> None:
    """One tensor without its row is not taken for several."""
    with pytest.raises(InputError, match=f"^{says}$"):
        function(given)


def test_points_are_as_many_as_states() -> None:
    """One point is not taken for those of two states."""
    interface = _interface()
    state = interface.initial_state(np.zeros((2, 3)))
    with pytest.raises(InputError, match=r"^x: .* \(1, 3\) given, \(2, 3\) needed$"):
        interface.update(state, [[0, 0, -1e-3]])
