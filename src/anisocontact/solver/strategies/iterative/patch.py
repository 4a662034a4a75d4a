"""Nodes that keep their unknowns on the coarse level: all that contact can couple."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Flags
from anisocontact.base.fenicsx import PETSc
from anisocontact.contact.remote_nodes import globally
from anisocontact.solver.strategies.condensed.reach import Reach
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.step import Step


class Patch:
    """Nodes in reach of contacts, of constraints and of springs that couple whole facet groups.

    Args:
        problem: The problem.
        steps: What will be done: tells what can be touched.
    """

    def __init__(self, problem: Problem, steps: Sequence[Step]) -> None:
        self._problem = problem
        self._meshed = [c for c in problem.contacts if c.meshed]
        none = np.zeros(0, dtype=np.int32)
        self._reach = Reach(problem.model, problem.contacts, steps, none)

    def select(self) -> Flags:
        """Nodes of the patch from the accepted state on, of those this rank owns, (owned,)."""
        problem = self._problem
        self._reach.select(problem.u.x.array.reshape(-1, 3))
        found: list[npt.NDArray[Any]] = [np.flatnonzero(self._reach.nodes)]
        for rows, columns, _ in problem.attached.couplings():
            found += [rows.ravel(), columns.ravel()]
        named = np.unique(np.concatenate(found))
        marks = problem.new_vector()
        at = 3 * globally(named[named >= 0], problem.model.space)
        marks.setValues(at.astype(PETSc.IntType), np.ones(len(at)), PETSc.InsertMode.ADD_VALUES)
        marks.assemble()
        owned = (marks.array_r > 0.0) | problem.constraints.involved()
        return np.asarray(owned[: problem.layout.owned].reshape(-1, 3).any(axis=1))

    def outgrown(self) -> bool:
        """Whether slave points of the trial are above master nodes outside; the same on all ranks.

        The next selection then allows for more motion.
        """
        feet = [contact.master.feet() for contact in self._meshed]
        outside = bool(feet) and not self._reach.has(np.concatenate(feet))
        if outside:
            self._reach.widen()
        return outside
