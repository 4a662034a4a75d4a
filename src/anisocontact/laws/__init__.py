"""Normal law, adhesion and friction with their sliding rules, and the adhesion domain."""

from typing import Any

from anisocontact.base.renamed import renamed
from anisocontact.laws.core import (
    SIDES,
    Adhesion,
    CarriedDirections,
    Friction,
    Named,
    NormalLaw,
    carried_directions,
)
from anisocontact.laws.domain import (
    Ellipse,
    Strip,
    adhesion_domain,
    domain_from_tensors,
    force_domain,
)
from anisocontact.laws.domain_figures import draw_force_plane, draw_tangent_plane
from anisocontact.laws.numerical_adhesion import EXPLICIT, numerical_adhesion
from anisocontact.laws.sliding import Slide, slide

__all__ = [
    "EXPLICIT",
    "SIDES",
    "Adhesion",
    "CarriedDirections",
    "Ellipse",
    "Friction",
    "Named",
    "NormalLaw",
    "Slide",
    "Strip",
    "adhesion_domain",
    "carried_directions",
    "domain_from_tensors",
    "draw_force_plane",
    "draw_tangent_plane",
    "force_domain",
    "numerical_adhesion",
    "slide",
]


def __getattr__(name: str) -> Any:
    return renamed(__name__, name)
