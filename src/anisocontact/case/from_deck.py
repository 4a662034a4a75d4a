"""A case file from a deck of Abaqus or CalculiX: what it says of materials, contact and steps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

from anisocontact.base.errors import InputError
from anisocontact.case.deck_contact import DeckContacts, table_lines
from anisocontact.case.deck_coupling import ReferencePoints, of_ideal
from anisocontact.case.deck_cyclic import DeckSectors
from anisocontact.case.deck_materials import Materials, Temperatures
from anisocontact.case.deck_options import unread_options
from anisocontact.case.deck_procedures import static_steps
from anisocontact.case.deck_steps import Steps
from anisocontact.case.deck_tools import Tools
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.deck import Card, real
from anisocontact.mesh.deck_contents import PLANE, Deck
from anisocontact.mesh.deck_reader import read_deck
from anisocontact.mesh.deck_supports import key_of, written
from anisocontact.mesh.inp import ideals, named_in, without_section
from anisocontact.mesh.readers import file_arrays

#: Keywords that ask for output or say nothing that a case needs.
SILENT = {"HEADING", "PREPRINT", "OUTPUT", "RESTART", "ENDSTEP", "ASSEMBLY", "ENDASSEMBLY"}
SILENT |= {"ENDINSTANCE", "MONITOR", "NODEOUTPUT", "ELEMENTOUTPUT", "CONTACTOUTPUT"}
SILENT |= {f"{what}{how}" for what in ("NODE", "EL", "CONTACT") for how in ("PRINT", "FILE")}
SILENT |= {"SECTIONPRINT", "TRANSFORM", "BOUNDARY"}
#: What a rigid body is made of whose deck says nothing: it changes nothing.
ANY_MATERIAL: dict[str, object] = {"model": "neo-hookean", "E": 1.0, "nu": 0.3}
#: Parts of a smooth step.
SMOOTH_PARTS = 20
#: Keyword that has no words in a case -> what to look at instead.
INSTEAD = {
    "EQUATION": ": components of single nodes are not tied; see faces, symmetry, tie",
    "MPC": ": single nodes are not tied; see faces of [rigid], symmetry, tie",
    "PRE-TENSIONSECTION": ": bolts; a force on the head, or an overlap in the mesh, does it",
    "MODELCHANGE": ": bodies and contacts are the same in all steps",
    "CHANGEFRICTION": ": friction is the same in all steps",
    "CLEARANCE": ": gaps are those of the mesh; move its nodes, or see adjust_gap",
    "CONTACTINTERFERENCE": ": overlaps of the mesh are pushed apart in the first increment",
    "CONTACTEXCLUSIONS": ": take its pairs out of [[contact]]",
    "RIGIDSURFACE": ": write it as *SURFACE and *RIGID BODY, ANALYTICAL SURFACE",
    "PARAMETER": ": write the numbers in their places",
    "VISCOELASTIC": ": see the model viscoelastic",
    "CREEP": ": a law in Python; see materials",
}


def case_of_deck(path: Path, target: Path) -> tuple[str, list[str]]:
    """What a deck says as a case file that reads its mesh.

    Args:
        path: The deck.
        target: Where the case file is to stand.

    Returns:
        The text, and a line for everything that was not taken over.

    Raises:
        InputError: The deck cannot be read, or none of its steps is static.
        OSError: It cannot be read.
    """
    mesh, deck = file_arrays(path, field=""), read_deck(path)  # the former says what is no file
    deck.cards, left = static_steps(deck.cards)
    case = _Case(deck, mesh, left)
    file = path.resolve().relative_to(target.resolve().parent, walk_up=True)
    return "\n".join(case.lines(file.as_posix())) + "\n", case.left_out


@dataclass
class _Case:
    """Tables of a case, as they are found in the cards of a deck.

    Attributes:
        deck: The deck.
        mesh: Its mesh.
        left_out: Lines on what is not taken over.
    """

    deck: Deck
    mesh: MeshArrays
    left_out: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._materials = Materials(self.deck, self._leave)
        self._amplitudes: dict[str, dict[str, object]] = {}
        self._ties: list[Card] = []
        self._title = ""
        self._warm: list[Card] = []
        self._named = named_in([*self.mesh.facets, *self.mesh.nodes])
        self._sectors = DeckSectors(self.mesh, self._named)
        self._steps = Steps(self.deck, self.mesh, self._named, self._temperatures)
        kinds = {kind for kind, _ in self.deck.elements.values()}
        turned = bool(kinds) and {kind[:3] for kind in kinds} <= {"CAX"}
        self._tools = Tools(self.deck.profiles, self.mesh.points, turned)
        self._contacts = DeckContacts(self.mesh, self._named, self._tools, self._leave)
        self._reference_points = ReferencePoints(
            self.deck, self.mesh, self._named, self._tools, of_ideal(kinds), self._leave
        )
        cards = [card for _, card in self.deck.cards]
        self._each(lambda step, card: bool(step) or not self._reference_points.take(card))
        self.deck.cards = self._reference_points.without(self.deck.cards)
        self._each(self._take)
        self.left_out += self._steps.finish()
        self._tell_unread(cards)

    def lines(self, file: str) -> Iterator[str]:
        """Lines of the case file.

        Args:
            file: The deck, as the case names it.
        """
        if self._title:
            yield f"title = {written(self._title)}"
        yield from table_lines("[mesh]", {"file": file})
        kinds = {kind for kind, _ in self.deck.elements.values()}
        if kinds <= set(PLANE):
            yield from table_lines("[idealisation]", self._ideal(kinds))
        for body in self.mesh.bodies:
            yield from table_lines(f"[material.{key_of(body)}]", self._of_body(body))
        for name, amplitude in self._amplitudes.items():
            yield from table_lines(f"[amplitude.{key_of(name)}]", amplitude)
        for place, node in self._steps.nodes.items():
            yield from table_lines(f"[nodes.{key_of(place)}]", {"near": node})
        yield from self._contacts.lines(self._reference_points.skins)
        for table in self._sectors.tables():
            yield from table_lines("[[cyclic]]", table)
        for card in self._ties:
            for slave, master, *_ in card.fields():
                if sides := self._contacts.sides(card, slave, master):
                    given = card.options.get("POSITIONTOLERANCE")
                    both: dict[str, object] = {"slave": sides[0], "master": sides[1]}
                    within = {"tolerance": real(given)} if given else {}
                    yield from table_lines("[[tie]]", both | within)
        for name, table in self._reference_points.tables.items():
            yield from table_lines(f"[rigid.{key_of(name)}]", table)
        for number, step in enumerate(self._steps.tables(), 1):
            coupled = self._reference_points.step(number, self._steps.with_amplitude)
            yield from table_lines("[[step]]", step | coupled)

    def _each(self, take: Callable[[int, Card], object]) -> None:
        """Hand each card on; those that cannot be taken over are left out with a line."""
        kept = []
        for step, card in self.deck.cards:
            try:
                if take(step, card) is not False:
                    kept.append((step, card))
            except InputError as error:
                self._leave(card, f": {error}")
            except (ValueError, IndexError):
                self._leave(card, ": its data are of another kind")
        self.deck.cards = kept

    def _tell_unread(self, cards: Iterable[Card]) -> None:
        """Lines on elements that are no solids, and on options of cards that are taken over."""
        for kind, count in self.deck.left_out.items():
            self.left_out.append(f"{count} elements {kind}: they are no solids")
        if lost := without_section(self.deck):
            self.left_out.append(lost)
        for card, why in unread_options(cards):
            if not any(line.startswith(_of(card) + ":") for line in self.left_out):
                self._leave(card, why)

    def _take(self, step: int, card: Card) -> None:
        if card.name in _READERS and not step:
            _READERS[card.name](self, card)
        elif self._contacts.take(step, card) or (
            not step and (self._materials.take(card) or self._sectors.take(card))
        ):
            return
        elif not self._steps.take(step, card) and card.name not in SILENT:
            self._leave(card, INSTEAD.get(card.name, ""))

    def read_heading(self, card: Card) -> None:
        """Take `*HEADING`."""
        self._title = card.data[0].replace('"', "'") if card.data else ""

    def read_start(self, card: Card) -> None:
        """Take `*INITIAL CONDITIONS` of temperatures.

        Raises:
            InputError: They are others.
        """
        if card.option("TYPE").upper() != "TEMPERATURE":
            raise InputError(f"TYPE={card.options['TYPE']} is not taken over")
        self._warm.append(card)

    def _temperatures(self) -> Temperatures:
        bodies = [body for body in self.mesh.bodies if self._materials.expands(body)]
        return Temperatures(self.deck, bodies, self._warm)

    def read_amplitude(self, card: Card) -> None:
        """Take `*AMPLITUDE`; what jumps to its value at the start goes there along the step."""
        name, table = card.option("NAME").lower(), _amplitude(card)
        values = set(table["value"])
        if len(values) == 1:
            self._steps.constant[name] = values.pop()
            self._leave(card, ": it is constant, values are reached at the end of the step")
        else:
            self._amplitudes[name] = table

    def read_tie(self, card: Card) -> None:
        """Take `*TIE`; those of sectors are taken with them."""
        for option in ("MULTISTAGE", "FLUIDCYCLIC", "FLUIDPERIODIC"):
            if option in card.options:
                raise InputError(f"{option} is no tie of faces")
        if not self._sectors.take(card):
            self._ties.append(card)

    def _leave(self, card: Card, why: str = "") -> None:
        self.left_out.append(_of(card) + why)

    def _ideal(self, kinds: set[str]) -> dict[str, object]:
        (kind,) = ideals(kinds)
        if kind[:5] != "plane":
            return {"kind": kind}
        thick = {name: real(one.thickness or "1") for name, one in self.deck.sections.items()}
        first = next(iter(thick.values()), 1.0)
        others = [
            f"{name.lower()} has {value:g}" for name, value in thick.items() if value != first
        ]
        if others:
            self.left_out.append(f"thickness: it is {first:g} of all bodies, {', '.join(others)}")
        return {"kind": kind} | ({"thickness": first} if first != 1.0 else {})

    def _of_body(self, body: str) -> dict[str, object]:
        """Table of the material of a body; without a model where the deck has none that is read."""
        sheet = {"plane-stress"} == ideals(kind for kind, _ in self.deck.elements.values())
        finite = self._steps.finite and not sheet  # sheets are at small strain alone
        table, left = self._materials.table(body, finite)
        if body in self._reference_points.rigid and "model" not in table:
            return dict(ANY_MATERIAL)  # of a body that does not deform
        self.left_out += left
        return table


#: Keyword in front of the first step -> what takes it.
_READERS: dict[str, Callable[[_Case, Card], None]] = {
    "HEADING": _Case.read_heading,
    "INITIALCONDITIONS": _Case.read_start,
    "AMPLITUDE": _Case.read_amplitude,
    "TIE": _Case.read_tie,
}


#: Option of `*AMPLITUDE` whose numbers are no times and values -> what to write instead.
_NO_TABLE = {
    "USER": 'see kind = "python" of [amplitude]',
    "SHIFTX": "shift its times",
    "SHIFTY": "shift its values",
}


def _of(card: Card) -> str:
    """A card as lines name it."""
    return f"*{card.name} of line {card.line}"


def _amplitude(card: Card) -> dict[str, Any]:
    """Table of a `*AMPLITUDE`; steps that are smooth become one with points between."""
    definition = "".join(card.options.get("DEFINITION", "TABULAR").upper().split())
    if card.options.get("VALUE", "RELATIVE").upper().startswith("ABS"):
        raise InputError("VALUE=ABSOLUTE is not read; write shares of what follows it")
    if definition not in ("TABULAR", "EQUALLYSPACED", "SMOOTHSTEP"):
        raise InputError(f"DEFINITION={card.options['DEFINITION']} is not read; see [amplitude]")
    for option, instead in _NO_TABLE.items():
        if option in card.options:
            raise InputError(f"{option} is not read; {instead}")
    numbers = card.numbers().tolist()
    if definition == "EQUALLYSPACED":
        interval = real(card.option("FIXEDINTERVAL"))
        start = real(card.options.get("BEGIN") or "0")
        numbers = [v for k, value in enumerate(numbers) for v in (start + k * interval, value)]
    if not numbers or len(numbers) % 2:
        raise InputError(f"{len(numbers)} numbers, times and values are needed")
    times, values = numbers[::2], numbers[1::2]
    if definition == "SMOOTHSTEP":
        times, values = _smooth(times, values)
    table: dict[str, Any] = {"kind": "table", "time": times, "value": values}
    total = card.options.get("TIME", "").upper().startswith("TOTAL")
    return table | ({"time_of": "total"} if total else {})


def _smooth(times: list[float], values: list[float]) -> tuple[list[float], list[float]]:
    """Points of steps without slope and curvature at their ends, as the manual has them."""
    shares = [k / SMOOTH_PARTS for k in range(1, SMOOTH_PARTS + 1)]
    points = [(times[0], values[0])]
    for (start, first), (end, last) in pairwise(zip(times, values, strict=True)):
        for x in shares:
            rise = x**3 * (10.0 - 15.0 * x + 6.0 * x * x)
            points.append((start + x * (end - start), first + rise * (last - first)))
    return [time for time, _ in points], [value for _, value in points]
