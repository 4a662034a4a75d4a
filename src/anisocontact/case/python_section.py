"""Tables that name a law of a contact, or a material, in a Python file."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from anisocontact.base.registry import Entry
from anisocontact.case.bodies import Weighed
from anisocontact.case.quantity import number
from anisocontact.case.section import Section
from anisocontact.laws import SIDES

#: The entry of a material in a Python file.
MATERIAL = Entry(
    "python",
    "material",
    "a class in a Python file of yours: an energy, a stress, or a law of points with a history",
    (),
)


class PythonClass(Section):
    """A class in a Python file."""

    file: str = Field(
        description="Python file, from the folder of the case file on; `run` and `check` run it "
        "with all rights of whoever calls them, `check --no-python` does not"
    )
    law: str = Field(description="name of the class in it")
    arguments: dict[str, Any] = Field(
        default_factory=dict, description="what the class is made with, by name"
    )


class PythonSection(PythonClass):
    """A tangential law of your own, a class in a Python file, in place of adhesion and friction."""

    isotropic: Annotated[
        bool,
        number("flag", "1", "whether the law is the same in all directions, so that it needs none"),
    ] = False
    directions: Any = None
    directions_on: str = SIDES[0]


class MaterialSection(Weighed):
    """A material, with what all of them may have."""

    expansion: Annotated[
        float,
        number("scalar", "1/temperature", "coefficient of linear thermal expansion"),
    ] = 0.0


class MaterialTable(PythonClass, MaterialSection):
    """A material in a Python file."""
