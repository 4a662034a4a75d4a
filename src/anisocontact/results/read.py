"""Reading a results folder, also while the run goes on."""

from __future__ import annotations

import csv
import json
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.results.dataset import DataSet, read_points
from anisocontact.results.history import read_history

if TYPE_CHECKING:
    import pyvista

__all__ = ["Results"]


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
    def times(self) -> npt.NDArray[np.float64]:
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
        path = self._file("contact.pvd", index)
        with _whole(path):
            return read_points(path)

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
            data = _pieces(path) if path.suffix == ".pvtp" else pyvista.read(path)
            if not data.n_points:  # VTK says nothing of a file that is cut off
                raise ValueError("no points")
        return data


def _pieces(path: Path) -> Any:
    """Points or surfaces of several processes, which pyvista has no reader for."""
    import pyvista
    from vtkmodules.vtkIOXML import vtkXMLPPolyDataReader

    reader = vtkXMLPPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return pyvista.wrap(reader.GetOutput())


@contextmanager
def _whole(path: Path) -> Iterator[None]:
    """Make of everything that is wrong with a file one line that names it."""
    try:
        yield
    except (OSError, ValueError, KeyError, zlib.error, ElementTree.ParseError, csv.Error) as error:
        raise InputError(f"'{path}' cannot be read: {error}") from None
