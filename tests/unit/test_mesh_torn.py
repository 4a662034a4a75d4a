"""A body that is a part of what its file has, with common nodes, is told: it would end there."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
pytest.importorskip("meshio")

import meshio

from anisocontact.base.errors import ModelWarning
from anisocontact.cli import main
from anisocontact.mesh import MeshFile, build_mesh
from anisocontact.mesh.readers import file_arrays

#: Two cubes, one on the other: four nodes are of both.
POINTS = np.array([[x, y, z] for z in (0, 1, 2) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))])
CELLS = np.array([[*range(8)], [*range(4, 12)]])
CASE = """
[mesh]
file = "part.{suffix}"

[material.{body}]
model = "linear-elastic"
E = 1000
nu = 0.3

[group."{body}.low"]
by = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[step]]
name = "hold"
increments = 1
displacement = {{ "{body}.low" = {{ x = 0, y = 0, z = 0 }} }}

[output]
pictures = false
"""


def by_meshio(data):
    """Both cubes by meshio, with data of the cells."""

    def write(path):
        meshio.Mesh(
            1.0 * POINTS, [("hexahedron", CELLS)], cell_data={k: [np.array(v)] for k, v in data}
        ).write(path)

    return write


def gmsh_file(named):
    """Both cubes as gmsh writes them, with the names of some volumes."""

    def write(path):
        names = [f'3 {k} "vol{k}"' for k in named]
        nodes = [f"{k} {x} {y} {z}" for k, (x, y, z) in enumerate(POINTS, 1)]
        cells = [f"{k} 5 2 {k} {k} {' '.join(map(str, c + 1))}" for k, c in enumerate(CELLS, 1)]
        parts = (("PhysicalNames", names), ("Nodes", nodes), ("Elements", cells))
        text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat"]
        for name, lines in parts:
            text += [f"${name}", str(len(lines)), *lines, f"$End{name}"]
        path.write_text("\n".join(text) + "\n")

    return write


def universal(path):
    """Both cubes in a universal file, with a group of the lower one."""
    nodes = [f"{k} 1 1 11\n{x} {y} {z}" for k, (x, y, z) in enumerate(POINTS, 1)]
    cells = [f"{k} 115 1 1 7 8\n{' '.join(map(str, c + 1))}" for k, c in enumerate(CELLS, 1)]
    group = ["1 0 0 0 0 0 0 1", "part", "8 1 0 0"]
    parts = ((2411, nodes), (2412, cells), (2467, group))
    path.write_text("".join(f"-1\n{n}\n{'\n'.join(lines)}\n-1\n" for n, lines in parts))


def deck(path):
    """Both cubes in a deck, with a section of the lower one."""
    nodes = "\n".join(f"{k}, {x}, {y}, {z}" for k, (x, y, z) in enumerate(POINTS, 1))
    cells = "\n".join(f"{k}, {', '.join(map(str, c + 1))}" for k, c in enumerate(CELLS, 1))
    path.write_text(
        f"*NODE\n{nodes}\n*ELEMENT, TYPE=C3D8\n{cells}\n*ELSET, ELSET=PART\n1\n"
        "*SOLID SECTION, ELSET=PART, MATERIAL=STEEL\n"
    )


FILES = [
    ("vtu", by_meshio([("MaterialIds", [1, 2])]), "body1", "of 'body2'"),
    ("vtu", by_meshio([("group:part", [1, 0])]), "part", "that are in no body"),
    ("msh", gmsh_file([1, 2]), "vol1", "of 'vol2'"),
    ("msh", gmsh_file([1]), "vol1", "that are in no body"),
    ("unv", universal, "part", "that are in no body"),
    ("inp", deck, "part", "that are in no body"),
]


@pytest.mark.parametrize(("suffix", "write", "body", "left"), FILES)
def test_a_body_that_ends_where_its_mesh_goes_on(tmp_path, capsys, suffix, write, body, left):
    """Requirement: `check`, a run and a script say that cells which hang together with a body are
    left out, with their body and the number of common nodes."""
    write(tmp_path / f"part.{suffix}")
    said = f"{body!r} ends where the mesh of its file goes on with cells {left}, which are left out"
    (tmp_path / "case.toml").write_text(CASE.format(suffix=suffix, body=body))
    for arguments in (["check"], ["run", "-o", str(tmp_path / "out")]):
        assert main([*arguments, str(tmp_path / "case.toml")]) == 0
        out, err = capsys.readouterr()
        assert out.count(f"warning   {said}: 4 nodes belong to both") == 1
        assert (f"warning: {said}" in err) == (arguments[0] == "run")
    with pytest.warns(ModelWarning, match="4 nodes belong to both"):
        build_mesh([MeshFile(tmp_path / f"part.{suffix}", [body])])


@pytest.mark.parametrize(("suffix", "write"), [("vtu", FILES[1][1]), ("unv", universal)])
def test_cells_in_no_group_are_told(tmp_path, capsys, suffix, write):
    """Requirement: `check` of a file says how many of its cells are in no body."""
    write(tmp_path / f"part.{suffix}")
    assert main(["check", str(tmp_path / f"part.{suffix}")]) == 0
    out = capsys.readouterr().out
    assert "cells     1 of 2 cells are in no group of cells: left out" in out
    assert out.count("warning   'part' ends where") == 1


@pytest.mark.parametrize("suffix", ["vtu", "msh"])
def test_whole_bodies_are_not_told(tmp_path, suffix):
    """Requirement: no word where all cells are taken, or those left out share no node."""
    path = tmp_path / f"part.{suffix}"
    {"vtu": FILES[0][1], "msh": FILES[2][1]}[suffix](path)
    apart = tmp_path / "apart.vtu"
    cells = [("hexahedron", np.arange(16).reshape(2, 8))]
    points = np.vstack([POINTS[:8], POINTS[:8] + np.array([3, 0, 0])]).astype(float)
    meshio.Mesh(points, cells, cell_data={"MaterialIds": [np.array([1, 2])]}).write(apart)
    with warnings.catch_warnings():
        warnings.simplefilter("error", ModelWarning)
        build_mesh([MeshFile(path)])
        build_mesh([MeshFile(apart, ["body1"])])
    assert file_arrays(apart).torn == ()
