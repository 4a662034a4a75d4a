"""Direction fields: two axes in the tangent plane at every point of a surface."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact import _core, registry
from anisocontact.errors import InputError
from anisocontact.surfaces import Floats, Surface, points


class DirectionField:
    """A direction field; make one with `make_directions`.

    Args:
        name: Name in the registry.
        core: The field of the core.
    """

    def __init__(self, name: str, core: _core.Field) -> None:
        self.name = name
        self.core = core

    def __repr__(self) -> str:
        return f"DirectionField({self.name!r})"

    def axes(
        self, surface: Surface, xi: npt.ArrayLike
    ) -> tuple[Floats, npt.NDArray[np.bool_]]:
        """Unit axes at coordinates of a surface.

        Args:
            surface: The surface.
            xi: Coordinates, (n, 2).

        Returns:
            Axes e_1, e_2, (n, 2, 3), and whether the field is regular there, (n,).
        """
        r = self.core.axes(surface.core, points(xi, 2, "xi"))
        return r["e"], r["valid"]


def make_directions(name: str, **parameters: object) -> DirectionField:
    """A direction field of the registry.

    Args:
        name: Name in `registry.direction_fields()`.
        **parameters: Its parameters; angles in radians.

    Returns:
        The field.

    Raises:
        InputError: Unknown name or parameter, or a value out of range.

    Example:
        >>> marks = make_directions("constant", vector=(1, 0, 0), angle=np.pi / 2)
        >>> from anisocontact.surfaces import make_surface
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> np.round(marks.axes(plane, [[0, 0]])[0][0], 12).tolist()
        [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    """
    e = registry.entry(registry.direction_fields(), name, "kind")
    v = registry.values(e, parameters)
    try:
        return DirectionField(name, _core.Field(name, v))
    except ValueError as error:
        raise InputError(f"direction field {name!r}: {error}") from None
