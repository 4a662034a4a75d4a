"""Surfaces of a master: analytic ones, facets of a mesh, their geometry and closest points."""

from anisocontact.base.array_types import Floats
from anisocontact.base.arrays import points
from anisocontact.surfaces.analytic import (
    PROJECTION_STATUS,
    Jet,
    Projection,
    Surface,
    default_threads,
    make_surface,
    threads_of,
)
from anisocontact.surfaces.facet_blocks import TOPOLOGIES
from anisocontact.surfaces.facets import (
    FACET_STATUS,
    FEATURES,
    FacetProjections,
    FacetSets,
    FacetSurface,
    outward_flips,
)
from anisocontact.surfaces.geometry import Geometry, GeometryDerivatives
from anisocontact.surfaces.kinematics import (
    ConvectiveRate,
    convective_velocity,
    relative_variation,
)
from anisocontact.surfaces.orientation import Orientation
from anisocontact.surfaces.smooth_facets import SmoothSurface

__all__ = [
    "FACET_STATUS",
    "FEATURES",
    "PROJECTION_STATUS",
    "TOPOLOGIES",
    "ConvectiveRate",
    "FacetProjections",
    "FacetSets",
    "FacetSurface",
    "Floats",
    "Geometry",
    "GeometryDerivatives",
    "Jet",
    "Orientation",
    "Projection",
    "SmoothSurface",
    "Surface",
    "convective_velocity",
    "default_threads",
    "make_surface",
    "outward_flips",
    "points",
    "relative_variation",
    "threads_of",
]
