"""What contacts come to carry where a body that springs let down is stopped."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import MPI
from anisocontact.solver.terms import lost_work
from anisocontact.solver.terms.lost_work import LostWork


def test_what_stops_a_body_is_what_contact_carries_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """A contact of two points that carries 3 where one has closed, 10 where both have, then 12.

    Requirement: the growth of its force counts where a point has closed since, and nothing does
    where none has, however the force grows. Source: by hand; what it carried before stops nothing.
    """
    now = SimpleNamespace(force=3.0, closed=[True, False])

    def add_force(out: Any) -> None:
        out[0, 2] += now.force

    contact = SimpleNamespace(add_force=add_force)
    monkeypatch.setattr(lost_work, "closed_points", lambda _: np.array(now.closed))
    springs: Any = SimpleNamespace(
        _free=[SimpleNamespace(contacts=[contact])] * 2,
        _before={id(contact): (np.zeros(2, dtype=bool), np.zeros((1, 3)))},
        _comm=MPI.COMM_SELF,
    )
    found = []
    for force, closed in ((3.0, [1, 0]), (10.0, [1, 1]), (12.0, [1, 1]), (12.0, [0, 1])):
        now.force, now.closed = force, np.array(closed, dtype=bool)
        found.append(float(LostWork._stopping(springs, np.zeros((1, 3)))[0, 2]))
    assert found == [3.0, 7.0, 0.0, 0.0]
