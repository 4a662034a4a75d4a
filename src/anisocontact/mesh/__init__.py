"""Meshes with named bodies and facet groups: built-in shapes and mesh files."""

from anisocontact.mesh.build import Body, GmshFile, MeshFile, Source, build_box, build_mesh
from anisocontact.mesh.gmsh import read_gmsh
from anisocontact.mesh.idealisation import (
    Axisymmetric,
    Idealisation,
    PlaneStrain,
    PlaneStress,
    idealisations,
    make_idealisation,
)
from anisocontact.mesh.model import Model
from anisocontact.mesh.node_groups import node_near, nodes_along
from anisocontact.mesh.placement import Placement, Rotation
from anisocontact.mesh.readers import register_reader, whole_reader
from anisocontact.mesh.selectors import make_selector, register_selector, selectors
from anisocontact.mesh.shapes import (
    AnnulusSpec,
    BallSpec,
    BoxSpec,
    CylinderSpec,
    DiscSpec,
    DomeSpec,
    RectangleSpec,
    RingSpec,
    Shape,
    make_shape,
    shapes,
)
from anisocontact.mesh.whole import WholeMesh

__all__ = [
    "AnnulusSpec",
    "Axisymmetric",
    "BallSpec",
    "Body",
    "BoxSpec",
    "CylinderSpec",
    "DiscSpec",
    "DomeSpec",
    "GmshFile",
    "Idealisation",
    "MeshFile",
    "Model",
    "Placement",
    "PlaneStrain",
    "PlaneStress",
    "RectangleSpec",
    "RingSpec",
    "Rotation",
    "Shape",
    "Source",
    "WholeMesh",
    "build_box",
    "build_mesh",
    "idealisations",
    "make_idealisation",
    "make_selector",
    "make_shape",
    "node_near",
    "nodes_along",
    "read_gmsh",
    "register_reader",
    "register_selector",
    "selectors",
    "shapes",
    "whole_reader",
]
