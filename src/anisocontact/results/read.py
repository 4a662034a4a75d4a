"""Reading a results folder, also while the run goes on."""

from __future__ import annotations

import csv
import json
import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from errno import ENOENT
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed
from anisocontact.results.dataset import DataSet, read_data_set
from anisocontact.results.history import read_history

if TYPE_CHECKING:
    import pyvista

#: Sorts of fields.
KINDS = ("fields", "contact", "surfaces")
#: Number of components -> their dimension, and what they are called.
_DIMENSIONS = {2: "axis_of_friction", 3: "axis", 6: "component"}
_COMPONENTS = {"axis": list("xyz"), "component": ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]}


def needed(package: str) -> Any:
    """A package that only few need.

    Raises:
        InputError: It is not installed.
    """
    try:
        return import_module(package)
    except ImportError:
        raise InputError(f"needs {package}: pip install {package}") from None


def _over_time(states: list[npt.NDArray[Any]], of: str) -> tuple[tuple[str, ...], Any]:
    """An array with its dimensions, time first."""
    values = np.stack(states)
    inner = [_DIMENSIONS.get(n, f"component_of_{n}") for n in values.shape[2:]]
    return ("time", of, *inner), values


@typed
class Results:
    """Results of a run.

    Args:
        folder: The results folder.

    Raises:
        InputError: It holds no `summary.json`; reading raises it where a file is damaged, or has
            no such time.

    Example:
        >>> Results("no-folder")
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: 'no-folder' holds no results: no summary.json in it
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        if not (self.folder / "summary.json").is_file():
            raise InputError(f"'{folder}' holds no results: no summary.json in it")

    @property
    def summary(self) -> dict[str, Any]:
        """Content of `summary.json`."""
        path = self.folder / "summary.json"
        with _whole(path):
            found = json.loads(path.read_text("utf-8"))
            if not isinstance(found, dict):
                raise ValueError("no table of results")
        return found

    @property
    def history(self) -> dict[str, npt.NDArray[Any]]:
        """Columns of `history.csv`, a value for each accepted increment."""
        path = self.folder / "history.csv"
        with _whole(path):
            return read_history(path) if path.is_file() else {}

    @property
    def times(self) -> Floats:
        """Times at which fields were written, the first is the start."""
        return np.array([time for time, _ in self._listed("fields.pvd")])

    def fields(self, index: int = -1) -> pyvista.UnstructuredGrid:
        """Displacement and stress of the bodies.

        Args:
            index: Which of `times`, the last one if not given.

        Returns:
            A grid of pyvista in the reference configuration.
        """
        grid: pyvista.UnstructuredGrid = self._read("fields.pvd", index)
        return grid

    def contact(self, index: int = -1) -> pyvista.PolyData:
        """The slave points with gap, pressure, tractions, slip, status and directions.

        Args:
            index: Which of `times`, the last one if not given.

        Returns:
            Points of pyvista, where they are at that time.
        """
        points: pyvista.PolyData = self._read("contact.pvd", index)
        return points

    def slave_points(self, index: int = -1) -> DataSet:
        """What `contact` gives, as arrays without pyvista.

        Args:
            index: Which of `times`, the last one if not given.

        Returns:
            Points, where they are at that time, and what is known at them.
        """
        return self._data_set("contact.pvd", index)

    def grid(self, index: int = -1) -> DataSet:
        """What `fields` gives, as arrays without pyvista.

        Args:
            index: Which of `times`, the last one if not given.

        Returns:
            Points, cells, and arrays at both by name.
        """
        return self._data_set("fields.pvd", index)

    def frame(self, table: str = "history") -> Any:
        """A table of the folder for pandas.

        Args:
            table: "history", or "probes/<name>".

        Returns:
            A `pandas.DataFrame`.

        Raises:
            InputError: pandas is not installed, or there is no such table.
        """
        pandas = needed("pandas")
        path = self.folder / f"{table}.csv"
        with _whole(path):
            return pandas.DataFrame(read_history(path))

    def arrays(self, kind: str = "fields") -> Any:
        """All states that were written for xarray.

        Args:
            kind: "fields", "contact" or "surfaces".

        Returns:
            An `xarray.Dataset` with the dimensions `time`, `point` or `cell`, and the components.

        Raises:
            InputError: xarray is not installed, or nothing was written.
        """
        xarray = needed("xarray")
        states, times = self.states(kind)
        first, found = states[0], {"position": _over_time([s.points for s in states], "point")}
        for name in first.point_data:
            found[name] = _over_time([s.point_data[name] for s in states], "point")
        for name in first.cell_data:
            found[name] = _over_time([s.cell_data[name] for s in states], "cell")
        return xarray.Dataset(found, {"time": times} | _COMPONENTS)

    def states(self, kind: str) -> tuple[list[DataSet], list[float]]:
        """All states that were written, as arrays without pyvista.

        Args:
            kind: "fields", "contact" or "surfaces".

        Returns:
            The states, and their times.

        Raises:
            InputError: Nothing was written.
        """
        times = [time for time, _ in self._listed(f"{kind}.pvd")]
        if not times:
            raise InputError(f"{kind!r} given, of which nothing was written", "kind")
        return [self._data_set(f"{kind}.pvd", i) for i in range(len(times))], times

    @property
    def kinds(self) -> list[str]:
        """Which of "fields", "contact" and "surfaces" were written."""
        return [kind for kind in KINDS if self._listed(f"{kind}.pvd")]

    def _data_set(self, name: str, index: int) -> DataSet:
        path = self._file(name, index)
        with _whole(path):
            return read_data_set(path)

    def surfaces(self, index: int = -1) -> pyvista.PolyData:
        """Patches of the analytic masters.

        Args:
            index: Which of `times`, the last one if not given.

        Returns:
            Surfaces of pyvista, where they are at that time.
        """
        patches: pyvista.PolyData = self._read("surfaces.pvd", index)
        return patches

    def fields_file(self, index: int = -1) -> Path:
        """File that `fields` reads.

        Args:
            index: Which of `times`, the last one if not given.

        Returns:
            Its path.
        """
        return self._file("fields.pvd", index)

    def _file(self, name: str, index: int) -> Path:
        listed = self._listed(name)
        if not isinstance(index, int | np.integer):
            raise InputError(f"{index!r} given, a whole number needed", "index")
        if not -len(listed) <= index < len(listed):
            text = f"{index} given, '{self.folder / name}' lists {len(listed)} times"
            raise InputError(text, "index")
        return self.folder / listed[index][1]

    def _listed(self, name: str) -> list[tuple[float, str]]:
        path = self.folder / name
        if not path.is_file():
            return []
        with _whole(path):
            sets = ElementTree.parse(path).iter("DataSet")
            return [(float(entry.attrib["timestep"]), entry.attrib["file"]) for entry in sets]

    def _read(self, name: str, index: int) -> Any:
        import pyvista

        path = self._file(name, index)
        with _whole(path):
            if not path.is_file():  # of which VTK would print pages
                raise FileNotFoundError(ENOENT, "No such file")
            data = _pieces(path) if path.suffix == ".pvtp" else pyvista.read(path)
            if not data.n_points:  # VTK says nothing of a file that is cut off
                raise ValueError("no points")
        return data


def _pieces(path: Path) -> Any:
    """Points or surfaces of several processes, which pyvista has no reader for."""
    import pyvista
    from vtkmodules.vtkIOXML import vtkXMLPPolyDataReader

    reader: Any = vtkXMLPPolyDataReader()
    reader.SetFileName(os.fsencode(path))
    reader.Update()
    return pyvista.wrap(reader.GetOutput())


@contextmanager
def _whole(path: Path) -> Iterator[None]:
    """Make of everything that is wrong with a file one line that names it."""
    try:
        yield
    except (OSError, ValueError, KeyError, zlib.error, ElementTree.ParseError, csv.Error) as error:
        raise InputError(f"'{path}' cannot be read: {error}") from None
