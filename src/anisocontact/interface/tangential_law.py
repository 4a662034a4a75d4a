"""What a tangential law in Python is given and what it returns, for n points at once."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.arrays import answered, read_only_view
from anisocontact.base.errors import InputError
from anisocontact.base.python_file import where_failed

#: Most variables of its own that a law has at a point: with more, states of points are no types.
MOST_VARIABLES = 1_000_000


@dataclass(frozen=True, eq=False)
class LawState:
    """History variables of n points, rotated to where they are now.

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


@dataclass(frozen=True, eq=False)
class LawKinematics:
    """Slip increment, pressure and time step of n points in contact.

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


@dataclass(frozen=True, eq=False)
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
    """A law of the tangential force; `internal` is the number of its own variables.

    Example:
        Nothing but a viscous film; `PythonLaw` has an elastic law, and how one is used.

        >>> class Film:
        ...     internal = 0
        ...     def update(self, state, kinematics):
        ...         n, c = len(kinematics.pressure), 2.0 / kinematics.dt
        ...         none = np.zeros((n, 2, 2))
        ...         t = -c * kinematics.increment
        ...         return LawResult(
        ...             traction=t, slip=kinematics.increment, d_increment=none - c * np.eye(2),
        ...             d_pressure=np.zeros((n, 2)), d_traction=none, d_elastic=none,
        ...             internal=state.internal, energy=np.zeros(n),
        ...             dissipation=-(t * kinematics.increment).sum(axis=1))
        >>> check_own_variables(Film())
    """

    internal: int

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        """Force, tangent and new state; must not change its arguments.

        Args:
            state: History of n points, rotated to where they are now.
            kinematics: Slip increment, pressure and time step of the n points.

        Returns:
            Force, tangent and new state, of the shapes of `LawResult`.
        """
        ...


def check_own_variables(law: Any) -> None:
    """Refuse a law that does not say how many variables of its own a point has.

    Raises:
        InputError: `internal` is no whole number, below zero, or larger than any memory.
    """
    count = getattr(law, "internal", None)
    fits = isinstance(count, int | np.integer) and 0 <= count <= MOST_VARIABLES
    if not fits or isinstance(count, bool):
        raise InputError(
            f"{type(law).__name__}.internal is {count!r}, the number of its own variables needed, "
            f"0 to {MOST_VARIABLES}",
            "law",
        )


def evaluate(law: TangentialLaw, state: LawState, kinematics: LawKinematics) -> LawResult:
    """The output of a law, checked.

    Args:
        law: The law.
        state: What n points remember.
        kinematics: What happens to them.

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
    arrays = {k: read_only_view(v) for k, v in parts.items() if isinstance(v, np.ndarray)}
    return replace(record, **(parts | arrays))


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
