"""Abaqus and CalculiX input as a mesh: sections are bodies, surfaces and node sets facet groups.

Solid elements alone are taken; parts are put where their instances are. Loads, materials and steps
are not read: they stand in the case file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.mesh.deck import Card, read_cards
from anisocontact.mesh.deck_supports import support_lines
from anisocontact.mesh.placement import Rotation
from anisocontact.mesh.tetrahedra import EDGES, FACES
from anisocontact.mesh.whole import WholeMesh

Nodes = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]

#: Element -> cell, number of nodes; letters behind it say how it is integrated.
SOLIDS = {
    "C3D4": ("tetrahedron", 4),
    "C3D10": ("tetrahedron", 10),
    "C3D8": ("hexahedron", 8),
    "C3D20": ("hexahedron", 20),
    "C3D6": ("prism", 6),
    "C3D15": ("prism", 15),
    "C3D5": ("pyramid", 5),
    "C3D13": ("pyramid", 13),
}
#: What elements of a mesh in the plane z = 0 are: beginning of their names -> idealisation.
IDEAL = {"CPE": "plane-strain", "CPS": "plane-stress", "CAX": "axisymmetric"}
#: Cells of these by the number of their nodes.
_IN_PLANE = {3: "triangle", 6: "triangle", 4: "quadrilateral", 8: "quadrilateral"}
PLANE = {f"{kind}{n}": (cell, n) for kind in IDEAL for n, cell in _IN_PLANE.items()}
_KNOWN = SOLIDS | PLANE
#: Faces of cells by their corners; of those in the plane their edges.
SIDES = FACES | {cell: tuple(EDGES[cell]) for cell in ("triangle", "quadrilateral")}
#: Keywords that make nodes or elements in a way that is not read.
GENERATED = ("NGEN", "NFILL", "NCOPY", "ELGEN", "ELCOPY", "NMAP")


def solid(element: str) -> str:
    """The solid that an element is, without the letters of its integration; empty if it is none.

    Those of a mesh in the plane are solids too, with and without twist.

    Example:
        >>> solid("C3D20R"), solid("c3d8i"), solid("CGAX4R"), solid("S8R")
        ('C3D20', 'C3D8', 'CAX4', '')
    """
    name = element.upper().replace("CGAX", "CAX")
    kind = name.rstrip("".join(set("RIHTMSEP")))
    return kind if kind in _KNOWN else ""


def read_inp(path: Path) -> WholeMesh:
    """Solid elements, their sections and the named faces of an input file.

    Args:
        path: The file.

    Returns:
        The mesh. Bodies are the element sets of `*SOLID SECTION` (of a part with one section its
        instances), or all elements as one where there is none; facet groups are the surfaces, and
        node sets that hold all corners of faces at the boundary.

    Raises:
        InputError: There is no solid element, an element names a node that is not there, or a
            keyword generates nodes or elements.
        OSError: It cannot be read.
    """
    return _whole_mesh(_read(path))


def deck_supports(path: Path, groups: Iterable[str]) -> list[str]:
    """Supports of an input file as a step of a case file has them, a line for each.

    Args:
        path: The file.
        groups: Groups "body.set" of its mesh.

    Raises:
        InputError: As of `read_inp`.
        OSError: It cannot be read.
    """
    deck, known = _read(path), list(groups)

    def named(entry: str) -> list[str]:
        name = _plain(entry)
        return [one for one in known if one.partition(".")[2] == name or one == entry.lower()]

    return list(support_lines(deck.supports, deck.nodes_of, named))


def _read(path: Path) -> _Deck:
    """What is in an input file, parts where their instances are."""
    whole = current = _Deck()
    step = 0
    parts: dict[str, _Deck] = {}
    for card in read_cards(path):
        try:
            if card.name in GENERATED:
                raise InputError("is not read; write nodes and elements out")
            if card.name == "PART":
                current = parts.setdefault(card.option("NAME").upper(), _Deck())
            elif card.name == "ENDPART":
                current = whole
            elif card.name == "INSTANCE":
                whole.add_instance(card, parts)
            elif card.name in _READERS:
                _READERS[card.name](current, card)
            elif card.name in ("TRANSFORM", "BOUNDARY"):
                whole.supports.append((step, card))
            step += card.name == "STEP"
        except InputError as error:
            raise InputError(f"line {card.line}: *{card.name}: {error}") from None
        except (ValueError, IndexError):
            raise InputError(f"line {card.line}: *{card.name}: its data cannot be read") from None
    return whole


@dataclass
class _Deck:
    """Nodes, elements and sets under their own numbers; names of sets are in capitals.

    Attributes:
        nodes: Number -> place.
        elements: Number -> solid, nodes.
        node_sets: Name -> numbers.
        element_sets: Name -> numbers.
        surfaces: Name -> (element or set, face; empty for all free ones).
        sections: Body -> set of elements.
        left_out: Elements that are no solids -> how many.
        offsets: Instance -> what is added to the numbers of its part.
        supports: Cards that hold nodes, with the number of the step in which they stand.
    """

    nodes: dict[int, list[float]] = field(default_factory=dict)
    elements: dict[int, tuple[str, tuple[int, ...]]] = field(default_factory=dict)
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    element_sets: dict[str, list[int]] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    sections: dict[str, str] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    offsets: dict[str, int] = field(default_factory=dict)
    supports: list[tuple[int, Card]] = field(default_factory=list)

    def read_nodes(self, card: Card) -> None:
        """Take `*NODE`."""
        if card.options.get("SYSTEM", "R").upper() != "R":
            raise InputError(f"SYSTEM={card.options['SYSTEM']} is not read, cartesian is needed")
        found = []
        for number, *place in card.fields():
            self.nodes[int(number)] = [float(v) for v in (*place, "0", "0", "0")[:3]]
            found.append(int(number))
        self._add(self.node_sets, card.options.get("NSET", ""), found)

    def read_elements(self, card: Card) -> None:
        """Take `*ELEMENT` where it is a solid, else count it."""
        written = card.option("TYPE").upper()
        kind = solid(written)
        if not kind:
            self.left_out[written] = self.left_out.get(written, 0) + len(card.data)
            return
        size = _KNOWN[kind][1] + 1
        numbers = card.numbers().astype(np.int64)
        rows = numbers.reshape(-1, size).tolist() if len(numbers) % size == 0 else []
        if not rows:  # nodes beyond those of the element are allowed where it is a line
            rows = [[int(v) for v in entries[:size]] for entries in card.fields()]
        if any(len(row) < size for row in rows):
            raise InputError(f"elements {written} need {size - 1} nodes each")
        self.elements |= {number: (kind, tuple(nodes)) for number, *nodes in rows}
        self._add(self.element_sets, card.options.get("ELSET", ""), [row[0] for row in rows])

    def read_node_set(self, card: Card) -> None:
        """Take `*NSET`."""
        self._add(self.node_sets, card.option("NSET"), self._members(card, self.node_sets))

    def read_element_set(self, card: Card) -> None:
        """Take `*ELSET`."""
        self._add(self.element_sets, card.option("ELSET"), self._members(card, self.element_sets))

    def read_surface(self, card: Card) -> None:
        """Take `*SURFACE`."""
        name = card.option("NAME")
        if card.options.get("TYPE", "ELEMENT").upper() == "NODE":
            found = [n for first, *_ in card.fields() for n in self._of(first, self.node_sets)]
            self._add(self.node_sets, name, found)
            return
        faces = [(first.upper(), (*rest, "")[0].upper()) for first, *rest in card.fields()]
        self.surfaces.setdefault(name.upper(), []).extend(faces)

    def read_section(self, card: Card) -> None:
        """Take `*SOLID SECTION`."""
        name = card.option("ELSET")
        self.sections[name] = name.upper()

    def add_instance(self, card: Card, parts: Mapping[str, _Deck]) -> None:
        """Put a part where an instance of it is; its sets are named `INSTANCE.SET` and `SET`."""
        name = card.option("NAME")
        if card.option("PART").upper() not in parts:
            raise InputError(f"there is no part {card.options['PART']!r}")
        part = parts[card.options["PART"].upper()]
        more = max((*self.nodes, *self.elements), default=0)
        self.offsets[name.upper()] = more
        points = _instance_places(np.array(list(part.nodes.values())), card)
        places = zip(part.nodes, points.tolist(), strict=True)
        self.nodes |= {more + number: place for number, place in places}
        for number, (kind, nodes) in part.elements.items():
            self.elements[more + number] = kind, tuple(more + n for n in nodes)
        for own, of_part in (
            (self.node_sets, part.node_sets),
            (self.element_sets, part.element_sets),
        ):
            for key, numbers in of_part.items():
                for full in (f"{name}.{key}", key):
                    self._add(own, full, [more + n for n in numbers])
        for key, faces in part.surfaces.items():
            moved = [
                (f"{name.upper()}.{s}" if s in part.element_sets else str(more + int(s)), face)
                for s, face in faces
            ]
            self.surfaces.setdefault(key, []).extend(moved)
        for body, key in part.sections.items():
            only = len(part.sections) == 1
            self.sections[name if only else f"{name}_{body}"] = f"{name}.{key}".upper()
        for element, count in part.left_out.items():
            self.left_out[element] = self.left_out.get(element, 0) + count

    def nodes_of(self, entry: str) -> list[int]:
        """Nodes of a set, or the one of a number."""
        return self._of(entry, self.node_sets)

    def members_of(self, entry: str) -> list[int]:
        """Elements of a set, or the one of a number."""
        return self._of(entry, self.element_sets)

    def _add(self, sets: dict[str, list[int]], name: str, numbers: Iterable[int]) -> None:
        if name:
            sets.setdefault(name.upper(), []).extend(numbers)

    def _members(self, card: Card, known: dict[str, list[int]]) -> list[int]:
        """Numbers of a set: one by one, by first, last and step, or by the names of others."""
        more = self.offsets.get(card.options.get("INSTANCE", "").upper(), 0)
        found: list[int] = []
        for entries in card.fields():
            if "GENERATE" in card.options:
                first, last, *step = (int(v) for v in entries)
                found += range(more + first, more + last + 1, *step)
            else:
                for entry in entries:
                    found += self._of(entry, known, more)
        return found

    @staticmethod
    def _of(entry: str, known: dict[str, list[int]], more: int = 0) -> list[int]:
        """Members of a set by its name, or a number; empty for a set that is not there."""
        return [more + int(entry)] if entry.isdigit() else known.get(entry.upper(), [])


def _instance_places(points: Floats, card: Card) -> Floats:
    """Points of a part where its instance is: moved, then turned about an axis."""
    lines = [[float(v) for v in entries] for entries in card.fields()]
    if lines:
        points = points + lines[0][:3]
    if len(lines) > 1:
        start, end, angle = np.array(lines[1][:3]), np.array(lines[1][3:6]), lines[1][6]
        turn = Rotation(tuple(end - start), angle_deg=angle, point=tuple(start))
        points = turn.apply(points)
    return points


_READERS: dict[str, Callable[[_Deck, Card], None]] = {
    "NODE": _Deck.read_nodes,
    "ELEMENT": _Deck.read_elements,
    "NSET": _Deck.read_node_set,
    "ELSET": _Deck.read_element_set,
    "SURFACE": _Deck.read_surface,
    "SOLIDSECTION": _Deck.read_section,
}


def _whole_mesh(deck: _Deck) -> WholeMesh:
    """The deck in arrays, its names as a user may write them."""
    if not deck.elements:
        others = ", ".join(f"{n} {kind}" for kind, n in deck.left_out.items()) or "none at all"
        allowed = ", ".join([*SOLIDS, *IDEAL])
        raise InputError(f"no solid element ({allowed}); there are: {others}")
    numbers = np.array(list(deck.nodes), dtype=np.int64)
    order = np.argsort(numbers)
    by_kind: dict[str, list[int]] = {}
    for number, (kind, _) in deck.elements.items():
        by_kind.setdefault(kind, []).append(number)
    mesh = WholeMesh(np.array(list(deck.nodes.values()), dtype=np.float64).reshape(-1, 3)[order])
    mesh.notes = _notes(by_kind)
    bodies = _bodies(deck)
    for kind, elements in by_kind.items():
        nodes = np.array([deck.elements[n][1] for n in elements], dtype=np.int64)
        places = np.searchsorted(numbers[order], nodes).clip(max=len(numbers) - 1)
        wrong = numbers[order][places] != nodes
        if wrong.any():
            row, column = np.argwhere(wrong)[0]
            text = f"element {elements[row]} has node {nodes[row, column]}, which is not there"
            raise InputError(text)
        cell, _ = _KNOWN[kind]
        mesh.add_cells(cell, places, [bodies.get(n, "") for n in elements])
    for name, members in deck.node_sets.items():
        places = np.searchsorted(numbers[order], np.unique(members)).clip(max=len(numbers) - 1)
        known = np.isin(numbers[order][places], members)
        mesh.node_sets[_plain(name)] = places[known]
    at = dict(zip(numbers[order].tolist(), range(len(numbers)), strict=True))
    for name, faces in deck.surfaces.items():
        mesh.surfaces[_plain(name)] = _faces(deck, faces, at)
    mesh.left_out = deck.left_out
    return mesh


def _notes(by_kind: dict[str, list[int]]) -> tuple[str, ...]:
    """What elements of a mesh in the plane ask a case file for; solids beside them are alone taken.

    Raises:
        InputError: They are of several kinds.
    """
    in_plane = {IDEAL[kind[:3]] for kind in by_kind if kind in PLANE}
    if not in_plane:
        return ()
    if set(by_kind) & set(SOLIDS):
        for kind in set(by_kind) & set(PLANE):
            del by_kind[kind]
        return ("elements of a plane beside solids are left out",)
    if len(in_plane) > 1:
        text = f"elements of {' and '.join(sorted(in_plane))}: a mesh in the plane is one of them"
        raise InputError(text)
    (ideal,) = in_plane
    return (f'in the plane: a case needs [idealisation] kind = "{ideal}"',)


def _bodies(deck: _Deck) -> dict[int, str]:
    """Body of each element: of the last section that names it."""
    sections = deck.sections or {"body": ""}
    found: dict[int, str] = {}
    for body, key in sections.items():
        members = deck.element_sets.get(key, list(deck.elements) if not key else [])
        found |= dict.fromkeys(members, _plain(body))
    return found


def _plain(name: str) -> str:
    """A name without the dot, which parts a body from its group, in small letters."""
    return name.replace(".", "_").lower()


def _faces(deck: _Deck, faces: Iterable[tuple[str, str]], at: Mapping[int, int]) -> list[Nodes]:
    """Corners of the faces of a surface, by the number of corners; see `WholeMesh.surfaces`."""
    found: dict[int, list[list[int]]] = {}
    for entry, face in faces:
        for number in deck.members_of(entry):
            if number not in deck.elements:
                continue  # of an element that is no solid
            kind, nodes = deck.elements[number]
            sides = SIDES[_KNOWN[kind][0]]
            known = ["", *(f"S{k + 1}" for k in range(len(sides)))]
            if face not in known:
                raise InputError(f"surface: face {face!r} given, S1 to S{len(sides)} are read")
            chosen = [sides[int(face[1:]) - 1]] if face else sides
            for side in chosen:
                found.setdefault(len(side), []).append([at[nodes[k]] for k in side])
    return [np.array(rows, dtype=np.int64) for rows in found.values()]
