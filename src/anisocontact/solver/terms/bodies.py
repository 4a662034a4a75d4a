"""The bodies themselves: internal forces, elastic energy and temperatures."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, override

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI, Mat, Vec
from anisocontact.bulk import LinearBulk, NonlinearBulk
from anisocontact.mesh.node_unknowns import NodeUnknowns
from anisocontact.solver.terms.form import FormBulk
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.prescribed_components import PrescribedComponents
from anisocontact.solver.terms.step import Step
from anisocontact.solver.terms.term import Term

#: Name of the internal force in a checkpoint.
_NAME = "internal_force"

#: What forces inside bodies come from.
type Bulk = LinearBulk | NonlinearBulk | FormBulk


def mean_diagonal(diagonal: Floats, comm: Any) -> float:
    """Mean diagonal of the tangent at rest of nodes that have a stiffness, force/length.

    Args:
        diagonal: Of the displacements this rank owns.
        comm: Communicator of the mesh; the call is collective.

    Returns:
        The mean over all ranks.
    """
    return float(comm.allreduce(diagonal.sum()) / comm.allreduce(np.count_nonzero(diagonal)))


class Bodies(Term):
    """Internal forces on the nodes, complete where this rank owns them.

    In sums of terms it comes first: its tangent is written, those of others are added.

    Args:
        bulk: Internal forces.
        unknowns: Where the displacement of nodes is among the unknowns.

    Attributes:
        unknowns: As given.
        scale: Mean diagonal of the tangent at rest, force/length.
        again: Whether `add_tangent` writes once more what it has written last.
        elastic_share: Share of the elastic tangent where bodies flow, see `BodyPoints`.
        largest: Norm of `stiff` over all ranks in the largest state accepted so far, force. What is
            left of that state where it has gone back to zero is its rounding.
    """

    def __init__(self, bulk: Bulk, unknowns: NodeUnknowns) -> None:
        self.bulk, self.unknowns = bulk, unknowns
        diagonal = unknowns.own_nodal(np.array(bulk.diagonal.array_r))
        self.scale = mean_diagonal(diagonal, unknowns.comm)
        self._u = bulk.stiffness.createVecRight()
        self._temperatures = {name: PrescribedComponents(1) for name in bulk.heated}
        #: Temperatures and displacement of the accepted state, where bodies are heated.
        self._heat = dict.fromkeys(bulk.heated, 0.0)
        self._start: Vec | None = self._u.copy() if bulk.heated else None
        self.again, self.elastic_share, self.largest = False, 0.0, 0.0
        #: Internal force of the last evaluation and where it was, and that of the accepted state.
        self._internal, self._internal_at = np.zeros(0), np.zeros(0)
        self._accepted: Floats | None = None
        #: Displacement and internal force at the last tangent.
        self._written: tuple[Vec, Floats] | None = None
        #: Displacement and internal force that forces are linear about, where they are.
        self._about: tuple[Vec, Floats] | None = None

    @override
    def add_force(self, u: Floats, out: Floats) -> None:
        internal = self.unknowns.own_nodal(self.internal_force(u))
        out[: len(internal)] += internal

    def internal_force(self, u: Floats) -> Floats:
        """Internal force of all unknowns this rank owns, force; collective.

        Of those of other fields as well, which have a residual, too.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
        """
        if self._about is not None:
            at, there = self._about
            self._internal = there - self.bulk.times(self._owned(u) - at).array_r
        else:
            self._internal = -np.asarray(self.bulk.force(self._owned(u)).array_r)
        self._internal_at = np.array(self._u.array_r)
        return self._internal

    @contextmanager
    def linearised(self) -> Iterator[None]:
        """Around evaluations in which forces follow from the last one and the last tangent."""
        self._about = self._u.copy(), self._internal
        try:
            yield
        finally:
            self._about = None

    def accepted_internal_force(self, u: Floats) -> Floats:
        """Internal force in the accepted state `u`, as of `internal_force`; collective.

        A material that knows time would go on from there by an increment if it was asked again.
        """
        return self.internal_force(u) if self._accepted is None else self._accepted

    def accepted_at_nodes(self) -> Arrays:
        """Internal force of the accepted state at the nodes this rank owns, to be restored.

        None where an evaluation of that state gives it: what a material has done in an increment
        cannot be asked again from its end.
        """
        return {} if self._accepted is None else {_NAME: self._accepted.reshape(-1, 3).copy()}

    def restore_at_nodes(self, kept: Arrays) -> None:
        """Go on from what `accepted_at_nodes` gave, among other things."""
        self._accepted = kept[_NAME].reshape(-1).copy() if _NAME in kept else None

    def missed(self) -> Floats:
        """What the internal force has changed by since the last tangent, beyond what it says.

        Of the last evaluation, of the unknowns of the mesh that this rank owns.
        """
        assert self._written is not None, "`add_tangent` comes first"
        u, internal = self._written
        return np.asarray(self._internal - internal + self.bulk.times(self._u - u).array_r)

    def check(self, step: Step) -> None:
        """Refuse temperatures of bodies that do not expand.

        Raises:
            InputError: There is one.
        """
        for name in step.temperature:
            if name not in self._temperatures:
                text = "no such body whose material has an expansion"
                raise InputError(text, f"step {step.name!r}.temperature.{name}")

    @override
    def begin(self, step: Step, released: Floats) -> None:
        self.check(step)
        for one in self._temperatures.values():
            one.begin(step.duration)
        for name, value in step.temperature.items():
            self._temperatures[name].prescribe(0, value)

    @override
    def end_at(self, factor: float) -> None:
        for one in self._temperatures.values():
            one.stop(factor)

    @override
    def set_load_factor(self, factor: float, dt: float) -> None:
        self.bulk.set_time(dt)
        for name, one in self._temperatures.items():
            self.bulk.heated[name].set_temperature(float(one.at(factor)[0]))

    @override
    def add_tangent(self, matrix: Mat) -> None:
        again = self.again or self._about is not None
        self.bulk.tangent(matrix, again=again, elastic_share=self.elastic_share)
        if not again:
            self._written = self._u.copy(), self._internal

    def energy(self, u: Floats) -> float:
        """Elastic energy over all ranks, force times length."""
        return self.bulk.energy(self._owned(u))

    def dissipated(self) -> dict[str, float]:
        """What materials with a history have dissipated, where there are any."""
        return {"inelastic": self.bulk.dissipated()} if self.bulk.histories else {}

    @override
    def energies(self, u: Floats) -> dict[str, float]:
        return {"elastic": self.energy(u)} | self.dissipated()

    @contextmanager
    def followed(self, u: Floats, in_full_alone: bool) -> Iterator[bool]:
        """Around corrections that begin at a state: whether to take them in full, see `follow`."""
        try:
            yield self.bulk.follow(self._owned(u), in_full_alone)
        finally:
            self.bulk.follow(None)

    @override
    def accept(self, u: Floats) -> float:
        if self.bulk.histories:
            there = np.array_equal(self._internal_at, self._owned(u).array_r)
            if not self.unknowns.comm.allreduce(there, MPI.LAND):
                self.internal_force(u)
            self._accepted = self._internal
        self.bulk.commit(self._owned(u))
        self._heat = self._temperatures_now()
        if self._start is not None:
            self._owned(u).copy(self._start)
        self._take_size(u)
        return 0.0

    @property
    def heats(self) -> bool:
        """Whether temperatures are others than in the accepted state."""
        return self._heat != self._temperatures_now()

    def heating(self, u: Floats) -> tuple[float, float]:
        """Energy that changes of temperature give at the accepted displacement, and at this one.

        Over all ranks, force times length.
        """
        if self._start is None:
            return 0.0, 0.0
        return self.bulk.heating(self._start, self._owned(u), self._heat)

    def _temperatures_now(self) -> dict[str, float]:
        return {name: body.temperature for name, body in self.bulk.heated.items()}

    @override
    def persistent(self) -> Arrays:
        own = {"bodies.largest": np.array(self.largest)}
        if self._heat:
            own["bodies.temperatures"] = np.array([*self._heat.values()])
        return own

    @override
    def restore(self, kept: Arrays) -> None:
        self.largest = float(kept["bodies.largest"])
        if self._heat:
            values = kept["bodies.temperatures"].tolist()
            self._heat = dict(zip(self._heat, values, strict=True))

    @override
    def histories(self) -> list[Arrays]:
        return [history.persistent() for history in self.bulk.histories.values()]

    @override
    def take_histories(self, kept: Iterator[Arrays], u: Floats) -> None:
        for history in self.bulk.histories.values():
            history.restore(next(kept))
        if self._start is not None:
            self._owned(u).copy(self._start)
        self._take_size(u)

    def _take_size(self, u: Floats) -> None:
        """Take note of how large an accepted state is; collective."""
        stiff = self.stiff(u)
        size = float(self.unknowns.comm.allreduce(float(stiff @ stiff)) ** 0.5)
        self.largest = max(self.largest, size)

    def stiff(self, u: Floats) -> Floats:
        """Forces of nodes that move alone, `K_ii u_i`, of those this rank owns: see `round_off`."""
        moved = np.abs(self._owned(u).array_r) + self.bulk.rest_length
        return np.asarray(self.bulk.diagonal.array_r * moved)

    def _owned(self, u: Floats) -> Vec:
        self._u.array[:] = self.unknowns.own(u)
        return self._u
