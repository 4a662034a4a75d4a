"""Prescribed displacements along the steps."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI, Vec
from anisocontact.base.load_curve import Held, history_of
from anisocontact.mesh import Model
from anisocontact.solver.terms.free_modes import Supported, along_axes
from anisocontact.solver.terms.step import AXES, Step
from anisocontact.solver.terms.support_motions import (
    RotatedSupport,
    StepStart,
    SupportMotion,
    TranslatedSupport,
)

Support = tuple[str, int]  # group of facets or nodes, axis

#: What holds nodes where they are.
_HELD = TranslatedSupport(Held())
#: Displacements that count as the same, over the largest coordinate.
SAME = 1e-13


class Supports:
    """Unknowns that are prescribed, and their values along a step.

    An unknown that several groups prescribe (an edge) counts as one of the first of them.

    Attributes:
        unknowns: Local numbers of the prescribed unknowns this rank owns, (p,).
        start: Their values at the beginning of the step, length.
        end: Their values at its end, length.
    """

    def __init__(self, model: Model) -> None:
        self._model = model
        x = np.abs(model.positions).max(initial=0.0)
        # Two values for a node are one if they differ by round-off of a rotation.
        self._same = SAME * float(model.mesh.comm.allreduce(x, MPI.MAX))
        self._fixed = _fixed(model)
        self._nodes: dict[str, Ints] = {}
        self._motions: dict[Support, SupportMotion] = {}
        self._owner: dict[Support, Ints] = {}
        self._curved: list[tuple[SupportMotion, Ints, StepStart]] = []
        self.unknowns: Ints = np.zeros(0, dtype=np.int64)
        self.start: Floats = np.zeros(0)
        self.end: Floats = np.zeros(0)
        #: Their values now, length.
        self.values: Floats = np.zeros(0)

    def begin(self, step: Step, u: Floats) -> None:
        """Take over the supports of a step.

        Args:
            step: The step.
            u: Local unknowns at its beginning, length.

        Raises:
            InputError: An unknown facet group, or two groups that give shared nodes different
                values.
        """
        self._take_over(step)
        taken = np.full((len(self.places), len(u)), np.nan)
        taken[:, self._fixed] = 0.0
        owner: dict[Support, Ints] = {}
        for (group, axis), motion in self._motions.items():
            unknowns = 3 * self._owned_nodes(group) + axis
            start = self._start(axis, unknowns, u, step.duration)
            value = np.array([motion.at(share, start) for share in self.places])
            clash = np.abs(taken[:, unknowns] - value) > self._same
            if clash.any():
                place, first = np.argwhere(clash)[0]
                shared = unknowns[clash.any(axis=0)]
                values = taken[place, unknowns[first]], value[place, first]
                raise self._clash(step, group, axis, owner, shared, values)
            owner[group, axis] = unknowns[np.isnan(taken[-1, unknowns])]
            taken[:, unknowns] = value
        self._owner = owner
        self.unknowns = np.flatnonzero(~np.isnan(taken[-1]))
        self.start = self.values = u[self.unknowns]
        self.end = taken[-1, self.unknowns]
        self._curved = [
            (
                self._motions[group, axis],
                np.searchsorted(self.unknowns, supported),
                self._start(axis, supported, u, step.duration),
            )
            for (group, axis), supported in owner.items()
            if not self._motions[group, axis].linear
        ]

    @property
    def places(self) -> Floats:
        """Shares of the step at which it is to be looked at: its end, or places all along it."""
        count = max((motion.places for motion in self._motions.values()), default=1)
        return np.arange(1, count + 1) / count

    def supported(self) -> list[Supported]:
        """Nodes that are held along each axis, and the axis."""
        return along_axes(self.unknowns)

    def resting(self) -> list[Supported]:
        """Nodes that are held where they are all along the step along each axis, and the axis."""
        return along_axes(self.unknowns[self._still()])

    @property
    def rest(self) -> bool:
        """Whether all of them stay where they are all along the step, on this rank."""
        return bool(self._still().all())

    def _still(self) -> Flags:
        """Which of the unknowns stay where they are all along the step."""
        still = np.abs(self.end - self.start) <= self._same
        for _, place, _ in self._curved:
            still[place] = False
        return np.asarray(still)

    @property
    def owners(self) -> dict[Support, Ints]:
        """Local unknowns that each support holds on this rank: none of them twice."""
        return self._owner

    def stop(self) -> None:
        """The step ends where it is: prescribed values stay there."""
        self._motions = dict.fromkeys(self._motions, _HELD)

    def set_load_factor(self, factor: float) -> None:
        """Go to a fraction of the step."""
        values = (1.0 - factor) * self.start + factor * self.end
        for motion, place, start in self._curved:
            values[place] = motion.at(factor, start)
        self.values = values

    def violation(self, x: Vec) -> Floats:
        """How far the prescribed unknowns are from their values, length."""
        return np.asarray(x.array_r[self.unknowns] - self.values)

    def _take_over(self, step: Step) -> None:
        for key, motion in self._motions.items():
            if not motion.linear:
                self._motions[key] = _HELD
        for group, values in step.displacement.items():
            self._model.nodes(group, f"step {step.name!r}.displacement")
            for name, given in values.items():
                self._motions.pop((group, AXES.index(name)), None)
                if given is not None:
                    self._motions[group, AXES.index(name)] = TranslatedSupport(history_of(given))
        for group in step.cylindrical:
            for axis in range(3):
                self._motions.pop((group, axis), None)
        for group, turn in step.turned_groups().items():
            self._model.nodes(group, f"step {step.name!r}.rotation")
            for axis in range(3):
                self._motions.pop((group, axis), None)
                self._motions[group, axis] = RotatedSupport(turn)

    def _start(self, axis: int, unknowns: Ints, u: Floats, duration: float) -> StepStart:
        """Where the nodes of unknowns are when a step begins."""
        nodes = unknowns // 3
        positions = np.asarray(self._model.positions[nodes] + u.reshape(-1, 3)[nodes])
        return StepStart(axis, u[unknowns], positions, duration)

    def reactions(self, force: Floats) -> dict[str, Floats]:
        """Force of each group's supports on the body.

        Args:
            force: Force of the supports on the unknowns this rank owns.

        Returns:
            Facet group -> force, (3,), over all ranks.
        """
        sums: dict[str, Floats] = {}
        for (group, axis), unknowns in self._owner.items():
            sums.setdefault(group, np.zeros(3))[axis] = force[unknowns].sum()
        return {group: self._model.mesh.comm.allreduce(local) for group, local in sums.items()}

    def _owned_nodes(self, group: str) -> Ints:
        if group not in self._nodes:
            self._nodes[group] = self._model.nodes(group).astype(np.int64)
        return self._nodes[group]

    def _clash(
        self,
        step: Step,
        group: str,
        axis: int,
        owner: dict[Support, Ints],
        shared: Ints,
        values: tuple[float, float],
    ) -> InputError:
        found = (g for (g, a), own in owner.items() if a == axis and np.isin(shared, own).any())
        other = next(found, self._model.idealisation.entry.name)
        return InputError(
            f"{other!r} prescribes {values[0]:g} and {group!r} {values[1]:g} for "
            f"{AXES[axis]} on {len(shared)} shared nodes",
            f"step {step.name!r}.displacement",
        )


def _fixed(model: Model) -> Ints:
    """Unknowns this rank owns that what the mesh is taken for holds at zero."""
    owned = model.space.dofmap.index_map.size_local
    at = model.positions[:owned]
    supported = [3 * nodes + axis for nodes, axis in model.idealisation.held(at)]
    return np.concatenate([np.zeros(0, dtype=np.int64), *supported])
