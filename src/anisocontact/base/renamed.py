"""Public names that have been replaced by standard terms, for one more version."""

from __future__ import annotations

import importlib
import warnings
from typing import Any

#: Names of before and those of today, in the packages that have them.
RENAMED = {
    "Course": "LoadCurve",
    "Expanding": "ThermalExpansion",
    "bare": "without_expansion",
    "courses_of": "load_curves",
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
        ...     found = renamed("anisocontact.base.course", "Course")
        >>> found.__name__, str(told[0].message)
        ('LoadCurve', 'Course is now LoadCurve')
    """
    package = importlib.import_module(module)
    today = RENAMED.get(name, "")
    if today not in dir(package):
        raise AttributeError(f"module {module!r} has no attribute {name!r}")
    warnings.warn(f"{name} is now {today}", DeprecationWarning, stacklevel=3)
    return getattr(package, today)
