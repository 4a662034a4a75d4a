"""Grids of bodies and their surfaces in VTK itself: pyvista takes longer to import than to draw."""

from __future__ import annotations

import itertools
import os
from pathlib import Path
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (
    VTK_VOXEL,
    vtkPlane,
    vtkPointSet,
    vtkPolyData,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersCore import vtkClipPolyData, vtkCutter, vtkFeatureEdges, vtkTriangleFilter
from vtkmodules.vtkFiltersGeneral import vtkTableBasedClipDataSet, vtkWarpVector
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
from vtkmodules.vtkIOXML import vtkXMLPUnstructuredGridReader, vtkXMLUnstructuredGridReader

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.results.section_plane import SectionPlane

#: Angle between facets from which on an edge is seen, degrees.
SHARP = 30.0


class Solid:
    """Cells, or facets, with arrays at their nodes."""

    def __init__(self, data: vtkPointSet) -> None:
        self.data: Any = data

    @property
    def points(self) -> Floats:
        """Positions, (n, 3), length."""
        return _floats(self.data.GetPoints().GetData())

    @property
    def bounds(self) -> tuple[float, ...]:
        """Least and largest coordinates: x, x, y, y, z, z."""
        return tuple(self.data.GetBounds())

    @property
    def length(self) -> float:
        """Diagonal of the box around it, length."""
        return float(self.data.GetLength())

    def values(self, name: str) -> Floats:
        """An array at the nodes, (n,) or (n, components)."""
        return _floats(self.data.GetPointData().GetArray(name))

    def triangles(self) -> Ints:
        """Nodes of the facets of a skin, (m, 3)."""
        to_numpy: Any = vtk_to_numpy
        found = to_numpy(self.data.GetPolys().GetConnectivityArray())
        return np.asarray(found, dtype=np.int64).reshape(-1, 3)

    def with_values(self, name: str, values: Floats) -> Solid:
        """The same with one more array at the nodes."""
        data = self.data.NewInstance()
        data.ShallowCopy(self.data)
        to_vtk: Any = numpy_to_vtk
        array = to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
        return Solid(data)

    def skin(self) -> Solid:
        """The surface as triangles."""
        return _through(vtkTriangleFilter(), _through(vtkDataSetSurfaceFilter(), self))

    def edges(self) -> Solid:
        """Sharp edges and borders of a skin, as lines."""
        lines = vtkFeatureEdges()
        lines.SetFeatureAngle(SHARP)
        lines.NonManifoldEdgesOff()
        lines.ColoringOff()
        return _through(lines, self)

    def behind(self, where: SectionPlane) -> Solid:
        """What is not in front of a cut."""
        lines = isinstance(self.data, vtkPolyData)
        clip: Any = vtkClipPolyData() if lines else vtkTableBasedClipDataSet()
        clip.SetClipFunction(_plane(where))
        return _through(clip, self)

    def rim(self, where: SectionPlane) -> Solid:
        """Where a cut goes through a skin, as lines."""
        cutter = vtkCutter()
        cutter.SetCutFunction(_plane(where))
        return _through(cutter, self)

    def moved(self, name: str, scale: float) -> Solid:
        """The same with nodes moved by an array."""
        warp: Any = vtkWarpVector()
        warp.SetInputArrayToProcess(0, 0, 0, 0, name)
        warp.SetScaleFactor(scale)
        return _through(warp, self)


def read_solid(path: Path) -> Solid:
    """Read what a run has written of its bodies.

    Raises:
        InputError: The file is gone or damaged.
    """
    parallel = path.suffix == ".pvtu"
    reader: Any = vtkXMLPUnstructuredGridReader() if parallel else vtkXMLUnstructuredGridReader()
    reader.SetFileName(os.fsencode(path))
    reader.Update()
    if reader.GetErrorCode() or not reader.GetOutput().GetNumberOfPoints():
        raise InputError(f"'{path}' cannot be read")
    return Solid(reader.GetOutput())


def one_cell() -> Solid:
    """The unit cube."""
    grid: Any = vtkUnstructuredGrid()
    points = vtkPoints()
    for corner in itertools.product((0.0, 1.0), repeat=3):
        points.InsertNextPoint(*corner)
    grid.SetPoints(points)
    grid.InsertNextCell(VTK_VOXEL, 8, range(8))
    return Solid(grid)


def _plane(cut: SectionPlane) -> vtkPlane:
    plane = vtkPlane()
    plane.SetOrigin(*(cut.place * (i == cut.axis) for i in range(3)))
    plane.SetNormal(*cut.normal)
    return plane


def _floats(array: Any) -> Floats:
    to_numpy: Any = vtk_to_numpy
    return np.asarray(to_numpy(array), dtype=np.float64)


def _through(step: Any, given: Solid) -> Solid:
    step.SetInputData(given.data)
    step.Update()
    return Solid(step.GetOutput())
