"""Directions of a surface and the tensors that they carry."""

from anisocontact.anisotropy.fields import (
    BY_COORDINATES,
    DirectionField,
    from_callable,
    from_reparametrisation,
    make_directions,
    require_regular,
)
from anisocontact.anisotropy.tensors import (
    PLACEMENTS,
    components,
    oblique_principal,
    tensor,
    tensor_derivative,
)

__all__ = [
    "BY_COORDINATES",
    "PLACEMENTS",
    "DirectionField",
    "components",
    "from_callable",
    "from_reparametrisation",
    "make_directions",
    "oblique_principal",
    "require_regular",
    "tensor",
    "tensor_derivative",
]
