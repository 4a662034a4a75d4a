"""Tangential laws of a case file that are classes in a Python file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from anisocontact.base.errors import InputError, within
from anisocontact.base.given_file import why_no_file
from anisocontact.base.python_file import module_of, where_failed
from anisocontact.case import objects
from anisocontact.case.model import ContactSection
from anisocontact.case.section import near
from anisocontact.interface import (
    ContactLaw,
    LawKinematics,
    LawResult,
    LawState,
    PythonLaw,
    TangentialLaw,
)
from anisocontact.interface.tangential_law import check_own_variables
from anisocontact.laws import SIDES


class _UnreadLaw:
    """Stands for a law that has not been read: it gives no traction."""

    internal = 0

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        n = len(kinematics.pressure)
        none, block = np.zeros((n, 2)), np.zeros((n, 2, 2))
        at = none[:, 0]
        return LawResult(none, none, block, none, block, block, state.internal, at, at)


def contact_law(
    section: ContactSection, place: str, auto: float = 1.0, law: TangentialLaw | None = None
) -> ContactLaw:
    """The law of a table, of the core or written in Python.

    Args:
        section: The table.
        place: Its path, for messages.
        auto: Stiffness where the table says "auto" [stress/length].
        law: The law in Python; without one what it stands in is good for checks alone.

    Raises:
        InputError: What the table says does not go together.
    """
    if section.python is None:
        return objects.contact_law(section, place, auto, meshed=section.meshed)
    with within(place):
        given = section.python
        if given.directions is None and not given.isotropic:
            raise InputError("missing; needed unless isotropic = true", "python.directions")
        if given.directions_on != SIDES[0] and not section.meshed:
            text = f'"{given.directions_on}" given, a rigid master needs "{SIDES[0]}"'
            raise InputError(text, "python.directions_on")
        along = objects.directions(given.directions, "python.directions")
        own = PythonLaw(law or _UnreadLaw(), directions=along, directions_on=given.directions_on)
        made = ContactLaw(objects.normal_law(section, auto), own, evolution=section.evolution)
        if section.meshed:
            made.check_meshed()
        return made


def law_of(
    section: ContactSection, resolve: Callable[[str], Path], place: str, execute: bool = True
) -> TangentialLaw | None:
    """The law of a table, read from its file and made.

    The file is run, with all rights of whoever runs the program.

    Args:
        section: The table.
        resolve: From a path in the case file to where that is.
        place: Path of the table, for messages.
        execute: Whether the file is run; if not, it only has to be there.

    Returns:
        The law; None if the table names laws of the core, or its file is not run.

    Raises:
        InputError: No such file or class, a file that cannot be run, arguments that the class
            refuses, or an object that is no law.
    """
    given = section.python
    if given is None:
        return None
    with within(f"{place}.python"):
        law: TangentialLaw | None = object_of(given, resolve, execute)
        if law is not None:
            _check_law(law, given.law)
        return law


def object_of(given: Any, resolve: Callable[[str], Path], execute: bool = True) -> Any:
    """The object of a table that names a class in a Python file; None if that is not to be run.

    Args:
        given: The table, with `file`, `law` (the class) and `arguments`.
        resolve: From a path in the case file to where that is.
        execute: Whether the file is run; if not, it only has to be there.

    Raises:
        InputError: No such file or class, a file that cannot be run, or arguments that the class
            refuses.
    """
    module = module_at(resolve, given.file, execute)
    if module is None:
        return None
    kind = getattr(module, given.law, None)
    if not isinstance(kind, type):
        classes = {n: k for n, k in vars(module).items() if isinstance(k, type)}
        known = [n for n, k in classes.items() if k.__module__ == module.__name__]
        text = f"\"{given.law}\" given, no such class in '{given.file}'; "
        raise InputError(text + near(given.law, known), "law")
    try:
        return kind(**given.arguments)
    except (Exception, SystemExit) as error:
        text = f"{given.law} refuses them: {where_failed(error)}"
        raise InputError(text, "arguments") from None


def module_at(
    resolve: Callable[[str], Path], given: str, execute: bool = True
) -> ModuleType | None:
    """The module of a Python file that a case names; None if it is not to be run.

    Args:
        resolve: From a path in the case file to where that is.
        given: The path as it is written.
        execute: Whether the file is run; if not, it only has to be there.

    Raises:
        InputError: No such file, or one that cannot be run.
    """
    path = resolve(given)
    if why_no_file(path):
        raise InputError(f"'{given}' given, no such file", "file")
    if not execute:
        return None
    if path.suffix != ".py":
        raise InputError(f"'{given}' given, a Python file needed, '.py'", "file")
    try:
        return module_of(path)
    except (Exception, SystemExit) as error:
        raise InputError(f"'{given}' cannot be run: {where_failed(error)}", "file") from None


def _check_law(law: Any, name: str) -> None:
    if not callable(getattr(law, "update", None)):
        raise InputError(f"{name} has no method update(state, kinematics)", "law")
    check_own_variables(law)
