"""Faces of bodies at small strain that have turned about an axis by no little share of friction.

Linear bodies take forces where their nodes were, the pressure with the direction that it has now.
Where a shaft has turned in its hub by the angle w, the normal of the hub leans against the radius
to where a node was by w, and the pressure N holds the shaft back like a friction of the coefficient
w more: at half a degree as one of 0.009, which friction of 0.3 does not feel and one of 0.03 does.
A hub that has turned on its shaft is driven on by as much.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.bulk import small_strain
from anisocontact.contact import Contact
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.system.rotations import CURE

#: Share of the tangential traction from which on what pressure holds is worth a warning.
WORTH_A_WARNING = 0.1
#: Friction that stands for the tangential traction where there is less of it.
SLIGHT = 0.02
#: Axes whose moment of inertia is less than this share of the largest have no turn to be told.
FLAT = 1e-9


@dataclass(frozen=True)
class TurnedFace:
    """A face of a body at small strain whose pressure has an arm that is not there.

    Attributes:
        body: Name of the body.
        angle: By which the face has turned, radian.
        friction: Coefficient of friction that the pressure seems to have.
        share: The same over what tangential tractions are of the pressure.
        driven: Whether it drives the body on, as of one around the other, or holds it back.
    """

    body: str
    angle: float
    friction: float
    share: float
    driven: bool

    def __str__(self) -> str:
        """How far, how wrong that is, and what to do."""
        there = f", {self.share:.0%} of what is there" if np.isfinite(self.share) else ""
        does = "drives it on" if self.driven else "holds it back"
        return (
            f"body {self.body!r}, at small strain, has turned there by "
            f"{np.degrees(self.angle):.2g} degrees on average: as forces act where its nodes were, "
            f"the pressure {does} like friction of {self.friction:.2g}{there}; {CURE}"
        )


class TurnedFaceWatch:
    """Says of which faces at small strain the pressure has an arm.

    Args:
        problem: The problem.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem, model = problem, problem.model
        small = {name for name, law in problem.materials.items() if small_strain(law)}
        self._watched = [
            (contact, body, nodes)
            for contact in problem.contacts
            for body, nodes in zip(
                map(model.body_of, contact.groups), contact.nodes_of_groups, strict=True
            )
            if body in small and len({*map(model.body_of, contact.groups)}) == len(contact.groups)
        ]

    def faces(self) -> dict[str, list[TurnedFace]]:
        """Of the accepted increment, by contact; none where nothing has turned; collective."""
        found: dict[str, list[TurnedFace]] = {}
        if not self._watched:
            return found
        problem = self._problem
        # nothing is evaluated: a run that goes on from here has to find it as it is
        whole = problem.reduction.whole
        u = problem.nodal if whole else problem.reduction.nodal(problem.accepted())
        for contact, body, nodes in self._watched:
            forces = np.zeros_like(u)
            contact.add_force(forces)
            moved = _Moved(problem.model.positions[nodes], u[nodes], forces[nodes])
            face = _face(contact, body, moved)
            if face is not None:
                found.setdefault(contact.name, []).append(face)
        return found


@dataclass(frozen=True)
class _Moved:
    """Nodes that contact acts on.

    Attributes:
        places: Where they were, (n, 3), length.
        u: Their displacement, (n, 3), length.
        forces: On them, (n, 3), force.
    """

    places: Floats
    u: Floats
    forces: Floats


def _face(contact: Contact, body: str, moved: _Moved) -> TurnedFace | None:
    """What pressure does beside tangential tractions, None if next to nothing; collective."""
    turn, centre = _turn(contact, moved)
    angle = float(np.linalg.norm(turn))
    if angle == 0.0:
        return None
    axis, now = turn / angle, contact.accepted
    arms = np.linalg.norm(np.cross(axis, now.points - centre), axis=1) * now.areas
    # what forces have about the axis where nodes are, less what they have where nodes were
    lever = -np.cross(axis, np.cross(axis, moved.places - centre))
    sums = np.array(
        [
            angle * np.sum(lever * moved.forces),
            arms @ now.response.pressure,
            arms @ np.linalg.norm(now.response.traction_t, axis=1),
        ]
    )
    held, pressed, rubbed = contact.model.mesh.comm.allreduce(sums)
    if abs(held) <= WORTH_A_WARNING * max(rubbed, SLIGHT * pressed):
        return None
    share = abs(held) / rubbed if rubbed > 0.0 else np.inf
    return TurnedFace(body, angle, float(abs(held) / pressed), float(share), bool(held > 0.0))


def _turn(contact: Contact, moved: _Moved) -> tuple[Floats, Floats]:
    """Turn of the nodes and a point of its axis, by the size of forces; collective.

    They are taken to turn and to widen around one axis, so that of the sector of a ring that a
    shaft widens it is that of the ring.

    Returns:
        Axis times angle, (3,), radian, and the point, (3,), length; zeros without forces.
    """
    comm, ideal = contact.model.mesh.comm, contact.model.idealisation
    around = bool(ideal.turn.any())
    weights = np.linalg.norm(moved.forces, axis=1)
    both = np.hstack([moved.places, moved.u])
    total, *means = comm.allreduce(np.concatenate([[weights.sum()], weights @ both]))
    if total == 0.0:
        return np.zeros(3), np.zeros(3)
    kept = np.array([0.0, 1.0, 0.0] if around else [1.0, 1.0, 1.0])  # a ring moves along its axis
    mean, shift = (np.reshape(means, (2, 3)) / total) * kept
    arms, way = moved.places - mean, moved.u - shift
    square = comm.allreduce(np.einsum("n,ni,nj->ij", weights, arms, arms))
    mixed = comm.allreduce(np.einsum("n,ni,nj->ij", weights, arms, way))
    inertia, skew = np.trace(square) * np.eye(3) - square, mixed - mixed.T
    free = [1] if around else [2] if ideal.dim == 2 else [0, 1, 2]
    turn = np.zeros(3)
    inverse = np.linalg.pinv(inertia[np.ix_(free, free)], rcond=FLAT, hermitian=True)
    turn[free] = inverse @ np.array([skew[1, 2], skew[2, 0], skew[0, 1]])[free]
    size = float(turn @ turn)
    if size == 0.0:
        return turn, mean
    across = np.eye(3) - np.outer(turn, turn) / size
    wider = np.sum(across * mixed) / (np.sum(across * square) or 1.0)
    return turn, mean - (wider * (across @ shift) - np.cross(turn, shift)) / (size + wider**2)
