"""Friction that turns round within an increment, which the work of the increment looks at."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.solver.system.contact_work import _reversed

UP = np.array([[0.0, 0.0, 1.0]])


def _point(tangential, pressure):
    """A point before or after, with a force along x."""
    return SimpleNamespace(traction=np.array([[tangential, 0.0, pressure]]), normal=UP)


@pytest.mark.parametrize(
    ("before", "after", "turned"),
    [
        ((0.3, 1.0), (-0.2, 1.0), True),
        ((0.3, 1.0), (0.2, 1.0), False),
        ((1e-4, 1.0), (-1e-4, 1.0), True),
        ((1e-9, 1.0), (-1e-9, 1.0), False),
        ((0.3, 1.0), (-1e-9, 1.0), False),
        ((1e-9, 1e-4), (-1e-9, 1.0), False),
    ],
)
def test_what_equilibrium_leaves_of_friction_is_none(before, after, turned):
    """Requirement: a force below a millionth of the pressure turns by chance, and says nothing.

    Source: a body that is pressed has no friction but the 1e-8 of the forces that equilibrium
    leaves. Where that turned round, the work of an increment was found in another way: half a
    percent more or less, as the unit of length or the strategy had it.
    """
    contact = SimpleNamespace(last=_point(*before), trial=_point(*after))
    assert _reversed(contact).tolist() == [turned]
