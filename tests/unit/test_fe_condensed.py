"""Condensed strategy: pieces, choice and refusals."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
import scipy.sparse
from tests.unit.condensed_samples import condensation, matrix_of

from anisocontact.solver import Solver, Step
from anisocontact.solver.strategies.condensed import pardiso
from anisocontact.solver.strategies.condensed.eliminate import WAYS
from anisocontact.solver.strategies.condensed.kept_factor import KeptFactor
from anisocontact.solver.strategies.condensed.krylov import gmres
from anisocontact.solver.strategies.condensed.patterns import InteriorState, Patterns
from anisocontact.solver.strategies.iterative.factor import Factor
from anisocontact.solver.terms.term import SingularError

PRESS = Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})


def _schur(a: np.ndarray, border: np.ndarray, inside: np.ndarray) -> np.ndarray:
    coupling = a[np.ix_(inside, border)]
    return a[np.ix_(border, border)] - coupling.T @ np.linalg.solve(
        a[np.ix_(inside, inside)], coupling
    )


@pytest.fixture(params=WAYS, ids=[name for name, _, _ in WAYS])
def way(request: pytest.FixtureRequest) -> Any:
    """Each way to eliminate an interior that is there."""
    name, there, way = request.param
    if not there():
        pytest.skip(f"no {name}")
    return way


def test_partial_factor(way: Any) -> None:
    matrix, border = matrix_of(40), np.array([3, 7, 8, 20, 33])
    inside = np.setdiff1d(np.arange(40), border)
    dense = matrix.toarray()
    factor = way(matrix, border)
    np.testing.assert_allclose(factor.schur, _schur(dense, border, inside), atol=1e-13)
    assert np.array_equal(factor.schur, factor.schur.T)
    for k in (1, 3):
        b = np.random.default_rng(k).random((40, k))
        x = factor.interior(b)
        np.testing.assert_allclose(dense[np.ix_(inside, inside)] @ x[inside], b[inside], atol=1e-13)
        assert not x[border].any()
    factor.close()


@pytest.mark.parametrize("exponent", [-66, -300, 66, 300])
def test_partial_factor_in_any_units(way: Any, exponent: int) -> None:
    """A matrix times a power of two has the same solutions, and S times it.

    MUMPS, which looks for no pivots there, takes those below 1e-16 for zero: a body with a modulus
    of 1e-19 was singular. Tolerance: rounding.
    """
    matrix, border, size = matrix_of(40), np.array([3, 7, 8, 20, 33]), 2.0**exponent
    plain, scaled = way(matrix, border), way(size * matrix, border)
    np.testing.assert_allclose(scaled.schur / size, plain.schur, atol=1e-13)
    b = np.random.default_rng(1).random((40, 2))
    np.testing.assert_allclose(scaled.interior(size * b), plain.interior(b), atol=1e-13)
    for factor in (plain, scaled):
        factor.close()


def test_mkl_is_found_where_packages_put_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The package of PyPI names its files, conda puts the library into `lib` of its environment.

    Requirement: both are looked at, no other folder is, and a file that is no library is passed
    over without an error.
    """
    library = tmp_path / "lib" / "libmkl_rt.so.2"
    library.parent.mkdir()
    library.write_text("no library")
    monkeypatch.setattr(pardiso.sys, "prefix", str(tmp_path))
    packaged = Mock(**{"locate.return_value": tmp_path / "libmkl_rt.so.3"})
    packaged.name = "libmkl_rt.so.3"
    monkeypatch.setattr(pardiso, "files", lambda package: [packaged])
    assert list(pardiso._libraries()) == [tmp_path / "libmkl_rt.so.3", library]
    assert pardiso.routine.__wrapped__() is None


def test_singular_schur_complement(way: Any) -> None:
    """A body that nothing holds: two springs in a row, of which only the middle is eliminated."""
    springs = np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    matrix = scipy.sparse.csr_array(springs)
    factor = way(matrix, np.array([0, 2]))
    np.testing.assert_allclose(factor.schur, [[0.5, -0.5], [-0.5, 0.5]], atol=1e-15)
    factor.close()


@pytest.mark.parametrize("seed", range(8))
def test_a_body_that_its_border_alone_holds(way: Any, seed: int) -> None:
    """Springs between 30 unknowns that nothing holds, of which four are left.

    Requirement: a Schur complement that is singular is one nevertheless, as forces may hold what
    is left; its least pivot is rounding, of either sign. Source: NumPy. Tolerance: rounding.
    """
    rng = np.random.default_rng(seed)
    springs = np.triu(rng.random((30, 30)) * (rng.random((30, 30)) < 0.4), 1)
    springs = springs + springs.T + np.diag(np.full(29, 0.1), 1) + np.diag(np.full(29, 0.1), -1)
    dense = np.diag(springs.sum(axis=1)) - springs
    border = np.array([2, 11, 12, 25])
    factor = way(scipy.sparse.csr_array(dense), border)
    expected = _schur(dense, border, np.setdiff1d(np.arange(30), border))
    np.testing.assert_allclose(factor.schur, expected, atol=1e-14 * dense.max())
    factor.close()


def test_singular_interior(way: Any) -> None:
    """A spring between two unknowns that nothing else holds."""
    matrix = scipy.sparse.csr_array(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, -1.0], [0.0, -1.0, 1.0]]))
    with pytest.raises(SingularError):
        way(matrix, np.array([0]))


def test_patterns_against_the_whole_system() -> None:
    """Loads, energies, works and reactions of a random state, from all unknowns."""
    rng = np.random.default_rng(3)
    bulk = condensation()
    assert bulk.contact.tolist() == [4, 17, 30, 31]
    k = bulk.stiffness.toarray()
    patterns = Patterns(bulk)
    load = rng.random(32)
    load[bulk.prescribed] = 0.0
    supports, contact = rng.random(3), rng.random(4)
    a, b = patterns.supports(supports), patterns.loads(load)
    state = InteriorState(contact, a, b, rng.random(3))
    u = patterns.displacement(state)
    fixed = np.union1d(bulk.contact, bulk.prescribed)
    inside = np.setdiff1d(np.arange(32), fixed)
    np.testing.assert_allclose(u[bulk.contact], contact, atol=1e-12)
    np.testing.assert_allclose(u[bulk.prescribed], supports, atol=1e-12)
    np.testing.assert_allclose((k @ u)[inside], load[inside], atol=1e-12)
    residual = bulk.schur_times(contact) - patterns.load(a, b)
    np.testing.assert_allclose(residual, (k @ u - load)[bulk.contact], atol=1e-12)
    assert patterns.energy(state) == pytest.approx(0.5 * u @ k @ u, rel=1e-12)
    assert b @ patterns.works(state) == pytest.approx(load @ u, rel=1e-12)
    outside = (k @ u)[bulk.prescribed] - state.at_supports
    assert a @ patterns.outside(state) == pytest.approx(supports @ outside, rel=1e-12)
    bulk.close()


def test_known_patterns_cost_no_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    """A load or displacement that is a combination of earlier ones is no work on the bulk."""
    bulk = condensation()
    patterns = Patterns(bulk)
    first, second = np.ones(3), np.arange(3.0)
    patterns.supports(first)
    patterns.supports(second)
    monkeypatch.setattr(bulk, "interior", None)
    patterns.supports(0.3 * first - 7.0 * second)
    with pytest.raises(TypeError):
        patterns.supports(np.array([1.0, 0.0, 0.0]))
    bulk.close()


def test_groups_of_supports_cost_one_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    """Groups moved as a whole are known from the start; they give what other patterns give."""
    bulk = condensation()
    moved = np.array([0.3, -2.0, -2.0])
    known, other = Patterns(bulk), Patterns(bulk)
    marks = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    assert known.add_groups(marks) == [0, 1, 2]
    expected = other.load(other.supports(moved), np.zeros(0))
    monkeypatch.setattr(bulk, "interior", None)
    np.testing.assert_allclose(known.load(known.supports(moved), np.zeros(0)), expected, rtol=1e-12)
    assert known.persistent()["supports"].shape == (3, 0)
    bulk.close()


def test_gmres() -> None:
    a = matrix_of(20).toarray() + 3.0 * np.triu(np.ones((20, 20)), 1)
    b = np.arange(20.0)
    x, left, used = gmres(lambda v: (v / 8.0, a @ v / 8.0), b, 1e-10, 20)
    assert left < 1e-10
    assert used <= 20
    np.testing.assert_allclose(a @ x, b, atol=1e-8)


@pytest.mark.parametrize("good", [0, 3])
def test_gmres_ends_where_a_product_overflows(good: int) -> None:
    """Tangents far from equilibrium overflow in single precision, which ended runs as internal.

    Requirement: what was found before, as if no more were allowed; without any, zero.
    """
    a = matrix_of(20).toarray()
    b = np.arange(20.0)
    calls: list[int] = []

    def step(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        calls.append(1)
        return v / 8.0, a @ v / 8.0 if len(calls) <= good else np.full(20, np.nan)

    x, left, used = gmres(step, b, 1e-10, 20)
    assert used == good
    wanted = (np.zeros(20), 1.0)
    if good:
        wanted = gmres(lambda v: (v / 8.0, a @ v / 8.0), b, 1e-10, good)[:2]
    np.testing.assert_array_equal(x, wanted[0])
    assert left == wanted[1]


def test_gmres_ends_where_the_most_iterations_will_not_do() -> None:
    """A cyclic shift: the residual stays what it was until the last of as many iterations as rows.

    Requirement: with a trial of 5 iterations it ends after those where 20 would not do, and not
    where a residual falls fast enough. Source: the shift is the standard example of a matrix on
    which GMRES stagnates [Nachtigal Reddy Trefethen 1992].
    """
    start = np.zeros(30)
    start[0] = 1.0
    for trial, expected in ((None, 20), (5, 5)):
        _, left, used = gmres(lambda v: (v, np.roll(v, 1)), start, 1e-3, 20, trial)
        assert used == expected
        assert left == pytest.approx(1.0)
    rates = 1.0 + 0.3 * np.linspace(0.0, 1.0, 30)
    wanted = gmres(lambda v: (v, rates * v), np.ones(30), 1e-12, 20)
    found = gmres(lambda v: (v, rates * v), np.ones(30), 1e-12, 20, 5)
    assert 5 < found[2] == wanted[2] < 20
    np.testing.assert_array_equal(found[0], wanted[0])


def test_bulk_is_recovered_only_when_asked_for(fe: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Reactions, energies and means need no solution with the interior; the displacement does."""
    from anisocontact.solver.strategies.condensed.parts import Condensation as Bulk

    calls = []
    interior = Bulk.interior
    monkeypatch.setattr(Bulk, "interior", lambda *a: calls.append(1) or interior(*a))
    problem = fe.block(fe.interface()).problem
    weights = np.ones(len(problem.u.x.array) // 3)
    counts = []
    steps = [Step("press", 4, PRESS.displacement)]
    for accepted in Solver(problem, steps, strategy="condensed").run():
        assert accepted.energies["elastic"] > 0.0
        problem.mean_displacement("all", weights)
        counts.append(len(calls))
    assert counts[1] == counts[2] == counts[3]
    before = len(calls)
    assert problem.u.x.array.any()
    assert len(calls) <= before + 1


@pytest.mark.parametrize("how", ["condensed", "iterative"])
def test_a_factorisation_that_failed_once_is_tried_again(
    how: str, fe: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The next attempt begins anew: PETSc would keep on saying that the last one had failed."""
    failed: list[int] = []
    owner, name, nothing = {
        "condensed": (KeptFactor, "solve", None),
        "iterative": (Factor, "renew", False),
    }[how]
    right = getattr(owner, name)

    def once_wrong(self: Any, *given: Any) -> Any:
        if failed:
            return right(self, *given)
        failed.append(1)
        return nothing

    monkeypatch.setattr(owner, name, once_wrong)
    accepted = list(Solver(fe.block(fe.interface()).problem, [PRESS], strategy=how).run())
    assert failed
    assert [one.done for one in accepted] == [1.0]
