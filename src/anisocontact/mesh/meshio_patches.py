"""What meshio is helped with: Nastran bulk data alone, and names in MED beyond ASCII."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.errors import InputError

#: Where the mesh of a Nastran file begins and ends.
BEGIN = re.compile(r"^\s*BEGIN\s+BULK.*$", re.IGNORECASE | re.MULTILINE)
END = re.compile(r"^\s*ENDDATA.*", re.IGNORECASE | re.MULTILINE)
#: What takes over another file.
INCLUDED = re.compile(r"^[ \t]*INCLUDE\b.*$", re.IGNORECASE | re.MULTILINE)


def nastran(path: Path) -> Any:
    """The mesh of a Nastran file, with or without control sections in front of its bulk data.

    Raises:
        InputError: Nodes are given in coordinate systems of their own, or other files are included.
    """
    from meshio.nastran import _nastran

    text = path.read_text("utf-8", errors="replace")
    begin = BEGIN.search(text)
    bulk = END.split(text[begin.end() :] if begin else text)[0]
    _check_included(bulk)
    _check_systems(bulk)
    return _nastran.read_buffer(io.StringIO(f"BEGIN BULK\n{bulk.strip()}\nENDDATA\n"))


def _check_included(bulk: str) -> None:
    """Refuse a file that includes others: meshio leaves out what is in them."""
    found = INCLUDED.search(bulk)
    if found:
        text = f"{found[0].strip()} is not read; put the lines of that file in its place"
        raise InputError(text)


def _check_systems(bulk: str) -> None:
    """Refuse nodes that are not in the basic coordinate system: meshio takes their numbers."""
    for line in bulk.splitlines():
        word = line[:8].split(",")[0].strip().upper()
        if word not in ("GRID", "GRID*", "GRDSET"):
            continue
        width = 16 if word == "GRID*" else 8
        fields = line.split(",") if "," in line else [line[:8], line[8:][:width], line[8 + width :]]
        system = (*fields, "", "")[2].split(",")[0][:width].strip()
        if system not in ("", "0"):
            name = f"{word} {fields[1].strip()}".strip()
            text = f"{name} is in the coordinate system {system}; the basic one is read"
            raise InputError(text)


@contextmanager
def names_of_med() -> Iterator[None]:
    """Let names of groups in MED files be UTF-8, of which meshio reads the ASCII part alone."""
    from meshio.med import _med

    before = getattr(_med, "_read_families", None)
    if before is None:
        yield
        return
    _med._read_families = _families
    try:
        yield
    finally:
        _med._read_families = before


def _families(families: Mapping[str, Any]) -> dict[int, list[str]]:
    """Names of the groups of each family of nodes or cells."""
    found = {}
    for family in families.values():
        names = np.asarray(family["GRO"]["NOM"][()]).view(np.uint8)
        found[int(family.attrs["NUM"])] = [
            bytes(row).split(b"\0")[0].decode("utf-8", errors="replace").strip() for row in names
        ]
    return found
