"""Slave nodes of which hardly anything is covered: left to their penalty while that is enough."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import MPI
from anisocontact.contact.slivers import Slivers
from anisocontact.interface.states import STATE


def test_what_a_penalty_leaves_too_deep_gets_a_multiplier_for_good() -> None:
    """Four nodes, two of them slivers, of which one lies deeper than the tolerance.

    Requirement: that one alone starts with its pressure as the multiplier, and is a sliver no more,
    so that the next trial does not leave it to its penalty again; the state before stays.
    """
    start = np.zeros(4, dtype=STATE)
    start["multiplier"] = (1.0, 2.0, 0.0, 0.0)
    deep = np.array([True, False, False, True])
    own: Any = SimpleNamespace(exact=True, beyond=lambda _: deep)
    points: Any = SimpleNamespace(facet=np.zeros(4), covered=lambda areas: areas)
    slivers = Slivers(points, MPI.COMM_SELF)
    slivers.begin(np.array([1.0, 1e-3, 1e-5, 1e-6]))
    answer = SimpleNamespace(pressure=np.array([5.0, 6.0, 7.0, 8.0]))
    step: Any = SimpleNamespace(answer=answer, covered=np.array([1.0, 1e-3, 1e-5, 1e-6]))
    found = slivers.held_as_well(own, step, start)
    assert found is not None
    assert found["multiplier"].tolist() == [1.0, 2.0, 0.0, 8.0]
    assert slivers.left.tolist() == [False, False, True, False]
    assert start["multiplier"].tolist() == [1.0, 2.0, 0.0, 0.0]
    assert slivers.held_as_well(own, step, start) is None


def test_what_a_compliance_leaves_too_deep_holds_exactly_until_the_next_increment() -> None:
    """Three nodes, of which little, next to nothing and nearly all is covered, all too deep.

    Requirement: the first two hold exactly from then on, with their pressures as multipliers, the
    third does so anyhow; none is asked for twice, and the next increment begins anew.
    """
    areas = np.array([1e-3, 1e-5, 0.9])
    points: Any = SimpleNamespace(facet=np.zeros(3), covered=lambda covered: covered)
    slivers = Slivers(points, MPI.COMM_SELF)
    slivers.begin(areas)
    own: Any = SimpleNamespace(exact=True, beyond=lambda _: np.ones(3, dtype=bool))
    step: Any = SimpleNamespace(answer=SimpleNamespace(pressure=np.full(3, 5.0)), covered=areas)
    found = slivers.held_as_well(own, step, np.zeros(3, dtype=STATE))
    assert found is not None
    assert found["multiplier"].tolist() == [5.0, 5.0, 0.0]
    assert slivers.firm.tolist() == [True, True, False]
    assert slivers.held_as_well(own, step, found) is None
    slivers.begin(areas)
    assert not slivers.firm.any()
