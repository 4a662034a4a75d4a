"""Functions of the user's that a run calls, measures of events and output quantities: one line."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.bulk import LinearElastic
from anisocontact.cli import main
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.results import quantities, register_quantity
from anisocontact.solver import Problem, Solver, Step, Until
from anisocontact.surfaces import make_surface

#: What is returned that is no number, or nothing; and what is said of it.
NONE = {
    "nothing": (None, "real numbers"),
    "text": ("1.5", "real numbers"),
    "complex": (1j, "real numbers"),
    "table": ([{}], "real numbers"),
    "ragged": ([[1], [2, 3]], "real numbers"),
}


def _fails():
    raise RuntimeError("two\nlines")


@pytest.fixture
def pressed():
    """Runs a step that is to end where a function says so."""

    def run(measure):
        model = build_box({"pad": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        contact = Contact(model, "pad.bottom", plane, Friction(coefficients=0.3))
        problem = Problem(model, {"pad": LinearElastic(E=100.0, nu=0.3)}, [contact])
        until = Until(measure=measure, value=5.0, name="load")
        down = {"pad.top": {"x": 0, "y": 0, "z": -0.01}}
        steps = [Step("press", 3, displacement=down, until=until)]
        return len(list(Solver(problem, steps).run()))

    return run


@pytest.mark.parametrize("late", [False, True])
@pytest.mark.parametrize(
    ("answer", "said"),
    [
        *NONE.values(),
        (float("nan"), "returned nan, a finite number"),
        (-np.inf, "returned -inf, a finite number"),
        (np.zeros(1), r"shape \(1,\), \(\) needed"),
    ],
)
def test_a_measure_that_returns_no_number(pressed, answer, said, late):
    """Requirement: before the run or in it, with step and measure; NaN is no event that waits."""
    calls = []

    def measure(problem, trial):
        calls.append(trial)
        return answer if not late or len(calls) > 4 else 0.0

    with pytest.raises(InputError, match=rf"^step 'press'\.until\.measure: load .*{said}"):
        pressed(measure)


def test_a_measure_that_fails(pressed):
    """Requirement: file and line of what failed; what is a line already is left as it is."""
    said = r"^step 'press'\.until\.measure: load failed: test_callbacks\.py, line \d+: "
    with pytest.raises(InputError, match=said + "RuntimeError: two lines$"):
        pressed(lambda problem, trial: _fails())

    def refuses(problem, trial):
        raise InputError("none", "mine")

    with pytest.raises(InputError, match=r"^mine: none$"):
        pressed(refuses)


def test_what_a_script_draws_is_read_only():
    """Requirement: pressures scaled in place for a picture are an error, no other solution."""
    model = build_box({"pad": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = Contact(model, "pad.bottom", plane, Friction(coefficients=0.3))
    problem = Problem(model, {"pad": LinearElastic(E=100.0, nu=0.3)}, [contact])
    down = {"pad.top": {"x": 0, "y": 0, "z": -0.01}}
    for _ in Solver(problem, [Step("press", 2, displacement=down)]).run():
        last = contact.last
        given = [last.pressure, last.gap, last.traction, last.normal, last.state, problem.nodal]
        given += [contact.areas, contact.points]
        for values in (*given, last.directions_friction, contact.state["pressure"]):
            with pytest.raises(ValueError, match="read-only"):
                values[:] = 0.0
        assert last.pressure.copy().max() > 0.0


@pytest.fixture
def quantity(tmp_path, unpictured, capsys, monkeypatch):
    """Runs a case with an output quantity; its exit code, and the last line it has written."""
    monkeypatch.setattr(quantities, "_TABLE", dict(quantities._TABLE))
    case = tmp_path / "case.toml"
    case.write_text(unpictured)

    def run(at, values):
        register_quantity("mine", at, "1", "mine")(values)
        code = main(["run", str(case), "-o", str(tmp_path / "out")])
        return code, capsys.readouterr().err.splitlines()[-1:]

    return run


@pytest.mark.parametrize(
    ("wrong", "at"),
    [
        *((wrong, "contact") for wrong in [*NONE, "fails", "too many axes"]),
        *(("ragged", at) for at in ("slave point", "node", "cell", "patch")),
    ],
)
def test_a_quantity_that_is_none(quantity, at, wrong):
    """Requirement: one line with its name, no internal error; one place looks at answers."""
    answer, said = NONE.get(wrong, (np.zeros((1, 1, 1)), "an array of shape (1, 1, 1) returned"))
    if wrong == "fails":
        code, (line,) = quantity(at, lambda of: _fails())
        said = "failed: test_callbacks.py"
    else:
        code, (line,) = quantity(at, lambda of: answer)
    assert code == 2
    assert line.startswith(f"error: quantity 'mine' of a {at}")
    assert said in line


@pytest.mark.parametrize("at", ["slave point", "node", "cell", "patch"])
@pytest.mark.parametrize(
    "of",
    [
        lambda n: np.zeros(n + 1),
        lambda n: np.zeros((n, 0)),
        lambda n: np.zeros((n, 1, 1)),
        lambda n: 0,
    ],
)
def test_a_quantity_of_another_number_of_rows(quantity, at, of):
    """Requirement: rows that are not those of the file are refused; it could not be read."""

    def rows(part):
        return of(len(part.displacement if at == "node" else part.numbers))

    code, (line,) = quantity(at, rows)
    assert code == 2
    assert line.startswith(f"error: quantity 'mine' of a {at}: an array of shape (")
    assert line.endswith(", k) needed")


def test_quantities_of_other_numbers(quantity, tmp_path):
    """Requirement: flags and whole numbers are numbers."""
    code, _ = quantity("slave point", lambda points: points.last.pressure > 0.0)
    assert code == 0
    last = max((tmp_path / "out" / "contact").iterdir())
    assert b'Name="mine"' in last.read_bytes()
