"""Tangential laws written in Python: batched NumPy in, batched NumPy out.

A law gives the tangential force of many points at once in an orthonormal frame of the tangent
plane. `PythonInterface` does the rest (projection, pressure, transport of the history, tangent in
space) and can be used wherever an `Interface` can. `PythonPairLaw` is the same for two meshed
bodies.
"""

from __future__ import annotations

import traceback
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.anisotropy import DirectionField
from anisocontact.base.errors import InputError
from anisocontact.interface.interface import (
    FAILURE,
    POINTS_ALONE,
    STATE,
    Response,
    SlaveSurface,
    State,
    as_state,
    raw_state,
)
from anisocontact.interface.series import History
from anisocontact.laws import NormalLaw
from anisocontact.surfaces import Floats, Surface, default_threads, points


@dataclass(frozen=True)
class LawState:
    """What n points remember, turned to where they are now.

    Args:
        traction: Elastic force, (n, 2) [stress].
        elastic: Elastic slip, (n, 2) [length].
        internal: The law's own variables, (n, k).
    """

    traction: Floats
    elastic: Floats
    internal: Floats


@dataclass(frozen=True)
class LawKinematics:
    """What happens to n points in contact in this step.

    Args:
        increment: Slip increment, (n, 2) [length].
        pressure: N at the end of the step, (n,) [stress].
        gap: xi^3 at the end of the step, (n,) [length].
        xi: Coordinates of the projection, (n, 2); on a meshed master those of a facet.
        dt: Time step [time].
    """

    increment: Floats
    pressure: Floats
    gap: Floats
    xi: Floats
    dt: float


@dataclass(frozen=True)
class LawResult:
    """Force, tangent and new state of n points.

    Args:
        traction: T on the slave, (n, 2) [stress].
        slip: Sliding increment, (n, 2) [length]; zero where the point sticks.
        d_increment: dT/d(increment), (n, 2, 2).
        d_pressure: dT/dN, (n, 2).
        d_traction: dT/d(state.traction), (n, 2, 2).
        d_elastic: dT/d(state.elastic), (n, 2, 2).
        internal: The law's own variables at the end of the step, (n, k).
        dissipation: Frictional dissipation of the step, (n,) [energy/area].
        energy: Elastic energy at the end of the step, (n,) [energy/area].
        stored: Elastic force that the next step starts from, (n, 2); T if left out.
    """

    traction: Floats
    slip: Floats
    d_increment: Floats
    d_pressure: Floats
    d_traction: Floats
    d_elastic: Floats
    internal: Floats
    dissipation: Floats
    energy: Floats
    stored: Floats | None = field(default=None)


class TangentialLaw(Protocol):
    """A law of the tangential force; `internal` is the number of its own variables."""

    internal: int

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        """Force, tangent and new state; must not change its arguments."""
        ...


class PythonInterface:
    """An interface whose tangential law is written in Python.

    The frame of the law has its first axis along the first axis of `directions`, its second
    along n x e_1. The tangent in space is exact if the law's blocks are.

    Args:
        surface: The master.
        normal: Law of the pressure.
        law: The tangential law.
        directions: First axis of the frame; along the first coordinate line if left out, which
            does for isotropic laws.
        threads: Number of threads of the kinematics; all processors if left out.

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> class Spring:
        ...     internal = 0
        ...     def update(self, state, kinematics):
        ...         n, eye = len(kinematics.pressure), np.eye(2)
        ...         t = state.traction - 10.0 * kinematics.increment
        ...         block = np.tile(eye, (n, 1, 1))
        ...         zero = np.zeros(n)
        ...         return LawResult(
        ...             traction=t, slip=np.zeros((n, 2)), d_increment=-10.0 * block,
        ...             d_pressure=np.zeros((n, 2)), d_traction=block, d_elastic=0.0 * block,
        ...             internal=state.internal, dissipation=zero, energy=(t**2).sum(1) / 20.0)
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> itf = PythonInterface(plane, NormalLaw(penalty=1e3), Spring())
        >>> r = itf.update(itf.initial_state([[0.0, 0.0, 0.0]]), [[0.1, 0.0, -0.01]])
        >>> r.traction.round(12).tolist()
        [[-1.0, 0.0, 10.0]]
    """

    def __init__(
        self,
        surface: Surface,
        normal: NormalLaw,
        law: TangentialLaw,
        *,
        directions: DirectionField | None = None,
        threads: int | None = None,
    ) -> None:
        self.surface, self.normal, self.law, self.directions = surface, normal, law, directions
        self.threads = threads or default_threads()
        self.core = _core.FramedInterface(
            surface.core, normal.named, directions.core if directions else None
        )
        self.dtype = state_type(law.internal)

    def stiffened(self, normal: float, _: float = 1.0) -> PythonInterface:
        """The interface with a normal penalty `normal` times as large."""
        stiffer = self.normal.stiffened(normal)
        return PythonInterface(
            self.surface, stiffer, self.law, directions=self.directions, threads=self.threads
        )

    def penalties(self) -> tuple[float, float]:
        """Normal penalty, stress/length; the tangential law has none: 1."""
        return self.normal.named[1]["penalty"][0], 1.0

    def in_series(self, compliance: float, dt: float) -> tuple[PythonInterface, History]:
        """The interface with a compliant layer behind its tangential law, see `LawInSeries`."""
        law = LawInSeries(self.law, compliance)
        made = PythonInterface(
            self.surface, self.normal, law, directions=self.directions, threads=self.threads
        )
        return made, History.unchanged()

    def slip_stiffness(self, dt: float) -> float:
        """Stiffness of the tangential law against slip, see `law_stiffness`, stress/length."""
        return law_stiffness(self.law, dt)

    def initial_state(self, x: npt.ArrayLike) -> State:
        """State before the first step: projected, free of force, own variables zero.

        Args:
            x: Slave points, (n, 3) [length].

        Returns:
            The state, (n,), with the fields of `STATE` and `internal` (n, k).

        Raises:
            InputError: A point has no closest point on the surface.
        """
        x = points(x, 3)
        r = self.core.initial_state(x)
        failed = np.flatnonzero(r["failure"])
        if failed.size:
            raise InputError(f"{FAILURE[1]} for the point {x[failed[0]].tolist()}", field="x")
        return with_internal(as_state(r["state"]), np.zeros((len(x), self.law.internal)))

    def takes_slave(self) -> bool:
        """Whether a surface of the slave would change what is answered: its turn turns the slip."""
        return True

    def update(
        self,
        state: State,
        x: npt.ArrayLike,
        dt: float = 1.0,
        *,
        tangent: bool = True,
        slave: SlaveSurface | None = None,
    ) -> Response:
        """Tractions at new positions; the committed state is not changed.

        Args:
            state: Committed state, (n,), from `initial_state` or a `Response`.
            x: Slave points, (n, 3) [length].
            dt: Time step [time].
            tangent: Whether dt/dx is wanted.
            slave: The slave's surface, whose turn against the master turns the slip.

        Returns:
            Tractions, tangent and trial state, as of `Interface.update`.
        """
        x = points(x, 3)
        raw = raw_state(common(state))
        own = (slave or POINTS_ALONE).arrays
        k = self.core.kinematics(raw, x, dt, self.threads, *own)
        n = len(x)
        frame = k["frame"].reshape(n, 3, 3)
        active = np.flatnonzero((k["pressure"][:, 0] > 0.0) & (k["failure"] == 0))
        result = self._ask(state, k, active, dt)
        traction = k["pressure"] * frame[:, 2]
        traction[active] += np.einsum("ni,nij->nj", result.traction, frame[active, :2])
        return Response(
            traction=traction,
            tangent=self._tangent(k, frame, active, result) if tangent else np.empty((0, 3, 3)),
            state=self._commit(raw, x, dt, active, result, own),
            normal=frame[:, 2].copy(),
            directions_adhesion=_in_contact(frame, active),
            directions_friction=_in_contact(frame, active),
            failure=k["failure"],
            tangent_slave=_by_slave(k["increment_slave"], frame, active, result),
        )

    def _ask(
        self,
        state: State,
        k: dict[str, npt.NDArray[np.float64]],
        active: npt.NDArray[np.intp],
        dt: float,
    ) -> LawResult:
        remembered = LawState(k["stored"][active], k["elastic"][active], state["internal"][active])
        now = LawKinematics(
            k["increment"][active],
            k["pressure"][active, 0],
            k["gap"][active, 0],
            k["xi"][active],
            dt,
        )
        return answer(self.law, remembered, now)

    def _tangent(
        self,
        k: dict[str, npt.NDArray[np.float64]],
        frame: Floats,
        active: npt.NDArray[np.intp],
        r: LawResult,
    ) -> Floats:
        """dt/dx = n (x) dN + N dn + e_a (x) dT_a + T_a de_a."""
        frame_dx = k["frame_dx"].reshape(len(frame), 3, 3, 3)
        tangent = np.einsum("ni,nj->nij", frame[:, 2], k["pressure_dx"][:, 0])
        tangent += k["pressure"][:, :, None] * frame_dx[:, 2]
        dt_dx = (
            np.einsum("nab,nbj->naj", r.d_increment, k["increment_dx"][active])
            + np.einsum("nab,nbj->naj", r.d_traction, k["stored_dx"][active])
            + np.einsum("nab,nbj->naj", r.d_elastic, k["elastic_dx"][active])
            + np.einsum("na,nj->naj", r.d_pressure, k["pressure_dx"][active, 0])
        )
        tangent[active] += np.einsum("nai,naj->nij", frame[active, :2], dt_dx)
        tangent[active] += np.einsum("na,naij->nij", r.traction, frame_dx[active, :2])
        return np.asarray(tangent)

    def _commit(
        self,
        raw: npt.NDArray[np.uint8],
        x: Floats,
        dt: float,
        active: npt.NDArray[np.intp],
        r: LawResult,
        own: tuple[Floats, Floats, Floats],
    ) -> State:
        n = len(x)
        pairs = {name: np.zeros((n, 2)) for name in ("traction", "stored", "slip")}
        pairs["traction"][active] = r.traction
        pairs["stored"][active] = r.traction if r.stored is None else r.stored
        pairs["slip"][active] = r.slip
        dissipation, energy = np.zeros(n), np.zeros(n)
        dissipation[active], energy[active] = r.dissipation, r.energy
        status = np.zeros(n, dtype=np.int8)
        status[active] = 1 + np.any(r.slip != 0.0, axis=1)
        new = self.core.commit(
            raw,
            x,
            dt,
            pairs["traction"],
            pairs["stored"],
            pairs["slip"],
            dissipation,
            energy,
            status,
            *own,
        )
        internal = np.zeros((n, self.law.internal))
        internal[active] = r.internal
        return with_internal(as_state(new), internal)


def answer(law: TangentialLaw, state: LawState, kinematics: LawKinematics) -> LawResult:
    """What a law answers, checked.

    Args:
        law: The law.
        state: What n points remember.
        kinematics: What happens to them.

    Returns:
        Its answer.

    Raises:
        InputError: The law failed, or an array has another shape or numbers that are not finite.
    """
    n, own = state.internal.shape
    try:
        result = law.update(state, kinematics)
    except (Exception, SystemExit) as error:
        raise InputError(f"the law {type(law).__name__} failed: {where_failed(error)}") from error
    shapes: dict[str, tuple[int, ...]] = {
        **dict.fromkeys(("traction", "slip", "d_pressure"), (n, 2)),
        **dict.fromkeys(("d_increment", "d_traction", "d_elastic"), (n, 2, 2)),
        **dict.fromkeys(("dissipation", "energy"), (n,)),
        "internal": (n, own),
    }
    if result.stored is not None:
        shapes["stored"] = (n, 2)
    for name, shape in shapes.items():
        values = np.asarray(getattr(result, name))
        if values.shape != shape:
            text = f"the law returned an array of shape {values.shape}, {shape} needed"
            raise InputError(text, field=name)
        bad = np.flatnonzero(~np.isfinite(values).all(axis=tuple(range(1, values.ndim))))
        if bad.size:
            text = f"the law returned {values[bad[0]].tolist()} at {len(bad)} of {n} points, "
            raise InputError(text + "finite numbers needed", field=name)
    return result


def where_failed(error: BaseException) -> str:
    """An error of somebody's code in one line: file and line, and what it says."""
    at: tuple[str | None, int | None] = (None, None)
    if isinstance(error, SyntaxError):
        at = (error.filename, error.lineno)
    elif frames := traceback.extract_tb(error.__traceback__)[1:]:
        at = (frames[-1].filename, frames[-1].lineno)
    said = " ".join(f"{type(error).__name__}: {getattr(error, 'msg', None) or error}".split())
    return said if at[0] is None else f"{Path(at[0]).name}, line {at[1]}: {said}"


def state_type(count: int) -> np.dtype[np.void]:
    """Type of the state of a point: the fields of `STATE`, and `internal` (count,)."""
    names = STATE.names or ()
    formats = [*(STATE[name] for name in names), (np.float64, (count,))]
    return np.dtype({"names": [*names, "internal"], "formats": formats})


def common(state: State) -> State:
    """The fields of `STATE` alone."""
    if state.dtype == STATE:
        return state
    alone = np.zeros(len(state), dtype=STATE)
    for name in STATE.names or ():
        alone[name] = state[name]
    return alone


def with_internal(alone: State, internal: Floats) -> State:
    """States with a law's own variables, (n, k)."""
    state = np.zeros(len(alone), dtype=state_type(internal.shape[1]))
    for name in STATE.names or ():
        state[name] = alone[name]
    state["internal"] = internal
    return state


def _by_slave(
    increment: Floats, frame: Floats, active: npt.NDArray[np.intp], r: LawResult
) -> Floats:
    """dt/ds_i = e_a (x) dT_a/ds_i by the tangents of the slave, (n, 2, 3, 3); (0, 2, 3, 3) without.

    Args:
        increment: Derivatives of the slip, (n, 2, 2, 3).
        frame: Frames, (n, 3, 3).
        active: Points in contact.
        r: What the law has answered there.
    """
    tangent = np.zeros((len(increment), 2, 3, 3))
    if len(increment):
        change = np.einsum("nab,nbij->naij", r.d_increment, increment[active])
        tangent[active] = np.einsum("nak,naij->nikj", frame[active, :2], change)
    return tangent


def _in_contact(frame: Floats, active: npt.NDArray[np.intp]) -> Floats:
    """Axes at points in contact, zero elsewhere."""
    axes = np.zeros((len(frame), 2, 3))
    axes[active] = frame[active, :2]
    return axes


#: Change of the force of a law in series over the force at which it is found, and the most
#: corrections that are made to find it.
_SAME, _MOST = 1e-12, 20


def law_stiffness(law: TangentialLaw, dt: float) -> float:
    """Stiffness of a law in Python against slip, from rest under a unit pressure, stress/length.

    Args:
        law: The law.
        dt: Time increment.

    Returns:
        The largest along any direction; 0 where the law has no answer there.
    """
    none = np.zeros((1, 2))
    state = LawState(none, none, np.zeros((1, law.internal)))
    try:
        found = answer(law, state, LawKinematics(none, np.ones(1), np.zeros(1), none, dt))
    except InputError:
        return 0.0
    return float(np.linalg.norm(found.d_increment[0], ord=2))


class LawInSeries:
    """A law in Python with a compliant layer behind it: the force T with `T = law(dxi + c T)`.

    Args:
        law: The law.
        compliance: c, length/stress.
    """

    def __init__(self, law: TangentialLaw, compliance: float) -> None:
        self._law, self._compliance = law, compliance
        self.internal = law.internal

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        """Force, tangent and new state, found by Newton's method at every point."""
        c, force = self._compliance, state.traction
        for _ in range(_MOST):
            moved = replace(kinematics, increment=kinematics.increment + c * force)
            result = answer(self._law, state, moved)
            left = np.eye(2) - c * np.asarray(result.d_increment)
            step = np.linalg.solve(left, (result.traction - force)[..., None])[..., 0]
            force = force + step
            if np.abs(step).max(initial=0.0) <= _SAME * np.abs(force).max(initial=0.0):
                break
        return replace(
            result,
            d_increment=np.linalg.solve(left, result.d_increment),
            d_pressure=np.linalg.solve(left, np.asarray(result.d_pressure)[..., None])[..., 0],
            d_traction=np.linalg.solve(left, result.d_traction),
            d_elastic=np.linalg.solve(left, result.d_elastic),
        )
