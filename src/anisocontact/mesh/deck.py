"""Lines of Abaqus and CalculiX input: keywords, their options, and the data below them.

Format: the keyword reference of either; names and keywords do not tell small letters from capitals,
`**` begins a comment, and a keyword line that ends with a comma goes on in the next.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.given_file import why_no_file

#: How deep files may include others.
DEPTH = 10
#: Keywords whose data may stand in a file of their own, `INPUT`.
_WITH_FILES = ("NODE", "ELEMENT", "NSET", "ELSET")


@dataclass(frozen=True)
class Card:
    """A keyword with what belongs to it.

    Attributes:
        name: The keyword in capitals, without blanks: `SOLIDSECTION`.
        options: Option in capitals -> value as written; empty where it has none.
        data: The lines below it, without comments.
        line: Number of its line in its file, for messages.
    """

    name: str
    options: dict[str, str]
    data: tuple[str, ...]
    line: int

    def option(self, name: str) -> str:
        """Value of an option that has to be there.

        Raises:
            InputError: It is not.
        """
        if not self.options.get(name):
            raise InputError(f"line {self.line}: *{self.name} needs the option {name}")
        return self.options[name]

    def fields(self) -> Iterator[list[str]]:
        """The entries of each line of data, without blanks, quotes and what is left empty."""
        for entries in self.rows():
            yield [entry for entry in entries if entry]

    def rows(self) -> Iterator[list[str]]:
        """The entries of each line of data at their places, empty ones behind the last left out.

        Example:
            >>> list(Card("BOUNDARY", {}, ('"the head", 3, , 0.1,',), 1).rows())
            [['the head', '3', '', '0.1']]
        """
        for line in self.data:
            entries = [entry.strip().strip('"') for entry in line.split(",")]
            while entries and not entries[-1]:
                entries.pop()
            yield entries

    def numbers(self) -> Floats:
        """All numbers of the data, one after the other.

        Raises:
            InputError: Something else is among them.
        """
        words = ",".join(self.data).replace(",", " ").split()
        try:
            found = np.array(words, dtype=np.float64)
            if np.isfinite(found).all():
                return found
        except ValueError:
            pass
        try:
            return np.array([real(word) for word in words])
        except ValueError:
            raise InputError(
                f"line {self.line}: the data of *{self.name} are not all numbers"
            ) from None


def real(text: str) -> float:
    """A number as Fortran reads it too.

    Raises:
        ValueError: It is none, or beyond what a number can be.

    Example:
        >>> real("1.5d-3")
        0.0015
    """
    found = float(text.replace("d", "e").replace("D", "e"))
    if not math.isfinite(found):
        raise ValueError(text)
    return found


def read_cards(path: Path, depth: int = 0) -> list[Card]:
    """The cards of a file and of those that it includes, in their order.

    Args:
        path: The file.
        depth: How many files have included this one.

    Raises:
        InputError: It does not begin with a keyword, or an included file is missing.
        OSError: It cannot be read.
    """
    cards: list[Card] = []
    for card in _own_cards(path):
        other = _included(path, card)
        if other is None:
            cards.append(card)
            continue
        if depth == DEPTH:
            raise InputError(f"line {card.line}: more than {DEPTH} files include each other")
        if what := why_no_file(other):
            raise InputError(f"line {card.line}: the included file {str(other)!r} {what}")
        if card.name == "INCLUDE":
            cards += read_cards(other, depth + 1)
        else:
            given = (line for _, line in _lines(other))
            cards.append(replace(card, data=(*given, *card.data)))
    return cards


def included_files(path: Path) -> list[Path]:
    """Files that a deck includes, and those that these include, each once.

    Args:
        path: The deck; what is wrong with it is left to who reads it.
    """
    found = [path]
    for file in found:
        try:
            others = [other for c in _own_cards(file) if (other := _included(file, c))]
        except (InputError, OSError):
            continue
        found += [one for one in dict.fromkeys(others) if one not in found and one.is_file()]
    return found[1:]


def _included(path: Path, card: Card) -> Path | None:
    """The file that a card of a deck includes, or has its data in; None if there is none."""
    if card.name != "INCLUDE" and not (card.name in _WITH_FILES and card.options.get("INPUT")):
        return None
    return path.parent / card.option("INPUT").replace("\\", "/")


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Lines of a file with their numbers, without comments and what is blank."""
    raw = path.read_bytes()
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:  # names of editors that write one byte a letter stay apart
        text = raw.decode("latin-1")
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip() and not line.strip().startswith("**"):
            yield number, line.strip()


def _own_cards(path: Path) -> Iterator[Card]:
    """The cards of a file, those that include others as they stand."""
    head: tuple[str, int] | None = None
    data: list[str] = []
    for number, line in _lines(path):
        if head is not None and not data and head[0].endswith(","):
            head = (head[0] + line, head[1])
        elif line.startswith("*"):
            if head is not None:
                yield _card(*head, data)
            head, data = (line, number), []
        elif head is None:
            raise InputError(f"line {number}: data in front of the first keyword")
        else:
            data.append(line)
    if head is not None:
        yield _card(*head, data)


def _card(text: str, number: int, data: list[str]) -> Card:
    """A card from its head and the lines below it."""
    keyword, *rest = text[1:].split(",")
    options = {}
    for option in rest:
        name, _, value = option.partition("=")
        if name.strip():
            options["".join(name.split()).upper()] = value.strip().strip('"')
    return Card("".join(keyword.split()).upper(), options, tuple(data), number)
