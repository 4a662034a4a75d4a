"""Levels of the iterative strategy: what they keep, and where they are of no use.

Requirement: the same answers as `direct`, an independent way to solve the same equations, to 1e-7
of their size as in `test_fe_iterative.py`, whatever the levels are made of; what a test asks for
beside that stands with it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import scipy.sparse
from tests.verification.test_fe_iterative import (
    CLAMP,
    DRAG,
    PRESS,
    _counts,
    _pair,
    _run,
    _same,
)

from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.solver import Problem, Step
from anisocontact.solver.strategies.iterative import (
    factor,
    levels,
    multilevel_inverse,
    newton,
    single_rows,
)


@pytest.mark.parametrize("case", ["linear", "finite strain", "held by contact", "slave nodes"])
def test_every_level(monkeypatch: pytest.MonkeyPatch, case: str) -> None:
    """Aggregates of aggregates down to the last, where a factor of the second level would do.

    Requirement: the same answers, at most half as many iterations more than two levels take.
    """
    rubber = {"model": "neo-hookean", "E": 1000.0, "nu": 0.3}
    pressed = Step("press", 2, CLAMP, {"block.top": {"z": -10.0}})
    makes: dict[str, tuple[Callable[[], Problem], Step]] = {
        "linear": (lambda: _pair(4), PRESS),
        "finite strain": (lambda: _pair(4, material=rubber), PRESS),
        "held by contact": (lambda: _pair(4), pressed),
        "slave nodes": (lambda: _pair(4, mortar=True), PRESS),
    }
    make, step = makes[case]
    steps = [step, Step("drag", 1, {"block.top": {"x": 0.005}})]
    two = _same(make, steps)
    monkeypatch.setattr(levels, "FEW", 0)
    monkeypatch.setattr(levels, "MANY", 0.0)
    monkeypatch.setitem(newton.DEFAULTS, "aggregates_pc_gamg_coarse_eq_limit", 10)
    all_levels = _same(make, steps)
    assert sum("3 levels: " in note or "4 levels: " in note for note in all_levels) > 0
    assert _counts(all_levels)[0] < 1.5 * _counts(two)[0]


def test_cycle_of_a_coarse_level(monkeypatch: pytest.MonkeyPatch) -> None:
    """A cycle B with the same smoothing before and after, of a symmetric matrix A and of 2 A.

    Requirement: `x B y = y B x`, as of any such cycle; B of 2 A is half of that of A, with all that
    is kept of the bodies renewed. Tolerance: 1e-4, a factor in single precision.
    """
    made: list[multilevel_inverse.MultilevelInverse] = []
    right = multilevel_inverse.MultilevelInverse.renew

    def seen(self: multilevel_inverse.MultilevelInverse, *given: Any) -> bool:
        made.append(self)
        return right(self, *given)

    monkeypatch.setattr(multilevel_inverse.MultilevelInverse, "renew", seen)
    monkeypatch.setattr(levels, "FEW", 0)
    monkeypatch.setattr(levels, "MANY", 0.0)
    monkeypatch.setitem(newton.DEFAULTS, "aggregates_pc_gamg_coarse_eq_limit", 10)
    monkeypatch.setattr(multilevel_inverse.MultilevelInverse, "destroy", lambda self: None)
    _run(_pair(4), [PRESS], "iterative")
    cycle, matrix = made[-1], made[-1]._matrix.copy()
    matrix.axpy(1.0, matrix.copy().transpose())
    (x, y), answers = matrix.createVecs(), []
    x.array[:], y.array[:] = np.random.default_rng(3).normal(size=(2, len(x.array)))
    for _ in range(2):
        assert right(cycle, matrix, False, True)
        answers.append([cycle.solve(one).copy() for one in (x, y)])
        matrix.scale(2.0)
    (of_x, of_y), (half, _) = answers
    size = abs(x.dot(of_x))
    assert abs(x.dot(of_y) - y.dot(of_x)) < 1e-4 * size
    assert (half * 2.0 - of_x).norm() < 1e-4 * of_x.norm()


def test_a_coarse_factor_in_single_precision_that_is_not_enough(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where it does not find a known solution all later factors are in double precision.

    Requirement: with one of no use the same answers and counts; it is said once. Without that
    nothing is said: single precision does for a penalty of 1e5, a hundred times the stiffness.
    """
    told = "the factor of the coarse level is in double precision from now on"
    usual = _same(_pair, [PRESS])
    assert told not in usual
    monkeypatch.setattr(factor, "TRUSTED", 0.0)
    notes = _same(_pair, [PRESS])
    assert notes.count(told) == 1
    assert _counts(notes) == _counts(usual)


def test_products_in_single_precision_that_are_not_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where they are too far from those in double precision these take their place.

    Requirement: with none that is near enough the same answers, and counts within one; it is said
    once. Without that nothing is said.
    """
    told = "products with the interior are in double precision from now on"
    usual = _same(_pair, [PRESS])
    assert told not in usual
    monkeypatch.setattr(single_rows, "TRUSTED", 0.0)
    notes = _same(_pair, [PRESS])
    assert notes.count(told) == 1
    assert abs(_counts(notes)[1] - _counts(usual)[1]) <= 1


def test_motions_of_aggregates_that_depend_on_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """A coarse level with two motions that are one: nothing but their difference is undetermined.

    Requirement: no increment is cut, answers and Krylov iterations are those of a coarse level
    without the second one, as both span the same. Aggregates of few nodes beside tied or prescribed
    ones have such motions, and whether the factorisation notices is a matter of rounding.
    """
    usual = _counts(_same(_pair, [PRESS]))
    made = levels.smoothed

    def twice(*args: Any) -> Mat:
        starts, columns, values = (prolong := made(*args)).getValuesCSR()
        matrix = scipy.sparse.csr_array((values, columns, starts), prolong.getSize())
        both = scipy.sparse.csr_array(scipy.sparse.hstack([matrix, matrix[:, :1]]))
        return PETSc.Mat().createAIJ(both.shape, csr=(both.indptr, both.indices, both.data))

    monkeypatch.setattr(levels, "smoothed", twice)
    mean, most = _counts(_same(_pair, [PRESS]))
    assert most <= usual[1] + 1
    assert mean <= usual[0] + 0.5


def _renewals(monkeypatch: pytest.MonkeyPatch) -> list[Mat]:
    """Tangents from which levels take bodies, as they come."""
    taken: list[Mat] = []
    renew = levels.Levels._renew

    def seen(self: levels.Levels, tangent: Mat) -> None:
        taken.append(tangent)
        renew(self, tangent)

    monkeypatch.setattr(levels.Levels, "_renew", seen)
    return taken


def test_bodies_of_an_earlier_tangent(monkeypatch: pytest.MonkeyPatch) -> None:
    """Levels with the bodies of an earlier tangent while corrections are found as fast with them.

    Requirement: the same answers and corrections, with half of the tangents taken at most and two
    Krylov iterations more than with the bodies of now, far from equilibrium, too.
    """
    rubber = {"model": "neo-hookean", "E": 1000.0, "nu": 0.3}
    far = Step("press", 1, {**CLAMP, "block.top": {"x": 0.0, "y": 0.0, "z": -0.15}})
    taken = _renewals(monkeypatch)
    ours, notes, u = _run(_pair(6, material=rubber), [far, DRAG], "iterative")
    lagging = len(taken)
    monkeypatch.setattr(newton, "FAR", 0.0)
    theirs, exact, their_u = _run(_pair(6, material=rubber), [far, DRAG], "iterative")
    assert lagging <= 0.5 * (len(taken) - lagging)
    assert [a.iterations for a in ours] == [a.iterations for a in theirs]
    assert _counts(notes)[1] <= _counts(exact)[1] + 2
    assert np.abs(u - their_u).max() < 1e-9 * np.abs(their_u).max()


def test_bodies_of_an_earlier_tangent_that_lead_nowhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bodies of now take their place, and no factor of all unknowns; the same answers."""
    monkeypatch.setattr(newton, "FAR", np.inf)
    monkeypatch.setitem(newton.DEFAULTS, "ksp_max_it", 20)
    rubber = {"model": "neo-hookean", "E": 1000.0, "nu": 0.3}
    far = Step("press", 1, {**CLAMP, "block.top": {"x": 0.0, "y": 0.0, "z": -0.15}})
    notes = _same(lambda: _pair(6, material=rubber), [far, DRAG])
    assert _counts(notes)[1] == 20
    assert not any("factorised" in note for note in notes)
