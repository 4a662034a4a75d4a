"""Data sets for ParaView, without pyvista, which takes a third of a second to be imported."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
import numpy.typing as npt

__all__ = ["DataSet", "polygons", "vertices"]

type Arrays = Mapping[str, npt.NDArray[Any]]

#: Types of VTK by those of NumPy.
_TYPES = {"float64": "Float64", "float32": "Float32", "int32": "Int32", "int64": "Int64"}
#: Of zlib, 1 to 9: hardly larger files than with the usual 5, in a third of the time.
_LEVEL = 1
_NO_ARRAYS: Arrays = {}


@dataclass(frozen=True)
class DataSet:
    """Points, cells and what is known at them.

    Attributes:
        kind: Type of VTK, "UnstructuredGrid" or "PolyData".
        points: Positions, (points, 3), length.
        cells: Sort of cells, "Cells", "Verts" or "Polys" -> "connectivity", the points of all
            cells in a row, "offsets", where each cell begins and the last one ends, and for
            "Cells" their "types".
        point_data: Name -> a row for each point.
        cell_data: Name -> a row for each cell.

    Example:
        >>> cloud = DataSet("PolyData", np.zeros((2, 3)), vertices(2), {"gap": np.ones(2)})
        >>> b'NumberOfVerts="2"' in cloud.encoded()
        True
    """

    kind: str
    points: npt.NDArray[np.float64]
    cells: Mapping[str, Arrays]
    point_data: Arrays
    cell_data: Arrays = field(default_factory=lambda: _NO_ARRAYS)

    def encoded(self) -> bytes:
        """Content of a file of this data set alone.

        VTK makes it in memory: where it writes itself, it loses the end of a file on a full disk
        without a word, or ends the process.
        """
        from vtkmodules import vtkIOXML

        writer = getattr(vtkIOXML, f"vtkXML{self.kind}Writer")()
        writer.SetInputData(self._in_vtk())
        writer.SetDataModeToBinary()
        writer.SetCompressionLevel(_LEVEL)
        writer.SetWriteToOutputString(True)
        writer.Write()
        return str(writer.GetOutputString()).encode()

    def _in_vtk(self) -> Any:
        """The data set as an object of VTK, which uses the memory of the arrays."""
        from vtkmodules import vtkCommonDataModel
        from vtkmodules.util import numpy_support
        from vtkmodules.vtkCommonCore import vtkPoints

        to_vtk: Callable[[npt.NDArray[Any]], Any] = numpy_support.numpy_to_vtk
        out = getattr(vtkCommonDataModel, f"vtk{self.kind}")()
        points = vtkPoints()
        points.SetData(to_vtk(np.ascontiguousarray(self.points)))
        out.SetPoints(points)
        for name, part in self.cells.items():
            rows = vtkCommonDataModel.vtkCellArray()
            rows.SetData(to_vtk(part["offsets"]), to_vtk(part["connectivity"]))
            if name == "Cells":
                out.SetCells(to_vtk(part["types"]), rows)
            else:
                getattr(out, f"Set{name}")(rows)
        for target, arrays in (
            (out.GetPointData(), self.point_data),
            (out.GetCellData(), self.cell_data),
        ):
            for name, values in arrays.items():
                array = to_vtk(np.ascontiguousarray(values))
                array.SetName(name)
                target.AddArray(array)
        return out

    def summary(self, pieces: list[str]) -> bytes:
        """Content of the file that names pieces like this one."""
        kind = f"P{self.kind}"
        fields = {
            "PPointData": self.point_data,
            "PCellData": self.cell_data,
            "PPoints": {"Points": self.points},
        }
        rows = [
            '<?xml version="1.0"?>',
            f'<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt32">',
            f'  <{kind} GhostLevel="0">',
        ]
        for name, arrays in fields.items():
            listed = [_described(n, a) for n, a in arrays.items()]
            rows += [f"    <{name}>", *listed, f"    </{name}>"]
        rows += [f"    <Piece Source={quoteattr(name)}/>" for name in pieces]
        return "\n".join([*rows, f"  </{kind}>", "</VTKFile>", ""]).encode()


def vertices(count: int) -> dict[str, Arrays]:
    """Cells of `DataSet` that show each of so many points."""
    ends = np.arange(count + 1, dtype=np.int32)
    return {"Verts": {"connectivity": ends[:-1], "offsets": ends}}


def polygons(corners: npt.NDArray[np.integer[Any]]) -> dict[str, Arrays]:
    """Cells of `DataSet` with the given points in order around each of them, (cells, corners)."""
    flat = corners.astype(np.int32).reshape(-1)
    ends = np.arange(len(corners) + 1, dtype=np.int32) * np.int32(corners.shape[1])
    return {"Polys": {"connectivity": flat, "offsets": ends}}


def _described(name: str, values: npt.NDArray[Any]) -> str:
    width = values.shape[1] if values.ndim > 1 else 1
    kind = _TYPES[values.dtype.name]
    return f'      <PDataArray type="{kind}" Name={quoteattr(name)} NumberOfComponents="{width}"/>'
