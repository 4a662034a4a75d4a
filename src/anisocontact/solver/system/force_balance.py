"""Balance of forces at a state, and whether it is one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats

#: Share of `|diag(K) u|` and of `Term.lever` that is round-off of the forces.
ROUND_OFF = 16.0 * float(np.finfo(np.float64).eps)
#: Share of the loads that may be left out of balance as round-off.
LOAD_SHARE = 1e-6
#: Displacements, over what is prescribed and the length of all bodies, from which on nothing leads
#: to a state: their rounding makes forces of a strain of 4e-9.
GONE = 1e6
#: Hardness from which on it is what rounds: nu = 0.49998 and more.
HARD = 1e4


class Rounds(Enum):
    """What is rounded where loads are too small for it, in words."""

    STRAINS = "forces inside bodies at finite strain"
    FORCES = "forces inside bodies"
    PLACES = "places of what touches"


@dataclass(frozen=True)
class FieldBalance:
    """How far a field is from its equations, norms over all ranks in units of force.

    Attributes:
        norm: Of the residual.
        scale: Of what is at work in it.
        round_off: Residual that floating point leaves.
    """

    norm: float
    scale: float
    round_off: float

    def relative(self, tolerance: float) -> float:
        """Residual over what is at work.

        Args:
            tolerance: Share of that which is small: where next to nothing is at work, what is left
                is rounding of larger numbers.
        """
        rounded = self.round_off / max(tolerance, _EPSILON)
        return self.norm / max(self.scale, rounded, _TINY)

    def small(self, tolerance: float, absolute: float) -> bool:
        """Whether no more than a share of what is at work is left, or rounding, or a force."""
        return self.norm <= max(tolerance * self.scale, self.round_off, absolute)


@dataclass(frozen=True)
class Reached:
    """Where displacements have got to.

    Attributes:
        prescribed: Whether all are where they are prescribed, see `prescribed_reached`.
        far: The largest where it is larger than all bodies together are long, else 0.
        gone: Whether that is beyond anything that is prescribed, see `GONE`: rounding of such
            displacements, as large as forces, excuses none that is out of balance.
    """

    prescribed: bool = True
    far: float = 0.0
    gone: bool = False


@dataclass(frozen=True)
class ForceBalance:
    """Forces at a state, of the unknowns this rank owns.

    Attributes:
        residual: Residual, with the forces that a correction takes beyond those of the state; NaN
            everywhere where a law has no answer.
        norm: Norm of the residual without them over all ranks; 0 where no multipliers follow and
            there is no other field.
        force_scale: Norm of the forces at work: of loads, contacts, supports or supports still to
            be moved, the largest.
        round_off: Residual that floating point leaves, force; never more than a small share of the
            loads, which a body that flies off would not balance, and none where it has, see
            `Reached.gone`.
        outside: All forces but those of contact.
        load: Of these, the loads.
        fields: Of a mixed problem the balance of each field, the displacement first.
        reached: Whether displacements are where they are prescribed, see `prescribed_reached`.
        rounded: Residual that floating point leaves however small the loads are, force.
        far: See `Reached.far`.
        hardness: See `Magnitudes.hardness`.
        rounds: See `Magnitudes.rounds`.
    """

    residual: Floats
    norm: float
    force_scale: float
    round_off: float
    outside: Floats
    load: Floats
    fields: tuple[FieldBalance, ...] = ()
    reached: bool = True
    rounded: float = 0.0
    far: float = 0.0
    hardness: float = 0.0
    rounds: Rounds = Rounds.FORCES

    @classmethod
    def none(cls, owned: int) -> ForceBalance:
        """No forces at all."""
        return cls(np.zeros(owned), 0.0, 0.0, 0.0, np.zeros(owned), np.zeros(owned))

    def in_rounding(self, norm: float) -> bool:
        """Whether a residual may be rounding, where loads are too small for it.

        Args:
            norm: Of the residual, force.
        """
        return norm <= self.rounded and self.rounded > self.round_off

    def explained(self, norm: float) -> str:
        """What a residual may come from where loads are too small for it; empty if not that.

        Args:
            norm: Of the residual, force.
        """
        if not self.in_rounding(norm):
            return ""
        if self.far:
            return (
                f"which may be rounding of the forces inside bodies, as these went {self.far:.3g} "
                "far, more than all is long: where that is not prescribed, contact and friction do "
                "not hold the loads on them; load them less, or lead them by displacements"
            )
        cures = ["larger loads"]
        if self.rounds is Rounds.STRAINS:
            cures.append("a material at small strain")
        if self.rounds is not Rounds.PLACES and self.hardness > HARD:
            cures.append("nu = 0.4999 in the place of 0.5, a hundredth of this rounding")
        said = ", or ".join(filter(None, [", ".join(cures[:-1]), cures[-1]]))
        rounded = f"which may be rounding of the {self.rounds.value}"
        return f"{rounded}, beside which loads are small: {said}"

    def of_fields(self, norm: float) -> tuple[FieldBalance, ...]:
        """The balance of each field, where the residual as a whole has a norm."""
        return self.fields or (FieldBalance(norm, self.force_scale, self.round_off),)


@dataclass(frozen=True)
class Magnitudes:
    """How large forces are, norms over all ranks.

    Attributes:
        load: Of the loads.
        at_work: Of whatever else is at work.
        stiff: Of the forces of nodes moved alone, which are rounded.
        lever: Of the terms, see `Term.lever`, which are rounded as well.
        hardness: Of bodies at finite strain against changes of volume, see `CellPressures`.
        finite: Whether a body is at finite strain.
    """

    load: float
    at_work: Sequence[float]
    stiff: float
    lever: float = 0.0
    hardness: float = 0.0
    finite: bool = False

    @property
    def force_scale(self) -> float:
        """As of `ForceBalance`."""
        return max(self.load, *self.at_work)

    @property
    def round_off(self) -> float:
        """As of `ForceBalance`."""
        return min(self.rounded, LOAD_SHARE * self.load) if self.load > 0.0 else self.rounded

    @property
    def rounded(self) -> float:
        """As of `ForceBalance`."""
        return ROUND_OFF * (self.stiff + self.lever)

    @property
    def rounds(self) -> Rounds:
        """What most of the rounding is of."""
        if self.lever > self.stiff:
            return Rounds.PLACES
        return Rounds.STRAINS if self.finite else Rounds.FORCES


#: All that is prescribed, and nothing is far.
EVERYTHING = Reached()


def closed(
    residual: Floats,
    sizes: Magnitudes,
    comm: Any,
    *,
    failed: bool,
    correction: Floats | None,
    forces: tuple[Floats, Floats] | None = None,
    fields: tuple[FieldBalance, ...] = (),
    reached: Reached = EVERYTHING,
) -> ForceBalance:
    """A balance of forces from its residual; collective.

    Args:
        residual: Of the unknowns of this rank, force; overwritten.
        sizes: How large the forces are.
        comm: Communicator.
        failed: Whether there is no answer on this rank.
        correction: Forces that a correction takes beyond those of the state; None where no
            multipliers follow.
        forces: See `ForceBalance.outside` and `ForceBalance.load`; none if left out.
        fields: See `ForceBalance.fields`.
        reached: Where displacements have got to.
    """
    if comm.allreduce(failed):
        residual[:] = np.nan
    norm = 0.0
    if correction is not None or fields:
        norm = float(np.sqrt(comm.allreduce(float(residual @ residual))))
    if correction is not None:
        residual = residual - correction
    outside, load = forces or (np.zeros(0), np.zeros(0))
    return ForceBalance(
        residual=residual,
        norm=norm,
        force_scale=sizes.force_scale,
        round_off=0.0 if reached.gone else sizes.round_off,
        outside=outside,
        load=load,
        fields=fields,
        reached=reached.prescribed,
        rounded=sizes.rounded,
        far=reached.far,
        hardness=sizes.hardness,
        rounds=sizes.rounds,
    )


# Stands for the forces where there are none, so that zero over zero is zero.
_TINY = float(np.finfo(np.float64).tiny)
_EPSILON = float(np.finfo(np.float64).eps)
