"""Viscous regularisation to the next equilibrium."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.limits import Limits
from anisocontact.contact import NotHeldError
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Solver, Step, StoppedError
from anisocontact.solver.stepping import attempts
from anisocontact.solver.stepping.attempts import Attempts
from anisocontact.solver.terms import viscous_regularisation
from anisocontact.solver.terms.viscous_regularisation import ViscousRegularisation

PRESS = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}
DRAG = {"block.top": {"x": 0.02, "y": 0.01}}
STEPS = (Step("press", 1, PRESS), Step("drag", 2, DRAG))
STRATEGIES = ["direct", "condensed", "iterative"]


def _always_regularised(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every attempt starts from the accepted state, with viscous forces."""

    def ordered(self: Attempts, *, full: Any, **_: Any) -> list[Any]:
        return [replace(full, regularised=True)]

    monkeypatch.setattr(Attempts, "_ordered", ordered)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_it_ends_where_newton_ends(fe: Any, monkeypatch: pytest.MonkeyPatch, strategy: str) -> None:
    """Where there is one equilibrium only, a block that sticks and slips, it finds that.

    Requirement: what is accepted is in balance without viscosity. Source: Newton's method
    alone. Tolerance: both leave 1e-8 of the forces out of balance.
    """
    plain = fe.block(fe.interface(), cells=(3, 3, 2))
    wanted = list(Solver(plain.problem, STEPS, strategy="direct").run())
    _always_regularised(monkeypatch)
    block = fe.block(fe.interface(), cells=(3, 3, 2))
    found = list(Solver(block.problem, STEPS, strategy=strategy).run())
    assert [a.done for a in found] == [1.0] * 3
    for one, other in zip(found, wanted, strict=True):
        forces = [a.resultants["block.bottom"][0] for a in (one, other)]
        assert np.abs(forces[0] - forces[1]).max() < 1e-6 * np.abs(forces[1]).max()
        assert one.contacts == other.contacts
    moved = np.abs(block.problem.u.x.array - plain.problem.u.x.array).max()
    assert moved < 1e-6 * np.abs(plain.problem.u.x.array).max()
    assert found[-1].energies == pytest.approx(wanted[-1].energies, rel=1e-5, abs=1e-9)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_its_work_is_what_its_ends_say(
    fe: Any, monkeypatch: pytest.MonkeyPatch, strategy: str
) -> None:
    """Work from outside = what is stored, whatever the path.

    Source: bodies, penalty and adhesion that sticks are linear, so that the trapezoidal rule is
    exact from one end of an increment to the other. Tolerance: 1e-8 of the forces are out of
    balance. What viscous forces took up on the way counted as the energy of a jump.
    """
    _always_regularised(monkeypatch)
    block = fe.block(fe.interface(coefficients=(10.0, 10.0)), cells=(3, 3, 2), nu=0.0)
    steps = (STEPS[0], Step("drag", 2, {"block.top": {"x": 0.002, "y": 0.001}}))
    accepted = list(Solver(block.problem, steps, strategy=strategy).run())
    points = len(block.contact.last.gap)
    for one in accepted:
        assert one.contacts["block.bottom"]["stick"] == points
        energies = one.energies
        assert energies["regularisation"] == 0.0
        assert abs(energies["residual"]) < 1e-7 * energies["external"]


def test_flow_is_told_and_switched_off(fe: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """A line for every increment that is regularised; nothing of it is left in the next attempt."""
    _always_regularised(monkeypatch)
    block = fe.block(fe.interface(), cells=(2, 2, 1))
    springs = block.problem.stabilisation
    for _ in Solver(block.problem, STEPS[:1], strategy="direct").run():
        (line,) = springs.take_notes()
        assert line.startswith("equilibrium was lost: ")
        assert not springs
        assert springs.regularisation.stiffness == 0.0


def _named(way: Any) -> str:
    """What an attempt is, in a word."""
    kinds = [name for name in ("regularised", "damped") if getattr(way, name)]
    return kinds[0] if kinds else way.detour or "plain"


def test_regularisation_comes_last_and_where_it_may(
    fe: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only small sub-increments, after the damped attempt, not with `stabilisation = false`."""
    tried: list[str] = []
    attempt = Attempts._attempt

    def alternating(self: Attempts, way: Any) -> Any:
        tried.append(_named(way))
        result, _ = attempt(self, way)
        return result, [attempts.Culprit("chattering", (0.0, 0.0, 0.0), "")]

    monkeypatch.setattr(Attempts, "_attempt", alternating)
    five = ["plain", "compliant", "plain", "graded", "damped"]
    for stabilised, ways in ((True, [*five, *five, "regularised"]), (False, [*five, *five])):
        tried.clear()
        block = fe.block(fe.interface(), cells=(2, 2, 1))
        block.problem.stabilisation.enabled = stabilised
        limits = Limits(smallest=0.25)
        options = {"snes_max_it": 0}
        run = Solver(block.problem, STEPS[:1], "", options, limits, strategy="direct").run()
        with pytest.raises(StoppedError, match="alternates"):
            list(run)
        assert tried == ways


def _flow() -> tuple[ViscousRegularisation, np.ndarray]:
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    u = np.zeros((8, 3))
    carried = ViscousRegularisation(model, 10.0)
    carried.start(u)
    return carried, u


def test_steps_grow_and_shrink() -> None:
    """An easy step is followed by a longer one, a failed one by shorter ones up to a limit."""
    carried, u = _flow()
    first = carried.stiffness
    assert carried.improve(u + 0.1, at_work=0.0)
    assert carried.stiffness == viscous_regularisation.LONGER * first
    assert carried.force(u + 0.1) == pytest.approx(0.0)
    assert carried.soften()
    assert (
        carried.stiffness == viscous_regularisation.LONGER * viscous_regularisation.SHORTER * first
    )
    while carried.soften():
        pass
    assert carried.stiffness > viscous_regularisation.MOST_VISCOUS * 10.0


def test_flow_without_end_is_given_up() -> None:
    """Bodies that never come to rest: no more than so many steps, then the attempt has failed."""
    carried, u = _flow()
    for count in range(viscous_regularisation.MOST_STEPS):
        assert carried.improve(u + count, at_work=0.0)
    with pytest.raises(
        NotHeldError, match=f"do not come to rest in {viscous_regularisation.MOST_STEPS} steps"
    ):
        carried.improve(u, at_work=0.0)
