"""The driver: a load path through an interface, step by step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.shown import shown
from anisocontact.base.typed import typed
from anisocontact.interface import State
from anisocontact.point.balance import (
    Control,
    GroupPose,
    PointBalance,
    PointInterface,
    StepError,
    Trial,
)
from anisocontact.point.device import Committed, Device
from anisocontact.point.foot import foot
from anisocontact.point.group import Group
from anisocontact.point.history import (
    ENERGY,
    POINT,
    STEP,
    History,
    Records,
    StoppedError,
    point_rows,
    set_slip,
)
from anisocontact.point.loads import Load
from anisocontact.point.newton import solve

#: How often a step is halved before the drive stops.
MOST_HALVINGS = 10
#: Of the whole stiffness: a tangential one below is rounding.
_ROUNDED = 1e-12


@typed
def drive(
    interface: PointInterface,
    load: Load,
    group: Group | None = None,
    *,
    on_step: Callable[[int, float], None] | None = None,
) -> History:
    """Move a point, or a rigid group of points, under a load.

    The first row of the history is the start: the points free of force at the beginning of the
    load, then pressed by its first pressure or gap, in a time step as long as the first one.

    Args:
        interface: Surface and laws; anything with `surface`, `initial_state` and `update`.
        load: `PrescribedPath`, `DraggingSpring`, `DeadLoad` or `Push`.
        group: The points; a single one at the reference if left out.
        on_step: Called with the number and the time of every step that converged.

    Returns:
        The history.

    Raises:
        InputError: The load does not fit the surface.
        StoppedError: A step did not converge; the message says where and why, and its `history`
            has what did.

    Example:
        >>> from anisocontact.interface import Interface
        >>> from anisocontact.laws import Adhesion, Friction, NormalLaw
        >>> from anisocontact.point import DraggingSpring
        >>> from anisocontact.surfaces import make_surface
        >>> interface = Interface(
        ...     make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)),
        ...     NormalLaw(penalty=1e5),
        ...     Adhesion(stiffness=(2e5, 2e5)),
        ...     Friction(coefficients=(0.3, 0.3)),
        ... )
        >>> spring = DraggingSpring([(0, 0, 0), (1, 0, 0)], 100.0, pressure=10.0)
        >>> history = drive(interface, spring)
        >>> history.steps["force"][-1, [0, 2]].round(6).tolist()
        [3.0, -10.0]
    """
    runner = _Runner(interface, load, group or Group())
    rows: list[tuple[Records, Records]] = []
    message = ""
    try:
        rows.append(runner.press())
        for i, t in enumerate(load.instants[1:].tolist(), start=1):
            rows.append(runner.advance(t))
            if on_step is not None:
                on_step(i, t)
    except (StepError, InputError) as failure:
        i = len(rows)
        if isinstance(failure, InputError) and i <= 1:
            raise
        message = f"stopped in step {i}, at time {load.instants[i]:g}: {failure}"
    history = History(
        interface.surface,
        np.array([row for row, _ in rows], dtype=STEP),
        np.array([p for _, p in rows], dtype=POINT).reshape(len(rows), len(runner.group.areas)),
        runner.group.areas,
        runner.turn,
    )
    if message:
        raise StoppedError(message, history)
    return history


@dataclass(frozen=True)
class _Accepted:
    """Everything that an accepted step leaves behind."""

    time: float
    state: State
    pose: GroupPose
    traction: Floats
    rows: Records
    step: Records


class _Runner:
    """The accepted state of a drive, and how to get to the next one."""

    def __init__(self, interface: PointInterface, load: Load, group: Group) -> None:
        self.interface, self.load, self.group = interface, load, group
        self.stiffness = self.whole = 0.0  # tangential, and that in any direction: the largest
        self.turn = 0.0  # the largest of all steps
        self.now = self._free()

    def _free(self) -> _Accepted:
        """The group at the start of the load, without force [eq. (101)]."""
        surface = self.interface.surface
        start = self.load.start(surface)
        under = foot(surface, start)
        if not under.reached:
            raise InputError(
                f"it begins at {shown(start, 6)}, where there is no surface under it", "load"
            )
        x = under.position + max(under.gap, 0.0) * under.normal
        pose = GroupPose(x, foot(surface, x), self.group.arms(under))
        state = self.interface.initial_state(pose.points)
        n = len(state)
        step = np.zeros((), dtype=STEP)
        time = float(self.load.instants[0])
        return _Accepted(time, state, pose, np.zeros((n, 3)), np.zeros(n, dtype=POINT), step)

    def press(self) -> tuple[Records, Records]:
        """The first row: pressed where it starts."""
        t0, t1 = self.load.instants[:2].tolist()
        held = self.load.pressure is not None or self.load.gap is not None
        device = Device(self.now.pose.foot.position) if held else self._device(t0)
        self.now = self._step(device, t0, t1 - t0, sized=False)
        return self.now.step, self.now.rows

    def advance(self, t: float) -> tuple[Records, Records]:
        """The row of the instant t, in one step or as many halves as it takes."""
        iterations = substeps = 0
        slip = np.zeros((len(self.group.areas), 3))
        pending = [t]
        while pending:
            to = pending[-1]
            try:
                new = self._step(self._device(to), to, to - self.now.time, sized=self.load.sized)
            except StepError:
                if len(pending) > MOST_HALVINGS:
                    raise
                pending.append(0.5 * (self.now.time + to))
                continue
            self.now = new
            touching = new.state[new.state["status"] > 0]
            self.turn = max(self.turn, float(touching["turn"].max(initial=0.0)))
            pending.pop()
            iterations += int(new.step["iterations"])
            substeps += 1
            slip += new.rows["slip"]
        self.now.step["iterations"], self.now.step["substeps"] = iterations, substeps
        if substeps > 1:
            set_slip(self.interface.surface, self.now.rows, slip)
        return self.now.step, self.now.rows

    def _device(self, t: float) -> Device:
        a = self.now
        axes = a.rows["friction_axes"][0], a.rows["adhesion_axes"][0]
        before = Committed(a.time, a.pose.position, a.pose.foot, *axes, self.stiffness)
        return self.load.device(self.interface.surface, before, t)

    def _control(self, t: float) -> Control:
        load = self.load
        if load.pressure is not None:
            pressure = float(load.pressure(t))
            if pressure > 0.0:
                return Control(pressure=pressure)
            # Without force: above the surface by no more than rounding.
            up = 16.0 * np.finfo(np.float64).eps * float(np.abs(self.now.pose.position).max())
            return Control(gap=up)
        return Control() if load.gap is None else Control(gap=float(load.gap(t)))

    def _step(self, device: Device, t: float, dt: float, *, sized: bool) -> _Accepted:
        """One step of length dt to time t.

        Raises:
            StepError: It did not converge.
        """
        a = self.now
        balance = PointBalance(
            self.interface,
            a.state,
            a.pose,
            self.group,
            device,
            self._control(t),
            dt,
            sized,
            self.stiffness or self.whole or 1.0,
        )
        guess = balance.start
        aim = device.at(guess[:3], 0.0).aim
        if aim is not None:
            guess[:3] = aim + a.pose.foot.gap * a.pose.foot.normal
        trial, iterations = solve(balance, guess)
        self._stiffen(trial)
        return self._accepted(trial, device, t, iterations)

    def _stiffen(self, trial: Trial) -> None:
        """Take the stiffnesses met; without friction the tangential one is rounding, no scale."""
        p, k = trial.pose.foot.tangent_plane, trial.d_force[:, :3]
        self.whole = max(self.whole, float(np.linalg.norm(k, 2)))
        along = float(np.linalg.norm(p @ k @ p, 2))
        if along > _ROUNDED * self.whole:
            self.stiffness = max(self.stiffness, along)

    def _accepted(self, trial: Trial, device: Device, t: float, iterations: int) -> _Accepted:
        a, r, areas = self.now, trial.response, self.group.areas
        rows = point_rows(self.interface.surface, trial.pose, r)
        step = np.zeros((), dtype=STEP)
        x = trial.pose.position
        step["time"], step["reference"], step["turn"] = t, x, trial.pose.turn
        step["free_end"], step["force"] = device.free_end(x), -trial.force
        step["moment"] = -areas @ np.cross(trial.pose.arms, r.traction)
        step["iterations"], step["substeps"] = iterations, 1
        step["residual"] = np.linalg.norm(trial.residual) / max(trial.scale, 1e-300)
        before, now = a.step["energy"], step["energy"]
        now["spring"] = device.energy(x)
        for name, column in _PER_AREA.items():
            now[name] = areas @ rows[column]
        lost = device.dissipation(x)
        now["regularisation"] = before["regularisation"] + lost
        # By equilibrium the device does the work that the contact takes and it keeps or loses.
        moved = trial.pose.points - a.pose.points
        taken = -0.5 * areas @ np.einsum("ni,ni->n", a.traction + r.traction, moved)
        now["external"] = before["external"] + taken + now["spring"] - before["spring"] + lost
        others = [n for n in ENERGY.names or () if n not in ("external", "residual")]
        now["residual"] = now["external"] - sum(now[n] for n in others)
        return _Accepted(t, r.state, trial.pose, r.traction, rows, step)


_PER_AREA = {
    "adhesion": "energy_adhesion",
    "normal": "energy_normal",
    "friction": "dissipation",
    "viscous": "dissipation_viscous",
}
