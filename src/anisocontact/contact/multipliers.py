"""Augmented Lagrangian: multipliers of the slave points that make penalties exact.

Inside an increment the multipliers are held while Newton's method solves

    N = <lambda_N - eps_N g>,    T = return(lambda_T - eps_T dxi, N)

to the end, with its generalised derivative: the projections of Alart and Curnier (1991). Then
lambda_N <- N and lambda_T <- T [Simo Laursen 1992], until both change by less than the tolerance.
Where they change too slowly the penalties are raised; the answer does not depend on them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.augmentation import Augmentation
from anisocontact.errors import InputError
from anisocontact.interface import STATUS, Interface, PairLaw, Response, State
from anisocontact.python_law import PythonInterface

#: Laws whose penalties can be augmented.
type AugmentedLaw = Interface | PairLaw | PythonInterface

Floats = npt.NDArray[np.float64]

#: Change of the multipliers over the tractions, both as norms over the area, that is good enough.
SHARE = 1e-5
#: Cycles after which an increment is given up.
MOST_CYCLES = 30
#: A cycle is slow where it leaves more than this share of the violation; what the penalties are
#: then multiplied with; the least they come down to before an increment is given up. It is very
#: slow where it leaves more than SOFT.
SLOW, SOFT, RAISE, SOFTEST = 0.3, 0.9, 10.0, 2e-3
#: Cycles before penalties that were too high are raised again.
PATIENCE = 4
#: Directions of the mixing that count, relative to the largest.
RANK = 1e-12

_OPEN, _STICK = STATUS.index("open"), STATUS.index("stick")


def check(augmentation: Augmentation, law: AugmentedLaw) -> None:
    """Find out whether the parts to be augmented are penalties.

    Raises:
        InputError: The normal law has a time, or the history enters in a form without vectors.
    """
    model = law.normal.named[0]
    if model != "penalty":
        raise InputError(
            f'"{model}" given, an augmented contact needs "penalty": other laws are physical',
            "normal.model",
        )
    if not augmentation.tangential:
        return
    if isinstance(law, PythonInterface):
        raise InputError(
            "a tangential law written in Python is physical: tangential=False needed", "method"
        )
    if law.adhesion.named[0] != "elastic":
        raise InputError(
            f'"{law.adhesion.named[0]}" given, an augmented contact needs "elastic"',
            "adhesion.model",
        )
    if isinstance(law, Interface) and law.evolution != "transport":
        raise InputError(
            f'"{law.evolution}" given, an augmented contact needs "transport"', "evolution"
        )


# Half the squared sum of two unit normals below which they are opposite.
_OPPOSITE = 1e-12


@dataclass(frozen=True)
class Frames:
    """Tangents of the master and its normal at n points.

    Attributes:
        tangents: First derivatives of the position, (n, 2, 3), length.
        normal: Unit normal, (n, 3).
    """

    tangents: Floats
    normal: Floats

    @classmethod
    def of(cls, tangents: Floats) -> Frames:
        """Frames with the normal of the tangents, (n, 2, 3)."""
        cross = np.cross(tangents[:, 0], tangents[:, 1])
        return cls(tangents, cross / np.linalg.norm(cross, axis=1)[:, None])

    def vector(self, covector: Floats) -> Floats:
        """Vectors (n, 3) of covariant components (n, 2)."""
        metric = np.einsum("nid,njd->nij", self.tangents, self.tangents)
        contra = np.linalg.solve(metric, covector[..., None])[..., 0]
        return np.asarray(np.einsum("ni,nid->nd", contra, self.tangents))

    def turned_to(self, other: Frames, vectors: Floats) -> Floats:
        """Tangent vectors turned with the least rotation of the normal, (n, 3)."""
        both = self.normal + other.normal
        # Opposite normals have no least rotation: there a tangent vector stays as it is.
        squared = 0.5 * np.einsum("nd,nd->n", both, both)
        share = np.einsum("nd,nd->n", vectors, other.normal) / np.maximum(squared, _OPPOSITE)
        return np.asarray(vectors - share[:, None] * both)


class Multipliers:
    """Multipliers of the points of one contact.

    They are what a trial starts from: the committed pressure and elastic force, better from cycle
    to cycle. Nothing of them lasts but the state of the points and `stiffening`.

    Args:
        augmentation: What is asked for.
        size: Facet size, length.
        penalties: Normal penalty and least tangential stiffness, stress/length.
        comm: Communicator of the mesh.

    Attributes:
        level: What the penalties are multiplied with at the beginning of an increment; it finds
            itself and is part of the history.
        factor: What they are multiplied with now.
    """

    def __init__(
        self, augmentation: Augmentation, size: float, penalties: tuple[float, float], comm: Any
    ) -> None:
        self.tangential = augmentation.tangential
        self.level = self.factor = 1.0
        self._limit = augmentation.tolerance * size
        self._penalties = penalties
        self._comm = comm
        self._found = 1.0
        self._cycles: list[float] = []
        self._raised, self._waits = False, 0
        self._mixing = Mixing(comm)
        self._status: npt.NDArray[np.int8] | None = None

    def begin(self, state: State, located: npt.NDArray[np.bool_]) -> State:
        """What the trials of the next increment start from.

        A point nearer than the tolerance counts as touching: friction acts from the start.

        Args:
            state: Committed state.
            located: Whether each point has a surface below it, (n,).
        """
        self._cycles = []
        self._raised, self._waits = False, 0
        self._status, self._mixing = None, Mixing(self._comm)
        self.factor = self._found = self.level
        start = state.copy()
        start["multiplier"] = state["pressure"]
        touching = located & (state["status"] == _OPEN) & (state["gap"] <= self._limit)
        start["gap"][touching] = np.minimum(state["gap"][touching], 0.0)
        if self.tangential:
            start["status"][touching] = _STICK
        return start

    def commit(self) -> None:
        """Keep the level that the increment has shown to be right."""
        self.level = self._found

    def soften(self) -> bool:
        """After a solution that failed: take penalties that are easier to solve with.

        Returns:
            Whether there is something else to be tried, with the multipliers of the last cycle.
        """
        if not self._cycles:
            if self._found < SOFTEST * self.level:
                return False
            self.factor = self._found = self._found / RAISE
            return True
        if not self._raised or len(self._cycles) > MOST_CYCLES:
            return False
        self.factor /= RAISE
        self._raised, self._waits = False, PATIENCE
        self._mixing = Mixing(self._comm)
        return True

    def improve(
        self, start: State, answer: Response, areas: Floats, now: Frames, before: Frames
    ) -> State | None:
        """Better multipliers from a trial in equilibrium.

        Args:
            start: What the trial started from.
            answer: The trial.
            areas: Area of each point, (n,), length^2.
            now: Frames of the trial.
            before: Frames at the committed coordinates, in the configuration of the trial.

        Returns:
            What the next trial starts from; None if these hold.

        Raises:
            NotHeldError: They did not get there.
        """
        pressure = answer.pressure[:, None]
        old, force = np.zeros((2, len(start), 3))
        if self.tangential:
            remembers = (start["status"] != _OPEN)[:, None]
            old = np.where(remembers, before.vector(start["stored"]), 0.0)
            stored = now.turned_to(before, now.vector(answer.state["stored"]))
            force = np.where(remembers, stored, 0.0)
        given = np.hstack([start["multiplier"][:, None], old])
        if self._held(given, np.hstack([pressure, force]), answer.traction, areas):
            return None
        self._settle(answer.status)
        better = self._mixing.next(given, np.hstack([pressure, force]), areas)
        better[answer.pressure == 0.0] = 0.0
        new = start.copy()
        new["multiplier"] = np.maximum(better[:, 0], 0.0)
        if self.tangential:
            new["stored"] = np.einsum("nid,nd->ni", before.tangents, better[:, 1:])
        return new

    def _held(self, given: Floats, found: Floats, traction: Floats, areas: Floats) -> bool:
        change = found - given
        stiffness = np.array(self._penalties) * self.factor
        violation = np.maximum(
            np.abs(change[:, 0]) / stiffness[0],
            np.linalg.norm(change[:, 1:], axis=1) / stiffness[1],
        )
        squares = np.array([areas @ (change**2).sum(axis=1), areas @ (traction**2).sum(axis=1)])
        changed, carried = np.sqrt(self._comm.allreduce(squares))
        largest = max(self._comm.allgather(float(violation.max(initial=0.0))))
        if largest <= self._limit and changed <= SHARE * carried:
            return True
        self._count(largest)
        typical = carried / np.sqrt(self._comm.allreduce(float(areas.sum())))
        self._raise(largest * float(stiffness.max()), float(typical))
        return False

    def _count(self, violation: float) -> None:
        """Count a cycle.

        Raises:
            NotHeldError: There were too many.
        """
        self._cycles.append(violation)
        if len(self._cycles) > MOST_CYCLES:
            raise NotHeldError(
                f"the augmented Lagrangian leaves a violation of {violation:.2g} after "
                f"{MOST_CYCLES} cycles, {self._limit:.2g} asked for"
            )

    def _raise(self, correction: float, typical: float) -> None:
        """Raise the penalties where a cycle was slow and Newton's method can follow.

        It can where the corrections of the multipliers stay below the tractions; where next to
        nothing is gained the penalties are far too soft, and it can as well.
        """
        self._raised = False
        self._waits -= 1
        if len(self._cycles) < 2 or self._waits > 0:
            return
        left = self._cycles[-1] / self._cycles[-2]
        near = RAISE * correction < typical
        if left > (SLOW if near else SOFT) and self._cycles[-1] > self._limit:
            self.factor *= RAISE
            self._found *= 1.0 if near else RAISE
            self._raised = True
            self._mixing = Mixing(self._comm)

    def _settle(self, status: npt.NDArray[np.int8]) -> None:
        """Forget earlier cycles where the status of a point has changed: the map has a kink."""
        same = self._status is not None and np.array_equal(self._status, status)
        if self._comm.allreduce(int(not same)) > 0:
            self._mixing = Mixing(self._comm)
        self._status = status


class Mixing:
    """Anderson mixing: the fixed point of a map from its last few values [Walker Ni 2011].

    Args:
        comm: Communicator over whose ranks the points are spread.
        memory: Number of values that are kept.
    """

    def __init__(self, comm: Any, memory: int = 6) -> None:
        self._comm = comm
        self._memory = memory
        self._seen: list[tuple[Floats, Floats]] = []

    def next(self, given: Floats, found: Floats, weights: Floats) -> Floats:
        """Best guess of the fixed point.

        Args:
            given: Argument, (n, k).
            found: Value of the map there, (n, k).
            weights: Weight of each of the n in the norm, (n,).

        Returns:
            The next argument, (n, k).
        """
        self._seen = [*self._seen[-self._memory + 1 :], (found, found - given)]
        values = np.array([value for value, _ in self._seen])
        rests = np.array([rest for _, rest in self._seen])
        if len(values) == 1:
            return found.copy()
        steps = np.diff(rests, axis=0)
        weighted = steps * weights[:, None]
        gram = self._comm.allreduce(np.einsum("ink,jnk->ij", weighted, steps))
        right = self._comm.allreduce(np.einsum("ink,nk->i", weighted, rests[-1]))
        share = np.linalg.lstsq(gram, right, rcond=RANK)[0]
        return np.asarray(found - np.einsum("i,ink->nk", share, np.diff(values, axis=0)))


class NotHeldError(RuntimeError):
    """Multipliers that do not converge."""
