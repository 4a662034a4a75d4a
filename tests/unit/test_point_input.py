"""What a user can get wrong with the driver, in Python: one line that names the field."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.interface import Interface
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
from anisocontact.point.schedule import Schedule, instants, knot_times
from anisocontact.surfaces import make_surface

PATH = [(0, 0, 0), (1, 0, 0)]


def _interface(shape: str = "plane") -> Interface:
    form = {
        "plane": {"point": (0, 0, 0), "normal": (0, 0, 1)},
        "sphere": {"centre": (0, 0, 0), "radius": 1.0},
    }[shape]
    return Interface(
        make_surface(shape, **form),
        NormalLaw(penalty=1e5),
        Adhesion(stiffness=(1e5, 1e5)),
        Friction(coefficients=(0.3, 0.3)),
    )


@pytest.mark.parametrize(
    ("make", "line"),
    [
        (lambda: PrescribedPath(PATH, pressure=1.0, gap=-1.0), "pressure: given with a gap"),
        (lambda: PrescribedPath([(0, 0), (1, 0)]), "pressure: missing"),
        (lambda: Push((1, 0, 0), [0, 1], (0, 0)), "pressure: missing"),
        (
            lambda: PrescribedPath(PATH, pressure=[1.0, 2.0, 3.0]),
            "pressure: an array of shape (3,)",
        ),
        (lambda: PrescribedPath(PATH, pressure=np.nan), "pressure: a number that is not finite"),
        (
            lambda: PrescribedPath([("a", 0), (1, 0)], pressure=1.0),
            "path: [('a', 0), (1, 0)] given, an array of numbers",
        ),
        (lambda: PrescribedPath([(0, 0, 0)], pressure=1.0), "times: missing"),
        (lambda: PrescribedPath(lambda t: (t, 0, 0), pressure=1.0), "times: missing"),
        (lambda: PrescribedPath(PATH, pressure=1.0, times=[0, 0]), "times: [0.0, 0.0] given"),
        (
            lambda: PrescribedPath(PATH, pressure=1.0, times=[0]),
            "times: [0.0] given, two or more finite",
        ),
        (lambda: PrescribedPath(PATH, pressure=1.0, increments=0), "increments: 0 given"),
        (lambda: PrescribedPath(PATH, pressure=1.0, increments=1.5), "increments: 1.5 given"),
        (lambda: PrescribedPath(PATH, pressure=1.0, increments=[1, 2]), "increments: 2 given"),
        (lambda: PrescribedPath(PATH, pressure=1.0, increments=True), "increments: True given"),
        (lambda: DraggingSpring(PATH, -1.0), "stiffness: -1.0 given"),
        (lambda: DraggingSpring(PATH, [1.0, 2.0]), "stiffness: one number, three"),
        (lambda: DraggingSpring(PATH, 1.0, start=(0,)), "start: (0,) given"),
        (lambda: DeadLoad(PATH, (0, 0), frame="here", pressure=1.0), "frame: 'here' given"),
        (lambda: DeadLoad(PATH, (0, 0), frame="friction", pressure=1.0), "force: an array"),
        (lambda: DeadLoad(PATH, (0, 0), viscosity=0.0, pressure=1.0), "viscosity: 0.0 given"),
        (lambda: Push((1, 0), [0, 1], (0, 0), pressure=1.0), "direction: an array of shape (2,)"),
        (lambda: Group([1.0, 2.0, 3.0, 4.0]), "offsets: an array of shape (4,)"),
        (lambda: Group([(0, 0, 0)], areas=[1.0, 2.0]), "areas: [1.0, 2.0] given"),
        (lambda: Group([(0, 0, 0)], areas=0.0), "areas: 0.0 given"),
        (
            lambda: PrescribedPath([(0, 1e60, 0), (1, 0, 0)], pressure=1.0),
            "path: up to 1e+60 given, must be 0, or from 1e-50 to 1e+50 in size",
        ),
        (lambda: PrescribedPath([(0, 0, 0), (1e-60, 0, 0)], pressure=1.0), "path: up to 1e-60"),
        (lambda: PrescribedPath(PATH, pressure=1e60), "pressure: up to 1e+60 given"),
        (lambda: PrescribedPath(PATH, gap=[-1e60, 0.0]), "gap: up to 1e+60 given"),
        (lambda: PrescribedPath(PATH, gap=0.0, times=[0, 1e60]), "times: up to 1e+60 given"),
        (lambda: PrescribedPath(PATH, gap=0.0, times=[1e60, 1e60 + 1e46]), "times: up to 1e+60"),
        (
            lambda: PrescribedPath([*PATH, (2, 0, 0)], gap=0.0, times=[0, 1e-60, 1.0]),
            "times: up to 1e-60 given, must be from 1e-50",
        ),
        (lambda: DraggingSpring(PATH, 1e60), "stiffness: up to 1e+60 given, must be from 1e-50"),
        (lambda: DraggingSpring(PATH, 1.0, start=(1e60, 0, 0)), "start: up to 1e+60 given"),
        (lambda: DeadLoad(PATH, (0, 0), viscosity=1e60, pressure=1.0), "viscosity: up to 1e+60"),
        (lambda: Group([(0, 1e60)]), "offsets: up to 1e+60 given"),
        (lambda: Group([(0, np.nan)]), "offsets: [(0, nan)] given, finite numbers are needed"),
        (lambda: Group(areas=1e60), "areas: up to 1e+60 given, must be from 1e-50"),
        (lambda: Group(orientation="loose"), "orientation: 'loose' given"),
        (lambda: Group(orientation="free"), "orientation: a free orientation needs"),
    ],
)
def test_one_line_names_the_field(make: Callable[[], object], line: str) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert str(caught.value).startswith(line)
    assert "\n" not in str(caught.value)


def test_function_of_another_shape() -> None:
    load = PrescribedPath(lambda t: (t, 0.0), times=[0, 1], pressure=1.0)
    assert load.start(make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))).shape == (3,)
    wrong = PrescribedPath(lambda t: t, times=[0, 1], pressure=1.0)
    with pytest.raises(InputError, match="path: the function gives an array of shape"):
        drive(_interface(), wrong)


def test_numbers_count_by_the_largest_of_their_history() -> None:
    """A path may begin a rounding from zero, and what a function gives may come near it."""
    PrescribedPath([(1e-60, 0, 0), (1, 0, 0)], pressure=[0.0, 1.0])
    near = PrescribedPath(lambda t: (1e-60 * t, 0.0, 0.0), times=[0, 1], pressure=1.0)
    assert near.path(1.0)[0] == 1e-60
    far = PrescribedPath(lambda t: (1e60 * t, 0.0, 0.0), times=[0, 1], pressure=1.0)
    with pytest.raises(InputError, match=r"path: the function gives \[1e\+60, 0.0, 0.0\] at"):
        far.path(1.0)


@pytest.mark.filterwarnings("error")
def test_a_law_whose_tangent_is_not_finite_stops_the_drive() -> None:
    """Stiffnesses that products of overflow: a line, and the steps before it, as of any stop."""
    marks = make_directions("constant", vector=(1, 0, 0), angle=np.radians(30))
    interface = Interface(
        make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)),
        NormalLaw(penalty=1e5),
        Adhesion(stiffness=(2e5, 1e49), directions=marks),
        Friction(coefficients=(0.3, 0.1), directions=marks),
    )
    path = PrescribedPath([(0, 0, 0), (4e-4, 0, 0)], pressure=10.0, increments=80)
    with pytest.raises(StoppedError, match=r"in step 1, .*tangent is not finite; stiffnesses may"):
        drive(interface, path)


def test_a_push_of_a_point_that_nothing_presses_says_so() -> None:
    """No force moves it along: the stop said a residual of 1e-21 beside forces of 0, no more."""
    push = Push((0.866, 0.5, 0), travel=[0, 1e-3], start=(0, 0, 0), pressure=0.0, increments=20)
    with pytest.raises(StoppedError, match="no forces: nothing presses the point, a pressure"):
        drive(_interface(), push)


def test_load_that_does_not_fit_the_surface() -> None:
    """A start without a closest point is bad input; a path into it stops the drive."""
    with pytest.raises(InputError, match="load: it begins at"):
        drive(_interface("sphere"), PrescribedPath([(0, 0, 0), (1, 0, 0)], pressure=1.0))
    into = PrescribedPath([(1, 0, 0), (-1, 0, 0)], pressure=1.0, increments=4)
    with pytest.raises(StoppedError, match=r"stopped in step 2, at time 0\.5: path: no point"):
        drive(_interface("sphere"), into)


def test_frame_of_a_law_needs_contact() -> None:
    load = Push((1, 0), [0, 1], (0, 0), frame="friction", pressure=[0.0, 1.0])
    with pytest.raises(InputError, match="frame: the friction axes are needed at time 0"):
        drive(_interface(), load)
    dead = DeadLoad([(0, 0, 0), (1, 0, 0)], (0, 0), pressure=[0.0, 1.0])
    with pytest.raises(InputError, match="viscosity: missing"):
        drive(_interface(), dead)


def test_schedule_is_exact_at_its_knots() -> None:
    """The end of a segment is the knot, to the last digit; constants and functions as given."""
    times = np.array([0.0, 0.1, 0.7])
    knots = [[0.1, 0.2, 0.3], [1.1, 1.7, -2.3], [0.3, 0.3, 7.7]]
    schedule = Schedule(knots, times, (3,), "path")
    for t, knot in zip(times, knots, strict=True):
        assert schedule(t).tolist() == knot
    assert Schedule(4.0, times, (0,), "gap")(0.3) == 4.0
    assert Schedule([1.0, 2.0, 3.0], times, (3,), "d")(0.3).tolist() == [1.0, 2.0, 3.0]
    assert Schedule(lambda t: 2 * t, times, (0,), "gap")(0.3) == 0.6


def test_instants_hit_the_knots() -> None:
    times = knot_times([0.0, 0.3, 1.0], None)
    found = instants(times, [3, 2])
    assert len(found) == 6
    assert found[3] == 0.3 and found[-1] == 1.0


def test_history_round_trip(tmp_path: object) -> None:
    """The table is written as it is: every number reads back the same."""
    history = drive(_interface(), PrescribedPath(PATH, pressure=10.0, increments=3))
    path = f"{tmp_path}/trace.csv"
    history.to_csv(path)
    columns = history.to_dict()
    read = np.genfromtxt(path, delimiter=",", names=True, dtype=None, deletechars="", encoding=None)
    assert len(read) == 4
    for name in ("traction.x", "energy.residual", "position.z", "slip_contra.1"):
        assert read[name].tolist() == columns[name].tolist()
    assert read["status"].tolist() == ["stick", "slip", "slip", "slip"]
    assert history.summary()["points"] == {"open": 0, "stick": 0, "slip": 1}
