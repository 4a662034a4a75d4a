"""Contacts of a sector as those of the whole: what lies beyond its cut faces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.contact import Contact
from anisocontact.contact.beyond_cuts import Seam
from anisocontact.solver.terms.cyclic import CutFaces
from anisocontact.solver.terms.sectors import Sectors

#: Angle between the normals of two sides of a cut, radian, from which on pressures there are wrong
#: as soon as points slip.
TILTED = 1e-3
#: What is said of it.
HALVED = (
    "slave nodes on the two cut faces of {} are one node of the whole, but each has the facets of "
    "its own side alone, whose normals are {:.2g} degrees apart: once they slip pressures there "
    "are wrong, and may be several times too large. Give both bodies a sector with the same turn, "
    "cut faces whose meshes match, and the run one process; or take integration points, or the "
    "whole instead of a sector"
)


def go_on_beyond_cuts(contacts: Sequence[Contact], sectors: Sectors) -> None:
    """Let contacts meet what goes on beyond the cut faces of sectors, before the first step.

    On several processes, and where a surface meets itself, they end at the cut faces.
    """
    for contact in contacts:
        if contact.of_two_groups and contact.unknowns.comm.size == 1:
            seams = _seams(contact, sectors)
            if seams:
                contact.go_on_beyond(seams)


def _seams(contact: Contact, sectors: Sectors) -> list[Seam]:
    """Cut faces of both bodies of a contact, cut by one turn, if it has nodes there."""
    of_bodies = [sectors.cuts_of(group.partition(".")[0]) for group in contact.groups]
    if not all(of_bodies):
        return []
    found = [cut.seam for cuts in of_bodies for cut in cuts]
    turns = [found[0].turning, found[0].turning.times(-1)]
    alike = all(any(one.turning.same_as(turn) for turn in turns) for one in found)
    nodes = np.concatenate([one.leading for one in found])
    reached = any(np.isin(nodes, some).any() for some in contact.nodes_of_groups)
    return found if alike and reached else []


def halved_nodes(contacts: Sequence[Contact], sectors: Sectors) -> Iterator[str]:
    """A line for each contact with slave nodes that are not those of the whole; collective.

    Those that follow others are no slave points of a contact that goes on beyond the cuts.
    """
    for contact in contacts:
        if contact.meshed and contact.slave_points.at_nodes:
            for cut in sectors.cuts_of(contact.slave.partition(".")[0]):
                tilt = _tilt(contact, cut, sectors.sides_of(cut))
                if tilt > TILTED:
                    said = HALVED.format(cut.name, np.degrees(tilt))
                    yield f"contact {contact.name!r}: {said}"


def _tilt(contact: Contact, cut: CutFaces, sides: tuple[Ints, Ints]) -> float:
    """Largest angle between the normals of slave nodes on both sides of a cut, radian."""
    points, comm = contact.slave_points, contact.unknowns.comm
    sets: list[tuple[Floats, Floats]] = []
    for side in sides:
        there = np.isin(points.nodes[:, 0], side)
        own = points.quadrature.reference[there], points.outward[there]
        place, normal = (np.concatenate(both) for both in zip(*comm.allgather(own), strict=True))
        sets.append((place, normal))
    (place, normal), (first, turned) = sets
    if not (len(place) and len(first)):
        return 0.0
    apart = np.linalg.norm(cut.turning.of(first)[:, None] - place[None], axis=2)
    met = turned @ cut.turning.matrix.T
    cosine = np.einsum("ni,ni->n", met, normal[apart.argmin(axis=1)])
    return float(np.arccos(np.clip(cosine, -1.0, 1.0)).max())
