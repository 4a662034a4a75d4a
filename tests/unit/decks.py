"""A deck of one cube, and what becomes of decks, for the tests that need them."""

from __future__ import annotations

import tomllib
from pathlib import Path

from anisocontact.case.from_deck import case_of_deck
from anisocontact.mesh.deck_contents import Deck
from anisocontact.mesh.deck_reader import read_deck

CUBE = """*NODE
1, 0, 0, 0
2, 2, 0, 0
3, 2, 2, 0
4, 0, 2, 0
5, 0, 0, 2
6, 2, 0, 2
7, 2, 2, 2
8, 0, 2, 2
*ELEMENT, TYPE=C3D8R
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=Set-1, GENERATE
1, 8, 1
*ELSET, ELSET=Set-1
1
*SURFACE, NAME=Top
Set-1, S2
*SOLID SECTION, ELSET=Set-1, MATERIAL=M
,
"""


def case_of(tmp_path: Path, text: str) -> tuple[dict, list[str]]:
    """The case of a deck, and the lines on what was left out."""
    path = tmp_path / "deck.inp"
    path.write_text(text)
    case, left = case_of_deck(path, tmp_path / "case.toml")
    return tomllib.loads(case), left


def read(tmp_path: Path, text: str) -> Deck:
    """What a deck holds."""
    path = tmp_path / "deck.inp"
    path.write_text(text)
    return read_deck(path)
