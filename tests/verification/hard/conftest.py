"""Hard cases run as a user runs them: a case file, default settings, to the end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest


@dataclass
class Run:
    """A run that came to its end.

    Attributes:
        accepted: Every accepted part.
        cuts: Every cut.
        problem: The problem in its last state.
        strategy: The strategy that was taken.
        notes: What the log has of bodies that flowed.
    """

    accepted: list[Any]
    cuts: list[Any]
    problem: Any
    strategy: str
    notes: list[str]

    @property
    def ends(self) -> dict[str, Any]:
        """The last accepted part of each step."""
        return {a.step: a for a in self.accepted}

    def force(self, step: str, contact: int = 0) -> Any:
        """Resultant on the slave at the end of a step."""
        name = self.problem.contacts[contact].name
        return self.ends[step].resultants[name][0]


@pytest.fixture
def to_the_end(tmp_path) -> Callable[..., Run]:
    """Runs the text of a case file with default settings; every increment is met, in order."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    from anisocontact.case import load
    from anisocontact.case.build import build

    def run(text: str, solver: str = "", most: int = 2500) -> Run:
        assert "[solver]" not in text
        path = tmp_path / "case.toml"
        path.write_text(f"{text}\n[solver]\n{solver}\n" if solver else text)
        built = build(load(path))
        assert built.problem.unknowns < most
        cuts: list[Any] = []
        accepted = list(built.solver.run(on_cut=cuts.append))
        met = [(a.step, a.increment) for a in accepted if a.done == 1.0]
        assert met == [(s.name, i + 1) for s in built.steps for i in range(s.increments)]
        times = [a.time for a in accepted]
        assert times == sorted(times)
        assert times[-1] == pytest.approx(sum(s.duration for s in built.steps), rel=1e-14)
        notes = built.problem.stabilisation.take_notes()
        return Run(accepted, cuts, built.problem, built.solver.choice.name, notes)

    return run
