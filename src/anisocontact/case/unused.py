"""Surfaces, amplitudes and paths of a case file that nothing in it names."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from typing import Any

#: Tables of what is named elsewhere, and what would name it.
_DEFINED = {
    "surface": "no contact has it as its master, so that bodies pass through it",
    "amplitude": "no value of a step follows it",
    "path": "nothing is moved along it",
}


def unused(text: str) -> Iterator[str]:
    r"""What a case file defines and does not name again, a line each.

    Args:
        text: The file, TOML.

    Example:
        >>> list(unused('[amplitude.up]\nkind = "ramp"'))
        ['amplitude.up: no value of a step follows it']
    """
    tables = tomllib.loads(text)
    named = set(_texts([tables[name] for name in tables.keys() - _DEFINED.keys()]))
    for kind, why in _DEFINED.items():
        for name in tables.get(kind, {}):
            if name not in named:
                yield f"{kind}.{name}: {why}"


def _texts(value: Any) -> Iterator[str]:
    """All texts in nested tables and lists."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for part in value.values() if isinstance(value, dict) else value:
            yield from _texts(part)
