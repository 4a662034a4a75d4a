"""A case file from a deck of Abaqus or CalculiX: what it says of materials, contact and steps."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from anisocontact.base.errors import InputError
from anisocontact.case.deck_coupling import Couplings, of_ideal
from anisocontact.case.deck_cyclic import Sectors
from anisocontact.case.deck_materials import Materials, Temperatures
from anisocontact.case.deck_procedures import static_steps
from anisocontact.case.deck_steps import Steps
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.deck import Card, real
from anisocontact.mesh.deck_contents import PLANE, Deck, read_deck
from anisocontact.mesh.deck_supports import key_of, written
from anisocontact.mesh.inp import ideals, named_in
from anisocontact.mesh.readers import file_arrays

__all__ = ["case_of_deck"]

#: Keywords that ask for output or say nothing that a case needs.
SILENT = {"HEADING", "PREPRINT", "OUTPUT", "RESTART", "ENDSTEP", "ASSEMBLY", "ENDASSEMBLY"}
SILENT |= {"ENDINSTANCE", "MONITOR", "NODEOUTPUT", "ELEMENTOUTPUT", "CONTACTOUTPUT"}
SILENT |= {f"{what}{how}" for what in ("NODE", "EL", "CONTACT") for how in ("PRINT", "FILE")}
SILENT |= {"SECTIONPRINT", "TRANSFORM", "BOUNDARY"}
#: Options of `*FRICTION` with which its first number is not the coefficient of all slips.
OTHER_FRICTION = {"ANISOTROPIC", "USER", "EXPONENTIALDECAY", "TAUMAX", "ROUGH", "DEPENDENCIES"}
#: Keyword that has no words in a case -> what to look at instead.
INSTEAD = {"EQUATION": ": components of single nodes are not tied; see faces, symmetry, tie"}


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
    deck, mesh = read_deck(path), file_arrays(path, field="")
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
        self._friction: dict[str, float] = {}
        self._penalty: dict[str, float] = {}
        self._amplitudes: dict[str, dict[str, object]] = {}
        self._pairs: list[Card] = []
        self._ties: list[Card] = []
        self._title, self._interaction = "", ""
        self._warm: list[Card] = []
        self._named = named_in([*self.mesh.facets, *self.mesh.nodes])
        self._sectors = Sectors(self.mesh, self._named)
        self._steps = Steps(self.deck, self.mesh, self._named, self._temperatures)
        kinds = {kind for kind, _ in self.deck.elements.values()}
        self._couplings = Couplings(self.deck, self.mesh, self._named, of_ideal(kinds), self._leave)
        self._each(lambda step, card: bool(step) or not self._couplings.take(card))
        self.deck.cards = self._couplings.without(self.deck.cards)
        self._each(self._take)
        self.left_out += self._steps.finish()

    def lines(self, file: str) -> Iterator[str]:
        """Lines of the case file.

        Args:
            file: The deck, as the case names it.
        """
        if self._title:
            yield f"title = {written(self._title)}"
        yield from _table("[mesh]", {"file": file})
        kinds = {kind for kind, _ in self.deck.elements.values()}
        if kinds <= set(PLANE):
            yield from _table("[idealisation]", self._ideal(kinds))
        for body in self.mesh.bodies:
            yield from _table(f"[material.{key_of(body)}]", self._of_body(body))
        for name, amplitude in self._amplitudes.items():
            yield from _table(f"[amplitude.{key_of(name)}]", amplitude)
        for place, node in self._steps.nodes.items():
            yield from _table(f"[nodes.{key_of(place)}]", {"near": node})
        for card in self._pairs:
            yield from self._contact(card)
        for table in self._sectors.tables():
            yield from _table("[[cyclic]]", table)
        for card in self._ties:
            for slave, master, *_ in card.fields():
                sides = self._sides(card, slave, master)
                if sides:
                    given = card.options.get("POSITIONTOLERANCE")
                    within = {"tolerance": real(given)} if given else {}
                    yield from _table("[[tie]]", sides | within)
        for name, table in self._couplings.tables.items():
            yield from _table(f"[rigid.{key_of(name)}]", table)
        for number, step in enumerate(self._steps.tables(), 1):
            led = self._couplings.step(number, self._steps.led)
            yield from _table("[[step]]", step | led)

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

    def _take(self, step: int, card: Card) -> None:
        if card.name in _READERS and not step:
            _READERS[card.name](self, card)
        elif not step and (self._materials.take(card) or self._sectors.take(card)):
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

    def read_interaction(self, card: Card) -> None:
        """Take `*SURFACE INTERACTION`; what follows is of it."""
        self._interaction = card.option("NAME").upper()

    def read_friction(self, card: Card) -> None:
        """Take `*FRICTION`."""
        if not OTHER_FRICTION.isdisjoint(card.options) or len(list(card.fields())) > 1:
            raise InputError("one coefficient is taken over; see friction")
        self._friction[self._interaction] = float(card.numbers()[0])

    def read_behaviour(self, card: Card) -> None:
        """Take `*SURFACE BEHAVIOR`: contact is exact here, a line says what was given."""
        kind = card.options.get("PRESSURE-OVERCLOSURE", "").upper()
        if kind == "TIED" or "NOSEPARATION" in card.options:
            raise InputError("its faces do not come apart, as [[tie]] has it; contact does here")
        if kind == "LINEAR":
            self._penalty[self._interaction] = float(card.numbers()[0])

    def read_amplitude(self, card: Card) -> None:
        """Take `*AMPLITUDE`; what jumps to its value at the start goes there along the step."""
        name, table = card.option("NAME").lower(), _amplitude(card)
        values = set(card.numbers()[1::2].tolist())
        if len(values) == 1:
            self._steps.constant[name] = values.pop()
            self._leave(card, ": it is constant, values are reached at the end of the step")
        else:
            self._amplitudes[name] = table

    def read_pair(self, card: Card) -> None:
        """Take `*CONTACT PAIR`."""
        self._pairs.append(card)

    def read_tie(self, card: Card) -> None:
        """Take `*TIE`; those of sectors are taken with them."""
        for option in ("MULTISTAGE", "FLUIDCYCLIC", "FLUIDPERIODIC"):
            if option in card.options:
                raise InputError(f"{option} is no tie of faces")
        if not self._sectors.take(card):
            self._ties.append(card)

    def _leave(self, card: Card, why: str = "") -> None:
        self.left_out.append(f"*{card.name} of line {card.line}{why}")

    def _ideal(self, kinds: set[str]) -> dict[str, object]:
        (kind,) = ideals(kinds)
        thick = [real(one.thickness) for one in self.deck.sections.values() if one.thickness]
        return {"kind": kind} | ({"thickness": thick[0]} if thick and kind[:5] == "plane" else {})

    def _of_body(self, body: str) -> dict[str, object]:
        """Table of the material of a body; without a model where the deck has none that is read."""
        sheet = {"plane-stress"} == ideals(kind for kind, _ in self.deck.elements.values())
        finite = self._steps.finite and not sheet  # sheets are at small strain alone
        table, left = self._materials.table(body, finite)
        self.left_out += left
        return table

    def _contact(self, card: Card) -> Iterator[str]:
        name = card.options.get("INTERACTION", "").upper()
        for slave, *others in card.fields():
            if not others:
                self._leave(card, ": a surface with itself; see self_contact")
                continue
            sides = self._sides(card, slave, others[0])
            if not sides:
                continue
            more: dict[str, object] = {}
            if "ADJUST" in card.options:
                more["adjust"] = True
            more["friction"] = {"coefficients": self._friction.get(name, 0.0)}
            yield from _table("[[contact]]", sides | more)
            if name in self._penalty:
                stiff = f"normal = {{ penalty = {self._penalty[name]:g} }}"
                yield f'# nothing overlaps; as in the deck: method = "penalty", {stiff}'

    def _sides(self, card: Card, slave: str, master: str) -> dict[str, object]:
        """Slave and master of a pair; empty where one of them is not on one body."""
        found: dict[str, object] = {}
        for side, name in (("slave", slave), ("master", master)):
            groups = [group for group in self._named(name) if group in self.mesh.facets]
            if len(groups) != 1:
                said = f"on {' and '.join(groups)}" if groups else "no facet group"
                self._leave(card, f": {name.lower()} is {said}")
                return {}
            found[side] = groups[0]
        return found


#: Keyword in front of the first step -> what takes it.
_READERS: dict[str, Callable[[_Case, Card], None]] = {
    "HEADING": _Case.read_heading,
    "INITIALCONDITIONS": _Case.read_start,
    "SURFACEINTERACTION": _Case.read_interaction,
    "FRICTION": _Case.read_friction,
    "SURFACEBEHAVIOR": _Case.read_behaviour,
    "SURFACEBEHAVIOUR": _Case.read_behaviour,
    "AMPLITUDE": _Case.read_amplitude,
    "CONTACTPAIR": _Case.read_pair,
    "TIE": _Case.read_tie,
}


#: Option of `*AMPLITUDE` whose numbers are no times and values -> what to write instead.
_NO_TABLE = {
    "USER": 'see kind = "python" of [amplitude]',
    "SHIFTX": "shift its times",
    "SHIFTY": "shift its values",
}


def _amplitude(card: Card) -> dict[str, object]:
    """Table of a `*AMPLITUDE`."""
    if card.options.get("DEFINITION", "TABULAR").upper() != "TABULAR":
        raise InputError(f"DEFINITION={card.options['DEFINITION']} is not read; see [amplitude]")
    for option, instead in _NO_TABLE.items():
        if option in card.options:
            raise InputError(f"{option} is not read; {instead}")
    numbers = card.numbers().tolist()
    if not numbers or len(numbers) % 2:
        raise InputError(f"{len(numbers)} numbers, times and values are needed")
    table: dict[str, object] = {"kind": "table", "time": numbers[::2], "value": numbers[1::2]}
    total = card.options.get("TIME", "").upper().startswith("TOTAL")
    return table | ({"time_of": "total"} if total else {})


def _table(head: str, values: dict[str, object]) -> Iterator[str]:
    """Lines of a table."""
    yield ""
    yield head
    for key, value in values.items():
        yield f"{key} = {written(value)}"
