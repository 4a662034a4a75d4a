"""Public names of before and what stands for them today, for one more version."""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Callable
from functools import partial
from operator import attrgetter
from typing import Any, NamedTuple

#: Names of before and those of today, in the packages that have them.
RENAMED = {
    "Before": "PreviousState",
    "Carried": "CarriedDirections",
    "Course": "LoadCurve",
    "Expanding": "ThermalExpansion",
    "bare": "without_expansion",
    "carried": "carried_directions",
    "courses_of": "load_curves",
}


class Replaced(NamedTuple):
    """A name of before that is no other name of the same today.

    Attributes:
        package: The package that had it.
        today: What a script writes instead.
        made: Takes this package and the arguments of before, and makes what these made.
    """

    package: str
    today: str
    made: Callable[..., Any]


def _contact(package: Any, *args: Any, **options: Any) -> Any:
    return package.Contact(*args, **options)


def _self_contact(package: Any, model: Any, group: str, *, law: Any, **options: Any) -> Any:
    return package.Contact(model, group, group, law, self_contact=True, **options)


def _pair_law(
    package: Any, normal: Any, adhesion: Any, friction: Any, *, evolution: str = "transport"
) -> Any:
    made = package.ContactLaw(normal, adhesion, friction, evolution=evolution)
    made.check_meshed()
    return made


def _python_pair_law(
    package: Any, normal: Any, law: Any, *, directions: Any = None, directions_on: str = "master"
) -> Any:
    own = package.PythonLaw(law, directions=directions, directions_on=directions_on)
    made = package.ContactLaw(normal, own)
    made.check_meshed()
    return made


def _python_interface(
    package: Any,
    surface: Any,
    normal: Any,
    law: Any,
    *,
    directions: Any = None,
    threads: int | None = None,
) -> Any:
    own = package.PythonLaw(law, directions=directions)
    return package.Interface(surface, normal, own, threads=threads)


_CONTACT, _INTERFACE = "anisocontact.contact", "anisocontact.interface"
#: Names of before that are made otherwise today.
REPLACED = {
    "FacetContact": Replaced(
        _CONTACT,
        'Contact(model, slave, "body.group", law, mortar=False)',
        partial(_contact, mortar=False),
    ),
    "TwoHalfPass": Replaced(_CONTACT, "Contact(..., mortar=True)", partial(_contact, mortar=True)),
    "SelfContact": Replaced(
        _CONTACT, "Contact(model, group, group, law, self_contact=True)", _self_contact
    ),
    "AnyContact": Replaced(_CONTACT, "Contact", _contact),
    "MeshedContact": Replaced(_CONTACT, "Contact", _contact),
    "PairLaw": Replaced(_INTERFACE, "ContactLaw", _pair_law),
    "PythonInterface": Replaced(_INTERFACE, "Interface with a PythonLaw", _python_interface),
    "PythonPairLaw": Replaced(_INTERFACE, "ContactLaw with a PythonLaw", _python_pair_law),
}


def renamed(module: str, name: str) -> Any:
    """What a name of before stands for, with a `DeprecationWarning`.

    Args:
        module: The package that is asked for it.
        name: The name.

    Raises:
        AttributeError: The package has not had it.

    Example:
        >>> import warnings
        >>> with warnings.catch_warnings(record=True) as told:
        ...     warnings.simplefilter("always")
        ...     found = renamed("anisocontact.base.load_curve", "Course")
        >>> found.__name__, str(told[0].message)
        ('LoadCurve', 'Course is now LoadCurve')
    """
    package = importlib.import_module(module)
    replaced = REPLACED.get(name)
    if replaced is not None and replaced.package == module:
        today, found = replaced.today, partial(replaced.made, package)
    elif (today := RENAMED.get(name, "")) in dir(package):
        found = getattr(package, today)
    else:
        raise AttributeError(f"module {module!r} has no attribute {name!r}")
    warnings.warn(f"{name} is now {today}", DeprecationWarning, stacklevel=3)
    return found


class RenamedAttribute:
    """An attribute or method of a class by its name of before, with a `DeprecationWarning`.

    Args:
        today: Its name today, dotted where it is one of an attribute.

    Example:
        >>> import warnings
        >>> class Sphere:
        ...     radius = 2.0
        ...     size = RenamedAttribute("radius")
        >>> with warnings.catch_warnings(record=True) as told:
        ...     warnings.simplefilter("always")
        ...     found = Sphere().size
        >>> found, str(told[0].message)
        (2.0, 'Sphere.size is now Sphere.radius')
    """

    def __init__(self, today: str) -> None:
        self._today, self._before = today, ""

    def __set_name__(self, owner: type, name: str) -> None:
        self._before = name

    def __get__(self, instance: Any, owner: type) -> Any:
        if instance is None:
            return self
        text = f"{owner.__name__}.{self._before} is now {owner.__name__}.{self._today}"
        warnings.warn(text, DeprecationWarning, stacklevel=2)
        return attrgetter(self._today)(instance)
