"""Penalties that are come to by way of multipliers are what they are without them.

What this spares where points slide to and fro: `hard/test_published_twisted_shaft.py`.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.verification.mixed_problems import PRESS_AND_DRAG, Held, on_plate, pad

from anisocontact.base.fenicsx import PETSc, Vec
from anisocontact.solver.stepping.compliant_penalties import CompliantPenalties
from anisocontact.solver.strategies.newton import NewtonResult


def test_multipliers_lead_to_the_same_forces(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pad pressed and dragged by a script whose first attempts all fail, which come to it second.

    Requirement: forces of penalties 1000 times as stiff as the pad and of friction along two axes,
    in every increment. Source: both are equilibria of the same law. Tolerance 1e-7: residuals are
    solved to 1e-8 of the forces.
    """
    g = pad(2, "none", 1)
    plainly = Held(g, [on_plate(g)]).go(PRESS_AND_DRAG)
    g = pad(2, "none", 1)
    held = Held(g, [on_plate(g)])
    solve, asked = held.problem.newton.solve, []

    def second(x: Vec, **options: Any) -> NewtonResult:
        asked.append("penalties" if held.contacts[0].trials.penalised else "multipliers")
        return solve(x, **options) if len(asked) % 3 != 1 else NewtonResult(0, [1.0], "refused")

    monkeypatch.setattr(held.problem.newton, "solve", second)
    forces = held.go(PRESS_AND_DRAG)
    assert asked == ["penalties", "multipliers", "penalties"] * len(PRESS_AND_DRAG)
    assert np.abs(forces - plainly).max() < 1e-7 * np.abs(plainly).max()


@pytest.mark.parametrize("reason", ["no convergence", None])
def test_multipliers_are_taken_away_whatever_came_of_them(reason: str | None) -> None:
    """Requirement: the next attempt has penalties alone, also after an error in the law."""
    told: list[str] = []

    def solve(x: Vec, full_steps: bool = False) -> NewtonResult:
        told.append("solved")
        if reason is None:
            raise ValueError("an error")
        return NewtonResult(3, [], reason)

    trials = SimpleNamespace(
        penalised=True,
        comply=lambda stiffness, size: told.append("multipliers"),
        take_away=lambda: told.append("none"),
    )
    contacts: Any = [SimpleNamespace(trials=trials, body_stiffness=1.0, facet_size=1.0)]
    newton: Any = SimpleNamespace(solve=solve)
    detour, x = CompliantPenalties(contacts, newton), PETSc.Vec().createSeq(1)
    if reason is None:
        with pytest.raises(ValueError, match="an error"):
            detour.solve(x)
    else:
        assert detour.solve(x).reason == reason
    assert told == ["multipliers", "solved", "none"]
