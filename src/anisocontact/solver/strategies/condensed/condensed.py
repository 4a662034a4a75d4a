"""A problem whose linear bulk is condensed on the unknowns that can be touched."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise, starmap

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.arrays import connected
from anisocontact.base.fenicsx import Vec
from anisocontact.solver.strategies.condensed.parts import Condensation
from anisocontact.solver.strategies.condensed.patterns import InteriorState, WorkForces
from anisocontact.solver.strategies.condensed.reach import Reach
from anisocontact.solver.strategies.condensed.system import ContactSystem
from anisocontact.solver.system.ends_work import EndsWork
from anisocontact.solver.system.partly_known import Kept
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.system.rotations import BodyRotation, Rotations
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.step import Step


class Condensed:
    """Answers for the bulk of a `Problem` while Newton moves its contact unknowns only.

    States of all unknowns stay with the problem, but after a commit they are up to date where
    contacts need them only; `recover` brings the rest when somebody asks.

    Args:
        problem: The problem, on one process, with linear bulk.
        steps: What will be done: tells what can be touched.
        note: Called with a line for all that is done.
        kept: What `persistent` gave of a run that goes on; nothing for one that begins.
    """

    whole = False

    def __init__(
        self,
        problem: Problem,
        steps: Sequence[Step],
        note: Callable[[str], None],
        kept: Arrays | None = None,
    ) -> None:
        self._problem, self._note = problem, note
        starts, columns, values = problem.bulk.stiffness.getValuesCSR()
        n = len(starts) - 1
        self._stiffness = scipy.sparse.csr_array((values, columns, starts), shape=(n, n))
        self._gathering = problem.constraints.gathering()
        cells = problem.model.space.dofmap.list
        self._part_of = np.repeat(connected(n // 3, cells, problem.constraints.links()), 3)
        self._reach = Reach(problem.model, problem.contacts, steps, problem.attached.nodes)
        self._bulk: Condensation | None = None
        self._system: ContactSystem | None = None
        self._state: InteriorState | None = None
        self._trial_load: Floats = np.zeros(n)
        self._load: Floats = np.zeros(n)
        self._forces: Floats = np.zeros(n)
        self._stale = False
        self._held: dict[tuple[str, int], int] = {}
        self._means: dict[str, tuple[WorkForces, Floats]] = {}
        self._whole: tuple[InteriorState, Floats] | None = None
        problem.reduce_by(self)
        if kept:
            self._restore(kept)

    def accepted(self) -> Vec:
        """Copy of the accepted state, true for what contacts need."""
        return self._problem.accepted()

    @property
    def known(self) -> ContactSystem | None:
        """The system of the contact unknowns, as far as there is one."""
        return self._system

    def persistent(self) -> Arrays:
        """All that the next increments depend on beside the state of the problem.

        Factors are not written but made again: from the same numbers, in the same order.
        """
        if self._system is None or self._state is None:
            return {}
        own = {
            "u": self._state.u,
            "a": self._state.a,
            "b": self._state.b,
            "at_supports": self._state.at_supports,
        }
        parts = (self._reach, self._system.patterns, self._system.solver)
        for part in parts:
            own |= part.persistent()
        return own

    def pending(self) -> Arrays:
        """What `recover` needs beside the accepted state, at the nodes.

        With constraints the state is completed: see `Interior`, which knows of none.
        """
        if self._gathering is not None:
            self.recover()
        if not self._stale:
            return {}
        loads = {"load": self._load, "contact_force": self._forces}
        return {"in_reach": self._reach.nodes} | {n: f.reshape(-1, 3) for n, f in loads.items()}

    def _restore(self, kept: Arrays) -> None:
        self._reach.restore(kept)
        system = self._eliminate(self._reach.start)
        system.patterns.restore(kept)
        system.solver.restore(kept)
        self._state = InteriorState(kept["u"], kept["a"], kept["b"], kept["at_supports"])
        if "load" in kept:  # also where the interior is known meanwhile, by other operations
            self._load = kept["load"].reshape(-1)
            self._forces = kept["contact_force"].reshape(-1)
            self._stale = True

    def prepare(self) -> ContactSystem:
        """The system of the contact unknowns at the load factor of the problem.

        What has been condensed is used again as long as the same unknowns are prescribed and no
        body has moved beyond what was allowed for.

        Raises:
            SingularError: A body is not held.
        """
        problem = self._problem
        if self._system is None or not self._fits(self._system):
            self._condense()
        assert self._system is not None
        problem.stabilise_at(self._reach.nodes)
        self._trial_load = problem.layout.assembled(problem.loads.force(self._nodal()))
        supports = np.zeros(self._stiffness.shape[0])
        supports[problem.supports.unknowns] = problem.supports.values
        self._system.set_load_factor(supports, self._trial_load)
        if problem.stabilisation.regularisation.active:
            problem.stabilisation.regularisation.start(self._nodal(), self._reach.nodes)
        return self._system

    def _fits(self, system: ContactSystem) -> bool:
        """Whether unknowns are prescribed and in reach as when the bodies were condensed."""
        fixed, _ = self._fixed()
        same = np.array_equal(system.bulk.prescribed, np.flatnonzero(fixed))
        same = same and np.array_equal(system.prescribed, self._problem.rigid.prescribed())
        return same and self._reach.valid(self._nodal())

    def _fixed(self) -> tuple[Flags, scipy.sparse.csr_array | None]:
        """Unknowns that are prescribed or follow from others; and how forces are handed on."""
        count = self._stiffness.shape[0]
        fixed = np.zeros(count, dtype=np.bool_)
        fixed[self._problem.supports.unknowns] = True
        gathering = self._problem.constraints.gathering()
        if gathering is not None:
            gathering = gathering[:count, :count]  # unknowns of rigid bodies follow from nothing
            fixed |= abs(gathering).sum(axis=1) == 0.0
        return fixed, gathering

    def grow(self) -> None:
        """Condense anew with more in reach, from the accepted state."""
        self.recover()
        for contact in self._problem.contacts:
            contact.roll_back()
        self._reach.widen()
        self._note("a slave point left the part of its master that can be touched: widened")
        self._condense()

    def commit(self, x: Vec) -> EndsWork:
        """Accept a state of the contact unknowns.

        Args:
            x: State of all unknowns, true for contact and prescribed ones.

        Returns:
            Work from outside since the last one, force times length.
        """
        system = self.system
        before, after = self._state, self._trial(x)
        assert before is not None
        way = pairwise([before, *system.way, after])
        work = sum(starmap(system.patterns.work, way), EndsWork(0.0, 0.0))
        self._state, self._load, self._forces = after, self._trial_load, system.raw_forces
        self._stale = True
        return work

    def nodal(self, x: Vec) -> Floats:
        """Displacement of the nodes in a vector of all unknowns, (nodes, 3), length."""
        return np.array(x.array_r[: self._stiffness.shape[0]]).reshape(-1, 3)

    def turned(self, rotations: Rotations, x: Vec, last: bool) -> dict[str, BodyRotation]:
        """As of `Reduction`."""
        return rotations.reduced(self, x, last)

    def _trial(self, x: Vec) -> InteriorState:
        """The state of the contact unknowns of a vector of all unknowns."""
        own = self.system.new_vector()
        own.array[:] = x.array_r[self.system.places]
        self.system.evaluate(own)
        return self.system.state(own.array_r)

    def kept(self, x: Vec) -> Kept:
        """What is known of a trial state in equilibrium without the interior."""
        given = np.zeros(self._stiffness.shape[0], dtype=np.bool_)
        given[self.system.bulk.prescribed] = True
        state, forces = self._trial(x), float(np.abs(self._trial_load).sum())
        work = self.system.patterns.load_work(state)
        return Kept(
            self._reach.nodes | given.reshape(-1, 3).all(axis=1),
            self.nodal(x),
            work / forces if forces > 0.0 else 0.0,
        )

    def displacement(self, x: Vec) -> Floats:
        """As of `Reduction`."""
        state = self._trial(x)
        self._whole = (state, self._solved(state, x))
        return self._whole[1].reshape(-1, 3)

    def recover(self) -> None:
        """Bring the state of the whole bulk up to date: one solution with the interior."""
        if self._stale and self._state is not None:
            self._stale = False
            state, accepted = self._state, self._problem.accepted()
            if self._whole is not None and self._whole[0].same(state):
                u = self._whole[1]
            else:
                u = self._solved(state, accepted)
            self._whole = None
            self._problem.whole.complete(u, self._forces, self._load)

    def _solved(self, state: InteriorState, x: Vec) -> Floats:
        """Displacements of all nodes, (n,), with those of `x` where they are prescribed."""
        u = self.system.patterns.displacement(state)
        fixed = self.system.bulk.prescribed
        u[fixed] = x.array_r[fixed]  # without rounding
        return u if self._gathering is None else self._gathering.T @ u

    def reactions(self, x: Vec | None = None) -> dict[str, Floats]:
        """As of `Reduction`."""
        whole = self._problem.whole
        if self._problem.inclined and x is not None:  # their forces need all displacements on them
            u = self.displacement(x)
            return whole.reactions_at(u, self.system.raw_forces, self._trial_load)
        if self._problem.inclined:
            self.recover()
        if x is None and not self._stale:  # of supports, too, that have begun since
            return whole.reactions()
        state = self._state if x is None else self._trial(x)
        assert state is not None
        outside = self.system.patterns.outside(state)
        load = self.system.handed(self._load if x is None else self._trial_load)
        sums: dict[str, Floats] = {}
        for (group, axis), unknowns in self._problem.supports.owners.items():
            total = sums.setdefault(group, np.zeros(3))
            if len(unknowns):  # a group that turns in the plane has none of its own across it
                total[axis] = outside[self._held[group, axis]] - load[unknowns].sum()
        return sums

    def elastic(self) -> float:
        """Elastic energy of the accepted state, force times length."""
        assert self._state is not None
        return self.system.patterns.energy(self._state)

    def mean(self, group: str, weights: Floats, x: Vec | None = None) -> Floats:
        """Mean displacement of nodes, (3,) or (3, k), length.

        Args:
            group: Name under which the weights are known.
            weights: Share of each node, (nodes,) or (nodes, k).
            x: All unknowns of a trial state in equilibrium; the accepted one if not given.
        """
        if group not in self._means:
            self._means[group] = self._probe(weights)
        probe, supports = self._means[group]
        state = self._state if x is None else self._trial(x)
        assert state is not None
        at = self._problem.accepted() if x is None else x
        free = self.system.patterns.work_of(probe, state)
        found = free + supports.T @ at.array_r[self.system.bulk.prescribed]
        return np.asarray(found.reshape(3, *weights.shape[1:]))

    def _probe(self, weights: Floats) -> tuple[WorkForces, Floats]:
        """Weights as forces on the free unknowns, and those of the prescribed ones."""
        each = np.zeros((len(weights), 3, 3, weights[0].size))
        for axis in range(3):
            each[:, axis, axis] = weights.reshape(len(weights), -1)
        forces = self.system.handed(each.reshape(self._stiffness.shape[0], -1))
        fixed = self.system.bulk.prescribed
        supports = forces[fixed]
        forces[fixed] = 0.0
        return self.system.patterns.probe(forces), supports

    @property
    def system(self) -> ContactSystem:
        """The system of the contact unknowns."""
        assert self._system is not None, "`prepare` comes first"
        return self._system

    def close(self) -> None:
        """Bring the problem up to date, unless another run goes on in it, and free the factors."""
        ours = self._problem.reduction is self
        if ours:
            self.recover()
        if self._bulk is not None:
            self._bulk.close()
        self._bulk = self._system = None
        if ours:
            self._problem.reduce_by(None)

    def _nodal(self) -> Floats:
        """Accepted displacement of the nodes, true for those in reach, (nodes, 3), length."""
        return self.nodal(self._problem.accepted())

    def _condense(self) -> None:
        """Eliminate what neither is prescribed nor can be touched from the accepted state on."""
        self.recover()
        if self._system is not None:
            self._system.solver.forget()
        u = self._nodal()
        self._reach.select(u, [free.touchable for free in self._problem.stabilisation.loose])
        system = self._eliminate(u)
        # in terms of the new unknowns: forces on what is no longer prescribed become loads
        outside = self._problem.outside
        system.set_load_factor(u.reshape(-1), outside)
        system.forces = system.handed(self._stiffness @ u.reshape(-1) - outside)
        self._state = system.state(u.reshape(-1)[system.bulk.contact])

    def _eliminate(self, u: Floats) -> ContactSystem:
        """The system of the unknowns that are in reach.

        Args:
            u: Displacement of the nodes when they were selected, (nodes, 3), length.
        """
        fixed, gathering = self._fixed()
        touched = np.repeat(self._reach.nodes, 3)
        self._gathering = gathering
        bulk = self._stiffness
        if gathering is not None:
            bulk = (gathering @ bulk @ gathering.T).tocsr()
            touched = abs(gathering) @ touched > 0.0
        self._bulk = Condensation(bulk, self._part_of, touched, fixed, self._reusable(), self._note)
        self._system = system = ContactSystem(
            self._bulk, self._problem, self._reach.nodes, u, gathering
        )
        self._means = {}
        # the order of steps that were taken up again is another one
        held = dict(sorted(self._problem.supports.owners.items()))
        marks = np.zeros((len(self._bulk.prescribed), len(held)))
        for column, unknowns in enumerate(held.values()):
            marks[np.searchsorted(self._bulk.prescribed, unknowns), column] = 1.0
        numbers = system.patterns.add_groups(marks)
        self._held = dict(zip(held, numbers, strict=True))
        return system

    def _reusable(self) -> Condensation | None:
        """The condensation so far where parts of it are good still; constraints change the bulk."""
        changes = bool(self._problem.inclined) or self._problem.constraints.ties is not None
        if not changes or self._bulk is None:
            return self._bulk
        self._bulk.close()
        return None
