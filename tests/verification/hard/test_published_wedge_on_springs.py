"""A wedge is pushed up an incline against a spring, on grooves too, as in benchmarks of sliding.

Source: statics of wedges [J. L. Meriam, L. G. Kraige, Engineering Mechanics: Statics, ch. 6]: under
its weight W and a push P along the ground the wedge of the angle a comes to rest at the way

    (P - W tan(a + r)) / k ,  tan r the friction up the incline.

On grooves nothing holds it across: friction acts up the incline alone, tan r = 1 / sqrt(F_uu) with
the tensor F of the ellipse, and the slip is normal to that, F_cu / F_uu times as far across as up
[R. Michalowski, Z. Mroz, Arch. Mech. 30, 1978]. Numbers are those of the sliding wedge of NAFEMS,
W = 3058 and P = 1500, tan a = 0.1, and a spring that is pressed by 1 without friction.

Requirement: way and drift, isotropic and on grooves either way, multipliers and penalties, at small
and at finite strain, with the ground in any plane of space. Tolerance: measured 2e-5 and 6e-6, what
the wedge is strained and, at small strain, turned. Corrections: 25 for the weight, under which it
slides on its own where tan r < tan a, 7 at most with multipliers and 37 with penalties in the five
increments of the push.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

WEIGHT, PUSH, STIFFNESS, STEEP = 3058.0, 1500.0, 1194.2, 0.1
ANGLE = float(np.arctan(STEEP))

CASE = """
title = "Wedge on a spring"
[mesh.box.wedge]
origin = [-1, -1, 0]
size = [2, 2, 1]
cells = [3, 3, 3]
rotate = {{ axis = {axis}, angle_deg = {turn} }}
[material.wedge]
model = "{model}"
E = 2e7
nu = 0.3
[surface.incline]
shape = "plane"
point = [0, 0, 0]
normal = {normal}
[[contact]]
slave = "wedge.bottom"
master = "incline"
{given}
[contact.friction]
coefficients = {friction}
directions = {{ kind = "constant", vector = {up}, angle_deg = {grooves} }}
[spring.stop]
group = "wedge.right"
stiffness = {stiffness}
[[step]]
name = "weight"
increments = 1
force = {{ "wedge.top" = {weight} }}
[[step]]
name = "push"
increments = 5
force = {{ "wedge.left" = {push} }}
"""


def _expected(friction: tuple[float, float], grooves: float) -> tuple[float, float]:
    """Way along the ground, and drift across over the way up."""
    c, s = np.cos(np.radians(grooves)), np.sin(np.radians(grooves))
    along, across = (coefficient**-2.0 for coefficient in friction)
    up, mixed = along * c**2 + across * s**2, (along - across) * c * s
    way = (PUSH - WEIGHT * np.tan(ANGLE + np.arctan(up**-0.5))) / STIFFNESS
    return float(way), float(mixed / up)


def _case(frame: Rotation, friction: tuple[float, float], grooves: float, more: dict[str, str]):
    """The case file with the ground x, y in another frame."""

    def listed(vector: Any) -> list[float]:
        return [float(v) for v in np.round(vector, 15)]

    def table(vector: Any) -> str:
        named = zip("xyz", listed(frame.apply(vector)), strict=True)
        return "{ " + ", ".join(f"{name} = {value!r}" for name, value in named) + " }"

    tilt = frame * Rotation.from_rotvec([0.0, -ANGLE, 0.0])
    turn = tilt.as_rotvec()
    text = CASE.format(
        axis=listed(turn / np.linalg.norm(turn)),
        turn=float(np.degrees(np.linalg.norm(turn))),
        normal=listed(tilt.apply([0.0, 0.0, 1.0])),
        up=listed(tilt.apply([1.0, 0.0, 0.0])),
        friction=list(friction),
        grooves=grooves,
        stiffness=listed(STIFFNESS * np.abs(frame.apply([1.0, 0.0, 0.0]))),
        weight=table([0.0, 0.0, -WEIGHT]),
        push=table([PUSH, 0.0, 0.0]),
        **more,
    )
    return text, tilt


@pytest.mark.parametrize(
    ("frame", "friction", "grooves", "given", "most"),
    [
        ([0.0, 0.0, 0.0], (0.1, 0.1), 0.0, "", 10),
        ([0.0, 0.0, 90.0], (0.1, 0.05), 30.0, "", 10),
        ([90.0, 0.0, 0.0], (0.05, 0.1), -50.0, "", 10),
        ([0.0, 0.0, 0.0], (0.1, 0.05), 30.0, 'method = "penalty"', 42),
    ],
    ids=["isotropic", "grooves", "other grooves", "penalties"],
)
@pytest.mark.parametrize("model", ["linear-elastic", "neo-hookean"])
def test_way_and_drift(
    to_the_end: Callable[..., Any],
    frame: list[float],
    friction: tuple[float, float],
    grooves: float,
    given: str,
    most: int,
    model: str,
) -> None:
    """Where the wedge comes to rest."""
    way, drift = _expected(friction, grooves)
    turned = Rotation.from_rotvec(np.radians(frame))
    text, tilt = _case(turned, friction, grooves, {"given": given, "model": model})
    run = to_the_end(text)
    assert not run.cuts
    weight, *push = [part.iterations for part in run.accepted]
    assert weight <= 32
    assert max(push) <= most
    u = run.problem.accepted().array_r[: run.problem.layout.owned].reshape(-1, 3).mean(axis=0)
    up, across, _ = tilt.inv().apply(u)
    assert up * np.cos(ANGLE) == pytest.approx(way, rel=1e-4)
    assert across / up == pytest.approx(drift, abs=2e-5)
