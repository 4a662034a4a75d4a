"""Tangential laws written in Python: batched NumPy in, batched NumPy out.

A law gives the tangential force of many points at once in an orthonormal frame of the tangent
plane. The core does the rest: projection, pressure, transport of the history, tangent in space. A
`PythonLaw` stands in a `ContactLaw` where adhesion and friction of the core do.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.anisotropy import DirectionField
from anisocontact.base.arrays import answered, read_only
from anisocontact.base.errors import InputError
from anisocontact.base.python_file import where_failed
from anisocontact.interface.series import History
from anisocontact.interface.states import STATE, State, as_state, raw_state
from anisocontact.laws import SIDES, Adhesion, Carried, Friction, NormalLaw
from anisocontact.surfaces import Floats

#: How the history enters a step: a law in Python sees it turned to where the point is.
EVOLUTION = "transport"

#: From the states of points, as rows of bytes, to what a law in Python sees of them.
type Look = Callable[[npt.NDArray[np.uint8]], dict[str, Any]]
#: From these rows, and the output of a law in Python, to what the core finds.
type Update = Callable[[npt.NDArray[np.uint8], Floats | None], dict[str, Any]]


@dataclass(frozen=True)
class LawState:
    """What n points remember, turned to where they are now.

    Args:
        traction: Elastic force, (n, 2) [stress].
        elastic: Elastic slip, (n, 2) [length].
        internal: The law's own variables, (n, k).

    Example:
        >>> start = LawState(np.zeros((3, 2)), np.zeros((3, 2)), np.zeros((3, 1)))
        >>> start.internal.shape  # one variable of the law at three points
        (3, 1)
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

    Example:
        >>> still, pressed = np.zeros((1, 2)), np.ones(1)
        >>> LawKinematics(still, pressed, -0.01 * pressed, still, dt=0.1).gap.tolist()
        [-0.01]
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

    Example:
        A spring, `T = - k dxi` at two points, of which nothing slides:

        >>> k, moved, none = 10.0, np.array([[0.1, 0.0], [0.0, 0.2]]), np.zeros((2, 2, 2))
        >>> found = LawResult(
        ...     traction=-k * moved, slip=0.0 * moved, d_increment=none - k * np.eye(2),
        ...     d_pressure=0.0 * moved, d_traction=none, d_elastic=none,
        ...     internal=np.zeros((2, 0)), dissipation=np.zeros(2),
        ...     energy=k * (moved**2).sum(axis=1) / 2.0)
        >>> found.traction.tolist(), found.energy.round(12).tolist()
        ([[-1.0, -0.0], [-0.0, -2.0]], [0.05, 0.2])
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


class PythonLaw:
    """The tangential law of a contact, written in Python.

    The frame of the law has its first axis along the first axis of `directions`, carried by the
    body it lies on, its second along n x e_1. The tangent in space is exact if the blocks of the
    law are.

    Args:
        law: The law.
        directions: First axis of the frame; along the first coordinate line or the first side of
            the master's facets if left out, which does for isotropic laws.
        directions_on: Body that carries the directions, "master" or "slave".

    Attributes:
        in_python: Whether the law is written in Python.
        dtype: Type of the state of a point: fields of `STATE`, and `internal` (k,).
        carried: Direction field and the body that carries it.
        adhesion: None, as `friction`: they are laws of the core.

    Raises:
        InputError: Another word for the body.

    Example:
        >>> from anisocontact.interface import ContactLaw, Interface
        >>> from anisocontact.laws import NormalLaw
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
        >>> itf = Interface(plane, ContactLaw(NormalLaw(penalty=1e3), PythonLaw(Spring())))
        >>> r = itf.update(itf.initial_state([[0.0, 0.0, 0.0]]), [[0.1, 0.0, -0.01]])
        >>> r.traction.round(12).tolist()
        [[-1.0, 0.0, 10.0]]
    """

    in_python = True
    model = sliding_rule = ""
    adhesion: Adhesion | None = None
    friction: Friction | None = None

    def __init__(
        self,
        law: TangentialLaw,
        *,
        directions: DirectionField | None = None,
        directions_on: str = "master",
    ) -> None:
        if directions_on not in SIDES:
            text = f'{directions_on!r} given, "master" or "slave" needed'
            raise InputError(text, "directions_on")
        self.law, self.friction_directions = law, directions
        self.carried: tuple[Carried, ...] = (Carried("directions", directions, directions_on),)
        self.dtype = state_type(law.internal)

    def core(self, normal: NormalLaw, evolution: str) -> _core.Law:
        """Normal law and axes as the core has them."""
        (one,) = self.carried
        field = one.field.core if one.field else None
        return _core.Law.given(normal.named, field, one.on_slave)

    def check_evolution(self, evolution: str) -> None:
        """Refuse another form of evolution than the one a law sees its history by."""
        if evolution != EVOLUTION:
            text = f'"{evolution}" given, a law of your own has "{EVOLUTION}" only'
            raise InputError(text, "evolution")

    def named(self) -> dict[str, tuple[str, dict[str, list[float]]]]:
        """Names of the parts, without values."""
        name = type(self.law).__name__
        return {"adhesion": (name, {}), "friction": (name, {})}

    def stiffened(self, _: float) -> PythonLaw:
        """The law as it is: it has no penalty."""
        return self

    def in_series(self, compliance: float, dt: float) -> tuple[PythonLaw, History]:
        """The law with a compliant layer behind it, see `LawInSeries`."""
        (one,) = self.carried
        law = LawInSeries(self.law, compliance)
        return PythonLaw(law, directions=one.field, directions_on=one.on), History.unchanged()

    def slip_stiffness(self, dt: float) -> float:
        """Stiffness of the law against slip, see `law_stiffness`, stress/length."""
        return law_stiffness(self.law, dt)

    def penalty(self) -> float:
        """The law has none: 1."""
        return 1.0

    def through(self, state: State, dt: float, look: Look, update: Update) -> dict[str, Any]:
        """What the core finds for a batch, with the law evaluated in between.

        Args:
            state: Committed state, (n,).
            dt: Time increment.
            look: From rows of bytes, the states, to the law input of the core.
            update: From these rows and the law output to what the core finds.

        Returns:
            As of the core; the state has the law's own variables.

        Raises:
            InputError: The law failed, or returned arrays that cannot be.
        """
        if state.dtype != self.dtype:
            raise InputError("no states of this law given", "state")
        raw = raw_state(state)
        seen = look(raw)
        active = np.flatnonzero(seen["pressure"] > 0.0)
        at = slice(None) if len(active) == len(state) else active
        result = evaluate(
            self.law,
            LawState(seen["stored"][at], seen["elastic"][at], state["internal"][at]),
            LawKinematics(
                seen["increment"][at], seen["pressure"][at], seen["gap"][at], seen["xi"][at], dt
            ),
        )
        found = update(raw, _laid_out(result, len(state), at))
        whole = as_state(found["state"], self.dtype)
        whole["internal"][at] = result.internal
        return found | {"state": whole}


def _laid_out(r: LawResult, count: int, at: slice | npt.NDArray[np.intp]) -> Floats:
    """Law outputs as the core reads them, a row for each of `count` points; those not `at` none."""
    stored = r.traction if r.stored is None else r.stored
    parts = (r.traction, stored, r.slip, r.d_increment, r.d_traction, r.d_elastic, r.d_pressure)
    arrays = [np.asarray(a) for a in (*parts, r.dissipation, r.energy)]
    widths = [math.prod(a.shape[1:]) for a in arrays]
    rows, end = np.zeros((count, sum(widths))), 0
    for a, width in zip(arrays, widths, strict=True):
        rows[at, end : end + width] = a.reshape(len(a), width)
        end += width
    return rows


def evaluate(law: TangentialLaw, state: LawState, kinematics: LawKinematics) -> LawResult:
    """The output of a law, checked.

    Args:
        law: The law.
        state: What n points remember.
        kinematics: What happens to them.

    Returns:
        Its output.

    Raises:
        InputError: The law failed, or an array has another shape or numbers that are not finite.
    """
    n, own = state.internal.shape
    who = f"the law {type(law).__name__}"
    try:
        result = law.update(_locked(state), _locked(kinematics))
    except (Exception, SystemExit) as error:
        raise InputError(f"{who} failed: {where_failed(error)}") from error
    if not isinstance(result, LawResult):
        raise InputError(f"{who} returned a {type(result).__name__}, a LawResult needed")
    shapes: dict[str, tuple[int, ...]] = {
        **dict.fromkeys(("traction", "slip", "d_pressure"), (n, 2)),
        **dict.fromkeys(("d_increment", "d_traction", "d_elastic"), (n, 2, 2)),
        **dict.fromkeys(("dissipation", "energy"), (n,)),
        "internal": (n, own),
    }
    if result.stored is not None:
        shapes["stored"] = (n, 2)
    given = {
        name: answered(getattr(result, name), s, "the law", name) for name, s in shapes.items()
    }
    for name, values in given.items():
        if np.isfinite(values.sum()):  # a sum is finite where all is, but for what is too large
            continue
        bad = np.flatnonzero(~np.isfinite(values).all(axis=tuple(range(1, values.ndim))))
        if bad.size:
            text = f"the law returned {values[bad[0]].tolist()} at {len(bad)} of {n} points, "
            raise InputError(text + "finite numbers needed", field=name)
    return replace(result, **given)


def _locked[T: (LawState, LawKinematics)](record: T) -> T:
    """The same record with arrays that a law cannot change: some are the accepted history."""
    parts: dict[str, Any] = vars(record)
    arrays = {k: read_only(v) for k, v in parts.items() if isinstance(v, np.ndarray)}
    return replace(record, **(parts | arrays))


def state_type(count: int) -> np.dtype[np.void]:
    """Type of the state of a point: the fields of `STATE`, and behind them `internal` (count,)."""
    own = np.dtype((np.float64, (count,)))
    fields: Mapping[str, Any] = STATE.fields or {}
    return np.dtype(
        {
            "names": [*fields, "internal"],
            "formats": [*(kind for kind, *_ in fields.values()), own],
            "offsets": [*(offset for _, offset, *_ in fields.values()), STATE.itemsize],
            "itemsize": STATE.itemsize + own.itemsize,
        }
    )


#: Change of the force of a law in series over the force at which it is found, and the most
#: corrections that are made to find it.
_SAME, _MOST = 1e-12, 20


def law_stiffness(law: TangentialLaw, dt: float) -> float:
    """Stiffness of a law in Python against slip, from rest under a unit pressure, stress/length.

    Args:
        law: The law.
        dt: Time increment.

    Returns:
        The largest along any direction; 0 where the law has no output there.
    """
    none = np.zeros((1, 2))
    state = LawState(none, none, np.zeros((1, law.internal)))
    try:
        found = evaluate(law, state, LawKinematics(none, np.ones(1), np.zeros(1), none, dt))
    except InputError:
        return 0.0
    return float(np.linalg.norm(found.d_increment[0], ord=2))


class LawInSeries:
    """A law in Python with a compliant layer behind it: the force T with `T = law(dxi + c T)`.

    Args:
        law: The law.
        compliance: c, length/stress.

    Example:
        A viscous law, `T = - 3 dxi / dt`, in front of a layer of the compliance 1: a quarter of the
        way is left to the law.

        >>> class Viscous:
        ...     internal = 0
        ...     def update(self, state, kinematics):
        ...         n, slip = len(kinematics.pressure), kinematics.increment
        ...         none, rate = np.zeros((n, 2, 2)), 3.0 / kinematics.dt
        ...         return LawResult(
        ...             traction=-rate * slip, slip=slip, d_increment=none - rate * np.eye(2),
        ...             d_pressure=0.0 * slip, d_traction=none, d_elastic=none,
        ...             internal=state.internal, dissipation=rate * (slip**2).sum(axis=1),
        ...             energy=np.zeros(n))
        >>> rest, moved = np.zeros((1, 2)), np.array([[0.4, 0.0]])
        >>> start = LawState(rest, rest, np.zeros((1, 0)))
        >>> found = LawInSeries(Viscous(), 1.0).update(
        ...     start, LawKinematics(moved, np.ones(1), np.zeros(1), rest, dt=1.0))
        >>> found.traction.round(12).tolist(), found.slip.round(12).tolist()
        ([[-0.3, -0.0]], [[0.1, 0.0]])
    """

    def __init__(self, law: TangentialLaw, compliance: float) -> None:
        self._law, self._compliance = law, compliance
        self.internal = law.internal

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        """Force, tangent and new state, found by Newton's method at every point."""
        c, force = self._compliance, state.traction
        for _ in range(_MOST):
            moved = replace(kinematics, increment=kinematics.increment + c * force)
            result = evaluate(self._law, state, moved)
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
