"""Rigid motions of bodies that no support keeps from happening."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.base.arrays import connected
from anisocontact.base.fenicsx import fem
from anisocontact.base.shown import shown
from anisocontact.contact import Contact
from anisocontact.mesh import Idealisation, Model
from anisocontact.mesh.connected_components import component_of_nodes
from anisocontact.mesh.idealisation import SOLID

#: Share of the largest eigenvalue below which a motion meets no support.
FREE = 1e-9
#: Cosine above which a direction counts as along an axis.
ALONG = 1.0 - 1e-6

#: Nodes this rank owns and the direction along which they are held, (3,) or (nodes, 3).
type Supported = tuple[Ints, Floats]


def along_axes(unknowns: Ints) -> list[Supported]:
    """Nodes of unknowns along each axis, and the axis."""
    nodes, axes = np.divmod(unknowns, 3)
    return [(nodes[axes == i], np.eye(3)[i]) for i in range(3)]


@dataclass(frozen=True)
class SupportedFrame:
    """Nodes that move as a rigid body, some components of whose motion are held.

    Attributes:
        nodes: Nodes this rank owns.
        point: Reference point of the body, (3,), length.
        supported: Components that are held, three translations and three turns, (6,).
        axes: Axes of these, rows, (3, 3).
    """

    nodes: Ints
    point: Floats
    supported: Flags
    axes: Floats = field(default_factory=lambda: np.eye(3))

    def rows(self, body: ConnectedBody, comm: Any) -> Floats:
        """What is held of the motion of a body, one row of (t, w) each, (k, 6); collective."""
        if not comm.allreduce(len(np.intersect1d(self.nodes, body.nodes))):
            return np.zeros((0, 6))
        arm = (self.point - body.centre) / body.size
        shift = np.hstack([self.axes, np.cross(arm, self.axes)])
        turn = np.hstack([np.zeros((3, 3)), self.axes])
        return np.asarray(np.vstack([shift, turn])[self.supported])


@dataclass(frozen=True, eq=False)
class ConnectedBody:
    """Nodes that move together where nothing is strained: a body, or bodies that share nodes.

    Attributes:
        parts: Names of the bodies.
        nodes: Nodes this rank owns, (n,).
        arms: Their places relative to the centre over the size of the body, (n, 3).
        count: Number of nodes over all ranks.
        local: All its nodes on this rank, those of other ranks too, (m,).
        fields: The six rigid motions of unit size at these, three translations and three rotations
            (times the size of the body), (6, m, 3).
        size: Root mean square distance of its nodes from the centre, length.
        resisted: Rows over the six motions that are zero where nothing is strained, (r, 6).
        centre: Mean of its nodes, (3,), length.
        whole: Whether it is all of its bodies, not a piece that shares no node with the rest.
    """

    parts: tuple[str, ...]
    nodes: Ints
    arms: Floats
    count: int
    local: Ints
    fields: Floats
    size: float
    resisted: Floats = field(default_factory=lambda: np.zeros((0, 6)))
    centre: Floats = field(default_factory=lambda: np.zeros(3))
    whole: bool = True

    @property
    def name(self) -> str:
        """Names of the bodies in one, and where it is if it is a piece of them."""
        return " + ".join(self.parts) + (
            "" if self.whole else f", the piece around {shown(self.centre, 3)}"
        )

    def has(self, nodes: Ints | Locals, comm: Any) -> bool:
        """Whether one of local nodes is a node of it on any rank; collective."""
        return bool(comm.allreduce(len(np.intersect1d(nodes, self.local))))


def sides_of(
    bodies: Sequence[ConnectedBody], contacts: Sequence[Contact]
) -> list[list[tuple[bool, ...]]]:
    """Whether bodies have nodes of the slave of contacts, and of their masters; collective.

    Args:
        bodies: Bodies that share no nodes.
        contacts: Contacts of their mesh.

    Returns:
        For each body and contact the slave first.
    """
    if not contacts:
        return [[] for _ in bodies]
    sides = [nodes for contact in contacts for nodes in contact.nodes_of_groups]
    dofs = contacts[0].space.dofmap.index_map
    owner = np.full(dofs.size_local + dofs.num_ghosts, len(bodies))
    for number, body in enumerate(bodies):
        owner[body.local] = number
    counts = [np.bincount(owner[nodes], minlength=len(bodies) + 1)[:-1] for nodes in sides]
    there = contacts[0].space.mesh.comm.allreduce(np.array(counts)) > 0
    ends = np.cumsum([len(contact.nodes_of_groups) for contact in contacts])[:-1]
    return [[tuple(own.tolist()) for own in np.split(body, ends)] for body in there.T]


def bodies(model: Model, links: Iterable[Sequence[str]] = ()) -> list[ConnectedBody]:
    """All bodies of a model, their pieces each; what shares nodes is one. Collective.

    Args:
        model: The model.
        links: Facet groups whose nodes move together beside these, a few names each.
    """
    space, comm, ideal = model.space, model.mesh.comm, model.idealisation
    label = component_of_nodes(space)

    def pieces(nodes: Ints | Locals) -> Ints:
        return np.unique(np.concatenate(comm.allgather(np.unique(label[nodes]))))

    of_bodies = {
        name: pieces(fem.locate_dofs_topological(space, ideal.dim, model.cells(name)))
        for name in model.body_names()
    }
    together = [np.concatenate([pieces(model.nodes(group)) for group in link]) for link in links]
    pairs = [np.column_stack([one, np.full_like(one, one[0])]) for one in together]
    count = 1 + max(int(own.max()) for own in of_bodies.values())
    number = connected(count, np.concatenate([np.zeros((0, 2), dtype=np.int64), *pairs]))
    found = []
    for one in range(number.max() + 1):
        names = [name for name, own in of_bodies.items() if np.any(number[own] == one)]
        whole = all(np.all(number[of_bodies[name]] == one) for name in names)
        body = connected_body(space, names, [np.flatnonzero(number[label] == one)], ideal)
        found.append(replace(body, whole=whole))
    return found


def joined(
    model: Model, contacts: Sequence[Contact], coupled: Iterable[Sequence[str]] = ()
) -> list[ConnectedBody]:
    """Bodies that only supports and springs can hold, those in contact with each other as one.

    Contact between bodies resists what one does to the other, not what they do as one rigid body;
    contact with itself resists nothing. Bodies in contact with a surface that is given are left
    out.

    Args:
        model: Mesh of the bodies.
        contacts: The contacts.
        coupled: Facet groups that move together.
    """
    given = [contact for contact in contacts if len(contact.groups) == 1]
    links = [contact.groups for contact in contacts if len(contact.groups) > 1]
    found = bodies(model, [*coupled, *links])
    sides = sides_of(found, given)
    return [body for body, of in zip(found, sides, strict=True) if not any(map(any, of))]


def connected_body(
    space: Any, parts: Sequence[str], local: Sequence[Ints], ideal: Idealisation = SOLID
) -> ConnectedBody:
    """Nodes as a body; collective.

    Args:
        space: Vector space of the displacement.
        parts: Names of the bodies that it is.
        local: Local nodes of each, with ghosts.
        ideal: What the mesh is taken for.
    """
    comm = space.mesh.comm
    here = np.unique(np.concatenate(local))
    nodes = here[here < space.dofmap.index_map.size_local]
    places = np.asarray(space.tabulate_dof_coordinates())
    x = places[nodes]
    count = comm.allreduce(len(nodes))
    centre = comm.allreduce(x.sum(axis=0)) / count
    arms = x - centre
    size = np.sqrt(comm.allreduce(float((arms**2).sum())) / count)
    fields = _fields((places[here] - centre) / size)
    resisted = ideal.resisted(centre / size)
    shape = float(size), resisted, np.asarray(centre)
    return ConnectedBody(tuple(parts), nodes, arms / size, count, here, fields, *shape)


def _fields(arms: Floats) -> Floats:
    """Rigid motions at arms, (6, n, 3)."""
    shift = np.repeat(np.eye(3)[:, None], len(arms), axis=1)
    return np.concatenate([shift, np.cross(shift, arms)])


def free_modes(
    body: ConnectedBody,
    supported: Iterable[Supported],
    comm: Any,
    frames: Iterable[SupportedFrame] = (),
) -> Floats:
    """Rigid motions of a body that meet no support.

    A support of node i along a holds `a . (t + w x r_i)`; the motions that do no work on any of
    them are the kernel of the sum of the squares.

    Args:
        body: The body.
        supported: What is held; nodes of other bodies do not count.
        comm: Communicator of the mesh.
        frames: What is held of nodes that move as rigid bodies.

    Returns:
        Translation t and rotation w (times the size of the body) of each, (k, 6).
    """
    sums = body.count * body.resisted.T @ body.resisted
    for nodes, direction in supported:
        _, own, at = np.intersect1d(nodes, body.nodes, return_indices=True)
        along = np.broadcast_to(direction, (len(nodes), 3))[own]
        rows = np.hstack([along, np.cross(body.arms[at], along)])
        sums += rows.T @ rows
    for frame in frames:
        rows = frame.rows(body, comm)
        sums += rows.T @ rows
    values, vectors = np.linalg.eigh(comm.allreduce(sums))
    return np.asarray(vectors.T[values <= FREE * max(values[-1], np.finfo(float).tiny)])


def named(modes: Floats) -> str:
    """Rigid motions in words.

    Example:
        >>> named(np.eye(6)[[0, 5]])
        'translation along x, rotation about z'
    """
    rotation = modes[:, 3:]
    u, sizes, about = np.linalg.svd(rotation, full_matrices=True)
    rank = int((sizes > np.sqrt(FREE)).sum())
    moves = u[:, rank:].T @ modes[:, :3]
    parts = []
    if len(moves):
        parts.append(f"translation {_directions('along', moves)}")
    if rank:
        parts.append(f"rotation {_directions('about', about[:rank])}")
    return ", ".join(parts)


def _directions(word: str, vectors: Floats) -> str:
    """Axes in the span of vectors, or the vectors where these are not all of it."""
    basis = np.linalg.svd(vectors, full_matrices=False)[2]
    axes = [axis for axis, e in zip("xyz", np.eye(3), strict=True) if _within(e, basis)]
    if len(axes) == len(basis):
        *rest, last = axes
        return f"{word} {', '.join(rest)}{' and ' if rest else ''}{last}"
    return f"{word} {' and '.join(shown(vector, 3) for vector in basis)}"


def _within(e: Floats, basis: Floats) -> bool:
    return bool(np.linalg.norm(basis @ e) > ALONG)
