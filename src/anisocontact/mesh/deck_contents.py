"""What an input file of Abaqus or CalculiX holds: nodes, elements and sets by their own numbers.

Parts are put where their instances are. What is no mesh is kept as it is written.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.mesh.deck import Card, real
from anisocontact.mesh.deck_profiles import ANALYTIC, Profile, profile_of
from anisocontact.mesh.deck_supports import supported_nodes

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


@dataclass(frozen=True)
class SolidSection:
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
        profiles: Name -> analytical surface of a rigid body.
        sections: Body -> its section.
        left_out: Elements that are no solids -> how many.
        offsets: Instance -> what is added to the numbers of its part.
        cards: Cards that are not of the mesh, with the number of the step in which they stand.
        same: Name of nodes that are held alike once more -> the name that they have already.
        of_parts: Names of sets and surfaces that parts alone have given.
        own: Largest number that nodes and elements beside the parts have; instances begin behind.
        unsorted: Names of node sets whose order counts.
        moved: How many nodes are given once more, at another place, which counts.
        absent: Sets that others name, in small letters, and that are not there.
    """

    nodes: dict[int, list[float]] = field(default_factory=dict)
    elements: dict[int, tuple[str, tuple[int, ...]]] = field(default_factory=dict)
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    element_sets: dict[str, list[int]] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    profiles: dict[str, Profile] = field(default_factory=dict)
    sections: dict[str, SolidSection] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    offsets: dict[str, int] = field(default_factory=dict)
    cards: list[tuple[int, Card]] = field(default_factory=list)
    own: int = 0
    of_parts: set[str] = field(default_factory=set)
    unsorted: set[str] = field(default_factory=set)
    moved: int = 0
    absent: set[str] = field(default_factory=set)
    same: dict[str, str] = field(default_factory=dict)
    _held: dict[tuple[int, ...], str] = field(default_factory=dict)

    def read_nodes(self, card: Card) -> None:
        """Take `*NODE`."""
        system = card.options.get("SYSTEM", "R").upper() or "R"
        if system not in ("R", "C"):
            raise InputError(f"SYSTEM={system} is not read; x, y, z are, and r, angle, z")
        found = []
        for number, *given in card.rows():
            x, y, z = (real(v or "0") for v in (*given, "0", "0", "0")[:3])
            if system == "C":
                x, y = x * math.cos(math.radians(y)), x * math.sin(math.radians(y))
            self.moved += self.nodes.get(int(number), [x, y, z]) != [x, y, z]
            self.nodes[int(number)] = [x, y, z]
            found.append(int(number))
        self.add_nodes(card, found)

    def read_elements(self, card: Card) -> None:
        """Take `*ELEMENT` where it is a solid, else count it."""
        written = card.option("TYPE").upper()
        kind = solid(written)
        if not kind:
            self.left_out[written] = self.left_out.get(written, 0) + len(card.data)
            return
        size = KNOWN[kind][1] + 1
        given = card.numbers()
        numbers = given.astype(np.int64)
        if len(broken := given[numbers != given]):
            raise InputError(f"{broken[0]:g} given, elements and nodes have whole numbers")
        rows = numbers.reshape(-1, size).tolist() if len(numbers) % size == 0 else []
        if not rows:  # nodes beyond those of the element are allowed where it is a line
            rows = [[int(v) for v in entries[:size]] for entries in card.fields()]
        if any(len(row) < size for row in rows):
            raise InputError(f"elements {written} need {size - 1} nodes each")
        for number, *nodes in rows:
            if self.elements.setdefault(number, (kind, tuple(nodes))) != (kind, tuple(nodes)):
                raise InputError(f"element {number} is given once more, as another one")
        self.add_elements(card, [row[0] for row in rows])

    def read_node_set(self, card: Card) -> None:
        """Take `*NSET`."""
        self._renew(self.node_sets, card.option("NSET"))
        if "UNSORTED" in card.options:
            self.unsorted.add(card.option("NSET").upper())
        found = self._members(card, self.node_sets)
        if elements := card.options.get("ELSET"):  # all nodes of a set of elements
            known = [self.elements[n][1] for n in self.members_of(elements) if n in self.elements]
            found += [node for nodes in known for node in nodes]
        self.add_nodes(card, found)

    def read_element_set(self, card: Card) -> None:
        """Take `*ELSET`."""
        self._renew(self.element_sets, card.option("ELSET"))
        self.add_elements(card, self._members(card, self.element_sets))

    def read_surface(self, card: Card) -> None:
        """Take `*SURFACE`."""
        name, kind = card.option("NAME").upper(), card.options.get("TYPE", "ELEMENT").upper()
        if kind in ANALYTIC:
            self.profiles[name] = profile_of(card)
            return
        self._renew(self.surfaces, name)
        if kind == "NODE":
            self._renew(self.node_sets, name)
            found = [n for first, *_ in card.fields() for n in self._of(first, self.node_sets)]
            self._add(self.node_sets, name, found)
            return
        if kind != "ELEMENT":
            raise InputError(f"TYPE={kind} is not read")
        how = card.options.get("COMBINE", "")
        if how and how.upper() != "UNION":
            raise InputError(f"COMBINE={how} is not read, UNION is")
        faces: list[tuple[str, str]] = []
        for first, *rest in card.fields():
            if how:
                faces += [face for one in (first, *rest) for face in self.surfaces[one.upper()]]
            else:
                faces.append((first.upper(), (*rest, "")[0].upper()))
        self.surfaces.setdefault(name, []).extend(faces)

    def read_section(self, card: Card) -> None:
        """Take `*SOLID SECTION`."""
        name = card.option("ELSET")
        first = next(card.fields(), [])
        thickness = first[0] if first else ""
        material, turn = (card.options.get(key, "") for key in ("MATERIAL", "ORIENTATION"))
        self.sections[name] = SolidSection(name.upper(), material, thickness, turn)

    def add_card(self, step: int, card: Card) -> None:
        """Keep what is not of the mesh.

        Faces under a pressure of `*DLOAD` become a surface, nodes that are held alike a set.
        """
        self.cards.append((step, card))
        if card.name == "BOUNDARY":
            for name, nodes in supported_nodes(card).items():
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

    def add_nodes(self, card: Card, numbers: Iterable[int]) -> None:
        """Nodes of the set that a card names, if it does."""
        self._add(self.node_sets, card.options.get("NSET", ""), numbers)

    def add_elements(self, card: Card, numbers: Iterable[int]) -> None:
        """Elements of the set that a card names, if it does."""
        self._add(self.element_sets, card.options.get("ELSET", ""), numbers)

    def bound(self, entry: str) -> list[int]:
        """Nodes of a set as `*NFILL` pairs them: by their numbers, if not as they are written."""
        found = list(dict.fromkeys(self.nodes_of(entry)))
        return found if entry.upper() in self.unsorted else sorted(found)

    def nodes_of(self, entry: str) -> list[int]:
        """Nodes of a set, or the one of a number."""
        return self._of(self.name_of(entry), self.node_sets)

    def name_of(self, entry: str) -> str:
        """The name under which a set of nodes is kept."""
        return self.same.get(entry.upper(), entry)

    def members_of(self, entry: str) -> list[int]:
        """Elements of a set, or the one of a number."""
        return self._of(entry, self.element_sets)

    def as_written(self, number: int) -> tuple[int, str]:
        """Number of an element in the file, and the instance that has it, or an empty name.

        Example:
            >>> Deck(offsets={"A": 0, "B": 100}).as_written(107)
            (7, 'B')
        """
        before = [(start, name) for name, start in self.offsets.items() if start < number]
        start, instance = max(before, default=(0, ""))
        return number - start, instance

    def told(self, element: int) -> str:
        """An element as messages name it, "7" or "7 of instance 'B'"."""
        number, instance = self.as_written(element)
        return f"{number} of instance {instance!r}" if instance else str(number)

    def _renew(self, sets: dict[str, Any], name: str) -> None:
        """Forget what parts call by a name that the assembly gives now."""
        if name.upper() in self.of_parts:
            for known in (self.node_sets, self.element_sets, self.surfaces):
                known.pop(name.upper(), None)
            self.of_parts.discard(name.upper())

    def _add(self, sets: dict[str, list[int]], name: str, numbers: Iterable[int]) -> None:
        if name:
            sets.setdefault(name.upper(), []).extend(numbers)

    def _members(self, card: Card, known: dict[str, list[int]]) -> list[int]:
        """Numbers of a set: one by one, by first, last and step, or by the names of others."""
        instance = card.options.get("INSTANCE", "").upper()
        more = self.offsets.get(instance, 0)
        found: list[int] = []
        for entries in card.fields():
            if "GENERATE" in card.options:
                first, last, *step = (int(v) for v in entries)
                if last < first or min(step, default=1) < 1 or len(step) > 1:
                    text = ", ".join(entries)
                    raise InputError(f"{text} given, GENERATE needs first, last and a step > 0")
                found += range(more + first, more + last + 1, *step)
            else:
                for entry in entries:
                    full = f"{instance}.{entry.upper()}"
                    if not (entry.isdigit() or full in known or entry.upper() in known):
                        self.absent.add(entry.lower())
                    found += known[full] if full in known else self._of(entry, known, more)
        return found

    @staticmethod
    def _of(entry: str, known: dict[str, list[int]], more: int = 0) -> list[int]:
        """Members of a set by its name, or a number; empty for a set that is not there."""
        return [more + int(entry)] if entry.isdigit() else known.get(entry.upper(), [])


def pressed_face(label: str) -> str:
    """Face of a pressure `P1` ... of `*DLOAD`; empty for other loads.

    Example:
        >>> pressed_face("P2"), pressed_face("GRAV")
        ('S2', '')
    """
    return f"S{label[1:]}" if label[:1].upper() == "P" and label[1:].isdigit() else ""


def pressures(card: Card) -> dict[str, tuple[list[str], list[tuple[str, str]]]]:
    """Faces under the pressures of a `*DLOAD`, as surfaces.

    Returns:
        Name of a surface -> its pressures as written, (element or set, face). A set with its face
        is one; faces of single elements under one pressure are one, named by the line of the card.
    """
    found: dict[str, tuple[list[str], list[tuple[str, str]]]] = {}
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
        given, faces = found.setdefault(name, ([], []))
        if not (given and entry.isdigit()):
            given.append(value)
        if (entry.upper(), face) not in faces:
            faces.append((entry.upper(), face))
    return found
