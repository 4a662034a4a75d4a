"""How far bodies at small strain have turned: their strain takes a rotation for a deformation.

A body that only turns by the angle t has the displacement gradient `R - 1`, whose symmetric part
is `cos(t) - 1` in the plane of the turn: a strain that is not there. At 1 degree it is 1.5e-4, at
5 degrees 3.8e-3, and it makes stress as any strain does.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple, dataclass
from functools import cached_property

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import MPI, Vec
from anisocontact.bulk import Material, small_strain
from anisocontact.mesh import Model
from anisocontact.solver.system.angles import polar_angle
from anisocontact.solver.system.cell_rotations import OF_STRAIN, CellRotations
from anisocontact.solver.system.partly_known import PartlyKnown

#: Angles beyond which a turn is worth a warning, and beyond which it is refused, radian.
WARNED, REFUSED = float(np.radians(1.0)), float(np.radians(5.0))
#: Mean strain of a body beyond which it is worth a warning that it is small strain.
STRAINED = 0.1
#: Share of the volume of a body from which on cells that turn far are no matter of a corner alone.
PART = 0.1
#: What a body at small strain that turns further needs.
CURE = (
    'take a material at finite strain, model = "neo-hookean" or "st-venant-kirchhoff", '
    'or strain = "logarithmic" if it has that'
)
#: Beyond this angle the whole is refused whatever its strain.
ANY_STRAIN = 3.0 * REFUSED
#: What known displacements have to have grown by before all cells are looked at again.
GROWN = 1.25


@dataclass(frozen=True)
class BodyRotation:
    """How far a body at small strain has turned from where it was made.

    Attributes:
        whole: Angle of the rotation of the mean deformation gradient, radian.
        largest: Largest angle of a cell that turns by more than it is strained, radian.
        stress: Stress that the larger of both makes of nothing, `E (1 - cos t)`.
        turns: Whether the whole turns by more than it is strained.
        bent: Share of the volume in cells that turn so and by more than ten degrees.
        strained: Largest principal value, in size, of the mean strain.
    """

    whole: float
    largest: float
    stress: float
    turns: bool = True
    bent: float = 0.0
    strained: float = 0.0

    @property
    def angle(self) -> float:
        """The larger angle, radian."""
        return max(self.whole, self.largest)

    @property
    def too_far(self) -> bool:
        """Whether small strain is no model of it."""
        bound = REFUSED if self.turns else ANY_STRAIN
        return self.whole > bound or self.bent > PART

    @property
    def strain(self) -> float:
        """Strain that it makes of nothing."""
        return spurious(self.angle)

    def __str__(self) -> str:
        """How far, and how wrong that is."""
        where = "" if self.whole >= self.largest else " in places"
        return (
            f"has turned by {np.degrees(self.angle):.3g} degrees{where}, which small strain takes "
            f"for a strain of {self.strain:.2g}, a stress of {self.stress:.3g}"
        )


def spurious(angle: float) -> float:
    """Strain that small strain makes of a rotation by an angle, radian."""
    return float(1.0 - np.cos(angle))


class Rotations:
    """Rotations of the bodies at small strain of a model.

    Args:
        model: The mesh.
        materials: Body name -> material; those at small strain count.

    Attributes:
        accepted: Of every body after the accepted increment, by name; the same on every rank.
    """

    def __init__(self, model: Model, materials: Mapping[str, Material]) -> None:
        self._model = model
        self._young = {n: law.young for n, law in sorted(materials.items()) if small_strain(law)}
        self._looked: dict[str, float] = {}
        self._now: tuple[dict[str, BodyRotation], dict[str, float]] = ({}, {})
        self.accepted: dict[str, BodyRotation] = {}

    def __bool__(self) -> bool:
        return bool(self._young)

    @cached_property
    def _bodies(self) -> dict[str, CellRotations]:
        return {name: CellRotations(self._model, name) for name in self._young}

    def at(self, u: Floats) -> dict[str, BodyRotation]:
        """Rotation of every body in a state, kept as the trial.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
        """
        comm, found = self._model.mesh.comm, {}
        for name, cells in self._bodies.items():
            gradient = comm.allreduce(u.T @ cells.mean)
            largest, bent = cells.turned(u)
            local = comm.allreduce(largest, MPI.MAX), comm.allreduce(bent)
            found[name] = self._turned(name, gradient, *local)
        self._now = (found, {})
        return found

    def reduced(self, known: PartlyKnown, x: Vec, last: bool) -> dict[str, BodyRotation]:
        """Rotation of every body of which only some unknowns are kept up to date.

        The mean gradient is known without the interior. Rotations of cells need all
        displacements, a solution with the interior: they are looked at where what is known has
        moved so unevenly that cells may have turned otherwise than the whole, and only where
        that has grown since the last look or a step ends; and at the end of a step where facets
        have turned, as below a ball, where nothing moves far.

        Args:
            known: Who knows them.
            x: All unknowns of the state, true for what contacts need.
            last: Whether this is the end of a step.
        """
        found, looked = {}, dict(self._looked)
        kept = known.kept(x)
        u: Floats | None = None
        for name, cells in self._bodies.items():
            gradient = known.mean(f"gradient of {name}", cells.mean, x)
            moved = cells.uneven(kept, gradient)
            before = self.accepted.get(name)
            local = (before.largest, before.bent) if before else (0.0, 0.0)
            grown = moved > max(0.0 if last else GROWN * looked.get(name, 0.0), WARNED)
            if grown or (last and cells.surface(kept) > WARNED):
                u = known.displacement(x) if u is None else u
                local, looked[name] = cells.turned(u), moved
            found[name] = self._turned(name, gradient, *local)
        self._now = (found, looked)
        return found

    def commit(self) -> None:
        """Accept the trial."""
        self.accepted, self._looked = self._now

    def persistent(self) -> Floats:
        """What the next looks depend on: what is known of each body."""
        rows = [
            [*astuple(turned), self._looked.get(name, 0.0)]
            for name, turned in self.accepted.items()
        ]
        return np.array(rows, dtype=np.float64).reshape(-1, 7)

    def restore(self, kept: Floats) -> None:
        """Go on from what `persistent` gave."""
        for name, row in zip(self._young, kept.tolist(), strict=False):
            whole, largest, stress, turns, *rest, self._looked[name] = row
            self.accepted[name] = BodyRotation(whole, largest, stress, bool(turns), *rest)

    def _turned(self, name: str, gradient: Floats, largest: float, bent: float) -> BodyRotation:
        whole = polar_angle(gradient)
        strain = 0.5 * float(np.linalg.norm(gradient + gradient.T))
        stress = self._young[name] * spurious(max(whole, largest))
        principal = float(np.abs(np.linalg.eigvalsh(0.5 * (gradient + gradient.T))).max())
        return BodyRotation(whole, largest, stress, whole >= OF_STRAIN * strain, bent, principal)
