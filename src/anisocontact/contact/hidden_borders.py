"""Borders of a master that lie inside facets of a slave whose points look for it.

The points of a slave facet stand for all of it. Where the master ends inside the facet they meet
all of their share or none of it, whatever of the facet it covers: the area that is met is another
one than that on which the bodies lie on each other. Slave nodes integrate over the overlaps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.contact.contact import Contact
from anisocontact.contact.facet_master import FacetMaster
from anisocontact.contact.facet_mesh import FacetMesh, FacetRule, facet_rule, isoparametric
from anisocontact.contact.sides import Sides, located

#: Degree of the quadrature that finds how much of a facet is covered: 8 points along each side,
#: which leave a sixteenth of the facet open.
FINE = 15
#: Gap up to which a facet touches, over its size.
CLOSE = 0.1
#: Share of the area that is met or missed wrongly which is worth a word: two blocks, one wider than
#: the other, carry 5 % less where 27 % of it is missed, 40 % less where it is 44 %.
WRONG = 0.25
#: The same of what is wrong as soft layers see it: their forces are off by that share.
WRONG_OF_SOFT = 0.1
#: What a line says of such a contact.
BORDERS = "the master ends inside facets of the slave"


@dataclass(frozen=True)
class Overlap:
    """Areas on which facets of a slave that touch lie on a master, on all processes, length^2.

    Attributes:
        met: That of the points.
        covered: What is covered.
        cut: What is covered of facets in which the master ends.
    """

    met: float
    covered: float
    cut: float


def hidden_borders(contacts: Sequence[Contact]) -> list[str]:
    """Contacts at points whose slave facets the master ends in, so that areas are wrong.

    Too small an area leaves forces to few points, into which the bodies sink. A wrong one is as
    many times stiffer or softer as a layer, which matters as far as that is softer than the bodies.
    Collective.

    Args:
        contacts: The contacts, in their accepted state.

    Returns:
        A line for each of them.
    """
    found = []
    for one in contacts:
        if not (one.of_two_groups and isinstance(one.master, FacetMaster)):
            continue
        overlap = overlapped(one.master.sides, one.master.positions)
        if not overlap.covered:
            continue
        share = overlap.met / overlap.covered
        if 1.0 - share > WRONG or abs(share - 1.0) * _softness(one) > WRONG_OF_SOFT:
            found.append(
                f"contact of {' with '.join(one.groups)}: {BORDERS} "
                f"({overlap.cut / overlap.covered:.0%} of the area on which they touch), "
                f"whose points meet {share:.0%} of that area, and the force is wrong; swap slave "
                'and master, take slave nodes (pass = "mortar", Contact(..., mortar=True)), or '
                "finer facets of the slave there"
            )
    return found


def _softness(contact: Contact) -> float:
    """Share of the softest layer in the compliance of the contact."""
    bodies = contact.body_stiffness
    layers = [k for k in contact.given_stiffnesses().values() if k > 0.0]
    return bodies / (bodies + min(layers)) if layers and bodies > 0.0 else 0.0


def overlapped(sides: Sides, now: Floats) -> Overlap:
    """How much of a slave its points meet, and how much the master covers; collective.

    Args:
        sides: Both sides; the surface is where the nodes are.
        now: Positions of the nodes, (nodes, 3), length.
    """
    slave = sides.slave
    every = np.arange(len(slave.nodes))
    areas, on, close, away = _look(sides, now, sides.rule, every)
    met, covered = (areas * on).sum(axis=1), (areas * on).sum(axis=1)
    across = np.sqrt(areas.sum(axis=1) / slave.share)
    corners = _corners_on(sides, now, every)
    cut = np.flatnonzero(~(on.all(axis=1) & corners) & (away.min(axis=1) <= 2.0 * across))
    touches = close.any(axis=1)
    share = None if slave.sweep is None else slave.share
    fine = facet_rule(slave.topology, FINE, share)
    areas, on, close, _ = _look(sides, now, fine, cut)
    covered[cut] = (areas * on).sum(axis=1)
    touches[cut] |= close.any(axis=1)
    of_cut = np.zeros(len(every), dtype=bool)
    of_cut[cut] = (on.any(axis=1)) & ~on.all(axis=1)
    local = [(each * touches).sum() for each in (met, covered, covered * of_cut)]
    return Overlap(*map(float, sides.comm.allreduce(np.array(local))))


def _look(
    sides: Sides, now: Floats, rule: FacetRule, which: Ints
) -> tuple[Floats, Flags, Flags, Floats]:
    """The master from points of slave facets, (m, q) each.

    Returns:
        Area of each point, whether the master is opposite to it, whether that is close as well,
        and the distance of the closest point of the master.
    """
    one = sides.slave
    facets = FacetMesh(one.topology, one.nodes[which], one.flip[which], one.sweep)
    there = isoparametric(facets, rule, now)
    each = there.weights.shape
    excluded = None
    if sides.near is not None:
        excluded = sides.near.unseen.take(np.repeat(which, each[1]))
    hit = sides.surface.project(there.reference, None, sides.reach, excluded)
    away = np.linalg.norm(there.reference - hit.position, axis=1)
    on = located(hit)
    close = on & (hit.gap <= CLOSE * sides.points.size)
    return there.weights, on.reshape(each), close.reshape(each), _known(away).reshape(each)


def _known(away: Floats) -> Floats:
    """Distances, infinite where nothing was found within reach."""
    return np.where(np.isnan(away), np.inf, away)


def _corners_on(sides: Sides, now: Floats, which: Ints) -> Flags:
    """Whether the master is opposite to all nodes of slave facets, (m,)."""
    nodes, place = np.unique(sides.slave.nodes[which], return_inverse=True)
    hit = sides.surface.project(now[nodes], None, sides.reach)
    on = located(hit)[place].reshape(sides.slave.nodes[which].shape)
    return np.asarray(on.all(axis=1))
