"""Meshes with named bodies and facet groups: built-in boxes and gmsh files."""

from anisocontact.mesh.box import BoxSpec, build_box
from anisocontact.mesh.gmsh import read_gmsh
from anisocontact.mesh.model import Model

__all__ = ["BoxSpec", "Model", "build_box", "read_gmsh"]
