"""Built-in shapes by name; a new one is a file here and a line in `_SHAPES`."""

from __future__ import annotations

from typing import Any

from anisocontact.base import registry
from anisocontact.base.registry import Entry
from anisocontact.base.typed import typed
from anisocontact.mesh.shapes.annulus import AnnulusSpec
from anisocontact.mesh.shapes.ball import BallSpec
from anisocontact.mesh.shapes.box import BoxSpec
from anisocontact.mesh.shapes.cylinder import CylinderSpec
from anisocontact.mesh.shapes.dome import DomeSpec
from anisocontact.mesh.shapes.plane import DiscSpec, RectangleSpec
from anisocontact.mesh.shapes.ring import RingSpec
from anisocontact.mesh.shapes.shape import Shape, checked_blocks

__all__ = [
    "AnnulusSpec",
    "BallSpec",
    "BoxSpec",
    "CylinderSpec",
    "DiscSpec",
    "DomeSpec",
    "RectangleSpec",
    "RingSpec",
    "Shape",
    "checked_blocks",
    "make_shape",
    "shapes",
]

_SHAPES: dict[str, type[Any]] = {
    s.entry.name: s
    for s in (
        *(BoxSpec, CylinderSpec, RingSpec, BallSpec, DomeSpec),
        *(RectangleSpec, DiscSpec, AnnulusSpec),
    )
}


def shapes() -> tuple[Entry, ...]:
    """The built-in shapes with their parameters.

    Returns:
        An entry for each.

    Example:
        >>> "ball" in [entry.name for entry in shapes()]
        True
    """
    return tuple(shape.entry for shape in _SHAPES.values())


@typed
def make_shape(name: str, *, cell: str = "", order: int = 1, **parameters: Any) -> Shape:
    """Built-in shape by name.

    Args:
        name: Name of a registered shape.
        cell: "hexahedron" or "tetrahedron" (six to each hexahedron), in the plane "quadrilateral"
            or "triangle"; the first of them if not given.
        order: Order of the displacement, 1 or 2; where the shape is curved cells of order 2 are.
        **parameters: Its parameters; angles in radian, or in degrees by `<name>_deg`.

    Returns:
        The shape.

    Raises:
        InputError: Unknown name or parameter, a parameter missing or out of range.

    Example:
        >>> make_shape("cylinder", radius=1.0, length=2.0, cells=(8, 1, 2)).order
        1
    """
    entry = registry.entry(shapes(), name, "shape")
    registry.values(entry, parameters)
    of_shape: dict[str, Any] = registry.in_radian(entry.parameters, parameters)
    if cell:
        of_shape["cell"] = cell
    shape: Shape = _SHAPES[name](order=order, **of_shape)
    checked_blocks(shape)
    return shape
