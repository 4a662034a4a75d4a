"""Whether what a free body stands on holds it, and what its springs stand against."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import MPI
from anisocontact.base.statuses import SLIP, STICK
from anisocontact.solver.terms import free_body
from anisocontact.solver.terms.free_body import FreeBody

#: Along z, and turns about x and y: what pressures from below can resist.
LEFT = np.eye(6)[[2, 3, 4]]
#: All motions in the plane of x and z, and in space.
PLANE, SPACE = np.eye(6)[[0, 2, 4]], np.eye(6)


def _on_points(
    monkeypatch: pytest.MonkeyPatch, points: list[list[float]], left: Any, statuses: list[int]
) -> Any:
    """A body of size 1 above points of a plane, all of them closed."""
    closed = np.ones(len(points), dtype=bool)
    monkeypatch.setattr(free_body, "closed_points", lambda *_: closed)
    normal = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    contact = SimpleNamespace(
        points=np.array(points),
        trial=SimpleNamespace(normal=normal, status=np.array(statuses)),
        space=SimpleNamespace(mesh=SimpleNamespace(comm=MPI.COMM_SELF)),
        interface=SimpleNamespace(
            tangential=SimpleNamespace(in_python=False, holds_all_ways=lambda: True)
        ),
    )
    body = SimpleNamespace(centre=np.zeros(3), size=1.0)
    free: Any = SimpleNamespace(left=left, contacts=[contact], body=body)
    free._resistance = lambda *given: FreeBody._resistance(free, *given)
    return free


@pytest.mark.parametrize(("height", "held"), [(1.0, True), (0.3, True), (0.05, False)])
def test_points_nearly_on_a_line_do_not_hold(
    monkeypatch: pytest.MonkeyPatch, height: float, held: bool
) -> None:
    """Three closed points of a triangle of base 2 below a body of size 1.

    Requirement: they hold it unless their resistance to the turn about the base is below a
    hundredth of the largest: 0.17, 0.02 and 6e-4 of it. Source: by hand, `sum(y^2) - sum(y)^2 / 3`
    over 3 to first order; a body on a line would tip.
    """
    points = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, height, 0.0]]
    free = _on_points(monkeypatch, points, LEFT, [SLIP] * 3)
    assert FreeBody._resisted(free) == held


@pytest.mark.parametrize(
    ("stuck", "left", "held"), [(0, PLANE, False), (1, PLANE, True), (1, SPACE, False)]
)
def test_one_point_that_sticks_holds_what_pressures_leave(
    monkeypatch: pytest.MonkeyPatch, stuck: int, left: Any, held: bool
) -> None:
    """Two hundred points that slide, one or none that sticks.

    Requirement: of the motions in a plane pressures resist the way across the floor and the turn,
    and any point that sticks the way along it, however many slide; in space nothing resists the
    turn about the normal through it. Source: by hand.
    """
    points = [[x, 0.1 * (-1) ** i, 0.0] for i, x in enumerate(np.linspace(-1.0, 1.0, 200))]
    free = _on_points(monkeypatch, points, left, [STICK] * stuck + [SLIP] * (200 - stuck))
    assert FreeBody._resisted(free) == held


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
