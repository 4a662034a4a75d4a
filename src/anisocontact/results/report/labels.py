"""Labels in the units of the user."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: The dimension at the end of a label, in brackets.
_BRACKETS = re.compile(r"\[[a-z/^0-9 ]+\]")
_WORD = re.compile(r"[a-z]+")


def in_units(text: str, units: Mapping[str, str]) -> str:
    """A text with units in the place of dimensions in brackets.

    Example:
        >>> in_units("moment [force length], area [length^2]", {"length": "mm", "force": "N"})
        'moment [N mm], area [mm^2]'
    """

    def unit(found: re.Match[str]) -> str:
        return _WORD.sub(lambda name: units.get(name[0], name[0]), found[0])

    return _BRACKETS.sub(unit, text)


def labelled(figure: Figure, units: Mapping[str, str]) -> Figure:
    """A figure whose texts have units in the place of dimensions."""
    from matplotlib.text import Text

    if not units:
        return figure  # to find all texts of a figure makes all its ticks
    for text in figure.findobj(Text):
        if isinstance(text, Text):
            text.set_text(in_units(text.get_text(), units))
    return figure
