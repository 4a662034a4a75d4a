"""What is said of a rigid body that nothing holds."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from mpi4py import MPI

from anisocontact.rigid import RigidBody
from anisocontact.solver.terms.unsupported_rigid_body import without_support


@pytest.mark.parametrize(
    ("before", "now", "why"),
    [
        (0, 0, "it touches nothing; bring it into contact"),
        (1, 0, "a correction leads it off what it touches; load it in more increments"),
        (1, 2, "what touches it slides; load it less"),
        (0, 2, "what touches it slides; load it less"),
    ],
)
def test_a_body_that_touched_is_not_said_to_touch_nothing(before: int, now: int, why: str) -> None:
    """Requirement: a die on 19 points was to be brought into contact first, as a trial left it."""
    states = [SimpleNamespace(status=np.array([0, status])) for status in (before, now)]
    contact = cast(Any, SimpleNamespace(last=states[0], trial=states[1]))
    told = without_support(
        RigidBody("die", (0, 0, 0), free=True), ["about y"], [contact], MPI.COMM_SELF
    )
    assert told.startswith(f"nothing holds the rigid body 'die' about y: {why}")
