"""What slave points store and dissipate where their areas change within an increment."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import MPI
from anisocontact.contact.energies import ContactEnergies
from anisocontact.interface.states import STATE


def _at(area: float, **values: float) -> Any:
    """Points at one state, two of one area each."""
    state = np.zeros(2, dtype=STATE)
    for name, value in values.items():
        state[name] = value
    return SimpleNamespace(areas=np.full(2, area), response=SimpleNamespace(state=state))


BEFORE = _at(1.0, pressure=4.0, energy_adhesion=0.5, energy_normal=0.25, dissipation=2.0)
END = _at(
    3.0,
    pressure=8.0,
    energy_adhesion=0.7,
    energy_normal=0.35,
    dissipation=5.0,
    dissipation_viscous=0.1,
)


@pytest.mark.parametrize("does_work", [True, False])
def test_energies_have_the_area_of_their_own_state(does_work: bool) -> None:
    """Two points whose area grows from 1 to 3, and whose energies per area are given.

    Requirement: what is stored is that of each state on its own area, less the accepted one; what
    the increment dissipates is on the area of its end, with the mean of what presses over that of
    the end, forces where an increment is accepted and pressures on the way to it. Source: by hand,
    a force is its traction on the area of now. With the area of the start the balance of bodies
    whose surface stretches was as far off as the area had changed. Tolerance: rounding.
    """
    trials: Any = SimpleNamespace(does_work=does_work)
    energies = ContactEnergies(trials, 2, MPI.COMM_SELF)
    before, end = BEFORE.response.state, END.response.state.copy()
    stored = 2 * (3.0 * 0.35 - 1.0 * 0.25)
    stored += 2 * (3.0 * 0.7 - 1.0 * 0.5) if does_work else 0.0
    friction = 0.5 * (1.0 + 4.0 / 8.0) * (5.0 - 2.0)
    found = energies.taken_up(BEFORE, before, END)
    assert found == pytest.approx(stored + 2 * 3.0 * (friction + 0.1), rel=1e-14)
    final: Any = SimpleNamespace(areas=END.areas, response=SimpleNamespace(state=end))
    energies.commit(BEFORE, before, final)
    pressed = 0.5 * (1.0 + (1.0 * 4.0) / (3.0 * 8.0)) * (5.0 - 2.0)
    assert end["dissipation"] == pytest.approx(2.0 + pressed, rel=1e-14)
    expected = [[3.0 * pressed, 3.0 * 0.1]] * 2
    np.testing.assert_allclose(energies.dissipated, expected, rtol=1e-14)
    totals = energies.totals(end, END.areas)
    assert totals["friction"] == pytest.approx(2 * 3.0 * pressed, rel=1e-14)
    assert totals["normal"] == pytest.approx(2 * 3.0 * 0.35, rel=1e-14)
