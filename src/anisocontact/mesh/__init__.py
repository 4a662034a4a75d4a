"""Meshes with named bodies and facet groups: built-in shapes and mesh files."""

from anisocontact.mesh.build import Body, GmshFile, MeshFile, Source, build_box, build_mesh
from anisocontact.mesh.gmsh import read_gmsh
from anisocontact.mesh.inp import read_inp
from anisocontact.mesh.model import Model
from anisocontact.mesh.placement import Placement, Rotation
from anisocontact.mesh.readers import register_reader, whole_reader
from anisocontact.mesh.selectors import make_selector, register_selector, selectors
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
from anisocontact.mesh.whole import WholeMesh

__all__ = [
    "BallSpec",
    "Body",
    "BoxSpec",
    "CylinderSpec",
    "DomeSpec",
    "GmshFile",
    "MeshFile",
    "Model",
    "Placement",
    "RingSpec",
    "Rotation",
    "Shape",
    "Source",
    "WholeMesh",
    "build_box",
    "build_mesh",
    "make_selector",
    "make_shape",
    "read_gmsh",
    "read_inp",
    "register_reader",
    "register_selector",
    "selectors",
    "shapes",
    "whole_reader",
]
