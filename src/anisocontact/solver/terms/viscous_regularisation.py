"""Viscous regularisation: from where equilibrium is lost to the next one.

At a limit point, such as an edge that digs in and lets go, the path of equilibria ends: no
sub-increment is small enough, and points alternate between stick and slip. The bodies would jump.
Here they move as in a viscous medium, in implicit steps of pseudo-time [Kelley Keyes 1998],

    R(x) + c (x - x_k) = 0 ,

c the viscosity over the step of time. Steps grow where they are easy and shrink where Newton's
method cannot follow. Friction goes from the accepted state to where they are, so that what is
accepted is equilibrium without viscosity.
"""

from __future__ import annotations

from typing import Any, override

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.fenicsx import PETSc
from anisocontact.contact import NotHeldError
from anisocontact.contact.quadrature import Couplings
from anisocontact.mesh import Model
from anisocontact.solver.terms.term import Term

#: Viscosity over the first step, and the largest, shares of the mean diagonal of the bulk.
FIRST, MOST_VISCOUS = 0.03, 1e3
#: What it is multiplied with after a step that was easy, and after one that failed.
LONGER, SHORTER = 0.25, 4.0
#: Corrections up to which a step was easy.
EASY = 8
#: Steps between two that may be longer, or between two searches for rest.
PATIENCE = 3
#: Viscous force over the forces at work below which rest may be near.
SLOW = 0.1
#: Steps after which it is given up.
MOST_STEPS = 200


class ViscousRegularisation(Term):
    """Viscous regularisation of all bodies from the accepted state to an equilibrium.

    Args:
        model: Mesh of the bodies.
        scale: Mean diagonal of the stiffness of the bulk, force/length.

    Attributes:
        stiffness: Viscosity over the step of time, of each node, force/length; 0 at rest.
        steps: Number of steps since the start.
        active: Whether this is one of the attempts that it regularises.
    """

    def __init__(self, model: Model, scale: float) -> None:
        self._comm: Any = model.mesh.comm
        self._owned = model.space.dofmap.index_map.size_local
        self._scale = scale
        self.stop()

    def stop(self) -> None:
        """No viscous forces."""
        self.stiffness = self._last = self._speed = 0.0
        self.steps = self._corrections = self._waits = self._tried = 0
        self.active = False
        self._from: Floats = np.zeros((0, 3))
        self._nodes = np.zeros(0, dtype=PETSc.IntType)

    def start(self, u: Floats, where: Flags | None = None) -> None:
        """Begin to add viscous forces.

        Args:
            u: State to start from, (nodes, 3), length.
            where: Nodes that viscous forces act on, (nodes,); all if left out.
        """
        self.stop()
        self.active = True
        nodes = np.arange(self._owned) if where is None else np.flatnonzero(where)
        self._nodes = nodes.astype(PETSc.IntType)
        self._from = u.copy()
        self.stiffness = self._last = FIRST * self._scale

    @override
    def add_force(self, u: Floats, out: Floats) -> None:
        if self.stiffness:
            out[self._nodes] -= self.stiffness * (u - self._from)[self._nodes]

    @override
    def blocks(self) -> list[Couplings]:
        """What the viscous force changes with the displacement, for one more correction."""
        self._corrections += 1
        if not self.stiffness:
            return []
        nodes = self._nodes[:, None]
        return [(nodes, nodes, np.tile(self.stiffness * np.eye(3), (len(nodes), 1, 1)))]

    def improve(self, u: Floats, at_work: float) -> bool:
        """Take the next step from a balance of forces.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            at_work: Norm of the forces at work.

        Returns:
            Whether there are viscous forces still.

        Raises:
            NotHeldError: They do not come to rest.
        """
        if not self.active:
            return False
        if self.stiffness and self.steps == MOST_STEPS:
            raise NotHeldError(
                f"the bodies do not come to rest in {MOST_STEPS} steps of viscous regularisation"
            )
        speed, before = self._move(u), self._speed
        if not self.stiffness:
            return False
        self.steps += 1
        self._waits -= 1
        self._speed = speed
        easy = self._corrections <= EASY and self._waits <= 0
        self._last = self.stiffness * (LONGER if easy else 1.0)
        calms = speed < before and speed <= SLOW * at_work and self.steps >= self._tried + PATIENCE
        self._tried = self.steps if calms else self._tried
        self.stiffness = 0.0 if calms else self._last
        self._corrections = 0
        return True

    def _move(self, u: Floats) -> float:
        """Go on to a state, (nodes, 3); the norm of the viscous forces there."""
        force = self.stiffness * (u - self._from)[self._nodes]
        self._from = u.copy()
        return float(np.sqrt(self._comm.allreduce(float((force**2).sum()))))

    def soften(self) -> bool:
        """After a step that failed: take a shorter one; whether there is one."""
        if not self.active:
            return False
        if self.stiffness:
            self._last *= SHORTER
            self._waits = PATIENCE
        self.stiffness = self._last
        self._corrections = 0
        return self._last <= MOST_VISCOUS * self._scale
