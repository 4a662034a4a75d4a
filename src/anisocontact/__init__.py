"""Frictional contact of surfaces that have a direction: anisotropic adhesion and friction.

All that scripts use has its name here; what it is made of is imported when it is asked for.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from anisocontact.base import import_hooks
from anisocontact.base.errors import InputError, ModelWarning

if TYPE_CHECKING:
    from anisocontact.anisotropy import *  # noqa: F403
    from anisocontact.bulk import *  # noqa: F403
    from anisocontact.contact import *  # noqa: F403
    from anisocontact.interface import *  # noqa: F403
    from anisocontact.laws import *  # noqa: F403
    from anisocontact.mesh import *  # noqa: F403
    from anisocontact.point import *  # noqa: F403
    from anisocontact.results import *  # noqa: F403
    from anisocontact.rigid import *  # noqa: F403
    from anisocontact.solver import *  # type: ignore[assignment]  # noqa: F403
    from anisocontact.surfaces import *  # noqa: F403

    __version__: str

#: Package -> what scripts use of it. The same names have other meanings nowhere.
_PUBLIC = {
    "surfaces": "FacetSurface Geometry Projection SmoothSurface Surface make_surface",
    "anisotropy": "DirectionField from_callable from_reparametrisation make_directions",
    "laws": "Adhesion Friction NormalLaw adhesion_domain force_domain slide",
    "interface": "AdhesionAndFriction Augmentation ContactLaw Interface LawInSeries LawKinematics "
    "LawResult LawState PythonLaw Response State",
    "point": "DeadLoad DraggingSpring Group History PrescribedPath Push drive",
    "results": "Results SlavePoints recorded register_quantity",
    "rigid": "MovingSurface Pose RigidBody",
    "mesh": "Axisymmetric Body MeshFile Model Placement PlaneStrain PlaneStress Rotation WholeMesh "
    "build_mesh make_selector make_shape node_near nodes_along register_reader register_selector "
    "whole_reader",
    "bulk": "Hill LinearElastic LinearElasticIncompressible MooneyRivlin NeoHookean "
    "NeoHookeanIncompressible Ogden Orthotropic Plastic PointLaw PointResult PointState "
    "StVenantKirchhoff ThermalExpansion TransverselyIsotropic UserEnergy UserStress Viscoelastic "
    "Yeoh cauchy_stress "
    "deformation_gradient from_mandel make_material register_material slope_from_mandel "
    "small_strain to_mandel",
    "contact": "Contact close_gaps facet_directions facet_size",
    "solver": "Accepted Amplitude ContactProblem CoupledFace CyclicSymmetry Cylindrical "
    "ElasticSupport Limits LoadCurve Newton Path Problem Solver Spring Step Strategy Tie Turn "
    "Until load_curves make_amplitude make_path register_amplitude register_path register_strategy",
}
_PACKAGE_OF = {name: package for package, names in _PUBLIC.items() for name in names.split()}

__all__ = ["InputError", "ModelWarning", "__version__", *_PACKAGE_OF]  # noqa: PLE0604 (strings, of the table)


def __getattr__(name: str) -> Any:
    """A name of the table, or the version."""
    if name == "__version__":
        from importlib.metadata import version

        found: Any = version("anisocontact")
    elif name in _PACKAGE_OF:
        found = getattr(import_module(f"anisocontact.{_PACKAGE_OF[name]}"), name)
    else:
        from anisocontact.base.renamed import renamed

        return renamed(__name__, name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)


import_hooks.install()
