"""Line search where pressures of cells are unknowns of their own; sources: [Armijo 1966]."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import PETSc
from anisocontact.solver.strategies.mixed_search import LEAST, MixedSearch


def searched(residual: Callable[[float], float], largest: float = 1.0) -> tuple[float, bool, Any]:
    """Share taken of a correction from 1 to 0, whether it is stuck, and what pressures took."""
    trials: list[float] = []
    taken: list[float] = []

    @contextmanager
    def trial(share: float) -> Iterator[None]:
        trials.append(share)
        yield
        trials.append(-1.0)

    def evaluate(x: Any) -> Any:
        assert x.array_r[0] == pytest.approx(1.0 - trials[-1])  # pressures go as far as nodes
        return np.array([residual(float(x.array_r[0]))])

    followed = SimpleNamespace(trial=trial, take=taken.append)
    system: Any = SimpleNamespace(followed=followed, evaluate=evaluate)
    x, correction = PETSc.Vec().createSeq(1), PETSc.Vec().createSeq(1)
    x.set(1.0)
    correction.set(1.0)
    search = MixedSearch(system)
    search.begin()
    share = search.share(x, correction, largest)
    assert x.array_r[0] == 1.0 and trials[-1] == -1.0
    return share, search.stuck, taken


def test_a_correction_that_helps_is_whole() -> None:
    assert searched(lambda x: x) == (1.0, False, [1.0])
    assert searched(lambda x: x, 0.5) == (0.5, False, [0.5])


def test_a_correction_is_halved_until_the_residual_falls() -> None:
    assert searched(lambda x: abs(x - 0.8)) == (0.25, False, [0.25])


def test_a_residual_that_is_no_number_is_none() -> None:
    assert searched(lambda x: x if x > 0.2 else np.nan) == (0.5, False, [0.5])


def test_a_residual_that_rises_is_stuck() -> None:
    share, stuck, taken = searched(lambda x: 2.0 - x)
    assert stuck and share == LEAST and taken == [LEAST]
