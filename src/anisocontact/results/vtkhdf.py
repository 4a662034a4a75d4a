"""One file of all states for ParaView: VTKHDF, beside the lists of files of a results folder.

Format: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/index.html
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.whole_files import named_by_user, replacing
from anisocontact.results.dataset import DataSet
from anisocontact.results.read import Results, needed

#: Sorts of cells of data sets here and there, in the order of the format.
_POLY = {"Verts": "Vertices", "Lines": "Lines", "Polys": "Polygons", "Strips": "Strips"}


def write_vtkhdf(results: Results, path: str | Path, kind: str = "fields") -> None:
    """Write all states of a run that were written as one file, for ParaView 5.12 and later.

    Args:
        results: The run.
        path: The file.
        kind: "fields" of the bodies, "contact", or "surfaces".

    Raises:
        InputError: h5py is not installed, nothing was written, or the file cannot be.
    """
    h5py = needed("h5py")
    states, times = results.states(kind)
    first = states[0]
    path = Path(path)
    with named_by_user(path), replacing(path) as draft, h5py.File(draft, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([2, 2])
        name = first.kind.encode()
        root.attrs.create("Type", name, dtype=h5py.string_dtype("ascii", len(name)))
        root["NumberOfPoints"] = np.array([len(first.points)], dtype=np.int64)
        root["Points"] = np.concatenate([state.points for state in states])
        widths = _cells(root, first)
        _steps(root, states, times, widths)


def _cells(root: Any, state: DataSet) -> int:
    """The cells, the same in all states; how many sorts there are."""
    if "Cells" in state.cells:
        root["Types"] = state.cells["Cells"]["types"].astype(np.uint8)
        _connectivity(root, state.cells["Cells"])
        return 1
    none = {"connectivity": np.zeros(0), "offsets": np.zeros(1)}
    for name, group in _POLY.items():
        _connectivity(root.create_group(group), state.cells.get(name, none))
    return len(_POLY)


def _connectivity(group: Any, cells: Mapping[str, Any]) -> None:
    points, offsets = (cells[name].astype(np.int64) for name in ("connectivity", "offsets"))
    group["NumberOfCells"] = np.array([len(offsets) - 1], dtype=np.int64)
    group["NumberOfConnectivityIds"] = np.array([len(points)], dtype=np.int64)
    group["Connectivity"], group["Offsets"] = points, offsets


def _steps(root: Any, states: Sequence[DataSet], times: Sequence[float], sorts: int) -> None:
    """The arrays of all states, one behind the other, and where each state begins."""
    count = len(states)
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = np.int64(count)
    steps["Values"] = np.array(times)
    steps["NumberOfParts"] = np.ones(count, dtype=np.int64)
    steps["PartOffsets"] = np.zeros(count, dtype=np.int64)
    steps["PointOffsets"] = np.arange(count, dtype=np.int64) * len(states[0].points)
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        steps[name] = np.zeros((count, sorts), dtype=np.int64)
    for kind in ("point_data", "cell_data"):
        group = "PointData" if kind == "point_data" else "CellData"
        for name in getattr(states[0], kind):
            arrays = [getattr(state, kind)[name] for state in states]
            root.create_dataset(f"{group}/{name}", data=np.concatenate(arrays), compression=1)
            starts = np.arange(count, dtype=np.int64) * len(arrays[0])
            steps[f"{group}Offsets/{name}"] = starts
