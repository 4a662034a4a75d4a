"""Shares of corrections of displacements and multipliers."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from anisocontact.base.fenicsx import PETSc
from anisocontact.solver.strategies.backtracking import LEAST, Backtracking

COMM = PETSc.COMM_SELF


class System:
    """One unknown whose residual is a function, and multipliers that remember where they were."""

    def __init__(self, residual: Callable[[float], float]) -> None:
        self._residual = residual
        self.contact_term = self
        self.retraceable = self.touching = True
        self.settled = self.outgrown = False
        self.visited: list[float] = []
        self.shares: list[float] = []
        self.balance: Any = None

    def evaluate(self, x: PETSc.Vec) -> np.ndarray:
        """The residual; the multipliers follow."""
        self.visited.append(float(x.array_r[0]))
        value = self._residual(self.visited[-1])
        self.balance = SimpleNamespace(norm=abs(value))
        return np.array([value])

    def touch(self) -> bool:
        """As of the contacts."""
        return self.touching

    def statuses(self) -> int:
        """As of the contacts."""
        return 0

    def same(self, _: int) -> bool:
        """Whether no point has changed its status."""
        return self.settled

    def damp_correction(self, share: float) -> None:
        """As of the contacts."""
        self.shares.append(share)

    def marks(self) -> int:
        """How far the multipliers have followed."""
        return len(self.visited)

    def go_back(self, marks: int) -> None:
        """As of the contacts."""
        del self.visited[marks:]


def vector(value: float) -> PETSc.Vec:
    """A vector of one number."""
    return PETSc.Vec().createWithArray(np.array([value]), comm=COMM)


def begun(residual: Callable[[float], float]) -> tuple[Backtracking, System]:
    """A search at 0, where the system was evaluated."""
    system = System(residual)
    search = Backtracking(system)
    search.begin()
    system.evaluate(vector(0.0))
    return search, system


@pytest.mark.parametrize(
    ("residual", "share"),
    [
        (lambda x: 1.0 - x, 1.0),
        (lambda x: np.nan if x > 0.3 else 1.0 - x, 0.25),
        (lambda x: 3.0 if x > 0.6 else 1.0 - x, 0.5),
        (lambda x: 1.0 + x, 1.0),
        (lambda x: np.nan if x > 0.6 else 1.0 + x, LEAST / 2.0),
    ],
    ids=["whole", "no answer", "rises", "never falls", "neither"],
)
def test_share(residual: Callable[[float], float], share: float) -> None:
    """The first of 1, 1/2, 1/4 ... with which the residual does not rise, or the whole.

    Multipliers have followed once, with that share, and the residual there is known.
    """
    search, system = begun(residual)
    assert search.share(vector(0.0), vector(-1.0), 1.0) == share
    assert system.visited == [0.0, share]
    assert system.shares[-1] == share
    np.testing.assert_array_equal(search.evaluated(vector(share)), [residual(share)])
    assert search.evaluated(vector(share)) is None


def test_residual_may_rise_for_a_while() -> None:
    """It may be as large as one of the last three, no larger."""
    search, system = begun(lambda x: {0.0: 4.0, 1.0: 1.0, 2.0: 3.0, 3.0: 3.5}.get(x, 0.5))
    shares = [search.share(vector(at), vector(-1.0), 1.0) for at in (0.0, 1.0, 2.0)]
    assert shares == [1.0, 1.0, 1.0]
    search, system = begun(lambda x: {0.0: 4.0, 1.0: 1.0, 2.0: 5.0}.get(x, 0.5))
    assert search.share(vector(0.0), vector(-1.0), 1.0) == 1.0
    assert search.share(vector(1.0), vector(-1.0), 1.0) == 0.5
    assert system.visited == [0.0, 1.0, 1.5]


@pytest.mark.parametrize("whole", [False, True])
def test_any_balance_will_do(whole: bool) -> None:
    """Where nothing touches, and where bodies want corrections in full: as far as there is one."""
    search, system = begun(lambda x: np.nan if x > 0.6 else 1.0 + x)
    system.touching, search.whole = whole, whole
    assert search.share(vector(0.0), vector(-1.0), 1.0) == 0.5


@pytest.mark.parametrize(("until", "share"), [(0.2, 1.0), (0.3, 1.0), (0.6, 0.5)])
def test_whole_where_points_keep_their_status(until: float, share: float) -> None:
    """Then less than half of a correction is none: the balance may rise by what it wants."""
    search, system = begun(lambda x: 1.0 - x if x < until else 50.0)
    system.settled = True
    assert search.share(vector(0.0), vector(-1.0), 1.0) == share
    assert system.visited == [0.0, share]


@pytest.mark.parametrize(("lost", "share"), [(0.6, 0.5), (0.2, 0.125), (2.0, 1.0), (0.01, 1.0)])
def test_contact_is_not_lost_at_once(
    lost: float, share: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the balance falls with no share: as far as something touches, all where nothing does.

    Source: a plate that retreats from a spring which stands on it; nothing holds that elsewhere.
    """
    search, system = begun(lambda x: 1.0 + x)
    monkeypatch.setattr(system, "touch", lambda: system.visited[-1] < lost)
    assert search.share(vector(0.0), vector(-1.0), 1.0) == share
    assert system.visited == [0.0, share]


def test_leaves_the_reach_when_it_is_wanted_twice() -> None:
    """Halves of corrections that leave what `condensed` has would creep towards its end."""
    search, system = begun(lambda x: np.nan if x > 0.6 else 1.0 - x)
    system.outgrown = True
    assert search.share(vector(0.0), vector(-1.0), 1.0) == 0.5
    assert search.share(vector(0.5), vector(-0.5), 1.0) == 1.0
    search.begin()
    system.evaluate(vector(0.0))
    assert search.share(vector(0.0), vector(-1.0), 1.0) == 0.5


def test_goes_back_where_another_state_is_asked_for() -> None:
    """A line search of the user may go elsewhere: multipliers start from where they were."""
    search, system = begun(lambda x: 1.0 - x)
    search.share(vector(0.0), vector(-1.0), 1.0)
    assert search.evaluated(vector(0.7)) is None
    assert system.visited == [0.0]


def test_layers_take_whole_steps() -> None:
    """Where multipliers cannot go back nothing is tried."""
    search, system = begun(lambda x: np.nan if x > 0.3 else 1.0)
    system.retraceable = False
    assert search.share(vector(0.0), vector(-1.0), 0.5) == 0.5
    assert system.visited == [0.0]
    assert search.evaluated(vector(0.5)) is None
