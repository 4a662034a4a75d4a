"""The files that a case file names, and whether they are what they were."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from anisocontact.base.errors import InputError
from anisocontact.base.python_file import imported_beside
from anisocontact.case.amplitudes import FunctionTable
from anisocontact.case.python_section import MaterialTable

if TYPE_CHECKING:
    from anisocontact.case.model import Case
    from anisocontact.case.read import CaseFile


def named(file: CaseFile) -> Iterator[tuple[str, str]]:
    """Place in the case file, and path as it is written there, of each file it names."""
    from anisocontact.mesh.deck import included_files  # a case is read without finite elements

    for place, given in _meshes(file.case):
        yield place, given
        path = file.resolve(given)
        for other in included_files(path) if path.suffix.lower() == ".inp" else []:
            beside = Path(given).parent / os.path.relpath(other, path.parent)
            yield place, beside.as_posix()
    for place, given in _programs(file.case):
        yield place, given
        path = file.resolve(given)
        for other in imported_beside(path):
            beside = Path(given).parent / other.relative_to(path.parent)
            yield place, beside.as_posix()


def _meshes(case: Case) -> Iterator[tuple[str, str]]:
    """Place and path of each mesh file."""
    if case.mesh.file is not None:
        yield "mesh.file", case.mesh.file
    for name, section in case.mesh.files.items():
        yield f"mesh.files.{name}.path", section.path


def _programs(case: Case) -> Iterator[tuple[str, str]]:
    """Place and path of each Python file."""
    for i, contact in enumerate(case.contact):
        if contact.python is not None:
            yield f"contact[{i}].python.file", contact.python.file
    for name, material in case.material.items():
        if isinstance(material, MaterialTable):
            yield f"material.{name}.file", material.file
    for name, amplitude in case.amplitude.items():
        if isinstance(amplitude, FunctionTable):
            yield f"amplitude.{name}.file", amplitude.file


def fingerprints(file: CaseFile) -> dict[str, str]:
    """What the files that a case names contain: meshes; laws, materials and amplitudes in Python.

    With a Python file come those beside it that it imports, with a deck those that it includes.

    Returns:
        SHA-256 of each file, by its path in the case file.

    Raises:
        InputError: A file is missing or cannot be read.
    """
    found: dict[str, str] = {}
    for place, given in named(file):
        if given in found:
            continue
        try:
            with file.resolve(given).open("rb") as opened:
                found[given] = hashlib.file_digest(opened, "sha256").hexdigest()
        except FileNotFoundError:
            raise InputError(f"'{given}' given, no such file", place) from None
        except OSError as error:
            raise InputError(f"'{given}' cannot be read: {error.strerror}", place) from None
    return found


def check_files(before: Mapping[str, str], file: CaseFile) -> None:
    """Refuse to go on with files that have become other ones.

    Args:
        before: Fingerprints of the run that is to go on.
        file: The case as it is now, with the same paths.

    Raises:
        InputError: Names the first file that has changed.
    """
    now = fingerprints(file)
    for place, given in named(file):
        if now[given] != before.get(given):
            text = f"'{given}' has changed since the run that is to go on began"
            raise InputError(f"{text}: run without --restart", place)
