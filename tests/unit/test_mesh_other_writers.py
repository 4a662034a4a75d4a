"""One mesh as a mesher writes it in the formats of several codes: bodies, names, orientation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
pytest.importorskip("meshio")

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.mesh import GmshFile, build_mesh
from anisocontact.mesh.described import described
from anisocontact.mesh.mirrored import AXES, turned
from anisocontact.mesh.readers import file_arrays
from anisocontact.mesh.tetrahedra import EDGES
from anisocontact.mesh.whole import FACES

gmsh = pytest.importorskip("gmsh")


def write_blocks(path: Path, order: int) -> None:
    """Two blocks of 8 cells, 3 x 3 x 1 and 1 x 1 x 1 on top, with named faces."""
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.ElementOrder", order)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
        for k, (low, high, z) in enumerate([(0.0, 3.0, 0.0), (1.0, 2.0, 1.0)]):
            _block(low, high, z, ("Grundkörper 1", "Stempel")[k], ("Boden", "Fläche")[k])
        gmsh.model.mesh.generate(3)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


def _block(low: float, high: float, z: float, body: str, face: str) -> None:
    geometry = gmsh.model.geo
    corners = [(low, low), (high, low), (high, high), (low, high)]
    points = [geometry.addPoint(x, y, z) for x, y in corners]
    lines = [geometry.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    below = geometry.addPlaneSurface([geometry.addCurveLoop(lines)])
    for line in lines:
        geometry.mesh.setTransfiniteCurve(line, 3)
    geometry.mesh.setTransfiniteSurface(below)
    geometry.mesh.setRecombine(2, below)
    made = geometry.extrude([(2, below)], 0, 0, 1, [2], recombine=True)
    geometry.synchronize()
    (volume,) = (tag for dim, tag in made if dim == 3)
    gmsh.model.addPhysicalGroup(3, [volume], name=body)
    gmsh.model.addPhysicalGroup(2, [below], name=face)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("suffix", ["msh", "inp", "bdf", "med", "vtk", "unv"])
def test_bodies_and_faces(tmp_path: Path, suffix: str, order: int) -> None:
    """Requirement: two bodies and their named or numbered faces in every format, names beyond ASCII
    as they are, volumes positive whatever way round a format numbers its cells. Source: 9 and 1.
    Tolerance: single precision of Nastran's eight columns."""
    path = tmp_path / f"blocks.{suffix}"
    write_blocks(path, order)
    mesh, model = file_arrays(path), build_mesh([GmshFile(path)])
    one = fem.Constant(model.mesh, 1.0)
    volume = fem.assemble_scalar(fem.form(one * ufl.dx(domain=model.mesh)))
    assert volume == pytest.approx(10.0, rel=1e-6)
    assert sorted(len(rows) for rows in mesh.bodies.values()) == [8, 8]
    assert mesh.order == order
    bodies = [name.lower().replace("_", " ") for name in mesh.bodies]
    faces = [name.partition(".")[2].lower() for name in mesh.facets]
    assert len(faces) >= 2
    if suffix not in ("bdf", "vtk"):  # which have numbers
        assert sorted(bodies) == ["grundkörper 1", "stempel"]
        assert {"boden", "fläche"} <= set(faces)
    if suffix == "med":
        assert any("the other way round" in note for note in mesh.notes)


@pytest.mark.parametrize("cell", AXES)
def test_nodes_of_turned_cells(cell: str) -> None:
    """Requirement: a cell that is numbered the other way round has its middle nodes between its own
    corners after it was turned, and a cell that is not stays as it is. Tolerance: exact."""
    rng = np.random.default_rng(3)
    axes = np.zeros((1 + max(max(max(side) for side in axis) for axis in AXES[cell]), 3))
    for k, (starts, ends) in enumerate(AXES[cell]):
        axes[list(starts), k], axes[list(ends), k] = 0.0, 1.0
    corners = axes + rng.uniform(-0.1, 0.1, axes.shape)
    faces = FACES if cell == "hexahedron" else []
    ends = [*EDGES[cell], *faces]
    points = np.array([*corners, *(corners[list(part)].mean(axis=0) for part in ends)])
    nodes = np.arange(len(points))[None]
    kept, count = turned(cell, nodes, points, faces)
    assert (count, kept.tolist()) == (0, nodes.tolist())
    points[:, 0] *= -1.0
    found, count = turned(cell, nodes, points, faces)
    assert count == 1
    own = points[found[0]]
    for k, part in enumerate(ends, len(corners)):
        assert own[k] == pytest.approx(own[list(part)].mean(axis=0), abs=1e-15)


def test_bulk_data_alone_and_other_coordinate_systems(tmp_path: Path) -> None:
    """Requirement: bulk data need no control section; nodes in a system of their own are refused,
    for their numbers would be taken as x, y, z."""
    rows = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    grid = [f"GRID,{k},{{}},{x},{y},{z}" for k, (x, y, z) in enumerate(rows, 1)]
    text = "\n".join([*grid, "CTETRA,1,7,1,2,3,4"]).replace("{}", "0")
    path = tmp_path / "part.bdf"
    path.write_text(text)
    assert list(file_arrays(path).bodies) == ["body7"]
    path.write_text(f"SOL 101\nCEND\nbegin bulk\n{text.replace('GRID,2,0', 'GRID,2,5')}\nENDDATA\n")
    with pytest.raises(InputError, match="GRID 2 is in the coordinate system 5; the basic one"):
        file_arrays(path)
    long = "GRID*                  1               5              0.              0.\n*       0.\n"
    path.write_text(long + text)
    with pytest.raises(InputError, match="GRID\\* 1 is in the coordinate system 5"):
        file_arrays(path)


def test_bulk_data_that_include_others_are_refused(tmp_path: Path) -> None:
    """Requirement: what an INCLUDE names is not left out in silence, beside cells or without."""
    path = tmp_path / "part.bdf"
    tetrahedron = "GRID,1\nGRID,2,,1.\nGRID,3,,,1.\nGRID,4,,,,1.\nCTETRA,1,7,1,2,3,4\n"
    for beside in (tetrahedron, ""):
        path.write_text(f"SOL 101\nCEND\nBEGIN BULK\n{beside}include 'rest.bdf'\nENDDATA\n")
        with pytest.raises(InputError, match=r"include 'rest\.bdf' is not read; put the lines of"):
            file_arrays(path)
    path.write_text("BEGIN BULK\nENDDATA\n")
    with pytest.raises(InputError, match=r"no solid cell .*; there are: none at all"):
        file_arrays(path)


@pytest.mark.parametrize(("name", "of"), [("part.cdb", "Ansys"), ("part.k", "LS-DYNA")])
def test_files_that_are_not_read_say_so(tmp_path: Path, name: str, of: str) -> None:
    """Requirement: a file of a code whose meshes are not read is told with what to write."""
    path = tmp_path / name
    path.write_text("/PREP7\n")
    with pytest.raises(InputError, match=f"files of {of} are not read; have it write .inp"):
        file_arrays(path)


def test_bodies_that_fall_apart_and_degenerate_cells(tmp_path: Path) -> None:
    """Requirement: a body of pieces that share no node is told, with nodes that were not joined;
    cells that name a node twice are told, open surfaces of STL too."""
    import meshio

    cube = np.array([(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
    points = np.vstack([cube, cube + np.array([1.0, 0, 0]), cube + np.array([5.0, 0, 0])])
    rows = np.arange(24).reshape(3, 8)
    path = tmp_path / "part.vtu"
    meshio.Mesh(points, [("hexahedron", rows)]).write(path)
    lines = described(file_arrays(path))
    joined = "4 nodes are at places of others: they were not joined"
    assert f"pieces    body: 3 that share no node, {joined}" in lines
    rows[0, 6] = rows[0, 7]
    meshio.Mesh(points, [("hexahedron", rows)]).write(path)
    with pytest.raises(InputError, match="1 of 3 hexahedrons name a node twice; degenerate cells"):
        file_arrays(path)
    path = tmp_path / "open.stl"
    meshio.Mesh(cube, [("triangle", np.array([[0, 1, 2], [0, 2, 3], [0, 1, 5]]))]).write(path)
    with pytest.raises(InputError, match="does not enclose a volume; a closed one is needed"):
        file_arrays(path)
