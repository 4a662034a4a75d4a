"""Radius of the area in which a contact touches, where that is round."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact import Contact
from anisocontact.solver import Problem

#: Ratio of the semi-axes, and of the farthest point to the radius, up to which an area is round.
AXES, FARTHEST = 1.15, 1.17
#: Area over the largest of a point from which on its shape is known.
FEWEST = 16.0
#: Sectors that stand for a body of revolution.
SECTORS = 16
#: Area over the largest of a ring from which on half a ring is at most 6 % of the radius: one ring
#: has the whole edge of contact, which in space passes many points in different places.
RINGS = 4.0
#: Distance over the size of a facet below which nodes are in a plane.
FLAT = 1e-4


class SymmetryImages:
    """What a model stands for by symmetry: maps `x -> M x + c` of its parts.

    A plane of symmetry bounds the slave, and its nodes there are held along the normal.

    Args:
        problem: The problem in its step.
        contact: One of its contacts.
    """

    def __init__(self, problem: Problem, contact: Contact) -> None:
        self.share = 1.0
        #: Area over the largest of an image of a point from which on the radius is known.
        self.fewest = FEWEST
        ideal = problem.model.idealisation
        #: Rotations and mirrors of space, each with a shift.
        self.maps: list[tuple[Floats, Floats]] = [(np.eye(3), np.zeros(3))]
        if ideal.turn.any():
            self.share, self.fewest = 1.0 / SECTORS, SECTORS * RINGS
            self.maps = [ideal.image(k / SECTORS) for k in range(SECTORS)]
        elif ideal.dim == 3:
            self.maps = _mirrors(list(_planes(problem, contact)))

    def of(self, points: Floats) -> Floats:
        """All images of points, one behind the other, (images n, 3)."""
        return np.concatenate([points @ turn.T + shift for turn, shift in self.maps])

    def of_vectors(self, vectors: Floats) -> Floats:
        """All images of vectors, (images n, 3)."""
        return np.concatenate([vectors @ turn.T for turn, _ in self.maps])


def _planes(problem: Problem, contact: Contact) -> Iterator[tuple[Floats, float]]:
    """Normal and distance from the origin of the planes of symmetry at the slave; collective."""
    comm, x = problem.model.mesh.comm, problem.model.positions
    slave = np.unique(contact.quadrature.nodes)
    slave = slave[slave < len(x)]
    found: list[Floats] = []
    for nodes, normal in (*problem.supports.resting(), *problem.inclined.of_planes()):
        at, on = x[slave] @ normal, x[np.intersect1d(slave, nodes)] @ normal
        local = [at.min(initial=np.inf), -at.max(initial=-np.inf)]
        local += [on.min(initial=np.inf), -on.max(initial=-np.inf)]
        low, high, first, last = np.min(comm.allgather(local), axis=0) * (1, -1, 1, -1)
        close = FLAT * contact.facet_size
        known = any(abs(one @ normal) > 0.99 for one in found)
        if last - first > close or known:  # not in one plane, or there are none
            continue
        if min(abs(first - low), abs(high - last)) <= close < high - low:
            found.append(normal)
            yield np.asarray(normal), float(first)


def _mirrors(planes: list[tuple[Floats, float]]) -> list[tuple[Floats, Floats]]:
    """Mirrors in planes that are square to each other, in any number of them at once."""
    found = []
    for count in range(len(planes) + 1):
        for some in combinations(planes, count):
            turn, shift = np.eye(3), np.zeros(3)
            for normal, distance in some:
                turn = turn - 2.0 * np.outer(normal, normal)
                shift = shift + 2.0 * distance * normal
            found.append((turn, shift))
    return found


def round_radius(contact: Contact, images: SymmetryImages) -> float:
    """The radius of the area that touches; no number where it is not round.

    Args:
        contact: The contact in its accepted state.
        images: What it is a part of.

    Returns:
        The radius, length.
    """
    comm, last = contact.space.mesh.comm, contact.last
    own = images.share * contact.touching()
    touching = (own > 0.0) & contact.counted()
    points = images.of(contact.points[touching])
    normals = images.of_vectors(last.normal[touching])
    areas = np.tile(own[touching], len(images.maps))
    normal = np.asarray(comm.allreduce(areas @ normals))
    total = float(np.linalg.norm(normal))
    if total <= 0.5 * comm.allreduce(areas.sum()):  # nothing, or all around a master
        return float("nan")
    normal /= total
    seen = areas * (normals @ normal)
    area = float(comm.allreduce(seen.sum()))
    middle = comm.allreduce(seen @ points) / area
    away = points - middle
    away -= np.outer(away @ normal, normal)
    moments = comm.allreduce((seen[:, None] * away).T @ away)
    minor, major = 2.0 * np.sqrt(np.linalg.eigvalsh(moments)[1:].clip(0.0) / area)
    radius = float(np.sqrt(area / np.pi))
    reach = np.linalg.norm(away, axis=1) + 0.5 * np.sqrt(areas)
    farthest = max(comm.allgather(float(reach.max(initial=0.0))))
    largest = max(comm.allgather(float(areas.max(initial=0.0))))
    resolved = area >= images.fewest * largest
    is_round = resolved and major <= AXES * minor and farthest <= FARTHEST * radius
    return radius if is_round else float("nan")
