"""Tangential laws written in Python: batched NumPy in, batched NumPy out.

A law gives the tangential force of many points at once in an orthonormal frame of the tangent
plane. The core does the rest: projection, pressure, transport of the history, tangent in space. A
`PythonLaw` stands in a `ContactLaw` where adhesion and friction of the core do.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.anisotropy import DirectionField
from anisocontact.base.array_types import Floats
from anisocontact.base.copied_by_arguments import CopiedByArguments
from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed
from anisocontact.interface.law_in_series import LawInSeries
from anisocontact.interface.series import SeriesHistory
from anisocontact.interface.states import STATE, State, as_state, raw_state
from anisocontact.interface.tangential_law import (
    LawKinematics,
    LawResult,
    LawState,
    TangentialLaw,
    check_own_variables,
    evaluate,
    law_stiffness,
)
from anisocontact.interface.wrong_slopes import wrong_slopes
from anisocontact.laws import SIDES, Adhesion, CarriedDirections, Friction, Named, NormalLaw

#: How the history enters a step: a law in Python sees it turned to where the point is.
EVOLUTION = "transport"

#: From the states of points, as rows of bytes, to what a law in Python sees of them.
type Look = Callable[[npt.NDArray[np.uint8]], dict[str, Any]]
#: From these rows, and the output of a law in Python, to what the core finds.
type Update = Callable[[npt.NDArray[np.uint8], Floats | None], dict[str, Any]]


@typed
class PythonLaw(CopiedByArguments):
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
        InputError: Another word for the body, or a law without a number of variables.

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
        check_own_variables(law)
        self.law, self.friction_directions = law, directions
        self.carried: tuple[CarriedDirections, ...] = (
            CarriedDirections("directions", directions, directions_on),
        )
        self.dtype = state_type(law.internal)
        self._seen: list[tuple[LawState, LawKinematics]] = []  # the last input, for `doubts`

    def core(self, normal: NormalLaw, evolution: str) -> _core.Law:
        """Normal law and axes as the core has them.

        Args:
            normal: Law of the pressure.
            evolution: Name of the form of evolution, always `transport`.

        Returns:
            A law of the core to which the tangential force is given.
        """
        (one,) = self.carried
        field = one.field.core if one.field else None
        return _core.Law.given(normal.named, field, one.on_slave)

    def check_evolution(self, evolution: str) -> None:
        """Refuse another form of evolution than the one a law sees its history by.

        Args:
            evolution: Name of the form.

        Raises:
            InputError: It is another one.
        """
        if evolution != EVOLUTION:
            text = f'"{evolution}" given, a law of your own has "{EVOLUTION}" only'
            raise InputError(text, "evolution")

    def named(self) -> dict[str, Named]:
        """Names of the parts, without values."""
        name = type(self.law).__name__
        return {"adhesion": (name, {}), "friction": (name, {})}

    def stiffened(self, _: float) -> PythonLaw:
        """The law as it is: it has no penalty."""
        return self

    def in_series(self, compliance: float, dt: float) -> tuple[PythonLaw, SeriesHistory]:
        """The law with a compliant layer behind it, see `LawInSeries`.

        Args:
            compliance: Of the layer, length/stress.
            dt: Time increment, without meaning here, time.

        Returns:
            The law, and that its history is the one it had.
        """
        (one,) = self.carried
        law = LawInSeries(self.law, compliance)
        behind = PythonLaw(law, directions=one.field, directions_on=one.on)
        behind._seen = self._seen
        return behind, SeriesHistory.unchanged()

    def slip_stiffness(self, dt: float) -> float:
        """Stiffness of the law against slip from rest, see `law_stiffness`.

        Args:
            dt: Time increment, time.

        Returns:
            The stiffness under a unit pressure, stress/length.
        """
        return law_stiffness(self.law, dt)

    def penalty(self) -> float:
        """The law has none: 1."""
        return 1.0

    def softness(self) -> Floats:
        """The law has no stiffness along axes: 1."""
        return np.ones(2)

    def holds_all_ways(self) -> bool:
        """The law has no axis along which it is known to let go: true."""
        return True

    def stiffest(self) -> float:
        """The law has no stiffness that is known: 0."""
        return 0.0

    def doubts(self) -> str:
        """What is wrong with the derivatives of the law at its last input, see `wrong_slopes`."""
        return wrong_slopes(self.law, *self._seen[0]) if self._seen else ""

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
        remembered = LawState(seen["stored"][at], seen["elastic"][at], state["internal"][at])
        happens = LawKinematics(
            seen["increment"][at], seen["pressure"][at], seen["gap"][at], seen["xi"][at], dt
        )
        if len(active):
            self._seen[:] = [(remembered, happens)]
        result = evaluate(self.law, remembered, happens)
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
