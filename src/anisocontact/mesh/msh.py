"""Reader of gmsh files, format 4.1 and 2.2, text or binary.

The gmsh package needs libraries of a desktop (libGLU, libX11) that a bare machine lacks; this
reads what it writes with NumPy alone. Format: https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

Nodes = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
# Dimension, physical tags of the entity -> nothing else is known of an element group.
Entity = tuple[int, int]

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


class MshError(ValueError):
    """The file is not a mesh this reader understands; the text says why."""


@dataclass
class Block:
    """Elements of one type with the same physical groups."""

    kind: int
    nodes: Nodes
    groups: tuple[int, ...]

    @property
    def dim(self) -> int:
        """Dimension of the elements."""
        return ELEMENTS[self.kind][0]


@dataclass
class MshFile:
    """Content of a file: nodes are numbered from 0 in `points`."""

    points: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    blocks: list[Block] = field(default_factory=list)
    names: dict[Entity, str] = field(default_factory=dict)


class _Stream:
    """Numbers of a file in the order they are written, text or binary alike."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0
        self.binary = False
        self._tokens: list[bytes] = []

    def line(self) -> bytes:
        end = self.data.find(b"\n", self.at)
        end = len(self.data) if end < 0 else end
        text = self.data[self.at : end].strip()
        self.at = end + 1
        return text

    def count(self) -> int:
        """A number on a line of its own."""
        try:
            return int(self.line())
        except ValueError:
            raise MshError("text where a number belongs") from None

    def open_section(self, name: bytes) -> None:
        """Make the numbers up to the closing line of a text section available."""
        if not self.binary:
            end = self._closing(name)
            self._tokens = self.data[self.at : end].split()[::-1]
            self.at = end

    def close_section(self, name: bytes) -> None:
        """Go behind the closing line; nothing may be left in between."""
        if self._tokens or not self.data[self.at :].lstrip().startswith(b"$End" + name):
            raise MshError(f"section ${name.decode()} holds more than it announces")
        self.skip(name)

    def skip(self, name: bytes) -> None:
        self.at = self._closing(name)
        self.line()

    def ints(self, n: int = 1) -> Nodes:
        return self._take(n, np.dtype("<i4")).astype(np.int64)

    def sizes(self, n: int = 1) -> Nodes:
        return self._take(n, np.dtype("<i8"))

    def floats(self, n: int = 1) -> Floats:
        return self._take(n, np.dtype("<f8"))

    def records(self, n: int, dtype: np.dtype[np.void]) -> npt.NDArray[np.void]:
        """Binary rows of mixed types."""
        return self._raw(n, dtype)

    def _take(self, n: int, dtype: np.dtype) -> npt.NDArray:  # type: ignore[type-arg]
        if self.binary:
            return self._raw(n, dtype)
        if not 0 <= n <= len(self._tokens):
            raise MshError("the file ends too early")
        taken = self._tokens[len(self._tokens) - n :][::-1]
        del self._tokens[len(self._tokens) - n :]
        kind = np.float64 if dtype.kind == "f" else np.int64
        try:
            return np.array(taken).astype(kind) if n else np.zeros(0, kind)
        except (ValueError, OverflowError):
            raise MshError("text where a number belongs") from None

    def _raw(self, n: int, dtype: np.dtype) -> npt.NDArray:  # type: ignore[type-arg]
        size = int(n) * dtype.itemsize
        if n < 0 or self.at + size > len(self.data):
            raise MshError("the file ends too early")
        out = np.frombuffer(self.data, dtype=dtype, count=int(n), offset=self.at)
        self.at += size
        return out

    def _closing(self, name: bytes) -> int:
        end = self.data.find(b"$End" + name, self.at)
        if end < 0:
            raise MshError(f"section ${name.decode()[:40]} is not closed")
        return end


def read_msh(path: Path) -> MshFile:
    """Nodes, elements and physical names of a gmsh file.

    Args:
        path: The file.

    Returns:
        Its content.

    Raises:
        MshError: It is not a mesh in format 4.1 or 2.2, or it is damaged.
        OSError: It cannot be read.
    """
    stream = _Stream(path.read_bytes())
    if stream.line() != b"$MeshFormat":
        raise MshError("it does not begin with $MeshFormat")
    sections = _format(stream)
    out = MshFile()
    entities: dict[Entity, tuple[int, ...]] = {}
    tags = np.zeros(0, dtype=np.int64)
    while stream.at < len(stream.data):
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
        elif name == b"Nodes":
            stream.open_section(name)
            tags, out.points = sections.nodes(stream)
            stream.close_section(name)
        elif name == b"Elements":
            stream.open_section(name)
            out.blocks = sections.elements(stream, entities)
            stream.close_section(name)
        else:
            stream.skip(name)
    _renumber(out, tags)
    return out


@dataclass(frozen=True)
class _Sections:
    """How a version of the format writes nodes and elements."""

    nodes: Callable[[_Stream], tuple[Nodes, Floats]]
    elements: Callable[[_Stream, dict[Entity, tuple[int, ...]]], list[Block]]


def _format(stream: _Stream) -> _Sections:
    words = stream.line().split()
    if len(words) != 3 or words[0] not in _VERSIONS:
        given = " ".join(w.decode("ascii", "replace")[:8] for w in words[:3]) or "none"
        raise MshError(f"format {given}, known are 4.1 and 2.2 (gmsh -format msh41)")
    stream.binary = words[1] == b"1"
    if stream.binary and stream.ints()[0] != 1:
        raise MshError("it is written in the other byte order")
    stream.skip(b"MeshFormat")
    return _VERSIONS[words[0]]


def _physical_names(stream: _Stream) -> dict[Entity, str]:
    names: dict[Entity, str] = {}
    try:
        for _ in range(stream.count()):
            dim, tag, name = stream.line().split(maxsplit=2)
            names[int(dim), int(tag)] = name.decode("utf-8").strip('"')
    except ValueError:
        raise MshError("section $PhysicalNames is damaged") from None
    stream.skip(b"PhysicalNames")
    return names


def _entities(stream: _Stream) -> dict[Entity, tuple[int, ...]]:
    """Physical tags of each elementary entity (4.1)."""
    groups: dict[Entity, tuple[int, ...]] = {}
    for dim, count in enumerate(stream.sizes(4)):
        for _ in range(int(count)):
            tag = int(stream.ints()[0])
            stream.floats(6 if dim else 3)
            groups[dim, tag] = tuple(int(g) for g in stream.ints(int(stream.sizes()[0])))
            if dim:
                stream.ints(int(stream.sizes()[0]))
    return groups


def _nodes_4(stream: _Stream) -> tuple[Nodes, Floats]:
    blocks = int(stream.sizes(4)[0])
    tags, points = [np.zeros(0, dtype=np.int64)], [np.zeros((0, 3))]
    for _ in range(blocks):
        dim, _, parametric = stream.ints(3)
        count = int(stream.sizes()[0])
        tags.append(stream.sizes(count))
        width = 3 + int(dim) * bool(parametric)
        points.append(stream.floats(count * width).reshape(count, width)[:, :3])
    return np.concatenate(tags), np.concatenate(points)


def _elements_4(stream: _Stream, entities: dict[Entity, tuple[int, ...]]) -> list[Block]:
    blocks = []
    for _ in range(int(stream.sizes(4)[0])):
        dim, entity, kind = (int(v) for v in stream.ints(3))
        count = int(stream.sizes()[0])
        width = 1 + _node_count(kind)
        rows = stream.sizes(count * width).reshape(count, width)
        blocks.append(Block(kind, rows[:, 1:], entities.get((dim, entity), ())))
    return blocks


def _nodes_2(stream: _Stream) -> tuple[Nodes, Floats]:
    if stream.binary:
        count = stream.count()
        rows = stream.records(count, np.dtype([("tag", "<i4"), ("x", "<f8", 3)]))
        return rows["tag"].astype(np.int64), rows["x"].astype(np.float64)
    count = int(stream.ints()[0])
    table = stream.floats(4 * count).reshape(count, 4)
    return table[:, 0].astype(np.int64), table[:, 1:]


def _elements_2(stream: _Stream, entities: dict[Entity, tuple[int, ...]]) -> list[Block]:
    """Elements of the old format: an element of several groups is listed once for each."""
    rows: dict[tuple[int, int], list[Nodes]] = {}
    left = stream.count() if stream.binary else int(stream.ints()[0])
    while left > 0:
        if stream.binary:
            kind, count, labels = (int(v) for v in stream.ints(3))
        else:
            (_, kind, labels), count = (int(v) for v in stream.ints(3)), 1
        if count < 1 or labels < 0:
            raise MshError("section $Elements is damaged")
        width = bool(stream.binary) + labels + _node_count(kind)
        table = stream.ints(count * width).reshape(count, width)
        label = table[:, int(stream.binary)] if labels else np.zeros(count, dtype=np.int64)
        for group in np.unique(label):
            nodes = table[label == group, width - _node_count(kind) :]
            rows.setdefault((kind, int(group)), []).append(nodes)
        left -= count
    return [Block(kind, np.concatenate(n), (group,)) for (kind, group), n in rows.items()]


_VERSIONS = {
    b"4.1": _Sections(_nodes_4, _elements_4),
    b"2.2": _Sections(_nodes_2, _elements_2),
}


def _node_count(kind: int) -> int:
    if kind not in ELEMENTS:
        raise MshError(f"element type {kind} is not known")
    return ELEMENTS[kind][1]


def _renumber(out: MshFile, tags: Nodes) -> None:
    if not np.all(np.isfinite(out.points)):
        raise MshError("a coordinate is not finite")
    order = np.argsort(tags, kind="stable")
    ranked = tags[order]
    if np.any(ranked[1:] == ranked[:-1]):
        raise MshError("a node number is used twice")
    for block in out.blocks:
        place = np.searchsorted(ranked, block.nodes)
        place[place == len(ranked)] = 0
        if not len(ranked) or np.any(ranked[place] != block.nodes):
            raise MshError("an element has a node that is not in the file")
        block.nodes = order[place]
