"""What an input file of Abaqus or CalculiX holds: nodes, elements and sets by their own numbers.

Parts are put where their instances are. What is no mesh is kept as it is written.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.mesh.deck import Card, read_cards, real
from anisocontact.mesh.deck_supports import held_nodes
from anisocontact.mesh.placement import Rotation

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
#: All of them.
KNOWN = SOLIDS | PLANE
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
    return kind if kind in KNOWN else ""


def read_deck(path: Path) -> Deck:
    """What is in an input file, parts where their instances are.

    Args:
        path: The file.

    Raises:
        InputError: As of `read_inp`.
        OSError: It cannot be read.
    """
    cards = read_cards(path)
    whole = current = Deck(own=_own_numbers(cards))
    step = 0
    parts: dict[str, Deck] = {}
    for card in cards:
        try:
            if card.name in GENERATED:
                raise InputError("is not read; write nodes and elements out")
            if card.name == "PART":
                current = parts.setdefault(card.option("NAME").upper(), Deck())
            elif card.name == "ENDPART":
                current = whole
            elif card.name == "INSTANCE":
                whole.add_instance(card, parts)
            elif card.name in _READERS:
                _READERS[card.name](current, card)
            else:
                step += card.name == "STEP"
                whole.add_card(step, card)
        except InputError as error:
            raise InputError(f"line {card.line}: *{card.name}: {error}") from None
        except (ValueError, IndexError):
            raise InputError(f"line {card.line}: *{card.name}: its data cannot be read") from None
    return whole


@dataclass(frozen=True)
class Section:
    """What a `*SOLID SECTION` says.

    Attributes:
        elements: Name of the set of elements, in capitals.
        material: Name of the material.
        thickness: Thickness in the plane as written; empty if there is none.
        orientation: Name of its `*ORIENTATION`; empty if there is none.
    """

    elements: str
    material: str = ""
    thickness: str = ""
    orientation: str = ""


@dataclass
class Deck:
    """Nodes, elements and sets under their own numbers; names of sets are in capitals.

    Attributes:
        nodes: Number -> place.
        elements: Number -> solid, nodes.
        node_sets: Name -> numbers.
        element_sets: Name -> numbers.
        surfaces: Name -> (element or set, face; empty for all free ones).
        sections: Body -> its section.
        left_out: Elements that are no solids -> how many.
        offsets: Instance -> what is added to the numbers of its part.
        cards: Cards that are not of the mesh, with the number of the step in which they stand.
        same: Name of nodes that are held alike once more -> the name that they have already.
        own: Largest number that nodes and elements beside the parts have; instances begin behind.
    """

    nodes: dict[int, list[float]] = field(default_factory=dict)
    elements: dict[int, tuple[str, tuple[int, ...]]] = field(default_factory=dict)
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    element_sets: dict[str, list[int]] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    sections: dict[str, Section] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    offsets: dict[str, int] = field(default_factory=dict)
    cards: list[tuple[int, Card]] = field(default_factory=list)
    own: int = 0
    same: dict[str, str] = field(default_factory=dict)
    _held: dict[tuple[int, ...], str] = field(default_factory=dict)

    def read_nodes(self, card: Card) -> None:
        """Take `*NODE`."""
        if card.options.get("SYSTEM", "R").upper() != "R":
            raise InputError(f"SYSTEM={card.options['SYSTEM']} is not read, cartesian is needed")
        found = []
        for number, *place in card.fields():
            self.nodes[int(number)] = [real(v) for v in (*place, "0", "0", "0")[:3]]
            found.append(int(number))
        self._add(self.node_sets, card.options.get("NSET", ""), found)

    def read_elements(self, card: Card) -> None:
        """Take `*ELEMENT` where it is a solid, else count it."""
        written = card.option("TYPE").upper()
        kind = solid(written)
        if not kind:
            self.left_out[written] = self.left_out.get(written, 0) + len(card.data)
            return
        size = KNOWN[kind][1] + 1
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
        first = next(card.fields(), [])
        thickness = first[0] if first else ""
        material, turn = (card.options.get(key, "") for key in ("MATERIAL", "ORIENTATION"))
        self.sections[name] = Section(name.upper(), material, thickness, turn)

    def add_card(self, step: int, card: Card) -> None:
        """Keep what is not of the mesh.

        Faces under a pressure of `*DLOAD` become a surface, nodes that are held alike a set.
        """
        self.cards.append((step, card))
        if card.name == "BOUNDARY":
            for name, nodes in held_nodes(card).items():
                first = self._held.setdefault(tuple(sorted(nodes)), name)
                if first == name:
                    self.node_sets[name] = nodes
                else:
                    self.same[name] = first
        for name, (_, faces) in pressures(card).items() if card.name == "DLOAD" else ():
            self.surfaces[name] = [
                (entry, face)
                for entry, face in faces
                if entry.isdigit() or entry in self.element_sets
            ]

    def add_instance(self, card: Card, parts: Mapping[str, Deck]) -> None:
        """Put a part where an instance of it is; its sets are named `INSTANCE.SET` and `SET`."""
        name = card.option("NAME")
        if card.option("PART").upper() not in parts:
            raise InputError(f"there is no part {card.options['PART']!r}")
        part = parts[card.options["PART"].upper()]
        more = max((*self.nodes, *self.elements, self.own))
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
        for body, section in part.sections.items():
            only = len(part.sections) == 1
            moved_set = f"{name}.{section.elements}".upper()
            self.sections[name if only else f"{name}_{body}"] = replace(section, elements=moved_set)
        for element, count in part.left_out.items():
            self.left_out[element] = self.left_out.get(element, 0) + count

    def nodes_of(self, entry: str) -> list[int]:
        """Nodes of a set, or the one of a number."""
        return self._of(self.name_of(entry), self.node_sets)

    def name_of(self, entry: str) -> str:
        """The name under which a set of nodes is kept."""
        return self.same.get(entry.upper(), entry)

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


def _own_numbers(cards: Sequence[Card]) -> int:
    """Largest number of a node or element of an assembly itself, as of its reference points."""
    largest, inside = 0, False
    if any(card.name == "PART" for card in cards):
        for card in cards:
            inside = card.name == "PART" or (inside and card.name != "ENDPART")
            if card.name in ("NODE", "ELEMENT") and not inside:
                firsts = (entries[0] for entries in card.fields() if entries)
                largest = max(largest, *(int(n) for n in firsts if n.isdigit()), 0)
    return largest


def _instance_places(points: Floats, card: Card) -> Floats:
    """Points of a part where its instance is: moved, then turned about an axis."""
    lines = [[real(v) for v in entries] for entries in card.fields()]
    if lines:
        points = points + lines[0][:3]
    if len(lines) > 1:
        start, end, angle = np.array(lines[1][:3]), np.array(lines[1][3:6]), lines[1][6]
        turn = Rotation(tuple(end - start), angle_deg=angle, point=tuple(start))
        points = turn.apply(points)
    return points


_READERS: dict[str, Callable[[Deck, Card], None]] = {
    "NODE": Deck.read_nodes,
    "ELEMENT": Deck.read_elements,
    "NSET": Deck.read_node_set,
    "ELSET": Deck.read_element_set,
    "SURFACE": Deck.read_surface,
    "SOLIDSECTION": Deck.read_section,
}


def pressed_face(label: str) -> str:
    """Face of a pressure `P1` ... of `*DLOAD`; empty for other loads.

    Example:
        >>> pressed_face("P2"), pressed_face("GRAV")
        ('S2', '')
    """
    return f"S{label[1:]}" if label[:1].upper() == "P" and label[1:].isdigit() else ""


def pressures(card: Card) -> dict[str, tuple[str, list[tuple[str, str]]]]:
    """Faces under the pressures of a `*DLOAD`, as surfaces.

    Args:
        card: The card.

    Returns:
        Name of a surface -> pressure as written, (element or set, face). A set with its face is
        one; faces of single elements under one pressure are one, named by the line of the card.
    """
    found: dict[str, tuple[str, list[tuple[str, str]]]] = {}
    values: list[str] = []
    for entry, label, *numbers in card.fields():
        face, value = pressed_face(label), (*numbers, "0")[0]
        if not face:
            continue
        name = f"{entry}_{label}".upper()
        if entry.isdigit():
            values += [value] if value not in values else []
            place = values.index(value)
            name = f"PRESSED_{card.line}" + (f"_{place + 1}" if place else "")
        found.setdefault(name, (value, []))[1].append((entry.upper(), face))
    return found
