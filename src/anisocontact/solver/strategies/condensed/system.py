"""Equilibrium of the contact unknowns alone, with the bulk condensed."""

from __future__ import annotations

from typing import Any, override

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.fenicsx import MPI, Mat, PETSc, Vec
from anisocontact.solver.strategies.condensed.dense import ContactTangent
from anisocontact.solver.strategies.condensed.kept_factor import KeptFactor
from anisocontact.solver.strategies.condensed.parts import Condensation
from anisocontact.solver.strategies.condensed.patterns import InteriorState, Patterns
from anisocontact.solver.strategies.forcing import Forcing
from anisocontact.solver.strategies.newton import TOLERANCE
from anisocontact.solver.system.assembled import AssembledSystem
from anisocontact.solver.system.culprit import Culprit
from anisocontact.solver.system.force_balance import ForceBalance, Magnitudes, Reached, closed
from anisocontact.solver.system.prescribed_reached import prescribed_reached
from anisocontact.solver.system.problem import Problem

#: Random patterns of signs that measure the norm of the forces at the supports.
_SAMPLES = 8


class ContactSystem(AssembledSystem):
    """Residual `S u_c - g - contact forces` and its tangent; a `System` for Newton.

    Args:
        bulk: The condensed bulk.
        problem: The problem: its contacts, what bodies are attached to, rigid bodies.
        in_reach: Nodes whose unknowns are contact unknowns or prescribed, (nodes,).
        nodal: Displacement of the nodes to start from, (nodes, 3), length.
        gathering: Hands forces of constrained unknowns to those they follow, see `Constraints`;
            the bulk is that of unknowns v with u = gathering^T v.

    Attributes:
        patterns: Loads and supports, condensed.
        places: Numbers of the unknowns of Newton's method: contact unknowns, then those of free
            rigid bodies that nothing prescribes.
        prescribed: Which unknowns of free rigid bodies are prescribed.
        raw_forces: Forces of contacts and of what bodies are attached to, on all nodes, (n,).
        forces: The same with those of constrained unknowns handed on.
        way: States that bodies that jump or fall have gone through since the last
            `set_load_factor`.
        balance: Forces of the last evaluation, of the unknowns of Newton's method.
        forcing: How precise corrections are.
        outgrown: Whether a slave point of the last evaluation met a facet out of reach.
        solver: Solves for Newton corrections.
    """

    def __init__(
        self,
        bulk: Condensation,
        problem: Problem,
        in_reach: Flags,
        nodal: Floats,
        gathering: scipy.sparse.csr_array | None = None,
    ) -> None:
        self.bulk, self._in_reach = bulk, in_reach
        self._assembly = problem.assembly
        self.contact_term, self._rigid = problem.contact_term, problem.rigid
        self._sides, self._stabilisation = problem.sides, problem.stabilisation
        self._aid = problem.stabilisation
        self._gathering = gathering
        self._extent = problem.layout.unknowns.extent
        self._nodal_now, self._v = nodal, nodal.reshape(-1).copy()
        self.prescribed = self._rigid.prescribed()
        loose = np.flatnonzero(~self.prescribed)
        self.places = np.concatenate([bulk.contact, nodal.size + loose])
        self._values = np.zeros(self._rigid.size)
        self.patterns = Patterns(bulk)
        signs = np.random.default_rng(1).choice([-1.0, 1.0], (len(bulk.prescribed), _SAMPLES))
        self._samples = self.patterns.add_displacements(signs.astype(np.float64))
        self._tangent = self._new_tangent()
        self._stiff = np.concatenate(
            [np.zeros(0), *(np.diagonal(block) for _, block in bulk.blocks)]
        )
        self.solver = KeptFactor(self._tangent)
        self._balance = ForceBalance.none(len(self.places))
        self.outgrown = False
        self.way: list[InteriorState] = []
        self.forcing = Forcing(TOLERANCE)
        self._load_norm = 0.0
        self._a, self._b, self._g = np.zeros(0), np.zeros(0), np.zeros(len(bulk.contact))
        self._evaluated: Floats | None = None
        self.raw_forces = self.forces = np.zeros(nodal.size)

    def _new_tangent(self) -> ContactTangent:
        total = len(self._v) + self._rigid.size
        number = np.full(total, -1, dtype=np.int64)
        number[self.places] = np.arange(len(self.places))
        spread = None
        if self._gathering is not None:
            whole = (self._gathering, scipy.sparse.eye_array(self._rigid.size))
            spread = scipy.sparse.block_diag(whole, format="csr")[self.places].T.tocsr()
        return ContactTangent(self.bulk.blocks, number, len(self.places), spread)

    def set_load_factor(self, supports: Floats, load: Floats) -> None:
        """Take the displacements that are prescribed and the loads at a load factor, (n,)."""
        load = self.handed(load)
        free = load.copy()
        free[self.bulk.prescribed] = 0.0
        supports = supports[self.bulk.prescribed]
        self._a = self.patterns.supports(supports)
        self._b = self.patterns.loads(free)
        self._g = self.patterns.load(self._a, self._b)
        self._load_norm = float(np.hypot(np.linalg.norm(load), np.linalg.norm(self._rigid.loads())))
        self.forcing.begin()
        self._v[self.bulk.prescribed] = supports
        self._values = self._rigid.values()
        self._evaluated, self.way = None, []

    def handed(self, forces: Floats) -> Floats:
        """Forces with those of constrained unknowns handed on, (n,) or (n, k)."""
        return forces if self._gathering is None else np.asarray(self._gathering @ forces)

    def all_unknowns(self, own: Floats) -> Floats:
        """Unknowns of the problem, true for nodes in reach, from those of Newton's method."""
        count = len(self.bulk.contact)
        self._v[self.bulk.contact] = own[:count]
        self._values[self.places[count:] - len(self._v)] = own[count:]
        u = self._v if self._gathering is None else self._gathering.T @ self._v
        return np.concatenate([u, self._values])

    def state(self, u: Floats) -> InteriorState:
        """State with the contact unknowns `u` and the forces of the last evaluation."""
        u = u[: len(self.bulk.contact)]
        return InteriorState(u.copy(), self._a, self._b, self.forces[self.bulk.prescribed])

    @property
    def comm(self) -> Any:
        """Communicator: one process."""
        return PETSc.COMM_SELF

    def new_vector(self) -> Vec:
        """Vector of the contact unknowns, zero."""
        vector = PETSc.Vec().createSeq(len(self.places), comm=PETSc.COMM_SELF)
        vector.zeroEntries()
        return vector

    def new_tangent(self) -> Mat:
        """Matrix of which only products can be made."""
        n = len(self.places)
        matrix = PETSc.Mat().createPython((n, n), self, comm=PETSc.COMM_SELF)
        matrix.setUp()
        return matrix

    def evaluate(self, x: Vec) -> Floats:
        """Residual; NaN where a law has no answer or a slave point has left the reach."""
        u = np.array(x.array_r)
        if self._evaluated is not None and np.array_equal(self._evaluated, u):
            return self.balance.residual.copy()
        self._evaluated = u
        self._respond(u)
        own = u[: len(self.bulk.contact)]
        aids = self._assembly.aids.force(self._nodal_now)
        forces = self.forces + self.handed(aids.reshape(-1))
        residual = self.bulk.schur_times(own) - self._g - forces[self.bulk.contact]
        of_bodies = self._rigid.residual(self._values, 1.0)[~self.prescribed]
        self._balance = closed(
            np.concatenate([residual, of_bodies]),
            self._magnitudes(own),
            MPI.COMM_SELF,
            failed=self._assembly.reactions.failed or self.outgrown,
            correction=self._multiplier_residual() if self.contact_term.simultaneous else None,
            reached=self._reached(),
        )
        return self.balance.residual.copy()

    def _reached(self) -> Reached:
        """How far bodies went; what is prescribed is no unknown here, and is reached."""
        none, extent = np.zeros(0), self._extent
        return prescribed_reached(none, none, MPI.COMM_SELF, extent, self._nodal_now, self._values)

    def _respond(self, u: Floats) -> None:
        """Forces on the nodes at the unknowns `u`."""
        nodal = self._nodal_now = self.all_unknowns(u)[: len(self._v)].reshape(-1, 3)
        self._rigid.place(self._values)
        forces = self._assembly.reactions.force(nodal)
        needed = [np.flatnonzero(forces.any(axis=1)), self.contact_term.feet()]
        self.outgrown = not self._in_reach[np.concatenate(needed)].all()
        self.raw_forces = forces.reshape(-1)
        self.forces = self.handed(self.raw_forces)

    def _multiplier_residual(self) -> Floats:
        """`Contacts.multiplier_residual` of the unknowns of Newton's method, force."""
        forces = self.contact_term.multiplier_residual(self._nodal_now).reshape(-1)
        of_bodies = self._rigid.multiplier_residual(forces)[~self.prescribed]
        return np.append(self.handed(forces)[self.bulk.contact], of_bodies)

    def tangent(self, x: Vec, out: Mat) -> bool:
        """Take the tangent at x; `out` multiplies with it, and has no pattern that could grow."""
        self.evaluate(x)
        couplings = self._rigid.body_couplings(len(self._v) // 3)
        couplings += [*self._assembly.acting.blocks(), *self._assembly.acting.couplings()]
        term = self.contact_term
        self._tangent.take(couplings, term.opposite(), term.beside())
        out.assemble()
        return False

    @property
    @override
    def nodal(self) -> Floats:
        return self._nodal_now

    @override
    def evaluate_at(self, x: Vec) -> None:
        self.evaluate(x)

    @override
    def improve(self, x: Vec) -> bool:
        changed = super().improve(x)
        if changed:
            self._evaluated = None
        return changed

    @override
    def behind_a_master(self, x: Vec) -> Culprit | None:
        return self._sides.objection(self._nodal_now, whole=False)

    @override
    def _go_on(self, x: Vec) -> None:
        self.way.append(self.state(x.array_r))
        self.contact_term.pass_through()

    @override
    def soften(self) -> bool:
        self._evaluated = None
        regularised = self._stabilisation.regularisation.active
        return not (regularised and self.outgrown) and super().soften()

    def mult(self, _: Mat, x: Vec, y: Vec) -> None:
        """Product with the tangent, for PETSc."""
        y.array[:] = self._tangent.times(x.array_r)

    def apply(self, pc: Any, b: Vec, x: Vec) -> None:
        """Newton correction, for PETSc: a preconditioner that is the solution."""
        size = float(np.linalg.norm(b.array_r))
        rtol = self.forcing.rtol(self, size)
        found = self.solver.solve(b.array_r, min(rtol, 0.1))
        if found is None:
            pc.setFailedReason(PETSc.PC.FailedReason.FACTOR_NUMERIC_ZEROPIVOT)
            found = np.zeros(len(self.places))
        x.array[:] = found

    def _magnitudes(self, u: Floats) -> Magnitudes:
        """Norms of the forces at work; of the supports from samples."""
        outside = self.patterns.outside(self.state(u))[self._samples]
        supports = float(np.sqrt(np.mean(outside**2)))
        springs = float(np.linalg.norm(self._rigid.spring_forces()))
        forces = float(np.linalg.norm(self.forces))
        stiff = max(float(np.linalg.norm(self._stiff * u)), self._assembly.bodies.largest)
        lever = self._assembly.acting.lever()
        return Magnitudes(self._load_norm, [forces, supports, springs], stiff, lever)
