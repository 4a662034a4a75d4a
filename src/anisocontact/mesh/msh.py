"""Reader of gmsh files, format 4.1 and 2.2, text or binary.

The gmsh package needs libraries of a desktop (libGLU, libX11) that a bare machine lacks; this
reads what it writes with NumPy alone. Format: https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import MPI
from anisocontact.mesh.split import Route, Split, share_of
from anisocontact.mesh.stream import FLOAT, SIZE, MshError, Stream

# Dimension, physical tags of the entity -> nothing else is known of an element group.
Entity = tuple[int, int]
type Groups = dict[Entity, tuple[int, ...]]

# gmsh element type -> (dimension, number of nodes)
ELEMENTS = {
    15: (0, 1),
    1: (1, 2),
    8: (1, 3),
    2: (2, 3),
    9: (2, 6),
    3: (2, 4),
    16: (2, 8),
    10: (2, 9),
    4: (3, 4),
    11: (3, 10),
    5: (3, 8),
    17: (3, 20),
    12: (3, 27),
    6: (3, 6),
    18: (3, 15),
    13: (3, 18),
    7: (3, 5),
    19: (3, 13),
    14: (3, 14),
}


#: Elements of the old format that are taken apart at a time.
PIECE = 1 << 14


@dataclass
class ElementBlock:
    """Elements of one type with the same physical groups.

    Attributes:
        kind: Type of the elements.
        nodes: Nodes of those that this process has, (n, nodes of an element).
        groups: Physical groups.
        places: Which of the block they are, (n,).
        count: Elements of the block on all processes.
    """

    kind: int
    nodes: Ints
    groups: tuple[int, ...]
    places: Ints
    count: int

    @property
    def dim(self) -> int:
        """Dimension of the elements."""
        return ELEMENTS[self.kind][0]


@dataclass
class MshFile:
    """What a process has of a file: some elements of every block, and a row of nodes.

    Nodes are numbered from 0, those of the first process first.
    """

    points: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    blocks: list[ElementBlock] = field(default_factory=list)
    names: dict[Entity, str] = field(default_factory=dict)


def read_msh(path: Path, comm: Any = MPI.COMM_SELF) -> MshFile:
    """Nodes, elements and physical names of a gmsh file.

    Every process goes through the file and keeps a share of the nodes and elements.

    Args:
        path: The file.
        comm: Processes that share it; the call is collective.

    Raises:
        MshError: It is not a mesh in format 4.1 or 2.2, or it is damaged; on all processes.
        OSError: It cannot be read.
    """
    problem: MshError | OSError | None = None
    try:
        out, tags = _read(Stream(path), comm)
    except (MshError, OSError) as error:
        problem = error
    found = next((p for p in comm.allgather(problem) if p is not None), None)
    if found is not None:
        raise found
    _renumber(out, tags, comm)
    return out


def _read(stream: Stream, comm: Any) -> tuple[MshFile, Ints]:
    """Content with the tags of the file, and the tags of the nodes."""
    if stream.line() != b"$MeshFormat":
        raise MshError("it does not begin with $MeshFormat")
    sections = _format(stream)
    out = MshFile()
    entities: Groups = {}
    tags = np.zeros(0, dtype=np.int64)
    while not stream.ended:
        head = stream.line()
        name = head[1:]
        if not head:
            continue
        if not head.startswith(b"$") or head.startswith(b"$End") or not name.isalnum():
            raise MshError("text between two sections")
        if name == b"PhysicalNames":
            out.names = _physical_names(stream)
        elif name == b"Entities":
            stream.open_section(name)
            entities = _entities(stream)
            stream.close_section(name)
        elif name == b"PartitionedEntities":
            stream.open_section(name)
            entities |= _partitioned_entities(stream)
            stream.close_section(name)
        elif name == b"Nodes":
            stream.open_section(name)
            tags, out.points = sections.nodes(stream, comm)
            stream.close_section(name)
        elif name == b"Elements":
            stream.open_section(name)
            out.blocks = sections.elements(stream, entities, comm)
            stream.close_section(name)
        else:
            stream.skip(name)
    if not np.all(np.isfinite(out.points)):
        raise MshError("a coordinate is not finite")
    return out, tags


@dataclass(frozen=True)
class _Sections:
    """How a version of the format writes nodes and elements."""

    nodes: Callable[[Stream, Any], tuple[Ints, Floats]]
    elements: Callable[[Stream, Groups, Any], list[ElementBlock]]


def _format(stream: Stream) -> _Sections:
    words = stream.line().split()
    if len(words) != 3 or words[0] not in _VERSIONS:
        given = " ".join(w.decode("ascii", "replace")[:8] for w in words[:3]) or "none"
        raise MshError(f"format {given}, known are 4.1 and 2.2 (gmsh -format msh41)")
    stream.binary = words[1] == b"1"
    if stream.binary and stream.ints()[0] != 1:
        raise MshError("it is written in the other byte order")
    stream.skip(b"MeshFormat")
    return _VERSIONS[words[0]]


def _physical_names(stream: Stream) -> dict[Entity, str]:
    names: dict[Entity, str] = {}
    try:
        for _ in range(stream.count()):
            dim, tag, name = stream.line().split(maxsplit=2)
            names[int(dim), int(tag)] = name.decode("utf-8").strip('"')
    except UnicodeDecodeError:
        raise MshError("a name in $PhysicalNames is not in UTF-8: save the file so") from None
    except ValueError:
        raise MshError("section $PhysicalNames is damaged") from None
    stream.skip(b"PhysicalNames")
    return names


def _entities(stream: Stream) -> Groups:
    """Physical tags of each elementary entity (4.1)."""
    groups: Groups = {}
    for dim, count in enumerate(stream.sizes(4)):
        for _ in range(int(count)):
            tag = int(stream.ints()[0])
            groups[dim, tag] = _physical_tags(stream, dim)
    return groups


def _partitioned_entities(stream: Stream) -> Groups:
    """Physical tags of the parts of entities in a mesh that was partitioned (4.1).

    Its elements name these parts, which have tags of their own, in the place of the entities.
    """
    groups: Groups = {}
    _, ghosts = stream.sizes(2)
    stream.ints(2 * int(ghosts))
    for dim, count in enumerate(stream.sizes(4)):
        for _ in range(int(count)):
            tag, _, _ = (int(v) for v in stream.ints(3))
            stream.ints(int(stream.sizes()[0]))
            groups[dim, tag] = _physical_tags(stream, dim)
    return groups


def _physical_tags(stream: Stream, dim: int) -> tuple[int, ...]:
    """Those of an entity, past its box and the entities that bound it.

    A group has the number of one with a minus sign where its elements are the other way round.
    """
    stream.floats(6 if dim else 3)
    tags = tuple(abs(int(g)) for g in stream.ints(int(stream.sizes()[0])))
    if dim:
        stream.ints(int(stream.sizes()[0]))
    return tags


def _nodes_4(stream: Stream, comm: Any) -> tuple[Ints, Floats]:
    blocks, total = (int(v) for v in stream.sizes(4)[:2])
    own = share_of(comm, total)
    tags, points = [np.zeros(0, dtype=np.int64)], [np.zeros((0, 3))]
    before = 0
    for _ in range(blocks):
        dim, _, parametric = stream.ints(3)
        count = int(stream.sizes()[0])
        some = _part(own, before, count, last=comm.rank == comm.size - 1)
        tags.append(stream.rows(count, 1, SIZE, some)[:, 0])
        width = 3 + int(dim) * bool(parametric)
        points.append(stream.rows(count, width, FLOAT, some)[:, :3])
        before += count
    return np.concatenate(tags), np.concatenate(points)


def _part(own: tuple[int, int], before: int, count: int, last: bool) -> tuple[int, int]:
    """What of a block behind others is one's own; the last process takes all that follows."""
    first = min(max(own[0] - before, 0), count)
    return first, count if last else min(max(own[1] - before, first), count)


def _elements_4(stream: Stream, entities: Groups, comm: Any) -> list[ElementBlock]:
    blocks = []
    for _ in range(int(stream.sizes(4)[0])):
        dim, entity, kind = (int(v) for v in stream.ints(3))
        count = int(stream.sizes()[0])
        own = share_of(comm, count)
        rows = stream.rows(count, 1 + _node_count(kind), SIZE, own)
        groups = entities.get((dim, entity), ())
        blocks.append(ElementBlock(kind, rows[:, 1:], groups, np.arange(*own), count))
    return blocks


def _nodes_2(stream: Stream, comm: Any) -> tuple[Ints, Floats]:
    if stream.binary:
        count = stream.count()
        row = np.dtype([("tag", "<i4"), ("x", "<f8", 3)])
        rows = stream.rows(count, 1, row, share_of(comm, count))[:, 0]
        return rows["tag"].astype(np.int64), rows["x"].astype(np.float64)
    count = int(stream.ints()[0])
    table = stream.rows(count, 4, FLOAT, share_of(comm, count))
    return table[:, 0].astype(np.int64), table[:, 1:]


def _elements_2(stream: Stream, entities: Groups, comm: Any) -> list[ElementBlock]:
    """Elements of the old format: an element of several groups is listed once for each."""
    rows: dict[tuple[int, int], _Growing] = {}
    left = stream.count() if stream.binary else int(stream.ints()[0])
    while left > 0:
        if stream.binary:
            kind, count, labels = (int(v) for v in stream.ints(3))
        else:
            (_, kind, labels), count = (int(v) for v in stream.ints(3)), 1
        if count < 1 or labels < 0:
            raise MshError("section $Elements is damaged")
        nodes = _node_count(kind)
        width = bool(stream.binary) + labels + nodes
        for start in range(0, count, PIECE):
            some = min(PIECE, count - start)
            table = stream.ints(some * width).reshape(some, width)
            label = (
                np.abs(table[:, int(stream.binary)]) if labels else np.zeros(some, dtype=np.int64)
            )
            for group in np.unique(label):
                growing = rows.setdefault((kind, int(group)), _Growing(comm))
                growing.add(table[label == group, width - nodes :])
        left -= count
    return [growing.block(kind, group) for (kind, group), growing in rows.items()]


class _Growing:
    """A block of which the number of elements is not known yet: every process takes its turn."""

    def __init__(self, comm: Any) -> None:
        self._rank, self._size = comm.rank, comm.size
        self._count = 0
        self._nodes: list[Ints] = []
        self._places: list[Ints] = []

    def add(self, nodes: Ints) -> None:
        places = np.arange(self._count, self._count + len(nodes))
        own = places % self._size == self._rank
        self._count += len(nodes)
        if own.any() or not self._nodes:
            self._nodes.append(nodes[own])
            self._places.append(places[own])

    def block(self, kind: int, group: int) -> ElementBlock:
        places = np.concatenate(self._places)
        return ElementBlock(kind, np.concatenate(self._nodes), (group,), places, self._count)


_VERSIONS = {
    b"4.1": _Sections(_nodes_4, _elements_4),
    b"2.2": _Sections(_nodes_2, _elements_2),
}


def _node_count(kind: int) -> int:
    if kind not in ELEMENTS:
        raise MshError(
            f"element type {kind} given, those of orders 1 and 2 are read (gmsh -order 2)"
        )
    return ELEMENTS[kind][1]


def _renumber(out: MshFile, tags: Ints, comm: Any) -> None:
    """Put the numbers of the nodes in the place of their tags.

    A node is looked up on the process that its tag names, wherever it lives.
    """
    own = Split(comm, len(tags))
    known = Route(comm, tags % comm.size)
    ranked, numbers = known.there(tags), known.there(own.numbers)
    order = np.argsort(ranked, kind="stable")
    ranked, numbers = ranked[order], numbers[order]
    if comm.allreduce(int(np.sum(ranked[1:] == ranked[:-1]))):
        raise MshError("a node number is used twice")
    for block in out.blocks:
        wanted = block.nodes.reshape(-1)
        route = Route(comm, wanted % comm.size)
        asked = route.there(wanted)
        place = np.searchsorted(ranked, asked)
        place[place == len(ranked)] = 0
        missing = np.any(ranked[place] != asked) if len(ranked) else len(asked) > 0
        if comm.allreduce(bool(missing), MPI.LOR):
            raise MshError("an element has a node that is not in the file")
        found = numbers[place] if len(ranked) else asked
        block.nodes = route.back(found).reshape(block.nodes.shape)
