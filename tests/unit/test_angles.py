"""Angles in Python are radian; degrees have a name of their own, and a slip of them is seen."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.laws import Friction
from anisocontact.rigid.body import RigidBody, turns_in_radian
from anisocontact.surfaces import make_surface

X = {"vector": (1, 0, 0)}
AXIS = {"axis": ((0, 0, 0), (0, 0, 1))}
CONE = {"apex": (0, 0, 0), "axis": (0, 0, 1)}
MARKS = make_directions("constant", **X)


def _ellipse(**angle: float) -> Friction:
    given = {"coefficients": 0.3, "sliding_rule": "slip-ellipse", "slip_axes": (2, 1)}
    return Friction(**given, directions=MARKS, **angle)


def _die(**turn: float) -> np.ndarray:
    body = RigidBody("die", (0, 0, 0))
    body.move(**turn)
    return body.trial.turn


MAKERS = {
    "constant": lambda **a: make_directions("constant", **X, **a),
    "polar": lambda **a: make_directions("polar", **AXIS, **a),
    "coordinate-lines": lambda **a: make_directions("coordinate-lines", **a),
    "cone": lambda **a: make_surface("cone", **CONE, **a),
}


@pytest.mark.parametrize("make", MAKERS.values(), ids=list(MAKERS))
def test_degrees_given_as_radian_are_seen(make):
    """`angle=30` is 4.8 turns: one line that says how degrees are written."""
    with pytest.raises(InputError, match=r"^angle: 30 given in radian, .* angle_deg = 30"):
        make(angle=30)
    with pytest.raises(InputError, match=r"given with angle_deg, one of the two"):
        make(angle=0.3, angle_deg=30)
    with pytest.raises(InputError, match=r"^angle_deg: 'x' given"):
        make(angle_deg="x")
    make(angle_deg=30)


def test_degrees_and_radian_give_the_same():
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    found = [
        make_directions("constant", **X, **angle).axes(plane, [[0, 0]])[0].tolist()
        for angle in ({"angle": math.pi / 6}, {"angle_deg": 30}, {"angle": math.radians(30)})
    ]
    assert found[0] == found[1] == found[2]
    assert _ellipse(slip_angle_deg=30).rule[1]["slip_angle"] == (math.radians(30),)
    # more than a turn may be meant where degrees are
    turned = make_directions("constant", **X, angle_deg=390).axes(plane, [[0, 0]])[0]
    assert turned == pytest.approx(np.array(found[0]), abs=1e-14)


def test_turns_of_rigid_bodies():
    assert _die(rz_deg=720.0)[2] == 4.0 * math.pi
    assert turns_in_radian({"rx_deg": None, "y": 2}, "") == {"rx": None, "y": 2}
    with pytest.raises(InputError, match=r"^rx: 30 given in radian, .* rx_deg = 30"):
        _die(rx=30)
    with pytest.raises(InputError, match="given twice, as rx and rx_deg"):
        turns_in_radian({"rx": 0.1, "rx_deg": 3}, "")
    with pytest.raises(InputError, match="slip_angle: 45 given in radian"):
        _ellipse(slip_angle=45)


def test_rotations_shapes_and_steps():
    """Where the finite elements take an angle it is the same."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    from anisocontact.mesh import Rotation, make_shape
    from anisocontact.solver import Step, Turn

    for kind in (Rotation, Turn):
        assert kind((0, 0, 1), angle_deg=90).angle == math.pi / 2
        assert kind((0, 0, 1), angle_deg=90) == kind((0, 0, 1), math.pi / 2)
        with pytest.raises(InputError, match=r"^angle: 30 given in radian, .* angle_deg = 30"):
            kind((0, 0, 1), 30)
        with pytest.raises(InputError, match=r"^angle: missing"):
            kind((0, 0, 1))
    assert Turn((0, 0, 1), angle_deg=3600).angle == 20.0 * math.pi
    ring = {"inner": 1, "outer": 2, "length": 1, "cells": (1, 4, 1)}
    assert make_shape("ring", **ring, end_deg=90).end == math.pi / 2
    assert make_shape("ring", **ring, start_deg=300, end_deg=400).start == math.radians(300)
    for key in ("start", "end"):
        with pytest.raises(InputError, match=rf"^{key}: 90 given in radian"):
            make_shape("ring", **ring, **{key: 90})
    step = Step("turn", 1, motion={"die": {"rz_deg": 90.0, "x": 1.0, "ry_deg": None}})
    assert step.motion["die"] == {"rz": math.pi / 2, "x": 1.0, "ry": None}
    with pytest.raises(InputError, match=r"step 'turn'\.motion\.die\.rz: 90 given in radian"):
        Step("turn", 1, motion={"die": {"rz": 90.0}})


def test_a_shape_takes_one_number_for_a_pair():
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    from anisocontact.mesh import make_shape

    given = {"radius": 1, "length": 1, "cells": (4, 1, 1)}
    assert make_shape("cylinder", **given, ratio=2).ratio == (2.0, 2.0)


def test_an_angle_that_turns_nothing_is_taken() -> None:
    """Angles that scripts compute may be next to nothing, and are no numbers to compute with."""
    assert make_directions("constant", vector=(1, 0, 0), angle=2e-313)
    with pytest.raises(InputError, match=r"angle: 1e\+60 given"):
        make_directions("constant", vector=(1, 0, 0), angle=1e60)


def test_many_turns_in_degrees_stay_what_they_are():
    """Requirement: degrees may be many turns, as the reference of `Turn` says, also in what is made
    of it by `dataclasses.replace`: a step makes its rotations anew, with its duration. Radian that
    is given stays one that is looked at."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    from anisocontact.solver import LoadCurve, Step, Turn

    spin = {"die": {"rz_deg": LoadCurve(lambda t: t, 1080.0)}, "roll": {"ry_deg": 1080.0}}
    step = Step("spin", 40, motion=spin, rotation={"b.top": Turn((0, 0, 1), angle_deg=720.0)})
    for made in (step, replace(step, increments=80), pickle.loads(pickle.dumps(step.rotation))):
        turn = (made if isinstance(made, dict) else made.rotation)["b.top"]
        assert turn.angle == 4.0 * math.pi
    again = replace(step, duration=2.0)
    assert again.motion["roll"]["ry"] == again.motion["die"]["rz"].value == 6.0 * math.pi
    with pytest.raises(InputError, match=r"^angle: 9 given in radian"):
        replace(turn, angle=9.0)
