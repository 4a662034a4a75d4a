"""The Jacobian of the driver's equations is exact: by order of convergence.

The error of a central difference falls by four when its step is halved; an error in the Jacobian
would stay. Every load, every orientation of a group, stick and slip, on a torus.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.point import Group
from anisocontact.point.balance import Control, GroupPose, PointBalance
from anisocontact.point.device import Advance, Dashpot, Device, DraggedSpring, FixedPlace
from anisocontact.point.foot import foot
from anisocontact.point.group import turned_arms
from anisocontact.surfaces import make_surface

TORUS = make_surface("torus", centre=(0, 0, 0), axis=(0, 0, 1), radius=1.5, tube=0.5)
START = TORUS.position([[0.4, 0.7]])[0]
ARMS = 0.05 * np.array([[0, 0, 0], [1, 2, 0], [-1, 0.5, 1.0], [0.3, -1, -0.7]])

DEVICES = {
    "place": Device(START),
    "position": FixedPlace(START),
    "spring": DraggedSpring(np.diag([300.0, 200.0, 100.0]), START + 0.01),
    "dead-load": Dashpot(np.array([1.0, -2.0, 0.5]), 30.0, START, 0.1),
    "push": Advance(np.array([0.0, 0.6, 0.8]), START, 0.003),
}
CONTROLS = {"pressure": Control(pressure=10.0), "gap": Control(gap=-2e-3), "none": Control()}


def _balance(device: str, orientation: str, control: str) -> PointBalance:
    marks = make_directions("constant", vector=(0.3, 1.0, 0.5))
    interface = Interface(
        TORUS,
        NormalLaw(penalty=1e4),
        Adhesion(stiffness=(2e3, 8e2), directions=marks),
        Friction(coefficients=(0.35, 0.15), directions=marks),
    )
    pose = GroupPose(START, foot(TORUS, START), ARMS)
    return PointBalance(
        interface=interface,
        state=interface.initial_state(pose.points),
        pose=pose,
        group=Group(ARMS, areas=[1.0, 0.5, 2.0, 1.5], orientation=orientation),
        device=DEVICES[device],
        control=CONTROLS[control],
        dt=0.1,
        sized=device == "push",
        stiffness=5e3,
    )


@pytest.mark.parametrize("moved", ["stick", "slip"])
@pytest.mark.parametrize("orientation", ["held", "surface", "free"])
@pytest.mark.parametrize(
    ("device", "control"),
    [
        ("place", "pressure"),
        ("place", "gap"),
        ("position", "none"),
        ("spring", "pressure"),
        ("spring", "none"),
        ("dead-load", "pressure"),
        ("push", "gap"),
        ("push", "pressure"),
    ],
)
def test_jacobian_by_order(device: str, control: str, orientation: str, moved: str) -> None:
    """Halving the step quarters the difference between central difference and Jacobian."""
    balance = _balance(device, orientation, control)
    n = balance.pose.foot.normal
    along = np.cross(n, [0.2, 0.5, -0.4])
    q = balance.start
    q[:3] += (2e-4 if moved == "stick" else 0.2) * along - 0.03 * n
    if len(q) > 3:
        q[3] = 1e-3 if orientation == "free" else 2.0
    at = balance.at(q)
    # Of the points that touch; the arms of a held group may lift some of them.
    assert set(at.response.status.tolist()) & ({1} if moved == "stick" else {2})
    direction = np.linspace(1.0, -0.7, len(q))
    exact = at.jacobian @ direction
    errors = []
    for h in (4e-5, 2e-5):
        step = h * direction
        change = (balance.at(q + step).residual - balance.at(q - step).residual) / (2.0 * h)
        errors.append(np.linalg.norm(change - exact))
    rounding = 1e-9 * np.linalg.norm(exact)
    assert errors[0] < 1e-3 * np.linalg.norm(exact)
    assert errors[0] < rounding or errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


@pytest.mark.parametrize("orientation", ["surface", "free"])
def test_arms_are_turned_rigidly(orientation: str) -> None:
    """A turn keeps lengths and angles, and heights over the tangent plane: rounding."""
    there = foot(TORUS, TORUS.position([[1.1, -0.4]])[0])
    before = foot(TORUS, START)
    arms = turned_arms(orientation, ARMS, before, there, 0.8).vectors
    assert np.allclose(arms @ arms.T, ARMS @ ARMS.T, atol=1e-16)
    assert np.allclose(arms @ there.normal, ARMS @ before.normal, atol=1e-15)
