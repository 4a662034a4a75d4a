"""Fields of a mixed problem beside the displacement: their rows, and whether they are solved for.

Their equations have units of their own, and are weighed so that what is at work in them counts as
the forces at work do at the start of a solution. Nothing may be at work then. With the tangent `K`
there, `s` the mean diagonal of its displacements, and `r`, `c`, `o` the root mean square norms of a
row of `K_fu`, of a column of `K_uf` and of a row of `K_ff`, the weight of a field is `s/r` where it
constrains displacements and `c/o` where it drives them, the smaller one if it does both: an error
of a row counts as the force that it stands for.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, override

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import MPI, Mat, PETSc, Vec
from anisocontact.bulk import cell_size
from anisocontact.mesh.node_unknowns import NodeUnknowns
from anisocontact.solver.system.force_balance import (
    ROUND_OFF,
    FieldBalance,
    ForceBalance,
    Magnitudes,
)
from anisocontact.solver.terms.bodies import Bodies


class Fields:
    """No field beside the displacement."""

    #: Options of PETSc that stand for what is not given.
    options: Mapping[str, int] = MappingProxyType({})

    def measure(self, bodies: Bodies) -> None:
        """Measure the tangent of the bodies at the start of a solution; collective."""

    def weigh_by(self, start: Callable[[], ForceBalance]) -> None:
        """Let what is at work in the fields count as the forces do.

        Args:
            start: Evaluates the state from which the solution starts.
        """

    def prescribe(self, matrix: Mat, rows: Ints, scale: float) -> None:
        """Write the rows of prescribed unknowns into the tangent, and weigh those of the fields.

        Args:
            matrix: The tangent.
            rows: Prescribed unknowns of this rank, local numbers.
            scale: Force for a unit of length.
        """
        first, _ = matrix.getOwnershipRange()
        matrix.zeroRows((first + rows).astype(PETSc.IntType), scale)

    def of_displacement(self, rows: Ints) -> Ints:
        """Those of the rows that are displacements."""
        return rows

    def weigh(self, residual: Floats, rows: Ints, off: Floats) -> None:
        """Weigh the rows of the fields in a residual, in place.

        Args:
            residual: Of the unknowns this rank owns.
            rows: Those that are prescribed, local numbers.
            off: How far these are from what is prescribed.
        """

    def rounded(self, x: Vec) -> float:
        """Forces that the fields have on nodes, as far as they are rounded: see `Bodies.stiff`."""
        return 0.0

    def balances(self, residual: Floats, x: Vec, sizes: Magnitudes) -> tuple[FieldBalance, ...]:
        """Balance of the displacement and of every field; collective.

        Args:
            residual: Weighed, of the unknowns this rank owns.
            x: All unknowns.
            sizes: How large forces are.
        """
        return ()


@dataclass(frozen=True)
class Measures:
    """How large the tangent is in rows and columns of a field.

    Attributes:
        row: Root mean square norm of a row of `K_fu`.
        column: That of a column of `K_uf`.
        own: That of a row of `K_ff`.
        pin: What rows of prescribed unknowns are multiplied with: the mean diagonal of `K_ff`, or
            what is there once displacements are eliminated.
    """

    row: float = 0.0
    column: float = 0.0
    own: float = 0.0
    pin: float = 1.0


class Field:
    """One field beside the displacement.

    Args:
        unknowns: Its unknowns on this rank, local numbers.
        displacement: Those of the displacement.
        unknowns_before: Number of unknowns on the ranks before this one.
        comm: Communicator of the mesh.

    Attributes:
        unknowns: As given.
        count: Number of unknowns over all ranks.
        measures: How large the tangent is.
        weight: What all rows are multiplied with; 1 where nothing is at work in a field that
            neither depends on the displacement nor drives it.
    """

    def __init__(self, unknowns: Ints, displacement: Ints, unknowns_before: int, comm: Any) -> None:
        self.unknowns, self._comm = unknowns, comm
        self.count = int(comm.allreduce(len(unknowns)))
        self.measures, self.weight = Measures(), 1.0
        self._sides = [
            PETSc.IS().createGeneral((unknowns_before + side).astype(PETSc.IntType), comm=comm)
            for side in (unknowns, displacement)
        ]
        self._block: Mat = None

    def measure(self, tangent: Mat, stiffness: float) -> None:
        """Measure the tangent, without conditions; collective.

        Args:
            tangent: Of all unknowns.
            stiffness: Mean diagonal of the displacements, force/length.
        """
        own, displacement = self._sides
        if self._block is not None:
            self._block.destroy()
        self._block = tangent.createSubMatrix(own, own)
        o = self._mean(self._block)
        r = self._mean_of(tangent, own, displacement)
        c = self._mean_of(tangent, displacement, own)
        diagonal = float(np.abs(self._block.getDiagonal().array_r).sum())
        pin = float(self._comm.allreduce(diagonal)) / self.count
        weights = ([stiffness / r] if r else []) + ([c / o] if c and o else [])
        pin = pin or r * c / stiffness or 1.0
        self.measures, self.weight = Measures(r, c, o, pin), min(weights, default=1.0)

    def balance(
        self, residual: Floats, moving: Floats, values: Floats, strained: float, displaced: float
    ) -> FieldBalance:
        """How far the field is from its equations; collective.

        Args:
            residual: Weighed, of its unknowns.
            moving: Of these the rows that are prescribed, zero elsewhere.
            values: Of the field.
            strained: Root mean square of the displacements, with the length whose rounding is that
                of strains, length.
            displaced: Displacement that the forces at work give single nodes, length.
        """
        m = self.measures
        x, flux = self._block.createVecs()
        x.array[:] = values
        self._block.mult(x, flux)
        own = self.weight * max(float(flux.norm()), m.row * displaced)
        rounded = m.own * float(x.norm()) + m.row * strained * self.count**0.5
        sums = self._comm.allreduce(np.array([residual @ residual, moving @ moving]))
        left, to_move = (float(one) for one in np.sqrt(sums))
        x.destroy()
        flux.destroy()
        return FieldBalance(left, max(own, to_move), ROUND_OFF * self.weight * rounded)

    def _mean(self, block: Mat) -> float:
        """Root mean square norm of the rows or columns of a block that are those of the field."""
        return float(block.norm(PETSc.NormType.FROBENIUS) / self.count**0.5)

    def _mean_of(self, tangent: Mat, rows: Any, columns: Any) -> float:
        block = tangent.createSubMatrix(rows, columns)
        found = self._mean(block)
        block.destroy()
        return found


class FieldsBeside(Fields):
    """Fields beside the displacement.

    Args:
        unknowns: Where the displacement is.
        fields: The unknowns of each field on this rank, local numbers.
    """

    #: MUMPS puts off pivots that are zero, and needs the more memory the more processes there are.
    options: Mapping[str, int] = MappingProxyType({"mat_mumps_icntl_14": 200})

    def __init__(self, unknowns: NodeUnknowns, fields: list[Ints]) -> None:
        self._comm = comm = unknowns.comm
        owned = unknowns.owned
        there = np.zeros(owned, dtype=bool)
        there[np.concatenate(fields)] = True
        self._displacement = np.flatnonzero(~there)
        before = int(comm.scan(owned)) - owned
        self.fields = [Field(one, self._displacement, before, comm) for one in fields]
        self._moved = max(int(comm.allreduce(len(self._displacement))), 1)
        self._size = cell_size(unknowns.nodes.mesh)
        self._stiffness, self._weights = 1.0, np.ones(owned)
        self._pins, self._moving = np.ones(owned), np.zeros(owned)

    @override
    def measure(self, bodies: Bodies) -> None:
        tangent, self._stiffness = bodies.bulk.stiffness, bodies.scale
        bodies.add_tangent(tangent)
        for field in self.fields:
            field.measure(tangent, self._stiffness)
            self._pins[field.unknowns] = field.measures.pin
        self._take_weights()

    @override
    def weigh_by(self, start: Callable[[], ForceBalance]) -> None:
        force, *beside = (one.scale for one in start().fields)
        for field, at_work in zip(self.fields, beside, strict=True):
            if 0.0 < force < np.inf and 0.0 < at_work < np.inf:
                field.weight *= force / at_work
        self._take_weights()

    def _take_weights(self) -> None:
        for field in self.fields:
            self._weights[field.unknowns] = field.weight

    @override
    def prescribe(self, matrix: Mat, rows: Ints, scale: float) -> None:
        super().prescribe(matrix, self.of_displacement(rows), scale)
        for field in self.fields:
            super().prescribe(matrix, np.intersect1d(rows, field.unknowns), field.measures.pin)
        weights = matrix.createVecLeft()
        weights.array[:] = self._weights
        matrix.diagonalScale(weights)
        weights.destroy()

    @override
    def of_displacement(self, rows: Ints) -> Ints:
        return np.intersect1d(rows, self._displacement)

    @override
    def weigh(self, residual: Floats, rows: Ints, off: Floats) -> None:
        of_field = ~np.isin(rows, self._displacement)
        pinned = rows[of_field]
        residual[pinned] = self._pins[pinned] * off[of_field]
        residual *= self._weights
        self._moving[:] = 0.0
        self._moving[pinned] = residual[pinned]

    @override
    def rounded(self, x: Vec) -> float:
        return sum(field.measures.column * self._norm(x, field.unknowns) for field in self.fields)

    @override
    def balances(self, residual: Floats, x: Vec, sizes: Magnitudes) -> tuple[FieldBalance, ...]:
        left = residual[self._displacement]
        norm = self._comm.allreduce(float(left @ left)) ** 0.5
        strained = self._norm(x, self._displacement) / self._moved**0.5 + self._size
        displaced = sizes.force_scale / self._stiffness
        beside = []
        for field in self.fields:
            own = field.unknowns
            values = residual[own], self._moving[own], x.array_r[own]
            beside.append(field.balance(*values, strained, displaced))
        return (FieldBalance(norm, sizes.force_scale, sizes.round_off), *beside)

    def _norm(self, x: Vec, unknowns: Ints) -> float:
        values = x.array_r[unknowns]
        return float(self._comm.allreduce(float(values @ values)) ** 0.5)


def fields_beside(unknowns: NodeUnknowns, space: Any) -> Fields:
    """Fields of a space beside the displacement; collective.

    Args:
        unknowns: Where the displacement is.
        space: The whole space.

    Returns:
        The other sub-spaces, each a field.
    """
    taken = unknowns.own(np.ones((unknowns.node_count, 3))) > 0.0
    found = []
    for i in range(space.num_sub_spaces):
        _, numbers = space.sub(i).collapse()
        numbers = np.unique(np.asarray(numbers, dtype=np.int64))
        numbers = numbers[numbers < unknowns.owned]
        numbers = numbers[~taken[numbers]]
        if unknowns.comm.allreduce(len(numbers), MPI.SUM):
            found.append(numbers)
    return FieldsBeside(unknowns, found) if found else Fields()
