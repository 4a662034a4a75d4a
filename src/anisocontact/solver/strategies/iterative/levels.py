"""Multilevel preconditioner: the interior of each level is smoothed, the last is factorised."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from anisocontact.base.fenicsx import MPI, Mat, PETSc, Vec, release_unreferenced
from anisocontact.solver.strategies.costs import factor_bytes, too_large
from anisocontact.solver.strategies.iterative.coarse import CoarseLevel
from anisocontact.solver.strategies.iterative.cycle import Residual, Smoother, cycle, residual
from anisocontact.solver.strategies.iterative.factor import Factor
from anisocontact.solver.strategies.iterative.interpolation import (
    Aggregates,
    aggregates,
    smoothed,
    tentative,
)
from anisocontact.solver.strategies.iterative.multilevel_inverse import Below
from anisocontact.solver.strategies.iterative.patch import Patch
from anisocontact.solver.strategies.iterative.single_rows import (
    InteriorRows,
    MixedResidual,
    SingleInterior,
)
from anisocontact.solver.strategies.iterative.split import UnknownSplit, interior_matrix
from anisocontact.solver.system.problem import Problem

#: Unknowns of a node where all are displacements in space.
BLOCK = 3
#: Given unknowns follow from given ones at most so often, with ties on a symmetry plane.
CHAIN = 3
#: Residual of given unknowns over that of all up to which the other rows need not be told of it.
NEGLIGIBLE = 1e-6
#: Krylov iterations over those with a new interpolation at which an old one is given up.
WORN = 1.5
#: Krylov iterations more than with the bodies of its tangent with which a correction may be found.
LAG = 2
#: Motions of aggregates over the unknowns of the patch from which on they get a further level.
MANY = 1.0
#: The same, in themselves: a factor of so few takes less than a level.
FEW = 6000


class Levels:
    """Preconditioner of the tangent J of a problem, as a Python context of PETSc.

    Given unknowns are solved from their rows. The rest takes one multiplicative cycle: smoothing of
    the interior, the coarse level `P^T J P`, smoothing again. Contact lies in the patch, which P
    leaves as it is, so the coarse level has all of it and the smoother nothing. Where most of the
    coarse level are aggregates it is solved by such a cycle in its turn. Where levels do not lead
    to the solution a factor of all unknowns takes their place.

    Bodies that are not linear stay those of an earlier tangent of the increment while corrections
    are found as fast with them; contact is always that of now.

    Args:
        problem: The problem.
        patch: Nodes that contact can couple.
        prefix: Prefix of the options of its parts.
        note: Called with a line when the interpolation is made.

    Attributes:
        lagging: Whether the bodies are those of an earlier tangent.
    """

    def __init__(
        self, problem: Problem, patch: Patch, prefix: str, note: Callable[[str], None]
    ) -> None:
        self._problem, self._patch, self._prefix, self._note = problem, patch, prefix, note
        self._tangent: Mat | None = None
        self._split: UnknownSplit | None = None
        self._interior: Mat | None = None
        self._smoother: Smoother | None = None
        self._coarse: CoarseLevel | None = None
        self._whole = False
        self._factor: Factor | None = None
        self._rest = problem.new_vector()
        self._bulk: object = None
        self._fresh = self._least = 0
        self.lagging, self._lags, self._due = False, True, False
        self._worn, self._single = False, True
        self._mixed: MixedResidual | None = None
        self._mixes = problem.linear and problem.layout.unknowns.block == BLOCK

    def begin(self, *, lags: bool = True) -> None:
        """Take it that an increment begins: what was before it matters no more.

        Args:
            lags: Whether bodies of an earlier tangent may do.
        """
        self._lags, self._due = lags, True

    def count(self, iterations: int) -> None:
        """Take the number of Krylov iterations of a correction."""
        if not self.lagging:
            self._least = iterations
        self._due = not self._lags or iterations > self._least + LAG
        if self._fresh == 0:
            self._fresh = iterations
        self._worn = iterations > WORN * max(self._fresh, 10)

    def give_up(self) -> str:
        """Factorise all unknowns from the next tangent on.

        Returns:
            Why not, in a line: there is no room, or it is what has been done; empty if so.
        """
        count, comm = self._problem.solved_for, self._problem.comm
        full = next(too_large(f"a factorisation of {count} unknowns", factor_bytes(count)), "")
        against = next(filter(None, comm.allgather(full)), "")
        if self._whole or against:
            return against or "all unknowns are factorised"
        self.close()
        self._whole = True
        return ""

    def setUp(self, pc: PETSc.PC) -> None:
        """Take the tangent that the linear solver has been given, for PETSc."""
        tangent, _ = pc.getOperators()
        if not self.take(tangent):
            pc.setFailedReason(PETSc.PC.FailedReason.FACTOR_NUMERIC_ZEROPIVOT)

    def apply(self, _: PETSc.PC, b: Vec, x: Vec) -> None:
        """One cycle from zero, or a solution with the factor, for PETSc."""
        self.solve(b, x)

    def take(self, tangent: Mat) -> bool:
        """Take a tangent; whether its last level could be factorised."""
        self._tangent = tangent
        if self._whole:
            return self._factorise(tangent)
        # what the tangent without contact depends on, beside the state where bodies are not linear
        bulk = self._problem.stabilisation.stiffnesses
        changed = not self._problem.linear or bulk != self._bulk
        outdated = self._outdated(changed)
        self.lagging = changed and not (outdated or self._due or bulk != self._bulk)
        if outdated:
            self._build(tangent)
        elif changed and not self.lagging:
            self._renew(tangent)
        self._bulk = bulk
        if self._mixed is not None:
            self._mixed.take(tangent)
        assert self._coarse is not None
        found = self._coarse.renew(tangent)
        if self._single and not self._coarse.single:
            self._single = False
            self._note("the factor of the coarse level is in double precision from now on")
        return found

    def solve(self, b: Vec, x: Vec) -> None:
        """Set x to what one cycle from zero, or the factor, finds for b."""
        if self._factor is not None:
            self._factor.solve(b).copy(x)
            return
        self._cycle(b, x)
        if self._mixed is not None and not self._mixed.trusted(b, x):
            self._mixes = False
            self._note("products with the interior are in double precision from now on")
            self._renew(self._tangent)
            self._cycle(b, x)

    def close(self) -> None:
        """Give back PETSc's objects."""
        for part in (self._smoother, self._interior, self._mixed, self._coarse, self._factor):
            if part is not None:
                part.destroy()
        self._factor = self._mixed = None
        self._split = self._smoother = self._interior = self._coarse = None

    def _cycle(self, b: Vec, x: Vec) -> None:
        """One cycle from zero."""
        assert self._coarse is not None and self._smoother is not None
        balance, rest = self._mixed or residual(self._tangent), self._rest
        x.zeroEntries()
        b.copy(rest)
        self._solve_given(balance, b, rest, x)
        cycle(balance, self._smoother, self._coarse, b, rest, x)

    def _factorise(self, tangent: Mat) -> bool:
        """Make a factor of the tangent; whether there is one."""
        if self._factor is None:
            prefix = f"{self._prefix}coarse_"
            self._factor = Factor(tangent, (), prefix, self._single, self._note)
        return self._factor.renew(tangent, grown=True, bodies=True)

    def _outdated(self, bulk_changed: bool) -> bool:
        """Whether the interpolation has to be made anew; the same on all ranks."""
        if self._split is None:
            return True
        other = not np.array_equal(self._split.given, self._problem.constrained())
        worn = self._worn and bulk_changed
        return bool(self._problem.comm.allreduce(other)) or worn or self._patch.outgrown()

    def _build(self, tangent: Mat) -> None:
        self.close()
        problem, scale = self._problem, self._problem.assembly.scale
        self._split = split = UnknownSplit(problem, self._patch.select())
        self._interior = interior = interior_matrix(tangent, split, scale)
        found = aggregates(split, interior, f"{self._prefix}aggregates_")
        rough = problem.constraints.spread(tentative(found[0], split, tangent))
        prolong = smoothed(rough, tangent, interior, split)
        kept = split.patch.getSize()
        levels = _worth_it(found, kept)
        size = split.patch.getLocalSize()
        below = Below(size, scale, self._prefix, self._single, self._note)
        self._coarse = CoarseLevel(
            tangent,
            prolong,
            split.patch,
            scale,
            lambda matrix: below.inverse(matrix, levels, (prolong,)),
        )
        self._smoother = Smoother(interior, split.interior, split.first, self._prefix)
        self._take_precision(tangent, interior)
        self._fresh, self._worn = 0, False
        release_unreferenced(problem.comm)
        counts = ", then ".join(str(level.count) for level in levels)
        self._note(
            f"preconditioner of {1 + len(levels)} levels: {split.interior.getSize()} unknowns of "
            f"the interior become {counts}, {kept} that contact can couple stay on all of them"
        )

    def _renew(self, tangent: Mat) -> None:
        """The same interpolation for bodies that have changed."""
        assert self._coarse is not None and self._split is not None and self._smoother is not None
        scale = self._problem.assembly.scale
        before = self._interior
        # on several processes emptied rows and columns are left out of what could be overwritten
        overwritten = self._problem.comm.size == 1 and not self._problem.linear
        again = before if overwritten else None
        self._interior = interior_matrix(tangent, self._split, scale, again)
        self._smoother.renew(self._interior)
        if again is None and before is not None:
            before.destroy()
        self._take_precision(tangent, self._interior)
        self._coarse.renew_bodies(tangent)

    def _take_precision(self, tangent: Mat, interior: Mat) -> None:
        """Products with an interior that stays: in single precision where that serves, or blocks.

        Args:
            tangent: Tangent of all unknowns.
            interior: That of the interior; destroyed where something else takes its place.
        """
        assert self._split is not None and self._smoother is not None
        if self._mixed is not None:
            self._mixed.destroy()
        self._mixed, split = None, self._split
        if self._mixes and self._smoother.of_products:
            rows = InteriorRows(tangent, split.interior)
            self._mixed = MixedResidual(rows, split.patch)
            single = SingleInterior(rows, self._rest, split.given, self._problem.assembly.scale)
            self._interior = single.matrix(tangent.getComm())
            self._smoother.renew(self._interior)
            interior.destroy()
        elif self._problem.linear:  # else every tangent would have to be converted
            interior.convert(PETSc.Mat.Type.BAIJ)

    def _solve_given(self, balance: Residual, b: Vec, rest: Vec, x: Vec) -> None:
        """Unknowns with a row of their own, and what they leave of the other rows."""
        assert self._split is not None
        given, least = self._split.given, NEGLIGIBLE * b.norm()
        for _ in range(CHAIN):
            left = rest.array_r[given]
            x.array[given] += left / self._problem.assembly.scale
            most = float(np.abs(left).max(initial=0.0))
            if self._problem.comm.allreduce(most, MPI.MAX) <= least:
                return
            balance(b, x, rest)


def _worth_it(found: Sequence[Aggregates], kept: int) -> list[Aggregates]:
    """The levels down to the first on which a factor is a matter of the patch."""
    few = max(FEW, MANY * kept)
    number = next((n for n, level in enumerate(found, 1) if level.count <= few), len(found))
    return list(found[:number])
