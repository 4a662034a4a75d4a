"""Iterative strategy: choice, options, failure."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.solver import Problem, Solver, Step, StoppedError
from anisocontact.solver.strategies import costs, direct
from anisocontact.solver.strategies.choice import Choice, choose
from anisocontact.solver.strategies.costs import factor_bytes
from anisocontact.solver.strategies.iterative import levels, newton, strategy
from anisocontact.solver.strategies.iterative.newton import IterativeNewton
from anisocontact.solver.strategies.strategy import Task

PRESS = Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
RUBBER = {"model": "neo-hookean", "E": 1000.0, "nu": 0.3}
RUBBER_CELLS = {"model": "neo-hookean-incompressible", "E": 1000.0}


def _problem(**material: Any) -> Problem:
    from anisocontact.bulk import make_material
    from anisocontact.contact import Contact
    from anisocontact.interface import Interface
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.surfaces import make_surface

    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (4, 4, 6))})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    laws = (
        NormalLaw(penalty=1e4),
        Adhesion(stiffness=(1e4, 1e4)),
        Friction(coefficients=(0.3, 0.3)),
    )
    contact = Contact(model, "block.bottom", Interface(plane, *laws), mortar=False)
    given = {"model": "linear-elastic", "E": 1000.0, "nu": 0.3} | material
    return Problem(model, {"block": make_material(**given)}, [contact])


def _choice(problem: Problem, **options: Any) -> Choice:
    return choose("auto", Task(problem, [PRESS], "none_", options))


def test_auto_takes_it_beyond_a_number_of_unknowns(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = _problem(**RUBBER)
    assert _choice(problem).name == "direct"
    monkeypatch.setattr(direct, "MOST_FACTORISED", 100)
    choice = _choice(problem)
    assert choice.name == "iterative"
    assert choice.reason == (
        "525 unknowns, more than 100: Krylov iterations are faster; "
        "not condensed: 525 unknowns: a factorisation costs no more than iterations"
    )


def test_auto_factorises_meshes_of_two_dimensions(monkeypatch: pytest.MonkeyPatch) -> None:
    """However many unknowns: their factors are small."""
    from anisocontact.bulk import make_material
    from anisocontact.mesh import Body, PlaneStrain, build_mesh, make_shape

    shape = make_shape("rectangle", origin=(0.0, 0.0), size=(2.0, 1.0), cells=(8, 8))
    model = build_mesh([Body("block", shape)], idealisation=PlaneStrain())
    problem = Problem(model, {"block": make_material(**RUBBER)})
    monkeypatch.setattr(direct, "MOST_FACTORISED", 100)
    assert problem.unknowns > 100
    assert _choice(problem).name == "direct"


def test_auto_takes_it_where_a_factor_does_not_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    """A factor of 525 unknowns needs 1.5 MB."""
    assert 1e6 < factor_bytes(525) < 2e6
    problem = _problem(**RUBBER)
    monkeypatch.setattr(costs, "free_memory", lambda: 2e6)
    assert _choice(problem).name == "iterative"
    monkeypatch.setattr(costs, "free_memory", lambda: 4e6)
    assert _choice(problem).name == "direct"


@pytest.mark.parametrize(("nu", "taken"), [(0.499, "iterative"), (0.4999, "direct")])
def test_auto_factorises_bodies_that_keep_their_volume(
    monkeypatch: pytest.MonkeyPatch, nu: float, taken: str
) -> None:
    """Iterations grow as the root of the bulk modulus over the shear modulus."""
    monkeypatch.setattr(direct, "MOST_FACTORISED", 100)
    assert _choice(_problem(**RUBBER_CELLS, nu=nu)).name == taken


def test_auto_leaves_the_choice_to_options(monkeypatch: pytest.MonkeyPatch) -> None:
    """A linear solver that the user asks for is one of the whole system."""
    monkeypatch.setattr(direct, "MOST_FACTORISED", 100)
    assert _choice(_problem(**RUBBER), pc_type="cholesky").name == "direct"


def test_auto_stays_where_most_would_be_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """75 of 525 unknowns can be touched."""
    monkeypatch.setattr(direct, "MOST_FACTORISED", 100)
    monkeypatch.setattr(strategy, "MOST_KEPT", 0.14)
    assert _choice(_problem(**RUBBER)).name == "direct"


def test_options_reach_the_krylov_method() -> None:
    """One iteration to 1e-14 is not possible: cut with the reason, then a line about `direct`."""
    problem = _problem()
    notes: list[str] = []
    options = {"ksp_rtol": 1e-14, "ksp_max_it": 2}
    solver = Solver(problem, [PRESS], options=options, strategy="iterative")
    with pytest.raises(StoppedError, match="the Krylov method did not converge in 2 iterations"):
        list(solver.run(on_note=notes.append))
    assert sum('take the strategy "direct"' in note for note in notes) == 1


def test_levels_that_lead_nowhere_are_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Requirement: a line says so, nothing is cut and forces are those of `direct`, to 1e-6.

    Source: a factorisation, an independent way. Tolerance: what Newton's method leaves.
    """
    (theirs,) = Solver(_problem(), [PRESS], strategy="direct").run()
    (name,) = theirs.resultants
    monkeypatch.setitem(newton.DEFAULTS, "ksp_max_it", 3)
    notes: list[str] = []
    (ours,) = Solver(_problem(), [PRESS], strategy="iterative").run(on_note=notes.append)
    assert ours.done == theirs.done == 1.0
    force = theirs.resultants[name][0]
    assert ours.resultants[name][0] == pytest.approx(force, rel=1e-6, abs=1e-6 * max(abs(force)))
    assert sum("all unknowns are factorised from now on" in note for note in notes) == 1
    assert notes[-1].endswith("at most 3")


@pytest.mark.parametrize(("room", "told"), [(True, 1), (False, 0)])
def test_levels_stay_where_there_is_no_room(
    monkeypatch: pytest.MonkeyPatch, room: bool, told: int
) -> None:
    """For a factor of all unknowns: the solution fails for the reason that it has."""
    monkeypatch.setitem(newton.DEFAULTS, "ksp_max_it", 3)
    monkeypatch.setattr(levels, "too_large", lambda *_: iter([] if room else ["no room"]))
    problem, notes = _problem(), list[str]()
    own = IterativeNewton(problem, [PRESS], "room_", {}, lambda *_: None, notes.append)
    problem.begin(PRESS)
    problem.set_load_factor(1.0, 1.0)
    result = own.solve(problem.accepted())
    assert result.reason == ("" if room else "the Krylov method did not converge in 3 iterations")
    assert sum("all unknowns are factorised" in note for note in notes) == told


def test_another_preconditioner() -> None:
    """The user's preconditioner replaces both levels."""
    problem = _problem()
    notes: list[str] = []
    newton = IterativeNewton(
        problem, [PRESS], "another_", {"pc_type": "jacobi"}, lambda *_: None, notes.append
    )
    problem.begin(PRESS)
    problem.set_load_factor(1.0, 1.0)
    x = problem.accepted()
    assert not newton.solve(x).reason
    newton.close()
    assert not any(" levels: " in note for note in notes)
    assert max(newton.krylov) > 15


def test_the_patch_is_on_the_coarse_level_without_zeros(monkeypatch: pytest.MonkeyPatch) -> None:
    """A row and a column of the patch in P are one entry: more would fill the coarse factor.

    Places of zeros would do so, and rows of the interior beside the patch that are smoothed.
    """
    made: list[Any] = []
    right = levels.smoothed

    def looked(rough: Any, tangent: Any, interior: Any, split: Any) -> Any:
        prolong = right(rough, tangent, interior, split)
        starts, columns, values = prolong.getValuesCSR()
        patch = split.patch.getIndices()
        below = np.bincount(columns)[-len(patch) :]
        made.append((np.diff(starts)[patch], below, values))
        return prolong

    monkeypatch.setattr(levels, "smoothed", looked)
    list(Solver(_problem(), [PRESS], strategy="iterative").run())
    ((entries, below, values),) = made
    assert entries.max() == 1
    assert below.max() == 1
    assert values.all()
