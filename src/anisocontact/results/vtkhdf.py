"""One file of all states for ParaView: VTKHDF, beside the lists of files of a results folder.

Format: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/index.html
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.base.whole_files import replacing
from anisocontact.results.dataset import DataSet
from anisocontact.results.read import Results, needed

__all__ = ["write_vtkhdf"]


def write_vtkhdf(results: Results, path: str | Path) -> None:
    """Write the bodies of a run in all states that were written, for ParaView 5.12 and later.

    Args:
        results: The run.
        path: The file.

    Raises:
        InputError: h5py is not installed, or nothing was written.
    """
    h5py = needed("h5py")
    states, times = [results.grid(i) for i in range(len(results.times))], results.times
    if not states:
        raise InputError(f"'{results.folder}' has no fields")
    with replacing(Path(path)) as draft, h5py.File(draft, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([2, 2])
        root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", 16))
        _mesh(root, states[0])
        _steps(root, states, times)


def _mesh(root: Any, state: DataSet) -> None:
    """The cells, the same in all states."""
    cells = state.cells["Cells"]
    sizes = {
        "NumberOfPoints": len(state.points),
        "NumberOfCells": len(cells["types"]),
        "NumberOfConnectivityIds": len(cells["connectivity"]),
    }
    for name, size in sizes.items():
        root[name] = np.array([size], dtype=np.int64)
    root["Points"] = state.points
    root["Connectivity"] = cells["connectivity"].astype(np.int64)
    root["Offsets"] = cells["offsets"].astype(np.int64)
    root["Types"] = cells["types"].astype(np.uint8)


def _steps(root: Any, states: Sequence[DataSet], times: Any) -> None:
    """The arrays of all states, one behind the other, and where each state begins."""
    count = len(states)
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = np.int64(count)
    steps["Values"] = times
    steps["NumberOfParts"] = np.ones(count, dtype=np.int64)
    for name in ("PartOffsets", "PointOffsets"):
        steps[name] = np.zeros(count, dtype=np.int64)
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        steps[name] = np.zeros((count, 1), dtype=np.int64)
    for kind in ("point_data", "cell_data"):
        group = "PointData" if kind == "point_data" else "CellData"
        for name in getattr(states[0], kind):
            arrays = [getattr(state, kind)[name] for state in states]
            root.create_dataset(f"{group}/{name}", data=np.concatenate(arrays), compression=1)
            starts = np.arange(count, dtype=np.int64) * len(arrays[0])
            steps[f"{group}Offsets/{name}"] = starts
