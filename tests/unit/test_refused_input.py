"""Input of other shapes and kinds than asked for: one line that says what was given."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact import (
    Body,
    PrescribedPath,
    Results,
    Until,
    WholeMesh,
    build_mesh,
    make_amplitude,
    make_material,
    make_selector,
    make_shape,
    node_near,
    nodes_along,
)
from anisocontact.base.errors import InputError
from anisocontact.cli import main
from anisocontact.mesh import Model
from anisocontact.mesh.readers import whole_reader

CUBE = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
HEXAHEDRON = np.arange(8)[None]


def _block() -> Body:
    return Body("block", make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(2, 2, 2)))


@pytest.mark.parametrize(
    ("name", "table", "says"),
    [
        ("block.face", "[]", "group.block.face: no selector given, one or more needed"),
        ("block.", '[{ by = "all" }]', "group.block.: 'block.' given, \"body.group\" or"),
        (
            "block.face",
            '[{ by = "plane", point = [0, 0, 9], normal = [0, 0, 1] }]',
            "no facet at the boundary is chosen, which lies between (0, 0, 0) and (1, 1, 0.5)",
        ),
    ],
)
def test_groups(refused: Callable[..., str], case_text: str, name: str, table: str, says: str):
    """Groups that nothing chooses, that have no name, or that have no facet."""
    group = f'[group]\n"{name}" = {table}\n[[contact]]'
    assert says in refused(case_text, "[[contact]]", group)


@pytest.mark.parametrize("name", ['""', '"a.b"'])
def test_a_body_without_a_name_to_call_it_by(refused: Callable[..., str], case_text: str, name):
    """The name alone is told, not what follows of it for materials and contacts."""
    said = refused(case_text, "[mesh.box.block]", f"[mesh.box.{name}]")
    assert said == f"error: mesh.box: {name} given, a name without a dot needed"


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        ("count = 5", "count: given without `to`, the other end of a line"),
        ("quantities = []", "quantities: [] given, one or more needed"),
    ],
)
def test_probes(refused: Callable[..., str], case_text: str, keys: str, says: str):
    """Points of no line, and a table of no values."""
    probe = f"[output.probe.p]\npoint = [0, 0, 0]\n{keys}\n[output]"
    assert refused(case_text, "[output]", probe) == f"error: output.probe.p.{says}"


@pytest.mark.parametrize("arguments", [["check", ""], ["report", " "], ["convert", "", "a.vtu"]])
def test_an_empty_name(capsys: pytest.CaptureFixture[str], arguments: list[str]):
    """A variable of a shell that was never set is no name of the working directory."""
    assert main(arguments) == 2
    assert "given, the name of a file or folder needed" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("cell", "nodes", "bodies", "says"),
    [
        ("hexahedran", HEXAHEDRON, ["a"], "cell: 'hexahedran' given, must be one of triangle, "),
        ("hexahedron", HEXAHEDRON[:, :4], ["a"], "of shape (1, 4) given, whole numbers (n, 8 or"),
        ("hexahedron", HEXAHEDRON + 0.5, ["a"], "nodes: float64 of shape (1, 8) given, whole"),
        ("hexahedron", HEXAHEDRON, ["a", "b"], "bodies: 2 names given, one for each of 1 elements"),
        ("hexahedron", HEXAHEDRON, "a", "bodies: 'a' given, one for each of 1 elements needed"),
    ],
)
def test_cells_of_a_reader(cell: str, nodes: Any, bodies: Any, says: str):
    """Elements that are none of their kind."""
    with pytest.raises(InputError) as told:
        WholeMesh(CUBE).add_cells(cell, nodes, bodies)
    assert says in str(told.value)


def _of_two_axes(path: Path) -> WholeMesh:
    mesh = WholeMesh(CUBE[:, :2])
    mesh.add_cells("hexahedron", HEXAHEDRON, ["a"])
    return mesh


@pytest.mark.parametrize(
    ("read", "says"),
    [
        (lambda path: None, "the reader <lambda> returned NoneType, a WholeMesh needed"),
        (lambda path: 1 / 0, "the reader <lambda> failed: test_refused_input.py, line "),
        (_of_two_axes, "points: an array of shape (8, 2) given, (nodes, 3) needed"),
    ],
)
def test_a_reader_of_the_user(read: Any, says: str):
    """A function that fails, or that returns something else, is named with the file it read."""
    with pytest.raises(InputError) as told:
        whole_reader(read)(Path("part.own"), None, "mesh.file", None)
    assert str(told.value).startswith("mesh.file: mesh file 'part.own': ")
    assert says in str(told.value)


def test_a_mistake_of_the_project_is_none_of_the_user():
    """A reader of the project that fails is an internal error, with its traceback."""

    def broken(path: Path) -> WholeMesh:
        raise KeyError(path)

    broken.__module__ = "anisocontact.mesh.unv"
    with pytest.raises(KeyError):
        whole_reader(broken)(Path("part.own"), None, "mesh.file", None)


def test_places_of_nodes():
    """A point that is nowhere has no node, and is no line without length."""
    model = build_mesh([_block()])
    with pytest.raises(InputError, match=r"^point: \[0.0, 0.0, nan\] given, finite numbers needed"):
        node_near(model, "block", (0, 0, np.nan))
    with pytest.raises(InputError, match=r"^start: \[nan, 0.0, 0.0\] given, finite numbers"):
        nodes_along(model, "block", (np.nan, 0, 0), (1, 0, 0))


@pytest.mark.parametrize("degrees", [180.0, 200.0, 360.0])
def test_angles_beyond_half_a_turn(degrees: float):
    """Normals differ by half a turn at most: larger angles choose all facets, as 180 degrees."""
    all_round = make_selector("normal", direction=(0, 0, 1), angle_deg=degrees)
    smooth = make_selector("nearest", point=(0.5, 0.5, 1), angle_deg=degrees)
    model = build_mesh([_block()], {"block.a": [all_round], "block.b": [smooth]})
    assert model.count_facets("block.a") == model.count_facets("block.b") == 24


@pytest.mark.parametrize("index", ["drag", 1.0, None])
def test_which_state_of_results(tmp_path: Path, index: Any):
    """States have whole numbers."""
    (tmp_path / "summary.json").write_text("{}")
    with pytest.raises(InputError, match=f"^index: {index!r} given, a whole number needed"):
        Results(tmp_path).grid(index)


def test_a_file_of_results_that_is_gone(tmp_path: Path, capfd: pytest.CaptureFixture[str]):
    """One line, to which VTK adds nothing."""
    (tmp_path / "summary.json").write_text("{}")
    entry = '<DataSet timestep="0" file="fields/0000.vtu"/>'
    (tmp_path / "fields.pvd").write_text(f"<VTKFile><Collection>{entry}</Collection></VTKFile>")
    with pytest.raises(InputError, match=r"0000.vtu' cannot be read: \[Errno 2\] No such file$"):
        Results(tmp_path).fields()
    assert capfd.readouterr() == ("", "")


def test_facets_by_a_value_without_tags():
    """The number of a tag says nothing without the tags."""
    space = build_mesh([_block()]).space
    with pytest.raises(InputError, match=r"^pad.bottom: 3 given without `tags`, MeshTags of"):
        Model.of(space, {"pad.bottom": 3})


def test_columns_that_do_not_rise():
    """The first numbers that are out of order are told."""
    with pytest.raises(InputError, match=r"^time: 0 after 1 given, two or more numbers that grow"):
        make_amplitude("table", time=[1, 0], value=[0, 1])
    with pytest.raises(InputError, match=r"^time: 1 numbers given, two or more"):
        make_amplitude("table", time=[1], value=[0])
    metal = {"E": 1e3, "nu": 0.3}
    for curve, says in (
        ([0, 1, 0.2, 2, 0.1, 3], "0.1 after 0.2 given, strains have to rise from 0"),
        ([0.1, 1, 0.2, 2], "0.1 first given, strains have to rise from 0"),
        ([0, 2, 0.1, 1], "1 after 2 given, stresses have to be > 0 and must not fall"),
    ):
        with pytest.raises(InputError, match=f"^flow_curve: {says}"):
            make_material("plastic", flow_curve=curve, **metal)


@pytest.mark.parametrize(
    ("times", "shown"), [([0, np.nan], "[0.0, nan]"), ([1], "[1.0]"), (2, "2.0")]
)
def test_times_of_a_path(times: Any, shown: str):
    """What was given is told, of which the number may be right."""
    with pytest.raises(InputError) as told:
        PrescribedPath([[0, 0, 0], [1, 0, 0]], times=times)
    assert str(told.value) == f"times: {shown} given, two or more finite times needed"


def test_an_event_and_a_value():
    """Both are told, of which one is needed."""
    with pytest.raises(InputError, match=r"^until: event and value given, with contact one of"):
        Until(contact="block.bottom", event="sliding", value=1.0)
