"""Materials of the bodies and the forces inside them."""

from anisocontact.bulk.hyperelastic import (
    NeoHookean,
    NeoHookeanIncompressible,
    StVenantKirchhoff,
    UserEnergy,
    UserStress,
    cauchy_stress,
    deformation_gradient,
)
from anisocontact.bulk.library import make_material, materials
from anisocontact.bulk.linear import LinearBulk
from anisocontact.bulk.materials import LinearElastic, Material
from anisocontact.bulk.nonlinear import NonlinearBulk

__all__ = [
    "LinearBulk",
    "LinearElastic",
    "Material",
    "NeoHookean",
    "NeoHookeanIncompressible",
    "NonlinearBulk",
    "StVenantKirchhoff",
    "UserEnergy",
    "UserStress",
    "cauchy_stress",
    "deformation_gradient",
    "make_material",
    "materials",
]
