"""Materials of the bodies and the forces inside them."""

from typing import Any

from anisocontact.base.renamed import renamed
from anisocontact.bulk.at_points import AtPoints
from anisocontact.bulk.expansion import Heated, ThermalExpansion, without_expansion
from anisocontact.bulk.history import BodyHistory, HistoryMaterial, PreviousState
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
from anisocontact.bulk.mandel import from_mandel, slope_from_mandel, to_mandel
from anisocontact.bulk.materials import (
    LinearElastic,
    LinearElasticIncompressible,
    Material,
    small_strain,
)
from anisocontact.bulk.nonlinear import NonlinearBulk, cell_size
from anisocontact.bulk.ogden import Ogden
from anisocontact.bulk.orthotropic import Orthotropic, TransverselyIsotropic
from anisocontact.bulk.plasticity import PLASTIC_STRAIN, Hill, Plastic
from anisocontact.bulk.point_law import (
    BodyPoints,
    ElasticVolume,
    PointLaw,
    PointResult,
    PointState,
)
from anisocontact.bulk.rubber import MooneyRivlin, Yeoh
from anisocontact.bulk.user_law import UserLaw, user_material
from anisocontact.bulk.viscoelastic import Viscoelastic
from anisocontact.bulk.volume import Volume

__all__ = [
    "PLASTIC_STRAIN",
    "AtPoints",
    "BodyHistory",
    "BodyPoints",
    "ElasticVolume",
    "Heated",
    "Hill",
    "HistoryMaterial",
    "LinearBulk",
    "LinearElastic",
    "LinearElasticIncompressible",
    "Material",
    "MooneyRivlin",
    "NeoHookean",
    "NeoHookeanIncompressible",
    "NonlinearBulk",
    "Ogden",
    "Orthotropic",
    "Plastic",
    "PointLaw",
    "PointResult",
    "PointState",
    "PreviousState",
    "StVenantKirchhoff",
    "ThermalExpansion",
    "TransverselyIsotropic",
    "UserEnergy",
    "UserLaw",
    "UserStress",
    "Viscoelastic",
    "Volume",
    "Yeoh",
    "cauchy_stress",
    "cell_size",
    "deformation_gradient",
    "from_mandel",
    "make_material",
    "materials",
    "register_material",
    "slope_from_mandel",
    "small_strain",
    "to_mandel",
    "user_material",
    "without_expansion",
]


def __getattr__(name: str) -> Any:
    return renamed(__name__, name)
