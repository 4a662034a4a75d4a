"""Whether what a free body stands on holds it, and what its springs stand against."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import MPI
from anisocontact.solver.terms import free_body
from anisocontact.solver.terms.free_body import FreeBody

#: Along z, and turns about x and y: what pressures from below can resist.
LEFT = np.eye(6)[[2, 3, 4]]


@pytest.mark.parametrize(("height", "held"), [(1.0, True), (0.3, True), (0.05, False)])
def test_points_nearly_on_a_line_do_not_hold(
    monkeypatch: pytest.MonkeyPatch, height: float, held: bool
) -> None:
    """Three closed points of a triangle of base 2 below a body of size 1.

    Requirement: they hold it unless their resistance to the turn about the base is below a
    hundredth of the largest: 0.17, 0.02 and 6e-4 of it. Source: by hand, `sum(y^2) - sum(y)^2 / 3`
    over 3 to first order; a body on a line would tip.
    """
    points = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, height, 0.0]])
    monkeypatch.setattr(free_body, "closed_points", lambda *_: np.ones(3, dtype=bool))
    contact = SimpleNamespace(
        points=points,
        trial=SimpleNamespace(normal=np.tile([0.0, 0.0, 1.0], (3, 1))),
        space=SimpleNamespace(mesh=SimpleNamespace(comm=MPI.COMM_SELF)),
    )
    free: Any = SimpleNamespace(
        left=LEFT, contacts=[contact], body=SimpleNamespace(centre=np.zeros(3), size=1.0)
    )
    assert FreeBody._pressed(free) == held


@pytest.mark.parametrize(("load", "against"), [(0.4, False), (0.6, True), (-1.0, False)])
def test_springs_that_carry_loads_are_told_from_those_beside_contact(
    load: float, against: bool
) -> None:
    """Requirement: springs stand against loads where these are more than half of what they carry.

    Springs carry -1 along the only free motion, on two nodes.
    """
    nodes = np.arange(2)
    free: Any = SimpleNamespace(
        body=SimpleNamespace(nodes=nodes),
        pushed=np.array([load]),
        along_free=lambda f: f.sum(0)[2:],
    )
    force = np.array([[0.0, 0.0, -0.5]] * 2)
    assert FreeBody.against_loads(free, force) == against
