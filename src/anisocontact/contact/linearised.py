"""The trial that a Newton step is linear about, where multipliers follow the displacements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Codes, Floats
from anisocontact.base.statuses import STICK
from anisocontact.contact.active_set import Active
from anisocontact.contact.contact_trial import ContactTrial
from anisocontact.contact.layer import Layer
from anisocontact.contact.master import Answer, Linear, Master
from anisocontact.contact.semismooth import Semismooth
from anisocontact.contact.slip_reversals import SlipReversals
from anisocontact.interface import Response, State


@dataclass(frozen=True)
class Base:
    """The trial about which a Newton step is linear.

    Attributes:
        multiplier: lambda as a vector, (n, 3), stress.
        traction: P, (n, 3), stress.
        residual: Change of P that takes the violation away, (n, 3), stress.
        kept: What lambda is of P where no gap closes, along the normal and the surface, (n, 2).
    """

    multiplier: Floats
    traction: Floats
    residual: Floats
    kept: Floats

    def after(self, change: Floats, share: float, normal: Floats) -> Floats:
        """Multiplier after a step.

        Args:
            change: Change of the traction with the displacement of the step, (n, 3), stress.
            share: Share of the step that was taken.
            normal: At the points, (n, 3).

        Returns:
            lambda as a vector, (n, 3), stress.
        """
        rest = (1.0 - share) * self.multiplier
        new = share * (self.traction + self.residual) + change
        pressure = np.einsum("nd,nd->n", new, normal)[:, None] * normal
        return np.asarray(rest + self.kept[:, 1:] * (new - pressure) + self.kept[:, :1] * pressure)


@dataclass(frozen=True)
class Linearised:
    """The trial that the next Newton step is linear about.

    Attributes:
        linear: How tractions change with the nodes.
        base: Tractions there, and what the multipliers have yet to take.
        slip: Slip by which the multipliers violate friction, see `Semismooth.stiff`.
        active: Which points are closed there.
        status: Status of the points there, (n,).
    """

    linear: Linear
    base: Base
    slip: Floats
    active: Active
    status: Codes

    @classmethod
    def of(
        cls,
        follows: Semismooth | Layer,
        step: ContactTrial,
        master: Master,
        trial: Answer,
        dt: float,
        physical: float,
        active: Active,
        reversals: SlipReversals,
    ) -> tuple[Answer, Linearised]:
        """A trial with the derivative of a Newton step, and what that is linear about.

        Args:
            follows: The multipliers.
            step: The trial and what it started from.
            master: What the points meet.
            trial: What laws answered, without derivative.
            dt: Time increment.
            physical: Stiffness of an adhesion that is no penalty, stress/length.
            active: Which points are closed.
            reversals: Which points slide to and fro.
        """

        def stiff_answer(state: State) -> Response:
            answer: Answer = master.answer(state, dt, tangent=False, derivative=True)
            return answer.snapshot.response

        state, slip = reversals.sticking(step, *follows.stiff(step), stiff_answer)
        stiff = master.answer(state, dt, derivative=True, separate=True)
        stiffness = stiff.stiffness / follows.ratio
        if not follows.tangential:
            stiffness += physical * step.areas * (step.answer.status == STICK)
        answer: Answer = trial.by_derivative(stiff, stiffness)
        linear = master.linear(answer)
        traction = master.into_frame(step.answer.traction)
        if follows.tangential:
            traction = traction + step.supported
        base = Base(follows.vector(step), traction, linear.slipped(slip), step.left)
        return answer, cls(linear, base, slip, active, step.answer.status)
