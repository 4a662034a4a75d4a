"""Meshes with named bodies and facet groups: built-in shapes and gmsh files."""

from anisocontact.mesh.build import Body, GmshFile, Source, build_box, build_mesh
from anisocontact.mesh.gmsh import read_gmsh
from anisocontact.mesh.model import Model
from anisocontact.mesh.placement import Placement, Rotation
from anisocontact.mesh.shapes import (
    BallSpec,
    BoxSpec,
    CylinderSpec,
    DomeSpec,
    RingSpec,
    Shape,
    make_shape,
    shapes,
)

__all__ = [
    "BallSpec",
    "Body",
    "BoxSpec",
    "CylinderSpec",
    "DomeSpec",
    "GmshFile",
    "Model",
    "Placement",
    "RingSpec",
    "Rotation",
    "Shape",
    "Source",
    "build_box",
    "build_mesh",
    "make_shape",
    "read_gmsh",
    "shapes",
]
