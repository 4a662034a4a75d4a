"""Newton's method on a system of two equations, apart from any mesh."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import MPI, Mat, PETSc, Vec
from anisocontact.solver.strategies.newton import Newton
from anisocontact.solver.strategies.newton_iteration import NewtonIteration
from anisocontact.solver.strategies.residual_history import PATIENCE, STUCK_OVER
from anisocontact.solver.strategies.settled_contact import SettledContact
from anisocontact.solver.system.force_balance import ForceBalance
from anisocontact.solver.terms.contacts import Contacts


class Valley:
    """The stationary point of a curved valley, as two equations: 1 - x and c (y - x^2).

    Full steps are there after two corrections, the first of which climbs; a search that lets the
    residual only fall follows the bend.
    """

    balance = replace(ForceBalance.none(2), force_scale=1.0)
    contact_term, followed = Contacts([]), None
    comm = MPI.COMM_SELF

    def __init__(self, steepness: float) -> None:
        self._steepness = steepness

    def new_vector(self) -> Vec:
        return PETSc.Vec().createSeq(2, comm=self.comm)

    def new_tangent(self) -> Mat:
        matrix = PETSc.Mat().createDense((2, 2), comm=self.comm)
        matrix.setUp()
        return matrix

    def evaluate(self, x: Vec) -> np.ndarray:
        a, b = x.array_r
        return np.array([1.0 - a, self._steepness * (b - a**2)])

    def tangent(self, x: Vec, out: Mat) -> bool:
        a, c = float(x.array_r[0]), self._steepness
        out.setValues([0, 1], [0, 1], [-1.0, 0.0, -2.0 * a * c, c])
        out.assemble()
        return False

    def take_elastic_share(self, _: float) -> None:
        """Nothing flows."""

    def corrected(self, _: bool) -> AbstractContextManager[bool]:
        return nullcontext(False)

    def improve(self, _: Vec) -> bool:
        return False

    def soften(self) -> bool:
        return False


def _newton(system: Valley, **options: Any) -> Newton:
    dense = {"pc_type": "lu", "pc_factor_mat_solver_type": "petsc"}
    return Newton(system, "equations_", dense | options, lambda *_: None)


def _at(system: Valley, a: float, b: float) -> Vec:
    x = system.new_vector()
    x.array[:] = (a, b)
    return x


def _solved(full_steps: bool, **options: Any) -> tuple[Any, np.ndarray]:
    system = Valley(1e3)
    newton, x = _newton(system, **options), _at(system, -1.2, 1.44)
    result = newton.solve(x, full_steps)
    newton.close()
    return result, x.array_r.copy()


def test_a_search_that_creeps_is_given_up():
    """It would need hundreds of corrections; what comes next are full steps."""
    result, _ = _solved(full_steps=False)
    assert "the line search got stuck" in result.reason
    assert result.iterations == STUCK_OVER
    again, x = _solved(full_steps=True)
    assert not again.reason
    assert again.iterations <= 3
    np.testing.assert_allclose(x, 1.0, rtol=1e-12)


class Uphill(Valley):
    """A valley whose tangent has the wrong sign: no share of a correction lowers the residual."""

    evaluations = 0

    def evaluate(self, x: Vec) -> np.ndarray:
        self.evaluations += 1
        return super().evaluate(x)

    def tangent(self, x: Vec, out: Mat) -> bool:
        grown = super().tangent(x, out)
        out.scale(-1.0)
        return grown


def test_a_search_that_finds_nothing_ends_after_a_dozen_halvings():
    """PETSc's own limit, 1e-12 of a correction, is 40 of them, and rounding takes it for a gain."""
    system = Uphill(10.0)
    newton = _newton(system)
    result = newton.solve(_at(system, -1.2, 1.0))
    newton.close()
    assert "the line search got stuck" in result.reason
    assert result.iterations == 0
    assert system.evaluations <= 1 + 13


def test_steps_without_search_are_never_given_up_for_creeping():
    """The user may choose them by an option of PETSc."""
    result, _ = _solved(full_steps=False, snes_linesearch_type="basic")
    assert not result.reason


def test_a_search_after_full_steps_is_the_one_of_the_options():
    """PETSc gives a type that is set anew its own defaults, of which cubic steps are one.

    Both solutions begin at the same point: their residuals are the same to the last bit.
    """
    system = Valley(10.0)
    newton = _newton(system)
    ways = (False, True, False)
    found = [newton.solve(_at(system, -1.2, 1.44), full_steps).residuals for full_steps in ways]
    newton.close()
    assert found[2] == found[0] != found[1]


class Jump(Valley):
    """A residual of slope one that jumps, beside one that is linear.

    Args:
        of: The first residual.
    """

    def __init__(self, of: Callable[[float], float]) -> None:
        super().__init__(1.0)
        self._of = of
        self.seen: list[float] = []

    def evaluate(self, x: Vec) -> np.ndarray:
        a, b = map(float, x.array_r)
        self.seen.append(a)
        return np.array([self._of(a), b])

    def tangent(self, x: Vec, out: Mat) -> bool:
        out.setValues([0, 1], [0, 1], [1.0, 0.0, 0.0, 1.0])
        out.assemble()
        return False


def test_the_line_search_halves_steps():
    """Behind a jump the parabola through a step says nothing: it would take a tenth of it.

    The residual jumps by ten at a = -1/5, in front of where full steps end.
    """
    system = Jump(lambda a: a if a < -0.2 else 10.0 + a)
    newton = _newton(system, snes_max_it=1)
    newton.solve(_at(system, -1.0, 0.0))
    newton.close()
    assert system.seen == pytest.approx([-1.0, 0.0, -0.5], abs=1e-15)


def test_cycle_of_two_is_given_up():
    """States that alternate are seen after two periods, not after 25 corrections.

    The equation is that of a spring with dry friction, which full steps go to and fro about.
    """
    system = Jump(lambda a: a + 2.0 * np.sign(a) - 0.5)
    newton = _newton(system)
    result = newton.solve(_at(system, 1.0, 0.0), full_steps=True)
    assert result.reason.startswith("no convergence")
    assert result.iterations < 8


def test_cycle_of_three_is_given_up():
    """States that follow one another round and round are seen after three periods.

    Full steps lead from 4 to 1, to 2 and to 4 again: the residual is what is left of the first two,
    and what lies between the last and the first, each with the slope one of the tangent.
    """
    follows = {4.0: 1.0, 1.0: 2.0, 2.0: 4.0}
    system = Jump(lambda a: a - follows[a])
    newton = _newton(system)
    result = newton.solve(_at(system, 4.0, 0.0), full_steps=True)
    newton.close()
    assert result.residuals == [3.0, 1.0, 2.0] * 3
    assert result.reason.startswith("no convergence")


class Floating(Valley):
    """Nothing pushes: 1e-9 is the rounding of forces that cancel."""

    balance = replace(ForceBalance.none(2), force_scale=1e-12, round_off=1e-9)

    def evaluate(self, x: Vec) -> np.ndarray:
        return np.array([5e-10, x.array_r[1]])


def test_what_rounding_leaves_is_told_over_what_was_rounded():
    """Without forces at work a residual of rounding is no share of them that anybody could read."""
    system = Floating(1.0)
    newton = Newton(system, "floating_", {}, lambda *_: None)
    x = system.new_vector()
    result = newton.solve(x)
    newton.close()
    assert not result.reason
    assert result.residuals == pytest.approx([5e-9])


@pytest.mark.parametrize(
    ("factor", "options", "most"),
    [
        (0.9, {}, 100),  # halved in eight corrections: it is waited for
        (0.95, {}, PATIENCE),
        (0.9, {"snes_max_it": 40}, 40),
        (0.95, {"snes_max_it": 100}, 100),
    ],
)
def test_a_residual_that_falls_is_waited_for(
    factor: float, options: dict[str, Any], most: int
) -> None:
    """A tangent that is too stiff: every correction takes the same share of the residual away.

    Requirement: corrections go on beyond the usual number while they halve the residual in eight,
    and options alone say how many there are if they do.
    """

    class Stiff(Valley):
        def evaluate(self, x: Vec) -> np.ndarray:
            return np.array(x.array_r)

        def tangent(self, x: Vec, out: Mat) -> bool:
            out.setValues([0, 1], [0, 1], (np.eye(2) / (1.0 - factor)).ravel())
            out.assemble()
            return False

    system = Stiff(1.0)
    newton = _newton(system, snes_rtol=1e-30, **options)
    result = newton.solve(_at(system, 1.0, 1.0), full_steps=True)
    newton.close()
    assert result.iterations == most
    assert result.reason.startswith(f"no convergence in {most} Newton iterations")


@pytest.mark.parametrize(
    ("residuals", "compact", "share"),
    [
        ([5.0], True, 0.0),
        ([1.0, 0.2], True, 0.06),
        ([1.0, 4.0], True, 0.5),
        ([1.0, 1e-3], True, 0.0),
        ([1.0, 0.2], False, 0.0),
    ],
)
def test_share_of_the_elastic_tangent(residuals, compact, share):
    """Requirement: none in the first correction, near equilibrium and in slender bodies, else in
    proportion to the residual up to a half. Source: `NewtonIteration`. Tolerance: rounding.
    """
    given: list[float] = []
    system = Valley(1.0)
    system.contact_term = Contacts([])
    system.contact_term.compact = compact
    system.take_elastic_share = given.append  # type: ignore[method-assign]
    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    settled = SettledContact(system, snes)
    iteration = NewtonIteration(system, lambda number, residual: None, settled)
    iteration.residuals.extend(residuals)
    iteration.tangent(snes, system.new_vector(), system.new_tangent())
    snes.destroy()
    assert given == pytest.approx([share, 0.0])
