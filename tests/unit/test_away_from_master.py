"""Whether loads carry a body away from what it touches, as the slave or as the master."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import MPI
from anisocontact.solver.terms.flown_off import flown_off

CUBE = np.array([(x, y, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("load", "gone"), [(1.0, True), (-1.0, False)])
def test_loads_say_where_a_body_goes(side: float, load: float, gone: bool) -> None:
    """A cube that is ten heights above, as the slave, or below, as the master, what it meets.

    Requirement: it is given up where its load points away from the other side, and not where it
    points there. Source: the normal is that of the master, along which the slave goes away and
    against which the master does.
    """
    space = SimpleNamespace(
        mesh=SimpleNamespace(comm=MPI.COMM_SELF), tabulate_dof_coordinates=lambda: CUBE
    )
    met = np.ones(4, dtype=bool)
    far = SimpleNamespace(gap=np.full(4, 10.0), normal=np.tile([0.0, 0.0, 1.0], (4, 1)))
    near: Any = SimpleNamespace(state=None, gap=np.zeros(4))
    contact: Any = SimpleNamespace(
        space=space,
        trial=far,
        located=lambda: met,
        accepted=SimpleNamespace(response=near),
        master=SimpleNamespace(located=lambda _: met),
        of_two_groups=False,
    )
    free: Any = SimpleNamespace(
        contacts=[contact],
        sides=[side],
        body=SimpleNamespace(nodes=np.arange(8)),
        nodes=np.arange(8),
        force=np.array([0.0, 0.0, side * load]),
    )
    begun = np.zeros((8, 3))
    found = flown_off([free], begun, np.tile([0.0, 0.0, 10.0 * side], (8, 1)))
    assert found == ((free, 10.0) if gone else None)
