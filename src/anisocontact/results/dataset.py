"""Data sets for ParaView, without VTK, which takes longer to be imported than a small case."""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from zlib import compress, decompress

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats

type NamedArrays = Mapping[str, npt.NDArray[Any]]

#: Types of VTK by those of NumPy.
_TYPES = {
    **{"float64": "Float64", "float32": "Float32", "int32": "Int32", "int64": "Int64"},
    "uint8": "UInt8",
}
#: Of zlib, 1 to 9: hardly larger files than with the usual 5, in a third of the time.
_LEVEL = 1
_BLOCK = 2**20
#: From version 2.2 on the nodes of curved hexahedra have the order of DOLFINx.
_HEAD = (
    '<?xml version="1.0"?>\n<VTKFile type="{kind}" version="2.2" byte_order="LittleEndian" '
    'header_type="UInt32" compressor="vtkZLibDataCompressor">'
)
_NO_ARRAYS: NamedArrays = {}
#: Sorts of cells that are read.
_CELLS = ("Cells", "Verts", "Lines", "Polys")


@dataclass(frozen=True)
class DataSet:
    """Points, cells and what is known at them.

    Attributes:
        kind: Type of VTK, "UnstructuredGrid" or "PolyData".
        points: Positions, (points, 3), length.
        cells: Sort of cells, "Cells", "Verts", "Lines" or "Polys" -> "connectivity", the points of
            all cells in a row, "offsets", where each cell begins and the last one ends, and for
            "Cells" their "types".
        point_data: Name -> a row for each point.
        cell_data: Name -> a row for each cell.

    Example:
        >>> cells = vertices(np.arange(2))
        >>> cloud = DataSet("PolyData", np.zeros((2, 3)), cells, {"gap": np.ones(2)})
        >>> b'NumberOfVerts="2"' in cloud.encoded()
        True
    """

    kind: str
    points: Floats
    cells: Mapping[str, NamedArrays]
    point_data: NamedArrays
    cell_data: NamedArrays = field(default_factory=lambda: _NO_ARRAYS)

    def encoded(self) -> bytes:
        """Content of a file of this data set alone, its arrays compressed where they stand."""
        sizes = {"Points": len(self.points)}
        parts = {"PointData": self.point_data, "CellData": self.cell_data}
        parts["Points"] = {"Points": self.points}
        for name, part in self.cells.items():
            sizes[name] = len(part["offsets"]) - 1
            parts[name] = {**part, "offsets": part["offsets"][1:]}  # a file has their ends alone
        counts = " ".join(f'NumberOf{name}="{size}"' for name, size in sizes.items())
        rows = [_HEAD.format(kind=self.kind), f"  <{self.kind}><Piece {counts}>"]
        for name, arrays in parts.items():
            listed = [_written(n, a) for n, a in arrays.items()]
            rows += [f"    <{name}>", *listed, f"    </{name}>"]
        return "\n".join([*rows, f"  </Piece></{self.kind}>", "</VTKFile>", ""]).encode()

    def summary(self, pieces: list[str]) -> bytes:
        """Content of the file that names pieces like this one."""
        kind = f"P{self.kind}"
        fields = {
            "PPointData": self.point_data,
            "PCellData": self.cell_data,
            "PPoints": {"Points": self.points},
        }
        rows = [
            _HEAD.format(kind=kind),
            f'  <{kind} GhostLevel="0">',
        ]
        for name, arrays in fields.items():
            listed = [f"      <PDataArray {_described(n, a)}/>" for n, a in arrays.items()]
            rows += [f"    <{name}>", *listed, f"    </{name}>"]
        rows += [f'    <Piece Source="{escape(name)}"/>' for name in pieces]
        return "\n".join([*rows, f"  </{kind}>", "</VTKFile>", ""]).encode()


def read_data_set(path: Path) -> DataSet:
    """Points, cells of a grid, and what is known of them, also of a file that names pieces.

    Args:
        path: What `DataSet` has written.

    Raises:
        ValueError, OSError: The file is damaged, or there is none.
    """
    tree = ElementTree.parse(path).getroot()
    kind = tree.attrib["type"]
    if kind.startswith(("PP", "PU")):
        sources = (one.get("Source") for one in tree.iter("Piece"))
        return _put_together([read_data_set(path.parent / name) for name in sources if name])

    def arrays(part: str) -> dict[str, npt.NDArray[Any]]:
        return {str(a.get("Name")): _read(a) for a in tree.iterfind(f"{kind}/Piece/{part}/*")}

    cells = {name: found for name in _CELLS if (found := arrays(name))}
    for found in cells.values():
        found["offsets"] = np.append(0, found["offsets"]).astype(found["offsets"].dtype)
    (points,) = arrays("Points").values()
    return DataSet(kind, points, cells, arrays("PointData"), arrays("CellData"))


def _put_together(parts: Sequence[DataSet]) -> DataSet:
    """Pieces as one data set."""
    first = np.cumsum([0] + [len(p.points) for p in parts])
    cells: dict[str, NamedArrays] = {}
    for name in parts[0].cells:
        own = [p.cells[name] for p in parts]
        ends = np.cumsum([0] + [len(c["connectivity"]) for c in own])
        of_points = [c["connectivity"] + n for c, n in zip(own, first, strict=False)]
        offsets = [c["offsets"][1:] + n for c, n in zip(own, ends, strict=False)]
        cells[name] = {
            "connectivity": np.concatenate(of_points),
            "offsets": np.concatenate([[0], *offsets]),
        }
        if name == "Cells":
            cells[name] = {**cells[name], "types": np.concatenate([c["types"] for c in own])}
    at_points, at_cells = (
        {n: np.concatenate([getattr(p, what)[n] for p in parts]) for n in getattr(parts[0], what)}
        for what in ("point_data", "cell_data")
    )
    points = np.concatenate([p.points for p in parts])
    return DataSet(parts[0].kind, points, cells, at_points, at_cells)


def vertices(points: npt.NDArray[np.integer[Any]]) -> dict[str, NamedArrays]:
    """Cells of `DataSet` that show each of some points, (points,)."""
    return {"Verts": _in_a_row(points[:, None])}


def polygons(*corners: npt.NDArray[np.integer[Any]]) -> dict[str, NamedArrays]:
    """Cells of `DataSet` with the given points in order around each of them, (cells, corners).

    Those of two points are lines.
    """
    kinds: dict[str, list[npt.NDArray[np.integer[Any]]]] = {"Lines": [], "Polys": []}
    for one in corners:
        kinds["Lines" if one.shape[1] == 2 else "Polys"].append(one)
    return {kind: _in_a_row(*cells) for kind, cells in kinds.items() if cells}


def _in_a_row(*cells: npt.NDArray[np.integer[Any]]) -> NamedArrays:
    """Points of all cells, and where each begins."""
    sizes = np.concatenate([np.full(len(one), one.shape[1]) for one in cells])
    return {
        "connectivity": np.concatenate([one.reshape(-1) for one in cells]).astype(np.int32),
        "offsets": np.append(0, np.cumsum(sizes)).astype(np.int32),
    }


def _described(name: str, values: npt.NDArray[Any]) -> str:
    width = values.shape[1] if values.ndim > 1 else 1
    kind = _TYPES[values.dtype.name]
    return f'type="{kind}" Name="{escape(name)}" NumberOfComponents="{width}"'


def _read(array: ElementTree.Element) -> npt.NDArray[Any]:
    """The values of an array that `_written` has written."""
    text = (array.text or "").strip()
    count = int.from_bytes(b64decode(text[:8])[:4], "little")
    head = 4 * -(-4 * (3 + count) // 3)  # characters of the sizes, to whole groups of four
    sizes = np.frombuffer(b64decode(text[:head]), dtype="<u4")[3 : 3 + count]
    content, ends = b64decode(text[head:]), np.cumsum([0, *sizes]).tolist()
    data = b"".join(decompress(content[a:b]) for a, b in pairwise(ends))
    values = np.frombuffer(data, dtype=array.attrib["type"].lower())
    width = int(array.get("NumberOfComponents") or 1)
    return values.reshape(-1, width) if width > 1 else values


def _written(name: str, values: npt.NDArray[Any]) -> str:
    """An array with its values in base 64: sizes of the compressed blocks, and the blocks."""
    data = np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<"), copy=False).tobytes()
    blocks = [compress(data[at : at + _BLOCK], _LEVEL) for at in range(0, len(data), _BLOCK)]
    sizes = np.array([len(blocks), _BLOCK, len(data) % _BLOCK, *map(len, blocks)], dtype="<u4")
    content = b64encode(sizes.tobytes()) + b64encode(b"".join(blocks))
    start = f'      <DataArray {_described(name, values)} format="binary">'
    return f"{start}{content.decode()}</DataArray>"
