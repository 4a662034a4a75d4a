"""Results for other tools: pandas, xarray, and one file of all states for ParaView."""

from __future__ import annotations

import sys

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.cli import main
from anisocontact.results import Results

CASE = """
[mesh.box.bar]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [2, 1, 1]
order = 2

[material.bar]
model = "linear-elastic"
E = 1000
nu = 0.0

[[step]]
name = "pull"
increments = 2
displacement = { "bar.bottom" = { x = 0, y = 0, z = 0 }, "bar.top" = { z = 0.01 } }

[output]
pictures = false
probe.end.point = [1, 1, 1]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("run")
    (place / "case.toml").write_text(CASE)
    assert main(["run", str(place / "case.toml"), "-o", str(place / "out")]) == 0
    return place / "out"


def test_one_file_of_all_states(folder, tmp_path, capsys):
    """Requirement: VTK's own reader finds the times, cells and arrays of the folder."""
    pytest.importorskip("h5py")
    hdf = pytest.importorskip("vtkmodules.vtkIOHDF")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    path = tmp_path / "run.vtkhdf"
    assert main(["convert", str(folder), str(path)]) == 0
    reader = hdf.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    results = Results(folder)
    assert reader.GetNumberOfSteps() == len(results.times) == 3
    for step in range(3):
        reader.SetStep(step)
        reader.Update()
        grid, known = reader.GetOutput(), results.grid(step)
        assert grid.GetNumberOfCells() == 2
        assert grid.GetCellType(0) == known.cells["Cells"]["types"][0]
        for name, values in known.point_data.items():
            found = vtk_to_numpy(grid.GetPointData().GetArray(name))
            assert np.array_equal(found, values)
        assert np.array_equal(vtk_to_numpy(grid.GetCellData().GetArray("body")), [0, 0])
    assert main(["convert", str(folder), str(tmp_path / "run.vtu")]) == 2
    assert "results are written as .vtkhdf" in capsys.readouterr().err
    assert main(["convert", str(folder), str(tmp_path / "none" / "run.vtkhdf")]) == 2
    assert "run.vtkhdf' cannot be written: No such file or directory" in capsys.readouterr().err


PRESSED = """
[mesh.box.upper]
origin = [0.2, 0.2, 1]
size = [0.5, 0.5, 0.5]
cells = [2, 2, 1]

[mesh.box.lower]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [3, 3, 1]

[material.upper]
model = "linear-elastic"
E = 1000
nu = 0.3

[material.lower]
model = "linear-elastic"
E = 1000
nu = 0.3

[surface.floor]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "upper.bottom"
master = "lower.top"
pass = "mortar"
friction = { coefficients = 0.3 }

[[contact]]
slave = "lower.bottom"
master = "floor"
pass = "single"
friction = { coefficients = 0.3 }

[[step]]
name = "press"
increments = 2
displacement = { "upper.top" = { x = 0, y = 0, z = -0.01 } }

[output]
pictures = false
vtkhdf = true
"""


def test_contacts_in_one_file(tmp_path, monkeypatch, capsys):
    """Requirement: VTK finds facets between slave nodes, loose points and patches, as they move."""
    pytest.importorskip("h5py")
    hdf = pytest.importorskip("vtkmodules.vtkIOHDF")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(PRESSED)
    assert main(["run", str(case), "-o", str(out)]) == 0
    results = Results(out)
    assert results.kinds == ["fields", "contact", "surfaces"]
    for kind in results.kinds:
        reader = hdf.vtkHDFReader()
        reader.SetFileName(str(out / f"{kind}.vtkhdf"))
        reader.UpdateInformation()
        states, times = results.states(kind)
        assert reader.GetNumberOfSteps() == len(times) == 3
        for step, known in enumerate(states):
            reader.SetStep(step)
            reader.Update()
            found = reader.GetOutput()
            assert np.array_equal(vtk_to_numpy(found.GetPoints().GetData()), known.points)
            for name, values in known.point_data.items():
                array = found.GetPointData().GetArray(name)
                assert np.array_equal(vtk_to_numpy(array), values)
        if kind == "contact":
            # four facets of the upper body, and the points of nine below
            assert found.GetNumberOfPolys() == 4
            assert found.GetNumberOfVerts() == 36
    with monkeypatch.context() as hidden:
        hidden.setattr("anisocontact.case.output.find_spec", lambda _: None)
        assert main(["check", str(case)]) == 2
        assert "output.vtkhdf: needs h5py: pip install h5py" in capsys.readouterr().err
    assert main(["convert", str(out), str(tmp_path / "run.vtkhdf")]) == 0
    written = {path.name for path in tmp_path.glob("*.vtkhdf")}
    assert written == {"run.vtkhdf", "run-contact.vtkhdf", "run-surfaces.vtkhdf"}


def test_tables_for_pandas(folder):
    pytest.importorskip("pandas")
    results = Results(folder)
    frame = results.frame()
    assert frame["time"].tolist() == [0.5, 1.0]
    assert np.allclose(frame["reactions.bar.top.z"], [5.0, 10.0])
    assert results.frame("probes/end")["displacement.z"].tolist()[-1] == pytest.approx(0.01)
    with pytest.raises(InputError, match="cannot be read"):
        results.frame("probes/none")


def test_states_for_xarray(folder):
    pytest.importorskip("xarray")
    results = Results(folder)
    found = results.arrays()
    assert found["displacement"].dims == ("time", "point", "axis")
    assert float(found["displacement"].sel(time=1.0, axis="z").max()) == pytest.approx(0.01)
    assert np.allclose(found["stress"].sel(component="ZZ", time=0.5), 5.0)
    with pytest.raises(InputError, match="nothing was written"):
        results.arrays("contact")


def test_a_package_that_is_not_there_is_one_line(folder, monkeypatch):
    for package, ask in (("pandas", Results.frame), ("xarray", Results.arrays)):
        monkeypatch.setitem(sys.modules, package, None)
        with pytest.raises(InputError, match=f"needs {package}: pip install {package}"):
            ask(Results(folder))
