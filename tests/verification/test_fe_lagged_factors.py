"""Strategy `condensed` with bodies that are not linear: when old factors serve and when not.

Requirement: every correction leaves the residual that is asked for, whatever the factor is worth,
and factors are made anew, or all unknowns factorised, where that costs less.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.verification.test_fe_lagged import (
    DRAG,
    HARDLY_COMPRESSIBLE,
    PRESS,
    RUBBER,
    _on_plane,
    _pair,
    _same,
)

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.contact.multiplier_schemes import COMPLIANT, GRADED, USUAL
from anisocontact.laws import Friction
from anisocontact.mesh import Body, PlaneStrain, build_mesh, make_shape
from anisocontact.solver import Problem, Solver, Step
from anisocontact.solver.stepping.attempts import Attempts, _Attempt
from anisocontact.solver.strategies.condensed import (
    bordered,
    interior,
    lagged,
    lagged_newton,
    lagged_preconditioner,
)
from anisocontact.solver.strategies.condensed.factor import singular
from anisocontact.solver.strategies.condensed.lagged import LaggedFactor
from anisocontact.solver.strategies.condensed.lagged_newton import CAREFUL, ROUGH, LaggedNewton
from anisocontact.solver.strategies.forcing import Forcing
from anisocontact.surfaces import make_surface

pytestmark = pytest.mark.skipif(not bordered.reachable(), reason="a PETSc without MUMPS")


def _corrected(
    problem: Problem, factor: LaggedFactor, distortion: float, shear: float = 0.0
) -> tuple[float, float]:
    """Residual of a correction over its right-hand side, what `direct` leaves.

    The state is one of random displacements on top of simple shear, which keeps the volume.
    """
    x, matrix = problem.new_vector(), problem.new_tangent()
    x.array[:] = distortion * np.random.default_rng(5).standard_normal(x.getLocalSize())
    nodes = problem.model.space.tabulate_dof_coordinates()
    x.array[: nodes.size : 3] += shear * nodes[:, 2]
    b = -problem.evaluate(x)
    problem.tangent(x, matrix)
    found = factor.solve(matrix, b, 1e-6)
    assert found is not None
    y, product = matrix.createVecs()
    y.array[:] = found
    matrix.mult(y, product)
    return float(np.linalg.norm(product.array_r - b) / np.linalg.norm(b))


def test_a_worn_factor_is_made_anew() -> None:
    """Cells distorted by a fifth of their size with the factor of the state at rest.

    Requirement: the residual that is asked for, whatever the factor is worth; one more
    factorisation, then none for the same state again; an old factor that leads nowhere is given up
    before the iterations that it is allowed.
    """
    problem = _on_plane()
    problem.predict_contact([PRESS])
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    assert _corrected(problem, factor, 1e-9) < 1e-5
    assert factor.factors == 1
    assert _corrected(problem, factor, 0.05) < 1e-5
    made = factor.factors
    assert factor.krylov[-1] < lagged._PATIENCE
    assert _corrected(problem, factor, 0.05) < 1e-5
    assert factor.factors == made <= 2
    factor.close()


@pytest.mark.parametrize("nu", [0.45, 0.499, 0.4999])
def test_volume_that_is_kept_wears_no_factor(nu: float) -> None:
    """Sheared bodies with the factor of the state at rest.

    Requirement: the residual that is asked for, of the displacements alone, with that factor;
    iterations that hardly grow with nu, from 7 to 11 at a residual at which single precision shows.
    Without the mixed form the factor is given up at 0.499.
    """
    problem = _on_plane(cells=6, material=HARDLY_COMPRESSIBLE | {"nu": nu})
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    assert _corrected(problem, factor, 1e-9) < 1e-6
    assert _corrected(problem, factor, 1e-6, shear=0.1) < 1e-6
    assert factor.factors == 1
    assert factor.krylov[-1] <= 12
    factor.close()


@pytest.mark.parametrize(
    ("material", "count"),
    [(RUBBER, 2), (HARDLY_COMPRESSIBLE, 2), (HARDLY_COMPRESSIBLE | {"nu": 0.4999}, 1)],
    ids=["rubber", "nu = 0.499", "nu = 0.4999"],
)
def test_no_attempt_is_made_twice(material: dict[str, Any], count: int) -> None:
    """Where pressures follow there is no line search: the second attempt would be the first.

    Requirement: from an accepted state, with nothing extrapolated, the ways to go differ.
    """
    problem = _pair(material=material)
    newton: Any = None
    attempts = Attempts(problem, newton, newton, newton)
    x = problem.accepted()
    searching, full = _Attempt(x, full_steps=False), _Attempt(x)
    assert len(attempts._apart(searching, full)) == count
    for start, ways in ((searching, count), (replace(searching, ratio=1.0), 2)):
        found = attempts._ordered(searching=start, full=full, led=USUAL)
        others = [""] * (ways - 1)
        assert [way.detour for way in found] == ["", COMPLIANT, *others, GRADED]


def test_a_factor_that_is_made_again_goes_on_as_the_first_one() -> None:
    """Requirement: a run that goes on finds the same corrections, to the last bit.

    Derivatives of the changes of volume at the state of the factor are kept with it.
    """
    problem = _on_plane(cells=6, material=HARDLY_COMPRESSIBLE)
    problem.set_load_factor(1.0, 1.0)
    first = LaggedFactor(problem, lambda _: None)
    _corrected(problem, first, 1e-9)
    again = LaggedFactor(problem, lambda _: None, first.persistent())
    left = [_corrected(problem, one, 1e-6, shear=0.1) for one in (first, again)]
    assert left[0] == left[1] < 1e-6
    assert again.factors == 0
    assert again.krylov[-1] == first.krylov[-1]
    for one in (first, again):
        one.close()


def test_where_there_is_no_new_factor_the_old_one_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """MUMPS fails at a tangent far from the one that the factor is of.

    Requirement: the factor of before solves, with the iterations that it would have taken.
    """
    problem = _on_plane()
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    for distortion in (1e-9, 1e-3):
        assert _corrected(problem, factor, distortion) < 1e-5
    used = factor.krylov[-1]
    check, failed = interior.Interior._check, list[Any]()

    def fails(of: interior.Interior) -> None:
        failed.append(of)
        if len(failed) == 1:
            raise singular()
        check(of)

    monkeypatch.setattr(interior.Interior, "_check", fails)
    factor._due = True
    assert _corrected(problem, factor, 1e-3) < 1e-5
    assert (len(failed), factor.factors, factor.krylov[-1]) == (2, 1, used)
    factor.close()


def test_couplings_that_are_in_the_border_need_no_new_factor() -> None:
    """Nodes that slide on couple others, all of which contact could couple before.

    Requirement: the factor there is, as its border has room for them; one where a node is not in
    it. A pair of order 2 at slave nodes took 11 factorisations for 32 corrections, now 3.
    """
    problem = _on_plane()
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    assert _corrected(problem, factor, 1e-9) < 1e-5
    factor.outgrow()
    assert _corrected(problem, factor, 1e-9) < 1e-5
    assert factor.factors == 1
    kept = factor._factor
    assert isinstance(kept, lagged_preconditioner.BorderedPreconditioner)
    assert kept._touched is not None
    kept._touched.unknowns = kept._touched.unknowns[3:]
    factor.outgrow()
    assert _corrected(problem, factor, 1e-9) < 1e-5
    assert factor.factors == 2
    factor.close()


def test_a_factor_in_single_precision_that_is_not_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where Krylov iterations do not get along with one, it is made in double precision."""
    asked = []
    make = bordered.BorderedLU

    def made(matrix: Any, border: Any, single: bool) -> Any:
        asked.append(single)
        factor = make(matrix, border, single)
        if single:  # stands for one that is of no use
            monkeypatch.setattr(factor, "solution", lambda b: 0.0 * b)
        return factor

    monkeypatch.setattr(lagged_preconditioner, "BorderedLU", made)
    problem = _on_plane()
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    assert _corrected(problem, factor, 1e-3) < 1e-5
    assert asked == [True, False]
    factor.close()


def test_where_no_kept_factor_serves(monkeypatch: pytest.MonkeyPatch) -> None:
    """A correction to which none leads comes from a factorisation of all unknowns."""
    make = bordered.BorderedLU

    def made(*given: Any) -> Any:
        factor = make(*given)
        monkeypatch.setattr(factor, "solution", lambda b: 0.0 * b)  # of no use
        return factor

    monkeypatch.setattr(lagged_preconditioner, "BorderedLU", made)
    problem = _on_plane()
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    assert _corrected(problem, factor, 1e-3) < 1e-12
    factor.close()


def test_where_a_factorisation_of_all_unknowns_costs_less(monkeypatch: pytest.MonkeyPatch) -> None:
    """Corrections that old factors make dearer are those of `direct`, but for a try now and then.

    Requirement: `condensed` costs hardly more than `direct` where a factorisation costs little, as
    in the plane. Here it is said to cost nothing; the tolerance of forces is that of Newton's
    method. Without it all 10 or so corrections take Krylov iterations; here two do in the
    beginning, and one after every two, four ... that do not.
    """
    made: list[LaggedFactor] = []

    class Free(LaggedFactor):
        _whole_cost = 0.0

        def __init__(self, *given: Any) -> None:
            super().__init__(*given)
            made.append(self)

    monkeypatch.setattr(lagged_newton, "LaggedFactor", Free)
    _same(_pair, [PRESS, DRAG])
    (factor,) = made
    tried = np.array(factor.krylov) > 0
    assert len(tried) > 8
    np.testing.assert_array_equal(tried[:7], [True, True, False, False, True, False, False])


def test_a_correction_after_one_without_gain_is_more_precise() -> None:
    """Corrections are as precise as the theory page says: 1e-3, and 1e-4 where nothing was gained.

    Source: docs/theory/condensation.md; both are the bounds themselves, without rounding. The
    system stands for one far out of balance, whose forces have not fallen by half since.
    """
    problem = _pair()
    problem.evaluation.balance = replace(problem.balance, force_scale=1.0)
    solver = LaggedNewton(problem, "lagged_", {}, lambda *_: None, lambda _: None, {})
    solver._forcing.begin()
    asked = [solver._forcing.rtol(problem, size) for size in (1.0, 0.6, 0.1)]
    solver.close()
    assert asked == [ROUGH, CAREFUL, ROUGH]


def test_a_correction_from_far_off_leaves_less_than_the_forces_at_work() -> None:
    """Forces of an iterate that is far off are no measure of what a correction may leave.

    Requirement: 3e-4 of the smallest forces at work in the increment, or in the one before where
    this one may begin with pressures that mean nothing, of residuals that are 1e5 times these, and
    1e-13 of the residual at least, which rounding allows. Tolerance: rounding.
    """
    forcing, problem = Forcing(1e-8, ROUGH, CAREFUL), _pair()
    problem.evaluation.balance = replace(problem.balance, force_scale=0.0)
    assert forcing.rtol(problem, 1e-1) == ROUGH  # where no force is at work there is no such bound
    problem.evaluation.balance = replace(problem.balance, force_scale=1.0)
    assert forcing.rtol(problem, 1e-1) == ROUGH
    problem.evaluation.balance = replace(problem.balance, force_scale=1e4)
    assert forcing.rtol(problem, 1e5) == pytest.approx(3e-9, rel=1e-12)
    assert forcing.rtol(problem, 1e12) == 1e-13
    forcing.begin(pressed=True)  # forces of pressures that mean nothing are no measure either
    assert forcing.rtol(problem, 1e5) == pytest.approx(3e-9, rel=1e-12)
    forcing.begin()
    assert forcing.rtol(problem, 1e4) == ROUGH


def test_a_tube_that_keeps_its_volume_takes_as_many_iterations_as_direct() -> None:
    """A tube of 69 unknowns is blown up; iterates have pressures of 1e5 times what blows it.

    Requirement: at most 1.15 times the iterations of exact corrections, 8; 10 where the first one
    of an increment is as precise as a share of those pressures. Source: `direct`.
    """

    def iterations(strategy: str) -> int:
        shape = make_shape("annulus", inner=1, outer=2, cells=(2, 3), order=2, end=0.5 * np.pi)
        model = build_mesh([Body("t", shape)], idealisation=PlaneStrain())
        sleeve = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=2.2, inside=True)
        contact = Contact(model, "t.outer", sleeve, Friction(coefficients=0.3))
        rubber = {"t": make_material("neo-hookean-incompressible", E=3.0, nu=0.5)}
        problem = Problem(model, rubber, [contact], symmetry=["t.start", "t.end"])
        blow = Step("blow", 2, pressure={"t.inner": 0.6})
        return sum(one.iterations for one in Solver(problem, [blow], strategy=strategy).run())

    assert iterations("condensed") <= 1.15 * iterations("direct")
