"""A long strip on a floor, pulled sideways at its end: it slides in zones that alternate.

Source: a beam that friction alone holds, as that of a pipeline that is bent on the sea bed
[R. E. Hobbs, J. Transp. Engng 110 (1984) 175], without axial force: `EI w'''' = -q sgn w` with the
friction q of its length. It slides as it is pulled over some length, backwards beyond that, and so
on in zones a quarter as long each time. With a way d of the end from rest, in one increment,

    F = 1.10490 (EI d q^3)^(1/4) .

Requirement: the force, with friction of one coefficient, and with less along the strip, which takes
part where sections turn; no cut. Tolerance: measured 1.1e-4, and 1.6e-3 with two coefficients; the
strip is 1 wide, its first zone 11.7 long. Corrections: 27.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import fsolve
from tests.verification.hard.case_texts import on_a_floor

YOUNG, THICK, WAY, ACROSS = 1e5, 0.2, 0.05, 0.3
BENDING, DRAG = YOUNG * THICK / 12.0, ACROSS * THICK

CASE = f"""
{on_a_floor("strip", (40, 1, THICK), (80, 1, 1), YOUNG, order=2)}
friction = {{{{ {{friction}} }}}}
[[step]]
name = "weight"
increments = 1
body_force = {{{{ strip = {{{{ z = -1 }}}} }}}}
[[step]]
name = "pull"
increments = 1
displacement = {{{{ "strip.left" = {{{{ y = {WAY} }}}} }}}}
"""


def pull() -> float:
    """The force on the end, by quartics in four zones that end at w = 0, the last at rest."""
    scale = (BENDING * WAY / DRAG) ** 0.25

    def left(unknown: np.ndarray) -> list[float]:
        """Slope and force, then lengths of the zones, over `scale` and the way."""
        state, sign, over = np.array([1.0, unknown[0], 0.0, unknown[1]]), 1.0, []
        for number, length in enumerate(unknown[2:]):
            powers = length ** np.arange(5) / np.array([1.0, 1.0, 2.0, 6.0, 24.0])
            sums = [*state, -sign]
            state = np.array([sum(powers[: 5 - k] * sums[k:]) for k in range(4)])
            sign, over = -sign, [*over, state[0]]
            last = number == len(unknown) - 3
        return [*over, *(state[1:3] if last else [])]

    start = np.concatenate([[-0.9, 0.9], 2.7 * np.array([1.0, 0.5, 0.13, 0.03])])
    found, _, ok, _ = fsolve(left, start, full_output=True, xtol=1e-12)
    assert ok == 1
    return float(found[1] * BENDING * WAY / scale**3)


def test_closed_form() -> None:
    """The number of the page."""
    assert pull() / (BENDING * WAY * DRAG**3) ** 0.25 == pytest.approx(1.104897, abs=1e-6)


TWO = 'coefficients = [0.1, 0.3], directions = { kind = "constant", vector = [1, 0, 0] }'


@pytest.mark.parametrize(
    ("friction", "error"), [("coefficients = 0.3", 5e-4), (TWO, 3e-3)], ids=["one", "two"]
)
def test_force(to_the_end: Callable[..., Any], friction: str, error: float) -> None:
    """The force on the end that is pulled."""
    run = to_the_end(CASE.format(friction=friction), most=5000)
    assert not run.cuts
    assert run.ends["pull"].iterations <= 36
    force = run.ends["pull"].reactions["strip.left"][1]
    assert force == pytest.approx(pull(), rel=error)
