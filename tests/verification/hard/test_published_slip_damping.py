"""A strip pressed on a floor, pulled to and fro at its end: slip goes along it as far as it must.

Source: L. E. Goodman, A review of progress in analysis of interfacial slip damping (ASME, 1959):
friction q per length holds a strip of stiffness EA from its end on; a force F lets it slip on the
length F / q, its end goes by F^2 / 2 E A q, and friction dissipates F^3 / 6 E A q the first time
and in a cycle between F and -F

    2 F^3 / (3 E A q) .

Friction 0.3 and 0.1 along axes at the angle c, in a plane that slip does not leave, holds with
q / p = |(0.3 cos c, 0.1 sin c)|, as it is normal to its ellipse [Michalowski, Mroz 1978].

Requirement: the energies, and the way of the end, with one increment a way; corrections of an
increment. Tolerance: measured 1e-3; 0.7 %, as friction below the middle of the strip shifts its
pressure; 21 corrections along an axis, 24 at an angle, where the traction across the plane comes
from how points slip.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.case_texts import on_a_floor

LENGTH, HIGH, E = 20.0, 0.25, 1e4

CASE = f"""
{on_a_floor("strip", (LENGTH, HIGH), (80, 1), E)}
[contact.friction]
coefficients = [0.3, 0.1]
directions = {{{{ kind = "constant", vector = [1, 0, 0], angle_deg = {{angle}} }}}}
[[step]]
name = "press"
increments = 1
pressure = {{{{ "strip.top" = 1.0 }}}}
"""
WAY = """
[[step]]
name = "{}"
increments = 1
force = {{ "strip.right" = {{ x = {!r} }} }}
"""


@pytest.mark.parametrize(("angle", "most"), [(0.0, 30), (50.0, 35)])
def test_cycle(to_the_end: Callable[..., Any], angle: float, most: int) -> None:
    """Energies of the first pull and of a cycle, and how far the end goes."""
    holds = float(np.hypot(0.3 * np.cos(np.radians(angle)), 0.1 * np.sin(np.radians(angle))))
    force = 0.5 * holds * LENGTH
    text = CASE.format(angle=angle)
    for step, sign in (("out", 1.0), ("in", -1.0), ("again", 1.0)):
        text += WAY.format(step, sign * force)
    run = to_the_end(text)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= most
    unit = force**3 / (E * HIGH * holds)
    spent = [run.ends[step].energies["friction"] for step in ("out", "in", "again")]
    assert spent[0] == pytest.approx(unit / 6.0, rel=3e-3)
    assert spent[2] - spent[0] == pytest.approx(2.0 / 3.0 * unit, rel=3e-3)
    u = run.problem.accepted().array_r[: run.problem.layout.owned].reshape(-1, 3)
    x = run.problem.model.space.tabulate_dof_coordinates()[: len(u)]
    end = u[x[:, 0] > LENGTH - 1e-9, 0].mean()
    assert end == pytest.approx(0.5 * force**2 / (E * HIGH * holds), rel=0.012)
