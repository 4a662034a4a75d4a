"""Materials of a case file that are classes in a Python file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from anisocontact.base.errors import InputError, within
from anisocontact.case import objects
from anisocontact.case.law_file import object_of
from anisocontact.case.python_section import MaterialSection, MaterialTable

if TYPE_CHECKING:
    from anisocontact.bulk import Material


class _UnreadMaterial:
    """Stands for a material that has not been read."""

    young = 1.0

    def piola(self, gradient: Any) -> Any:
        return gradient


def material_of(
    section: MaterialSection, resolve: Callable[[str], Path], place: str, execute: bool = True
) -> Material:
    """The material of a table, registered or in a Python file, which is run.

    Args:
        section: The table.
        resolve: From a path in the case file to where that is.
        place: Path of the table, for messages.
        execute: Whether the file is run; without it what stands in is good for checks alone.

    Raises:
        InputError: What the table says is wrong, or the file, or what is in it.
    """
    from anisocontact.bulk import ThermalExpansion

    if isinstance(section, MaterialTable):
        made = _own(section, resolve, place, execute)
    else:
        made = objects.material(section, place)
    return ThermalExpansion(made, section.expansion) if section.expansion else made


def _own(
    section: MaterialTable, resolve: Callable[[str], Path], place: str, execute: bool
) -> Material:
    from anisocontact.bulk import user_material

    with within(place):
        made = object_of(section, resolve, execute)
        try:
            return user_material(made or _UnreadMaterial())
        except InputError as error:
            raise InputError(str(error), "law") from None
