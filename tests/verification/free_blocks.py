"""Blocks that nothing holds but a contact."""

from __future__ import annotations

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem
from anisocontact.surfaces import make_surface

YOUNG, PENALTY = 1000.0, 4e4
CLAMP = {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}


def laws() -> tuple[NormalLaw, Adhesion, Friction]:
    """Penalties with friction."""
    return (
        NormalLaw(penalty=PENALTY),
        Adhesion(stiffness=(PENALTY, PENALTY)),
        Friction(coefficients=(0.3, 0.3)),
    )


def free_block(
    gap: float,
    unit: float = 1.0,
    stress: float = 1.0,
    along_y: float = PENALTY,
    evolution: str = "transport",
    **options: bool,
) -> Problem:
    """A block above a plane with no support at all."""
    boxes = {"block": BoxSpec((0, 0, gap * unit), (unit, unit, 0.5 * unit), (4, 4, 2))}
    model = build_box(boxes)
    own = (
        NormalLaw(penalty=PENALTY * stress / unit),
        Adhesion(
            stiffness=(PENALTY * stress / unit, along_y * stress / unit),
            directions=make_directions("constant", vector=(1, 0, 0)),
        ),
        Friction(coefficients=(0.3, 0.3)),
    )
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = Contact(
        model, "block.bottom", Interface(plane, *own, evolution=evolution), mortar=False
    )
    elastic = make_material("linear-elastic", E=YOUNG * stress, nu=0.3)
    return Problem(model, {"block": elastic}, [contact], **options)  # type: ignore[arg-type]
