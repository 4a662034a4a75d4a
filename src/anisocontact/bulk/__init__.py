"""Materials of the bodies and the forces inside them."""

from anisocontact.bulk.history import Before, BodyHistory, HistoryMaterial
from anisocontact.bulk.hyperelastic import (
    NeoHookean,
    NeoHookeanIncompressible,
    StVenantKirchhoff,
    UserEnergy,
    UserStress,
    cauchy_stress,
    deformation_gradient,
)
from anisocontact.bulk.library import make_material, materials, register_material
from anisocontact.bulk.linear import LinearBulk
from anisocontact.bulk.materials import LinearElastic, Material
from anisocontact.bulk.nonlinear import NonlinearBulk
from anisocontact.bulk.orthotropic import Orthotropic, TransverselyIsotropic
from anisocontact.bulk.rubber import MooneyRivlin, Yeoh

__all__ = [
    "Before",
    "BodyHistory",
    "HistoryMaterial",
    "LinearBulk",
    "LinearElastic",
    "Material",
    "MooneyRivlin",
    "NeoHookean",
    "NeoHookeanIncompressible",
    "NonlinearBulk",
    "Orthotropic",
    "StVenantKirchhoff",
    "TransverselyIsotropic",
    "UserEnergy",
    "UserStress",
    "Yeoh",
    "cauchy_stress",
    "deformation_gradient",
    "make_material",
    "materials",
    "register_material",
]
