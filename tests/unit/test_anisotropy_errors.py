"""A mistake in a direction field or a friction model is one line that names the entry."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import (
    from_callable,
    from_reparametrisation,
    make_directions,
    tensor,
    tensor_derivative,
)
from anisocontact.base.errors import InputError
from anisocontact.laws import Adhesion, Friction
from anisocontact.surfaces import make_surface

PLANE = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))
MARKS = make_directions("constant", vector=(1, 0, 0))
AXIS = ((0, 0, 0), (0, 0, 1))
GRID: dict[str, Any] = {"lower": (0, 0), "upper": (1, 1), "counts": (5, 5)}
WINDOW: dict[str, Any] = {"lower": (0, 0), "upper": (1, 1), "counts": (5, 5)}
THREE = np.eye(3)


def grid(**more: Any) -> Any:
    return make_directions("tabulated-grid", **({"vectors": np.ones((25, 3))} | GRID | more))


def scattered(**more: Any) -> Any:
    return make_directions("tabulated-points", **({"points": THREE, "vectors": THREE} | more))


CASES: dict[str, tuple[Callable[[], Any], str]] = {
    "unknown field": (
        lambda: make_directions("spirel"),
        "unknown direction field 'spirel', there are",
    ),
    "zero vector": (
        lambda: make_directions("constant", vector=(0, 0, 0)),
        "vector: (0, 0, 0) given",
    ),
    "axis of one vector": (
        lambda: make_directions("polar", axis=(0, 0, 1)),
        "axis: (0, 0, 1) given, a point and a direction",
    ),
    "axis without direction": (
        lambda: make_directions("polar", axis=((1, 2, 3), (0, 0, 0))),
        "axis: ((1, 2, 3), (0, 0, 0)) given, its direction must not be zero",
    ),
    "axis with true among numbers": (
        lambda: make_directions("polar", axis=((0, True, 0), (0, 0, 1))),
        "axis: ((0, True, 0), (0, 0, 1)) given, a point and a direction",
    ),
    "axis with true of NumPy among numbers": (
        lambda: make_directions("polar", axis=((0, np.True_, 0), (0, 0, 1))),
        "axis: ((0, np.True_, 0), (0, 0, 1)) given, a point and a direction",
    ),
    "axis of words": (lambda: make_directions("polar", axis=(("a",) * 3,) * 2), "axis: (('a', 'a'"),
    "no pitch": (
        lambda: make_directions("spiral", axis=AXIS, pitch=0),
        "pitch: 0 given, must not be zero",
    ),
    "parallel axes": (
        lambda: make_directions(
            "oblique", vector=(1, 0, 0), angle_first=0.3, angle_second=0.3 + np.pi
        ),
        "direction field 'oblique': angle_second: the two axes are parallel",
    ),
    "parallel vectors": (
        lambda: make_directions("from-vectors", first=(1, 1, 0), second=(-2, -2, 0)),
        "direction field 'from-vectors': second: parallel to first",
    ),
    "ragged table": (
        lambda: scattered(points=[[0, 0, 0], [1, 0]]),
        "points: [[0, 0, 0], [1, 0]] given",
    ),
    "infinite table": (lambda: scattered(points=np.full((3, 3), np.inf)), "points: array([["),
    "not in threes": (
        lambda: scattered(vectors=[1, 2]),
        "direction field 'tabulated-points': vectors: 2",
    ),
    "too few vectors": (
        lambda: scattered(vectors=THREE[:2]),
        "direction field 'tabulated-points': vectors: 2",
    ),
    "zero in a table": (
        lambda: scattered(vectors=[[1, 0, 0], [0, 0, 0], [1, 0, 0]]),
        "direction field 'tabulated-points': vectors: vector 1 is zero",
    ),
    "too few points": (
        lambda: scattered(points=THREE[:2], vectors=THREE[:2]),
        "direction field 'tabulated-points': points: 2 given, at least 3 needed",
    ),
    "one place": (
        lambda: scattered(points=np.zeros((4, 3)), vectors=np.ones((4, 3))),
        "direction field 'tabulated-points': points: all in one line",
    ),
    "grid of four nodes": (
        lambda: grid(counts=(5, 4), vectors=np.ones((20, 3))),
        "direction field 'tabulated-grid': counts: 4 given, at least 5 needed for bicubic",
    ),
    "grid of one count": (
        lambda: grid(counts=(25,)),
        "direction field 'tabulated-grid': counts: 1 given",
    ),
    "grid reversed": (
        lambda: grid(upper=(1, -1)),
        "direction field 'tabulated-grid': upper: must be",
    ),
    "grid and vectors": (
        lambda: grid(second_vectors=np.ones((24, 3))),
        "direction field 'tabulated-grid': second_vectors: 24 vectors given, 25 needed",
    ),
    "unknown interpolation": (
        lambda: grid(interpolation="cubic"),
        "interpolation: 'cubic' given, allowed",
    ),
    "endless surface": (
        lambda: from_callable(PLANE, lambda x: x),
        "lower: (-inf, -inf) is where the surface ends, two finite numbers needed",
    ),
    "less than no nodes": (
        lambda: from_callable(PLANE, lambda x: x, **WINDOW | {"counts": (-5, 5)}),
        "counts: (-5, 5) given, must be > 0",
    ),
    "far too many nodes": (
        lambda: from_callable(PLANE, lambda x: x, **WINDOW | {"counts": (10**6, 10**6)}),
        "counts: (1000000, 1000000) given, 1.0e+12 nodes, at most 1e+07 allowed",
    ),
    "callable of another shape": (
        lambda: from_callable(PLANE, lambda x: x[:, :2], **WINDOW),
        "directions of shape (25, 2) given",
    ),
    "callable along the normal": (
        lambda: from_callable(PLANE, lambda x: x * 0 + (0, 0, 1), **WINDOW),
        "directions: no direction along the surface at x = [0.0, 0.0, 0.0]",
    ),
    "callable that does not know": (
        lambda: from_callable(PLANE, lambda x: x * np.nan, **WINDOW),
        "directions: no direction along the surface at x = [0.0, 0.0, 0.0]",
    ),
    "callable that fails": (
        lambda: from_callable(PLANE, lambda x: x / "2", **WINDOW),
        "f: the function failed: test_anisotropy_errors.py, line",
    ),
    "callable of words": (
        lambda: from_callable(PLANE, lambda x: "along", **WINDOW),
        "directions: 'along' given, an array of real numbers needed",
    ),
    "map that fails": (
        lambda: from_reparametrisation(PLANE, lambda xi: xi / "2", **WINDOW),
        "jacobian: the function failed: test_anisotropy_errors.py, line",
    ),
    "map of another shape": (
        lambda: from_reparametrisation(PLANE, lambda xi: np.eye(2), **WINDOW),
        "jacobian: an array of shape (2, 2) for 25 positions given, (25, 2, 2) needed",
    ),
    "singular map": (
        lambda: from_reparametrisation(PLANE, lambda xi: np.zeros((len(xi), 2, 2)), **WINDOW),
        "jacobian: singular at xi = [0.0, 0.0]",
    ),
    "indefinite": (lambda: tensor(PLANE, [[0, 0]], MARKS, (1, -2)), "eigenvalues: (1, -2) given"),
    "placement": (
        lambda: tensor(PLANE, [[0, 0]], MARKS, (1, 2), "up"),
        "placement: 'up' given, allowed",
    ),
    "placement of a derivative": (
        lambda: tensor_derivative(PLANE, [[0, 0]], MARKS, (1, 2), "mixed"),
        "placement: 'mixed' given, allowed: co, contra",
    ),
    "basis off the plane": (
        lambda: tensor(PLANE, [[0, 0]], MARKS, (1, 2), basis=[[1, 0, 0], [0, 1, 1]]),
        "basis: two independent vectors of the tangent plane needed",
    ),
    "friction of zero": (
        lambda: Friction(coefficients=(0.3, 0.0), directions=MARKS),
        "friction.coefficients: 0.3 and 0 given, the yield ellipse needs both > 0, or both 0",
    ),
    "no adhesion": (
        lambda: Adhesion(stiffness=(-1, 1), directions=MARKS),
        "stiffness: (-1, 1) given",
    ),
    "word of another argument": (
        lambda: Adhesion(stiffness=1, direction=MARKS),
        "direction: adhesion model 'elastic' has no parameter 'direction', allowed: directions, "
        "directions_on, stiffness; did you mean 'directions'?",
    ),
    "one surface of two": (
        lambda: Friction(model="he-curnier", alpha=(0.2, 0.1, 0.1), directions=MARKS),
        "friction.directions_second: missing; friction model 'he-curnier' needs",
    ),
    "two surfaces of one": (
        lambda: Friction(coefficients=(0.3, 0.1), directions=MARKS, directions_second=MARKS),
        "friction.directions_second: given, but friction model 'orthotropic' has one",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_one_line_that_names_the_entry(case: str) -> None:
    make, line = CASES[case]
    with pytest.raises(InputError) as caught:
        make()
    said = str(caught.value)
    assert line in said and said.startswith((line, "kind: " + line))
    assert "\n" not in said and len(said) < 250


def test_axis_is_written_as_two_vectors_or_flat() -> None:
    """A case file hands on six numbers, a script two vectors; both are the same field."""
    xi = [[1.0, 2.0]]
    first = make_directions("polar", axis=((0.5, -2, 0), (0, 0, 1))).axes(PLANE, xi)[0]
    second = make_directions("polar", axis=(0.5, -2, 0, 0, 0, 1)).axes(PLANE, xi)[0]
    assert np.array_equal(first, second)
