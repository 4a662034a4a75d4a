"""Contacts as they are before the first step: overlaps, sides, singular directions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.arrays import by_place
from anisocontact.base.errors import InputError
from anisocontact.base.shown import shown
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.contact.master import Master
from anisocontact.interface import FAILURE, ContactLaw, Interface, Response, State
from anisocontact.laws import Adhesion, CarriedDirections, Friction, NormalLaw

#: Cosine of the angle of the normals of slave and master above which they point the same way.
SAME_WAY = 0.5
#: Depth over the facet size above which surfaces count as overlapping: more than the rounding of
#: CAD kernels and mesh files.
OVERLAP = 1e-5
#: Distance over the facet size within which a point can be in contact at once.
NEAR = 1.0


@dataclass(frozen=True, eq=False)
class Overlap:
    """Slave points below the surface of the master.

    Attributes:
        depth: Largest depth, length.
        point: Where it is, (3,), length.
        count: Number of such points over all ranks.

    Example:
        See `initial_overlap`, which finds it.

        >>> Overlap(0.1, np.array([0.5, 0.5, 0.0]), 9).depth
        0.1
    """

    depth: float
    point: Floats
    count: int


class PlacedSlave(Protocol):
    """Slave points where they are, with the space of the bodies: a contact or a pass of it."""

    space: Any

    @property
    def state(self) -> State:
        """Committed history, one record for each point."""

    @property
    def points(self) -> Floats:
        """The points, (n, 3), length."""


class Beginning(PlacedSlave, Protocol):
    """Slave points that meet a master for the first time."""

    slave: str
    slave_points: IntegrationPoints
    master: Master

    @property
    def interface(self) -> Interface | ContactLaw:
        """The laws."""

    @property
    def last(self) -> Response:
        """What the laws answer where the points are."""


def initial_overlap(contact: PlacedSlave, size: float) -> Overlap | None:
    """Overlap of the accepted state.

    Args:
        contact: The contact.
        size: Facet size, length.

    Returns:
        The overlap, None if there is none worth a word.

    Example:
        >>> from anisocontact import Adhesion, Contact, ContactLaw, Friction, NormalLaw
        >>> from anisocontact import make_surface
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        >>> plane = make_surface("plane", point=(0, 0, 0.1), normal=(0, 0, 1))
        >>> friction = Friction(coefficients=(0.3, 0.3))
        >>> law = ContactLaw(NormalLaw(penalty=1e3), Adhesion(stiffness=(100, 100)), friction)
        >>> contact = Contact(model, "bar.bottom", plane, law)
        >>> round(initial_overlap(contact, 0.5).depth, 12)
        0.1
    """
    depth = -contact.state["gap"]
    deepest = int(np.argmax(depth)) if len(depth) else -1
    local = (
        float(depth[deepest]) if len(depth) else -np.inf,
        contact.points[deepest].tolist() if len(depth) else [],
        int((depth > OVERLAP * size).sum()),
    )
    everywhere = contact.space.mesh.comm.allgather(local)
    worst = max(everywhere)
    count = sum(one[2] for one in everywhere)
    return Overlap(worst[0], np.array(worst[1]), count) if count else None


def check_start(contact: Beginning, size: float) -> None:
    """Check slave and master before the first step; done when a contact is made.

    Args:
        contact: The contact, before the first step.
        size: Facet size, length.

    Raises:
        InputError: Points without a finite distance to the master, slave and master that face the
            same way, or a direction field without a direction at a point that can be in contact at
            once.
    """
    _check_distances(contact)
    _check_sides(contact, size)
    for one in _fields(contact.interface):
        gaps = np.abs(contact.state["gap"])
        near = contact.master.located(contact.state) & (gaps <= NEAR * size)
        bad = _singular(contact, one, size)
        if contact.space.mesh.comm.allreduce(int((~bad).sum())) > 0:
            bad &= near
        _refuse(
            contact,
            bad,
            "no direction at {count} slave points that can be in contact, the first at {point}: "
            "the field is singular there, out of its table or parallel to its normal",
            one.place,
            contact.last.normal,
        )


def _check_distances(contact: Beginning) -> None:
    gaps = contact.state["gap"][contact.master.located(contact.state)]
    if not all(contact.space.mesh.comm.allgather(bool(np.isfinite(gaps).all()))):
        text = "slave points have no finite distance to it: is it far too large or too small?"
        raise InputError(text, "master")


def _check_sides(contact: Beginning, size: float) -> None:
    """The nearest points of two bodies that do not overlap have normals that face each other.

    Slave nodes overlap with what faces them alone, so that the master is looked at; a group that
    is its own master has itself beside each point.
    """
    if contact.slave in contact.master.groups:
        return
    seen = contact.master.look(contact.points)
    gaps = np.abs(seen.gap)
    located = seen.on & (gaps <= contact.master.reach)
    comm = contact.space.mesh.comm
    least = min(comm.allgather(float(gaps[located].min(initial=np.inf))))
    _check_not_behind(contact, located & (seen.gap < -OVERLAP * size), located, seen.normal)
    nearest = located & (gaps <= least + OVERLAP * size)
    outward = contact.slave_points.outward
    cosine = np.einsum("nd,nd->n", outward, seen.normal)
    wrong = nearest & (cosine > SAME_WAY)
    if 2 * comm.allreduce(int(wrong.sum())) <= comm.allreduce(int(nearest.sum())):
        return
    _refuse(
        contact,
        wrong,
        f"{contact.slave!r} faces the same way as its master: at {{point}} the normals of slave "
        f"and master are {{outward}} and {{normal}}; {_other_side(contact)}",
        "master",
        seen.normal,
    )


def _other_side(contact: Beginning) -> str:
    """What helps where slave and master face the same way."""
    if not contact.master.groups:
        return (
            "turn the surface over (a bore: inside = true, a plane: its normal the other way), or "
            "name the facets on the other side"
        )
    if _of_one_body(contact):
        return (
            "name the facets on the other side, or both as one group with self_contact = true "
            "where the body folds onto itself"
        )
    return "name the facets on the other side"


def _of_one_body(contact: Beginning) -> bool:
    """Whether slave and master are facets of one body."""
    body = contact.slave.partition(".")[0]
    groups = contact.master.groups
    return bool(groups) and all(group.partition(".")[0] == body for group in groups)


def _check_not_behind(contact: Beginning, behind: Flags, located: Flags, normal: Floats) -> None:
    """A body that is drawn does not overlap itself: what is behind all of a slave is its back.

    Pieces of it that share no node may overlap, as a ring and the shaft that it is pressed on.
    """
    body = contact.slave.partition(".")[0]
    comm = contact.space.mesh.comm
    if not _of_one_body(contact) or comm.allreduce(int((located & ~behind).sum())):
        return
    if not contact.master.connected_to_slave():
        return
    _refuse(
        contact,
        behind,
        f"{contact.slave!r} has it behind itself, across body {body!r}, at {{point}}, where the "
        "normals of slave and master are {outward} and {normal}; name facets that face each other",
        "master",
        normal,
    )


def _fields(law: Interface | ContactLaw) -> list[CarriedDirections]:
    return [one for one in law.carried if one.field is not None]


def _singular(contact: Beginning, one: CarriedDirections, size: float) -> Flags:
    """Points at which a field has no direction: asked by pressing every point a little."""
    law = (
        NormalLaw(penalty=1.0),
        Adhesion(stiffness=(1.0, 1.0)),
        Friction(coefficients=(1.0, 1.0), directions=one.field, directions_on=one.on),
    )
    state = contact.state.copy()
    state["offset"] += state["gap"] + size
    return np.asarray(contact.master.probe(law, state) == _DIRECTION)


_DIRECTION = next(code for code, text in enumerate(FAILURE) if "direction field" in text)


def _refuse(contact: Beginning, bad: Flags, text: str, field: str, normal: Floats) -> None:
    vectors = np.hstack([contact.points, contact.slave_points.outward, normal])[bad]
    first = vectors[by_place(vectors[:, :3])[:1]]
    comm = contact.space.mesh.comm
    everywhere = np.concatenate(comm.allgather(first))
    count = comm.allreduce(len(vectors))
    if len(everywhere):
        first = everywhere[by_place(everywhere[:, :3])[0]]
        place, *normals = first.reshape(3, 3)
        outward, met = map(shown, normals)
        point = shown(place, size=contact.slave_points.size)
        message = text.format(count=count, point=point, outward=outward, normal=met)
        raise InputError(message, field)
