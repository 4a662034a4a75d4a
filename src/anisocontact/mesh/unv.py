"""Universal files of I-deas (UNV), as Salome, Gmsh and many test rigs write them.

Nodes, solid and surface elements and permanent groups are read; groups of elements are bodies or
facet groups, groups of nodes as everywhere. Numbers are taken as they are: units (dataset 164) and
coordinate systems are not looked at.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.mesh.torn import without_body
from anisocontact.mesh.whole import WholeMesh

#: Element -> cell, and where the nodes in the order of VTK stand: universal files go round a face
#: from corner to middle node.
SOLIDS: dict[int, tuple[str, list[int]]] = {
    111: ("tetrahedron", [*range(4)]),
    118: ("tetrahedron", [0, 2, 4, 9, 1, 3, 5, 6, 7, 8]),
    112: ("prism", [*range(6)]),
    113: ("prism", [0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8]),
    115: ("hexahedron", [*range(8)]),
    116: (
        "hexahedron",
        [*range(0, 8, 2), *range(12, 20, 2), *range(1, 8, 2), *range(13, 20, 2), *range(8, 12)],
    ),
}
#: Surface element -> places of its corners.
SURFACES = {
    kind + more: corners
    for kind, corners in ((1, [0, 1, 2]), (2, [0, 2, 4]), (4, [0, 1, 2, 3]), (5, [0, 2, 4, 6]))
    for more in (40, 50, 60, 80, 90)  # plane stress, plane strain, plate, axisymmetric, shell
}
#: Elements of three lines: rods and beams.
_BEAMS = {11, 21, 22, 23, 24}
#: Datasets of groups -> integers of an entry; its kind and its number come first.
_GROUPS = {**dict.fromkeys((2435, 2452, 2467, 2477), 4), **dict.fromkeys((2429, 2430, 2432), 2)}
#: Kinds of entries of groups.
_NODE, _ELEMENT = 7, 8


class _Content:
    """What a file has, by its own numbers."""

    def __init__(self) -> None:
        self.nodes: dict[int, list[float]] = {}
        self.elements: dict[int, tuple[int, list[int]]] = {}
        self.groups: dict[str, list[tuple[int, int]]] = {}

    def read_nodes(self, lines: list[str]) -> None:
        """Take datasets 781 and 2411: number and systems, then the place."""
        for head, place in zip(lines[::2], lines[1::2], strict=True):
            numbers = [float(v.replace("D", "E").replace("d", "e")) for v in place.split()]
            self.nodes[int(head.split()[0])] = numbers

    def read_elements(self, lines: list[str]) -> None:
        """Take datasets 780 and 2412: number, kind, ..., nodes; then the nodes."""
        rest = iter(lines)
        for line in rest:
            head = [int(v) for v in line.split()]
            number, kind, count = head[0], head[1], head[-1]
            if kind in _BEAMS:
                next(rest)
            nodes: list[int] = []
            while len(nodes) < count:
                nodes += [int(v) for v in next(rest).split()]
            self.elements[number] = kind, nodes

    def read_groups(self, lines: list[str], width: int) -> None:
        """Take groups: number, ..., entries; a name; then the entries."""
        rest = iter(lines)
        for line in rest:
            count, name = int(line.split()[-1]), next(rest).strip()
            entries: list[int] = []
            while len(entries) < width * count:
                entries += [int(v) for v in next(rest).split()]
            pairs = zip(entries[::width], entries[1::width], strict=True)
            self.groups.setdefault(name, []).extend(pairs)


def read_unv(path: Path) -> WholeMesh:
    """Solid elements and groups of a universal file.

    Returns:
        The mesh. Bodies are the groups of solid elements, or all of these as `body` where there is
        none; facet groups are those of surface elements, and of nodes that hold all corners of
        facets at the boundary.

    Raises:
        InputError: It is no such file, or has no solid element.
        OSError: It cannot be read.
    """
    content = _Content()
    readers: dict[int, Callable[[list[str]], None]] = {
        781: content.read_nodes,
        2411: content.read_nodes,
        780: content.read_elements,
        2412: content.read_elements,
    }
    found = False
    for number, first, lines in _datasets(path):
        found = True
        try:
            if number in readers:
                readers[number](lines)
            elif number in _GROUPS:
                content.read_groups(lines, _GROUPS[number])
        except (ValueError, IndexError, StopIteration, RuntimeError):
            text = f"dataset {number} at line {first}: its data cannot be read"
            raise InputError(text) from None
    if not found:
        raise InputError("no dataset of a universal file is in it")
    return _whole_mesh(content)


def _datasets(path: Path) -> Iterator[tuple[int, int, list[str]]]:
    """Number, line and content of each dataset, which stands between lines of -1."""
    inside: list[str] | None = None
    first = 0
    for count, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
        if line.strip() == "-1":
            if inside:
                number = inside[0].split()[0]
                yield int(number) if number.isdigit() else 0, first, inside[1:]
            inside, first = ([], count + 1) if inside is None else (None, 0)
        elif inside is not None:
            inside.append(line)


def _whole_mesh(content: _Content) -> WholeMesh:
    numbers = np.array(sorted(content.nodes), dtype=np.int64)
    mesh = WholeMesh(np.array([content.nodes[n] for n in numbers.tolist()]).reshape(-1, 3))
    rows = {n: k for k, n in enumerate(numbers.tolist())}
    places = {number: _rows(number, nodes, rows) for number, (_, nodes) in content.elements.items()}
    bodies = _bodies(content)
    for kind, (cell, order) in SOLIDS.items():
        own = [n for n, (k, _) in content.elements.items() if k == kind]
        if own:
            nodes = np.array([[places[n][i] for i in order] for n in own], dtype=np.int64)
            mesh.add_cells(cell, nodes, [bodies.get(n, "") for n in own])
    if not mesh.cells:
        kinds = sorted({kind for kind, _ in content.elements.values()})
        text = f"no solid element ({', '.join(map(str, SOLIDS))}); there are: "
        raise InputError(text + (", ".join(map(str, kinds)) or "none at all"))
    for name, members in content.groups.items():
        found: dict[int, list[list[int]]] = {}
        for what, number in members:
            kind = content.elements.get(number, (0, []))[0]
            if what == _ELEMENT and kind in SURFACES:
                corners = [places[number][i] for i in SURFACES[kind]]
                found.setdefault(len(corners), []).append(corners)
        if found:
            mesh.surfaces[_plain(name)] = [np.array(one, dtype=np.int64) for one in found.values()]
        nodes = np.array([rows[n] for w, n in members if w == _NODE and n in rows], dtype=np.int64)
        if len(nodes):
            mesh.node_sets[_plain(name)] = np.unique(nodes)
    mesh.notes = tuple(without_body(mesh.bodies))
    return mesh


def _rows(element: int, nodes: list[int], rows: dict[int, int]) -> list[int]:
    missing = [n for n in nodes if n not in rows]
    if missing:
        raise InputError(f"element {element} has node {missing[0]}, which is not there")
    return [rows[n] for n in nodes]


def _bodies(content: _Content) -> dict[int, str]:
    """Body of each solid element: of the last group that has it."""
    solids = {n for n, (kind, _) in content.elements.items() if kind in SOLIDS}
    found: dict[int, str] = {}
    for name, members in content.groups.items():
        found |= {n: _plain(name) for w, n in members if w == _ELEMENT and n in solids}
    return found or dict.fromkeys(solids, "body")


def _plain(name: str) -> str:
    """A name without the dot, which parts a body from its group."""
    return name.replace(".", "_")
