"""Reads an input file of Abaqus or CalculiX card by card, parts, instances and steps apart."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from anisocontact.base.errors import InputError
from anisocontact.mesh.deck import Card, read_cards
from anisocontact.mesh.deck_contents import Deck
from anisocontact.mesh.deck_generated import GENERATORS, NOT_READ
from anisocontact.mesh.deck_instances import begun, numbered, own_numbers, place

#: Keywords of a part that every instance of it has under its own names.
OF_PARTS = ("RIGIDBODY", "COUPLING", "KINEMATIC", "DISTRIBUTING", "TIE", "EQUATION", "MPC")


def read_deck(path: Path) -> Deck:
    """What is in an input file, parts where their instances are.

    Raises:
        InputError: As of `read_inp`.
        OSError: It cannot be read.
    """
    cards = read_cards(path)
    reader = _Reader(Deck(own=own_numbers(cards)))
    for card in cards:
        try:
            reader.take(card)
        except InputError as error:
            raise InputError(f"line {card.line}: *{card.name}: {error}") from None
        except (ValueError, IndexError):
            raise InputError(f"line {card.line}: *{card.name}: its data cannot be read") from None
    return reader.whole


class _Reader:
    """Takes the cards of a file one after the other.

    Args:
        whole: What is filled.
    """

    def __init__(self, whole: Deck) -> None:
        self.whole = self._current = whole
        self._parts: dict[str, Deck] = {}
        self._instance: Card | None = None
        self._step = 0

    def take(self, card: Card) -> None:
        """Take a card.

        Raises:
            InputError: It cannot be read.
        """
        if card.name in NOT_READ:
            raise InputError("is not read; write nodes and elements out")
        card = numbered(card, self.whole.offsets)
        if card.name == "PART":
            self._current = self._parts.setdefault(card.option("NAME").upper(), Deck())
        elif card.name == "INSTANCE":
            self._instance, self._current = card, begun(card, self._parts)
        elif card.name in ("ENDPART", "ENDINSTANCE"):
            if self._instance is not None:
                place(self.whole, self._instance, self._current)
            self._instance, self._current = None, self.whole
        elif card.name in _READERS:
            _READERS[card.name](self._current, card)
        elif card.name in GENERATORS:
            GENERATORS[card.name](self._current, card)
        else:
            self._step += card.name == "STEP"
            inside = card.name in OF_PARTS and self._current is not self.whole
            (self._current if inside else self.whole).add_card(self._step, card)


_READERS: dict[str, Callable[[Deck, Card], None]] = {
    "NODE": Deck.read_nodes,
    "ELEMENT": Deck.read_elements,
    "NSET": Deck.read_node_set,
    "ELSET": Deck.read_element_set,
    "SURFACE": Deck.read_surface,
    "SOLIDSECTION": Deck.read_section,
}
