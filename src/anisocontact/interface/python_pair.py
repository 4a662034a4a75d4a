"""Laws written in Python for the contact of two meshed bodies.

The core says what happens at the slave points, in the axes of the law; the law answers for all of
them at once; forces and tangent on the nodes of both bodies then follow in the core as they do for
its own laws, the slopes of the law by the chain rule.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.anisotropy import DirectionField
from anisocontact.base.errors import InputError
from anisocontact.interface.interface import PairLaw, State, as_state, raw_state
from anisocontact.interface.python_law import (
    LawInSeries,
    LawKinematics,
    LawResult,
    LawState,
    PythonInterface,
    TangentialLaw,
    answer,
    common,
    law_stiffness,
    state_type,
    with_internal,
)
from anisocontact.interface.series import History
from anisocontact.laws import Carried, NormalLaw
from anisocontact.surfaces import Floats

__all__ = ["PYTHON_LAWS", "MeshedLaw", "PythonPairLaw", "PythonPairs"]

type Arrays = Mapping[str, npt.NDArray[Any]]


class PythonPairLaw:
    """Laws of the contact of two meshed bodies, the tangential one written in Python.

    The frame of the law has its first axis along the first axis of `directions`, carried by the
    body it lies on, its second along n x e_1. The tangent is exact if the law's blocks are.

    Args:
        normal: Law of the pressure.
        law: The tangential law.
        directions: First axis of the frame; along the first side of the master's facets if left
            out, which does for isotropic laws.
        directions_on: Body that carries the directions, "master" or "slave".

    Attributes:
        dtype: Type of the state of a point: fields of `STATE`, and `internal` (k,).
        carried: Direction field and the body that carries it.

    Raises:
        InputError: A direction field that goes by coordinates of a surface, or another word for the
            body.

    Example:
        >>> class Smooth:
        ...     internal = 0
        ...     def update(self, state, kinematics):
        ...         n = len(kinematics.pressure)
        ...         none, block, zero = np.zeros((n, 2)), np.zeros((n, 2, 2)), np.zeros(n)
        ...         own = state.internal
        ...         return LawResult(none, none, block, none, block, block, own, zero, zero)
        >>> law = PythonPairLaw(NormalLaw(penalty=1e3), Smooth())
        >>> law.stiffened(10.0).penalties()
        (10000.0, 1.0)
    """

    def __init__(
        self,
        normal: NormalLaw,
        law: TangentialLaw,
        *,
        directions: DirectionField | None = None,
        directions_on: str = "master",
    ) -> None:
        if directions_on not in {"master", "slave"}:
            text = f'{directions_on!r} given, "master" or "slave" needed'
            raise InputError(text, "directions_on")
        self.normal, self.law, self.directions = normal, law, directions
        self.dtype = state_type(law.internal)
        self.carried = (Carried("directions", directions, directions_on),)
        self.carried[0].check_meshed(directions_on)

    def pairs(self, mirrored: bool = False) -> PythonPairs:
        """The law for slave points and facets.

        Args:
            mirrored: Whether slave and master have swapped their parts: the master then carries
                what is the slave's, and the law sees its axes from the other side.

        Returns:
            What answers for them.
        """
        one = self.carried[0]
        on_slave = one.on_slave != (mirrored and one.field is not None)
        field = self.directions.core if self.directions else None
        core = _core.FramedPairs(self.normal.named, field, mirrored, on_slave)
        return PythonPairs(self.law, core, mirrored)

    def stiffened(self, normal: float, _: float = 1.0) -> PythonPairLaw:
        """The laws with a normal penalty `normal` times as large."""
        return PythonPairLaw(
            self.normal.stiffened(normal),
            self.law,
            directions=self.directions,
            directions_on=self.carried[0].on,
        )

    def in_series(self, compliance: float, dt: float) -> tuple[PythonPairLaw, History]:
        """The laws with a compliant layer behind the tangential one, see `LawInSeries`."""
        law, own = LawInSeries(self.law, compliance), self.carried[0]
        made = PythonPairLaw(self.normal, law, directions=self.directions, directions_on=own.on)
        return made, History.unchanged()

    def slip_stiffness(self, dt: float) -> float:
        """Stiffness of the tangential law against slip, see `law_stiffness`, stress/length."""
        return law_stiffness(self.law, dt)

    def penalties(self) -> tuple[float, float]:
        """Normal penalty, stress/length; the tangential law has none: 1."""
        return self.normal.named[1]["penalty"][0], 1.0


class PythonPairs:
    """What answers for slave points that meet facets, with a law written in Python.

    Args:
        law: The tangential law.
        core: Normal law and axes.
        mirrored: Whether slave and master have swapped their parts.
    """

    def __init__(self, law: TangentialLaw, core: _core.FramedPairs, mirrored: bool) -> None:
        self._law, self._core, self._side = law, core, -1.0 if mirrored else 1.0

    def respond(self, state: State, by_points: bool, *batch: Any) -> dict[str, Any]:
        """Forces, blocks and the trial state.

        Args:
            state: Committed state, (n,).
            by_points: Whether every point is to have a block, or those of one pair of facets share
                one.
            batch: The batch as `FacetPairs.update` of the core takes it, after the state.

        Returns:
            As of the core, but for the state, which has the law's own variables.

        Raises:
            InputError: The law returned arrays that cannot be.
        """
        raw = raw_state(common(state))
        told = self._core.tell(raw, *batch)
        active = np.flatnonzero(told["pressure"] > 0.0)
        result = self._ask(state, told, active, batch)
        answers = _laid_out(result)
        laid = np.zeros((len(state), answers.shape[1]))
        laid[active] = answers
        answered = self._core.answered(laid)
        found = (answered.update if by_points else answered.assemble)(raw, *batch)
        internal = np.zeros((len(state), self._law.internal))
        internal[active] = result.internal
        axes = np.zeros((len(state), 2, 3))
        axes[active, 0] = told["axis"][active]
        axes[active, 1] = self._side * np.cross(told["normal"][active], told["axis"][active])
        whole = with_internal(as_state(found["state"]), internal)
        return found | {"state": whole, "adhesion_axes": axes, "friction_axes": axes}

    def _ask(
        self, state: State, told: Arrays, active: npt.NDArray[np.intp], batch: tuple[Any, ...]
    ) -> LawResult:
        remembered = LawState(
            told["stored"][active], told["elastic"][active], state["internal"][active]
        )
        dt, xi = batch[0], batch[_XI]
        now = LawKinematics(
            told["increment"][active], told["pressure"][active], told["gap"][active], xi[active], dt
        )
        return answer(self._law, remembered, now)


#: Laws of two meshed bodies.
type MeshedLaw = PairLaw | PythonPairLaw

#: Laws whose tangential part is written in Python.
PYTHON_LAWS = (PythonInterface, PythonPairLaw)

#: Where the coordinates of the projections stand in a batch.
_XI = 12


def _laid_out(r: LawResult) -> Floats:
    """The answer at each point as the core reads it, one row each."""
    parts = (
        r.traction,
        r.traction if r.stored is None else r.stored,
        r.slip,
        r.d_increment,
        r.d_traction,
        r.d_elastic,
        r.d_pressure,
        r.dissipation,
        r.energy,
    )
    arrays = [np.asarray(part) for part in parts]
    return np.concatenate([a.reshape(len(a), math.prod(a.shape[1:])) for a in arrays], axis=1)
