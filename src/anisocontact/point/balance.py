"""Equations of one step of the driver, with their exact derivative.

Unknowns q: the reference x (3), then the turn about its normal where that is free, then the size
of the force where that is unknown. With R the resultant of the tractions on the points, F the
force of the load, n and P = I - n (x) n at the foot of the reference:

    P (R + F) + c n = 0,    c = R.n - N A,  k (gap - g),  or  (R + F).n

and k P (aim - x) in place of P (R + F) where the foot is prescribed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats
from anisocontact.base.shown import shown
from anisocontact.interface import FAILURE, Response, State
from anisocontact.point.device import Action, Device
from anisocontact.point.foot import Foot, foot
from anisocontact.point.group import Arms, Group, turned_arms
from anisocontact.surfaces import Surface


class PointInterface(Protocol):
    """What the driver asks of an interface: `Interface`, or one of your own."""

    @property
    def surface(self) -> Surface:
        """The master."""
        ...

    def initial_state(self, x: npt.ArrayLike) -> State:
        """State of points x, (n, 3), without force."""
        ...

    def update(
        self, state: State, x: npt.ArrayLike, dt: float = 1.0, *, tangent: bool = True
    ) -> Response:
        """Tractions, tangent and trial state at new positions; `state` is not changed."""
        ...


@dataclass(frozen=True)
class GroupPose:
    """Where the group is: reference, its foot, and arms in space.

    Args:
        position: Reference, (3,) [length].
        foot: Its foot.
        arms: From the reference to the points, (n, 3).
        turn: Turn about the normal since the start, radians.
    """

    position: Floats
    foot: Foot
    arms: Floats
    turn: float = 0.0

    @property
    def points(self) -> Floats:
        """The points, (n, 3)."""
        return self.position + self.arms


@dataclass(frozen=True)
class Control:
    """What is given along the normal: N, the gap, or neither.

    Args:
        pressure: N; None if it is not given.
        gap: xi^3; None if it is not given.
    """

    pressure: float | None = None
    gap: float | None = None

    @property
    def free(self) -> bool:
        """Whether nothing is given."""
        return self.pressure is None and self.gap is None


@dataclass(frozen=True)
class Trial:
    """The equations at a trial position.

    Args:
        q: Unknowns.
        pose: Where the group is.
        response: What the interface answers.
        force: R, resultant of the tractions, (3,).
        d_force: dR/dq, (3, m).
        residual: (m,) [force].
        jacobian: d(residual)/dq, (m, m).
        scale: Size of the forces, for the tolerance.
    """

    q: Floats
    pose: GroupPose
    response: Response
    force: Floats
    d_force: Floats
    residual: Floats
    jacobian: Floats
    scale: float


class StepError(Exception):
    """A trial position or a step that cannot be evaluated; the message says why."""


@dataclass(frozen=True)
class PointBalance:
    """The equations of a step.

    Args:
        interface: The interface; only `update` and `surface` are used.
        state: Committed state of the points.
        pose: Committed pose.
        group: The group.
        device: What the load does.
        control: What is given along the normal.
        dt: Time step.
        sized: Whether the size of the force is an unknown.
        stiffness: Scale that makes a length a force in the equations of places.
    """

    interface: PointInterface
    state: State
    pose: GroupPose
    group: Group
    device: Device
    control: Control
    dt: float
    sized: bool
    stiffness: float

    @property
    def start(self) -> Floats:
        """Unknowns of the committed pose."""
        return np.concatenate([self.pose.position, np.zeros(self._turns + int(self.sized))])

    @property
    def _turns(self) -> int:
        return int(self.group.orientation == "free")

    def at(self, q: Floats) -> Trial:
        """Evaluate at the unknowns q.

        Raises:
            StepError: The reference has no foot, or a point cannot be updated.
        """
        here = foot(self.interface.surface, q[:3])
        if not here.reached:
            raise StepError(f"no point of the surface is under {shown(q[:3], 6)}, it ends before")
        turn = float(q[3]) if self._turns else 0.0
        arms = turned_arms(self.group.orientation, self.pose.arms, self.pose.foot, here, turn)
        response = self.interface.update(self.state, q[:3] + arms.vectors, self.dt)
        failed = np.flatnonzero(response.failed)
        if failed.size:
            i = int(failed[0])
            raise StepError(
                f"point {shown(q[:3] + arms.vectors[i], 6)}: {FAILURE[response.failure[i]]}"
            )
        if not (np.isfinite(response.traction).all() and np.isfinite(response.tangent).all()):
            raise StepError(
                f"with the reference at {shown(q[:3], 6)} the traction or its tangent is not "
                "finite; stiffnesses may be too far apart"
            )
        return self._assembled(q, here, arms, response, turn)

    def _assembled(
        self, q: Floats, here: Foot, arms: Arms, response: Response, turn: float
    ) -> Trial:
        m, areas = len(q), self.group.areas
        moved = np.zeros((len(areas), 3, m))
        moved[:, :, :3] = np.eye(3) + arms.d_position
        moved[:, :, 3 : 3 + self._turns] = arms.d_turn
        d_traction = response.tangent @ moved
        force, d_force = areas @ response.traction, np.tensordot(areas, d_traction, 1)
        action = self.device.at(q[:3], float(q[-1]) if self.sized else 0.0)
        residual, jacobian = np.zeros(m), np.zeros((m, m))
        residual[:3], jacobian[:3] = self._forces(q, here, force, d_force, action)
        if self._turns:
            residual[3], jacobian[3] = self._moment(here, arms, response, d_traction)
        if action.advance is not None:
            direction, left = action.advance
            residual[-1] = self.stiffness * left
            jacobian[-1, :3] = -self.stiffness * direction
        return Trial(
            q=q,
            pose=GroupPose(q[:3], here, arms.vectors, self.pose.turn + turn),
            response=response,
            force=force,
            d_force=d_force,
            residual=residual,
            jacobian=jacobian,
            scale=float(
                areas @ np.linalg.norm(response.traction, axis=1) + np.linalg.norm(action.force)
            ),
        )

    def _forces(
        self, q: Floats, here: Foot, force: Floats, d_force: Floats, action: Action
    ) -> tuple[Floats, Floats]:
        """Balance of forces, or the place, with what is given along the normal."""
        k, m = self.stiffness, len(q)
        if action.aim is None:
            g, dg = force + action.force, d_force.copy()
            dg[:, :3] += action.d_position
            if action.d_size is not None:
                dg[:, -1] += action.d_size
        else:
            g, dg = k * (action.aim - q[:3]), -k * np.eye(3, m)
        if self.control.free:
            return g, dg
        n, dn = here.normal, np.zeros((3, m))
        dn[:, :3] = here.d_normal
        c, dc = self._along(here, force, d_force, dn)
        along = float(n @ g)
        residual = g - along * n + c * n
        jacobian = dg + np.outer(n, dc - n @ dg - g @ dn) + (c - along) * dn
        return residual, jacobian

    def _along(
        self, here: Foot, force: Floats, d_force: Floats, dn: Floats
    ) -> tuple[float, Floats]:
        """Residual along the normal: of the gap or of the pressure."""
        n = here.normal
        if self.control.gap is not None:
            k = self.stiffness
            return k * (self.control.gap - here.gap), -k * (n @ np.eye(3, dn.shape[1]))
        return float(force @ n) - self.normal_force, n @ d_force + force @ dn

    @property
    def normal_force(self) -> float:
        """Resultant that belongs to the given pressure [force]."""
        return (self.control.pressure or 0.0) * float(self.group.areas.sum())

    def _moment(
        self, here: Foot, arms: Arms, response: Response, d_traction: Floats
    ) -> tuple[float, Floats]:
        """Moment about the normal at the reference, over the length of the longest arm."""
        m = d_traction.shape[2]
        a, u, t, n = self.group.areas, arms.vectors, response.traction, here.normal
        length = float(np.linalg.norm(u, axis=1).max())
        du = np.zeros((len(u), 3, m))
        du[:, :, :3] = arms.d_position
        du[:, :, 3:4] = arms.d_turn
        total = a @ np.cross(u, t)
        d_total = np.stack(
            [a @ (np.cross(du[:, :, j], t) + np.cross(u, d_traction[:, :, j])) for j in range(m)],
            axis=1,
        )
        d_moment = n @ d_total
        d_moment[:3] += total @ here.d_normal
        return float(total @ n) / length, d_moment / length
