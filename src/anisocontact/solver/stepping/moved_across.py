"""Rigid bodies that move across a plane of symmetry where a body touches them.

A translation is its own mirror image along the plane, a turn about the normal of the plane. Where a
rigid body is on the plane and moves otherwise, the half that is left out has a second one there,
which moves the other way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.contact import Contact
from anisocontact.rigid import RigidBody
from anisocontact.solver.system.problem import Problem

#: Way across a plane of symmetry over the whole way, and over the size of a facet, worth a word.
SHARE, OF_FACET = 0.01, 1e-3
#: Distance from the plane, over the size of a facet, that slave points on it may have beyond the
#: least.
NEAR = 1e-3


@dataclass(frozen=True)
class MovedAcross:
    """How far a rigid body has moved across a plane of symmetry where a slave on it touches.

    Attributes:
        body: Its name.
        plane: Facet group of the plane.
        way: How far, length.
    """

    body: str
    plane: str
    way: float

    def __str__(self) -> str:
        """What is wrong with it, and what to do."""
        return (
            f"rigid body {self.body!r} has moved by {self.way:.3g} across the symmetry plane "
            f"{self.plane!r} where the slave touches it there: the half that is left out has its "
            "mirror image, which moves the other way; take the whole, unless two such bodies are "
            "meant, or let it move along the plane and turn about its normal only"
        )


class AcrossWatch:
    """Says which rigid bodies move across planes of symmetry on which they touch.

    Args:
        problem: The problem.
    """

    def __init__(self, problem: Problem) -> None:
        self._comm = problem.comm
        planes = list(zip(problem.inclined.groups, problem.inclined.of_planes(), strict=True))
        self._watched = []
        for contact in problem.contacts:
            body = contact.body
            if body is None:
                continue
            for group, (nodes, normal) in planes:
                on = np.intersect1d(np.unique(contact.quadrature.nodes), nodes)
                rows = self._rows(contact, contact.model.positions[on], normal)
                self._watched.append((contact, body, group, normal, rows))

    def moved(self) -> dict[str, list[MovedAcross]]:
        """In the accepted state, by contact; none where nothing does; collective."""
        found: dict[str, list[MovedAcross]] = {}
        for contact, body, group, normal, rows in self._watched:
            touch = contact.points[rows[contact.last.pressure[rows] > 0.0]]
            way = self._way(body, touch, normal)
            if way > OF_FACET * contact.facet_size:
                found.setdefault(contact.name, []).append(MovedAcross(body.name, group, way))
        return found

    def _way(self, body: RigidBody, touch: Floats, normal: Floats) -> float:
        """Largest way across of points of a body that are now at places; 0 if it is a small share.

        Args:
            body: The body.
            touch: The places, (n, 3), length.
            normal: Of the plane, (3,).
        """
        way = touch - body.to_body(touch, accepted=True)
        across = float(np.abs(way @ normal).max(initial=0.0))
        size = float(np.linalg.norm(way, axis=1).max(initial=0.0))
        across, size = np.max(self._comm.allgather([across, size]), axis=0)
        return float(across) if across > SHARE * size else 0.0

    def _rows(self, contact: Contact, places: Floats, normal: Floats) -> Ints:
        """Slave points of this rank that are nearest to a plane; none if the slave ends elsewhere.

        Args:
            contact: The contact.
            places: Nodes of its slave on the plane, (n, 3), length.
            normal: Of the plane, (3,).
        """
        levels = [h for own in self._comm.allgather((places @ normal).tolist()) for h in own]
        if not levels:
            return np.zeros(0, dtype=np.int64)
        away = np.abs(contact.slave_points.quadrature.reference @ normal - levels[0])
        least = min(self._comm.allgather(float(away.min(initial=np.inf))))
        return np.flatnonzero(away < least + NEAR * contact.facet_size)
