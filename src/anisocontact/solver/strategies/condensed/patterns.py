"""Loads and supports seen from the contact unknowns, without work on the bulk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.solver.strategies.condensed.parts import Condensation
from anisocontact.solver.system.ends_work import EndsWork
from anisocontact.solver.terms.persistent import Arrays

#: Share of a load that may be missing from its combination of patterns: rounding.
_ROUNDING = 1e-13


class Span:
    """Orthonormal vectors that span what has been asked for so far.

    Args:
        size: Length of the vectors.

    Attributes:
        vectors: The vectors, (size, k).

    Example:
        >>> span = Span(2)
        >>> span.coefficients(np.array([3.0, 4.0])), span.coefficients(np.array([6.0, 8.0]))
        (array([5.]), array([10.]))
    """

    def __init__(self, size: int) -> None:
        self.vectors: Floats = np.zeros((size, 0))

    def add(self, unit: Floats) -> None:
        """Add a vector, (size,), of length one and orthogonal to the others."""
        self.vectors = np.column_stack([self.vectors, unit])

    def coefficients(self, v: Floats) -> Floats:
        """Coefficients of `v`; a vector is added where the span does not hold it.

        Args:
            v: Vector, (size,).

        Returns:
            One coefficient for each vector, (k,).
        """
        norm = float(np.linalg.norm(v))
        rest, found = v, np.zeros(self.vectors.shape[1])
        for _ in range(2):  # twice is enough for vectors that are orthogonal to rounding
            part = self.vectors.T @ rest
            rest, found = rest - self.vectors @ part, found + part
        left = float(np.linalg.norm(rest))
        if left > _ROUNDING * norm:
            self.add(rest / left)
            found = np.append(found, left)
        return found


@dataclass(frozen=True)
class InteriorState:
    """A state of equilibrium of the interior: `u = E u_c + e a + y b`.

    Attributes:
        u: Displacements of the contact unknowns, (c,), length.
        a: Coefficients of the displacements of supports.
        b: Coefficients of the forces.
        at_supports: Contact forces on the prescribed unknowns, (p,).
    """

    u: Floats
    a: Floats
    b: Floats
    at_supports: Floats

    def same(self, other: InteriorState) -> bool:
        """Whether another state is this one."""
        pairs = ((self.u, other.u), (self.a, other.a), (self.b, other.b))
        return all(np.array_equal(mine, its) for mine, its in pairs)


@dataclass(frozen=True)
class ForcePattern:
    """Forces and what the bulk makes of them.

    Attributes:
        force: The forces f, zero where prescribed, (n, k).
        answer: Displacement of the interior, `y = K_ii^-1 f_i`, (n, k).
        passed_on: Load on the contact unknowns, `f_c - K_ci y`, (c, k).
    """

    force: Floats
    answer: Floats
    passed_on: Floats


@dataclass
class WorkForces:
    """Forces whose work in many states is asked for.

    Attributes:
        response: What the bulk makes of them.
        lifted: Their work on the patterns of displacements, (k, number of those).
        loaded: Their work on the answers to the patterns of forces, (k, number of those).
    """

    response: ForcePattern
    lifted: Floats
    loaded: Floats


class Patterns:
    """Patterns of displacements of the supports and of forces, condensed.

    Every pattern costs one solution with the interior when it is first met. After that its part in
    forces on the contact unknowns, in energies and in reactions is small products. With
    `e = (-K_ii^-1 K_ip d on i, d on p)` for the columns d of the supports and `y = K_ii^-1 f_i` for
    the columns f of forces (zero on p), the state `u = E u_c + e a + y b` (E extends u_c into the
    interior) has

    * the load on the contact unknowns `g = (f_c - K_ci y) b - (K e)_c a`,
    * the energy `2 W = u_c . S u_c + 2 u_c . (K e)_c a + a . (e . K e) a + b . (y . f) b`,
    * the work of forces `f . u = (f_c - K_ci y) . u_c + (e . f) . a + (y . f) b`,
    * the forces of supports along d, `d . (K u)_p = (K e)_c . u_c + (e . K e) a - (e . f) b`.

    Args:
        condensation: The bulk.
    """

    def __init__(self, condensation: Condensation) -> None:
        self._bulk = condensation
        n, c, p = (
            condensation.stiffness.shape[0],
            len(condensation.contact),
            len(condensation.prescribed),
        )
        self._supports, self._loads = Span(p), Span(n)
        self._support_columns: list[int] = []
        self._support_sizes: list[float] = []
        self._groups = 0
        self._load_columns: list[int] = []
        self._lifts, self._forces, self._answers = (np.zeros((n, 0)) for _ in range(3))
        self._lift_force, self._passed_on = np.zeros((c, 0)), np.zeros((c, 0))
        self._lift_stiffness, self._lift_work = np.zeros((0, 0)), np.zeros((0, 0))
        self._load_work = np.zeros((0, 0))

    def supports(self, u: Floats) -> Floats:
        """Coefficients a of displacements of the prescribed unknowns, (p,), length."""
        known = self._supports.vectors.shape[1]
        found = self._supports.coefficients(u)
        if len(found) > known:
            self._meet_supports()
        shares = found / self._support_sizes
        return _scattered(shares, self._support_columns, self._lifts.shape[1])

    def loads(self, force: Floats) -> Floats:
        """Coefficients b of forces on all unknowns, (n,), zero where prescribed."""
        known = self._loads.vectors.shape[1]
        found = self._loads.coefficients(force)
        if len(found) > known:
            self._meet_loads()
        return _scattered(found, self._load_columns, self._forces.shape[1])

    def persistent(self) -> Arrays:
        """What supports and loads have been met so far, in order."""
        met = self._supports.vectors[:, self._groups :]
        return {"supports": met, "loads": self._loads.vectors}

    def restore(self, kept: Arrays) -> None:
        """Meet again what `persistent` gave, one by one, so that rounding is the same."""
        for vector in kept["supports"].T:
            self._supports.add(vector)
            self._meet_supports()
        for vector in kept["loads"].T:
            self._loads.add(vector)
            self._meet_loads()

    def _meet_supports(self) -> None:
        self._support_columns += self.add_displacements(self._supports.vectors[:, -1:])
        self._support_sizes.append(1.0)

    def _meet_loads(self) -> None:
        self._load_columns += self.add_forces(self._loads.vectors[:, -1:])

    def add_groups(self, marks: Floats) -> list[int]:
        """Add displacements by one of groups of prescribed unknowns; their numbers are returned.

        What supports prescribe is mostly combined of these, and then costs nothing when it is met.

        Args:
            marks: One where an unknown belongs to a group, none to two of them, (p, k).
        """
        numbers = self.add_displacements(marks)
        sizes = np.linalg.norm(marks, axis=0)
        for k in np.flatnonzero(sizes):
            self._supports.add(marks[:, k] / sizes[k])
            self._support_columns.append(numbers[k])
            self._support_sizes.append(float(sizes[k]))
        self._groups = self._supports.vectors.shape[1]
        return numbers

    def add_displacements(self, patterns: Floats) -> list[int]:
        """Add displacements of the prescribed unknowns, (p, k); their numbers are returned."""
        old, bulk = self._lifts.shape[1], self._bulk
        lift = np.zeros((len(self._lifts), patterns.shape[1]))
        lift[bulk.prescribed] = patterns
        lift -= bulk.interior(bulk.stiffness @ lift)
        force = bulk.stiffness @ lift
        self._lifts = np.column_stack([self._lifts, lift])
        self._lift_force = np.column_stack([self._lift_force, force[bulk.contact]])
        products = self._lifts[bulk.prescribed].T @ force[bulk.prescribed]
        self._lift_stiffness = np.block(
            [[self._lift_stiffness, products[:old]], [products[:old].T, products[old:]]]
        )
        self._lift_work = self._lifts.T @ self._forces
        return list(range(old, old + patterns.shape[1]))

    def add_forces(self, patterns: Floats) -> list[int]:
        """Add forces, (n, k), zero where prescribed; their numbers are returned."""
        old, new = self._forces.shape[1], self.respond(patterns)
        self._forces = np.column_stack([self._forces, new.force])
        self._answers = np.column_stack([self._answers, new.answer])
        self._passed_on = np.column_stack([self._passed_on, new.passed_on])
        self._lift_work = self._lifts.T @ self._forces
        self._load_work = self._answers.T @ self._forces
        return list(range(old, old + patterns.shape[1]))

    def respond(self, forces: Floats) -> ForcePattern:
        """What the bulk makes of forces, (n, k), zero where prescribed."""
        bulk = self._bulk
        answer = bulk.interior(forces)
        on_contact = forces[bulk.contact] - (bulk.stiffness @ answer)[bulk.contact]
        return ForcePattern(forces, answer, on_contact)

    def probe(self, forces: Floats) -> WorkForces:
        """Forces, (n, k), zero where prescribed, for `work_of`."""
        nothing = np.zeros((forces.shape[1], 0))
        return WorkForces(self.respond(forces), nothing, nothing)

    def work_of(self, probe: WorkForces, state: InteriorState) -> Floats:
        """Work `f . u` of each force of a probe in a state, (k,)."""
        a, b = self._padded(state)
        own = probe.response
        if probe.lifted.shape[1] != len(a):
            probe.lifted = own.force.T @ self._lifts
        if probe.loaded.shape[1] != len(b):
            probe.loaded = own.answer.T @ self._forces
        return np.asarray(own.passed_on.T @ state.u + probe.lifted @ a + probe.loaded @ b)

    def load(self, a: Floats, b: Floats) -> Floats:
        """Load g on the contact unknowns, (c,), force."""
        lift = self._lift_force[:, : len(a)] @ a
        return np.asarray(self._passed_on[:, : len(b)] @ b - lift)

    def works(self, state: InteriorState) -> Floats:
        """Work `f . u` of each pattern of forces in a state, (number of forces,)."""
        a, b = self._padded(state)
        return np.asarray(self._passed_on.T @ state.u + self._lift_work.T @ a + self._load_work @ b)

    def load_work(self, state: InteriorState) -> float:
        """Work `f . u` of the loads of a state, force times length."""
        return float(self._padded(state)[1] @ self.works(state))

    def outside(self, state: InteriorState) -> Floats:
        """Forces from outside along each pattern of displacements: all but those of contact."""
        a, b = self._padded(state)
        bulk = self._lift_force.T @ state.u + self._lift_stiffness @ a - self._lift_work @ b
        return np.asarray(bulk - self._lifts[self._bulk.prescribed].T @ state.at_supports)

    def energy(self, state: InteriorState) -> float:
        """Elastic energy of a state, force times length."""
        a, b = self._padded(state)
        u = state.u
        coupling = u @ self._lift_force @ a
        own = a @ self._lift_stiffness @ a + b @ self._load_work @ b
        return float(0.5 * (u @ self._bulk.schur_times(u) + own) + coupling)

    def work(self, before: InteriorState, after: InteriorState) -> EndsWork:
        """Work from outside between two states, force times length."""
        (a, b), (a_new, b_new) = self._padded(before), self._padded(after)
        loads = EndsWork.between(b, b_new, self.works(after) - self.works(before))
        return loads + EndsWork.between(self.outside(before), self.outside(after), a_new - a)

    def displacement(self, state: InteriorState) -> Floats:
        """Displacement of all unknowns, (n,): the one solution with the interior of a state."""
        a, b = self._padded(state)
        bulk = self._bulk
        u = np.zeros(len(self._lifts))
        u[bulk.contact] = state.u
        u -= bulk.interior((bulk.stiffness @ u)[:, None])[:, 0]
        return np.asarray(u + self._lifts @ a + self._answers @ b)

    def _padded(self, state: InteriorState) -> tuple[Floats, Floats]:
        """Coefficients with zeros for patterns that have come since."""
        padded = np.zeros(self._lifts.shape[1]), np.zeros(self._forces.shape[1])
        for own, out in zip((state.a, state.b), padded, strict=True):
            out[: len(own)] = own
        return padded


def _scattered(values: Floats, at: list[int], size: int) -> Floats:
    out = np.zeros(size)
    out[at] = values
    return out
