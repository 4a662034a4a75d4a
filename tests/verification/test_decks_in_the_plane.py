"""Meshes in the plane of other codes: elements, sets, and what they give in a run."""

from pathlib import Path

import numpy as np
import pytest

from anisocontact.base.errors import InputError


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


#: Two cells of 1 by 2 side by side, from the corner (1, 0), numbers of corners and middle nodes.
PLACES = {
    1: (1, 0), 2: (2, 0), 3: (3, 0), 4: (1, 2), 5: (2, 2), 6: (3, 2),
    12: (1.5, 0), 23: (2.5, 0), 45: (1.5, 2), 56: (2.5, 2), 14: (1, 1), 25: (2, 1), 36: (3, 1),
    24: (1.5, 1), 35: (2.5, 1),
}  # fmt: skip
ROWS = {
    "4": [(1, 2, 5, 4), (2, 3, 6, 5)],
    "8": [(1, 2, 5, 4, 12, 25, 45, 14), (2, 3, 6, 5, 23, 36, 56, 25)],
    "3": [(1, 2, 4), (2, 5, 4), (2, 3, 5), (3, 6, 5)],
    "6": [
        (1, 2, 4, 12, 24, 14),
        (2, 5, 4, 25, 45, 24),
        (2, 3, 5, 23, 35, 25),
        (3, 6, 5, 36, 56, 35),
    ],
}
#: Element and side at the bottom left, and at the right.
SIDES = {"4": ("1, S1", "2, S2"), "3": ("1, S1", "4, S1")}


def deck(element: str, more: str = "") -> str:
    """Both cells as elements of one kind, the lower left edge and the right one named."""
    count = element.rstrip("RH")[-1]
    low, right = SIDES["3" if count in "36" else "4"]
    used = {n for row in ROWS[count] for n in row}
    nodes = [f"{n}, {x}, {y}" for n, (x, y) in PLACES.items() if n in used]
    rows = [f"{k}, {', '.join(map(str, row))}" for k, row in enumerate(ROWS[count], 1)]
    lines = [
        *("*NODE", *nodes, f"*ELEMENT, TYPE={element}, ELSET=PLATE", *rows),
        *("*SURFACE, NAME=LOW", low, "*SURFACE, NAME=RIGHT", right),
        *("*NSET, NSET=LEFT", "1, 4, 14" if 14 in used else "1, 4", "*NSET, NSET=CORNER", "6"),
        *("*SOLID SECTION, ELSET=PLATE, MATERIAL=STEEL", "1.", more),
    ]
    return "\n".join(line for line in lines if line)


ELEMENTS = [
    ("CPE4", "plane-strain", "quadrilateral", 1),
    ("CPS4R", "plane-stress", "quadrilateral", 1),
    ("CAX8R", "axisymmetric", "quadrilateral", 2),
    ("CGAX4", "axisymmetric", "quadrilateral", 1),
    ("CPE8H", "plane-strain", "quadrilateral", 2),
    ("CPS3", "plane-stress", "triangle", 1),
    ("CAX6", "axisymmetric", "triangle", 2),
]


@pytest.mark.parametrize(("element", "ideal", "cell", "order"), ELEMENTS)
def test_elements_sets_and_surfaces(tmp_path, element, ideal, cell, order):
    """Requirement: bodies, facets S1 ... and node sets where the manual has them, and the line that
    says what the elements are. Source: places of the nodes. Tolerance: 1e-12."""
    from anisocontact.mesh.readers import file_arrays

    path = tmp_path / "plate.inp"
    path.write_text(deck(element))
    mesh = file_arrays(path)
    assert (mesh.cell, mesh.order) == (cell, order)
    assert {k: len(v) for k, v in mesh.bodies.items()} == {"plate": 2 if cell[0] == "q" else 4}
    middle = {k: mesh.points[v[:, :2]].mean(axis=1).tolist() for k, v in mesh.facets.items()}
    assert middle == {
        "plate.low": [[1.5, 0.0, 0.0]],
        "plate.right": [[3.0, 1.0, 0.0]],
        "plate.left": [[1.0, 1.0, 0.0]],
    }
    assert mesh.nodes["plate.corner"].tolist() == [[3.0, 2.0, 0.0]]
    assert mesh.notes == (f'in the plane: a case needs [idealisation] kind = "{ideal}"',)


CASE = """
[mesh]
file = "{file}"
[idealisation]
kind = "{kind}"
[material.{body}]
model = "linear-elastic"
E = 1000
nu = 0.3
[[step]]
name = "pull"
increments = 1
displacement = {{ "{body}.left" = {{ x = 0 }}, "{body}.corner" = {{ y = 0 }} }}
traction = {{ "{body}.right" = {{ x = 7 }} }}
"""


def stretched(folder: Path, name: str, kind: str, body: str = "plate") -> np.ndarray:
    """Displacement and places of the nodes of a mesh that is pulled along x, by `run`."""
    from anisocontact.case import load
    from anisocontact.case.build import build

    case = folder / "case.toml"
    case.write_text(CASE.format(file=name, kind=kind, body=body))
    built = build(load(str(case)))
    list(built.solver.run())
    x = built.problem.model.space.tabulate_dof_coordinates()
    return np.concatenate([x, built.problem.u.x.array.reshape(-1, 3)], axis=1)


def hooke(kind: str, x: np.ndarray) -> np.ndarray:
    """Displacement under the stress 7 along x, from x = 1 and y = 2."""
    strain = 7.0 / 1000.0 * np.array([1.0, -0.3])
    if kind == "plane-strain":
        strain = 7.0 / 1000.0 * np.array([1.0 - 0.09, -0.3 - 0.09])
    return np.stack([strain[0] * (x[:, 0] - 1.0), strain[1] * (x[:, 1] - 2.0), 0.0 * x[:, 2]], 1)


@pytest.mark.parametrize(
    "element", ["CPE3", "CPE4", "CPE6", "CPE8", "CPS3", "CPS4", "CPS6", "CPS8"]
)
def test_uniform_tension(tmp_path, element):
    """Requirement: a run gives a uniform stress. Source: Hooke. Tolerance: 1e-10."""
    kind = "plane-strain" if element.startswith("CPE") else "plane-stress"
    (tmp_path / "plate.inp").write_text(deck(element))
    found = stretched(tmp_path, "plate.inp", kind)
    assert found[:, 3:] == pytest.approx(hooke(kind, found[:, :3]), abs=1e-10)


def test_a_single_free_node(tmp_path):
    """Requirement: a deck of CPS4 is solved with bilinear squares in plane stress.

    Source: stiffness of a corner of a cell of a by b, E t/(1 - nu^2) (b/3a + (1 - nu)/2 a/3b) along
    x, and as much with a and b changed along y; the parts that couple both cancel between two cells
    side by side. Tolerance: 1e-10.
    """
    from anisocontact.case import load
    from anisocontact.case.build import build
    from anisocontact.case.from_deck import case_of_deck

    rest = """*NSET, NSET=HELD
1, 2, 3, 4, 6
*MATERIAL, NAME=STEEL
*ELASTIC
1000., 0.3
*BOUNDARY
HELD, 1, 2
*STEP
*STATIC
*CLOAD
5, 1, 3.
5, 2, 5.
*END STEP"""
    (tmp_path / "plate.inp").write_text(deck("CPS4", rest).replace("\n1.\n", "\n0.5\n"))
    text, left_out = case_of_deck(tmp_path / "plate.inp", tmp_path / "plate.toml")
    assert not left_out
    (tmp_path / "plate.toml").write_text(text)
    built = build(load(str(tmp_path / "plate.toml")))
    list(built.solver.run())
    place = built.problem.model.space.tabulate_dof_coordinates()
    (node,) = np.flatnonzero(np.all(np.abs(place - [2.0, 2.0, 0.0]) < 1e-9, axis=1))
    found = built.problem.u.x.array.reshape(-1, 3)[node]
    plate = 2 * 1000.0 * 0.5 / (1.0 - 0.3**2)
    along_x, along_y = plate * (2 / 3 + 0.35 / 6), plate * (1 / 6 + 0.35 * 2 / 3)
    assert found == pytest.approx([3.0 / along_x, 5.0 / along_y, 0.0], abs=1e-10)


def test_triangles_beside_quadrilaterals(tmp_path):
    """Requirement: quadrilaterals are cut, said in a line, and the stress is uniform; of order 2
    they are refused. Source: Hooke. Tolerance: 1e-10."""
    from anisocontact.mesh.readers import file_arrays

    path = tmp_path / "plate.inp"
    mixed = deck("CPS4", "*ELEMENT, TYPE=CPS3, ELSET=PLATE\n8, 2, 3, 5\n9, 3, 6, 5")
    mixed = mixed.replace("2, 2, 3, 6, 5\n", "").replace("2, S2", "9, S1")
    path.write_text(mixed)
    mesh = file_arrays(path)
    assert (mesh.cell, len(mesh.cells)) == ("triangle", 4)
    said = "quadrilaterals of 4 nodes and triangles of 3 nodes are taken as 4 triangles"
    assert mesh.notes[-1] == said
    found = stretched(tmp_path, "plate.inp", "plane-stress")
    assert found[:, 3:] == pytest.approx(hooke("plane-stress", found[:, :3]), abs=1e-10)
    path.write_text(deck("CPS8", "*ELEMENT, TYPE=CPS3, ELSET=PLATE\n8, 1, 2, 4"))
    with pytest.raises(InputError, match="of order 2 needs cells of one kind"):
        file_arrays(path)
    path.write_text(mixed.replace("CPS3", "CAX3"))
    with pytest.raises(InputError, match="axisymmetric and plane-stress: a mesh in the plane is"):
        file_arrays(path)


def meshio_mesh(cell, names):
    """The two cells for meshio, with groups by number or by name."""
    meshio = pytest.importorskip("meshio")
    numbers = {n: k for k, n in enumerate(PLACES)}
    count, facet = {"triangle": ("3", "line"), "quad": ("4", "line"), "quad8": ("8", "line3")}[cell]
    rows = np.array([[numbers[n] for n in row] for row in ROWS[count]])
    edges = {"line": [[1, 4], [3, 6]], "line3": [[1, 4, 14], [3, 6, 36]]}[facet]
    lines = np.array([[numbers[n] for n in row] for row in edges])
    points = np.array([(*place, 0.0) for place in PLACES.values()])
    used = np.unique(np.concatenate([rows.ravel(), lines.ravel()]))
    place = np.full(len(points), -1)
    place[used] = np.arange(len(used))
    blocks = [(cell, place[rows]), (facet, place[lines[:1]]), (facet, place[lines[1:]])]
    blocks.append(("vertex", np.array([[place[numbers[6]]]])))
    return meshio.Mesh(points[used], blocks, **names(blocks))


def by_array(blocks):
    """Groups as arrays of 0 and 1."""
    names = ("plate", "left", "right", "corner")
    data = {
        f"group:{name}": [
            np.full(len(rows), k == i, np.int32) for i, (_, rows) in enumerate(blocks)
        ]
        for k, name in enumerate(names)
    }
    return {"cell_data": data}


@pytest.mark.parametrize("cell", ["triangle", "quad", "quad8"])
@pytest.mark.parametrize("ending", ["vtu", "vtk"])
def test_files_that_meshio_reads(tmp_path, cell, ending):
    """Requirement: triangles and quadrilaterals of a file without solids are bodies, lines are
    facets. Source: Hooke, as above. Tolerance: 1e-10."""
    meshio_mesh(cell, by_array).write(tmp_path / f"plate.{ending}")
    found = stretched(tmp_path, f"plate.{ending}", "plane-stress")
    assert found[:, 3:] == pytest.approx(hooke("plane-stress", found[:, :3]), abs=1e-10)


def test_numbers_of_formats(tmp_path):
    """Requirement: numbers of a format are body1, surface2 ... in the plane as in space, of Medit
    and Nastran. Source: definition."""
    from anisocontact.mesh.readers import file_arrays

    def numbered(key):
        def names(blocks):
            return {"cell_data": {key: [np.full(len(r), k) for k, (_, r) in enumerate(blocks, 1)]}}

        return names

    for ending, key in (("mesh", "medit:ref"), ("bdf", "nastran:ref")):
        mesh = meshio_mesh("quad", numbered(key))
        mesh.cells.pop()
        mesh.cell_data[key].pop()
        mesh.write(tmp_path / f"plate.{ending}")
        found = file_arrays(tmp_path / f"plate.{ending}")
        assert found.cell == "quadrilateral"
        assert list(found.bodies) == ["body1"]
        assert sorted(found.facets) == ["body1.surface2", "body1.surface3"]


def test_convert_and_back(tmp_path):
    """Requirement: a deck in the plane becomes files of gmsh and VTK that give the same mesh.
    Source: the deck. Tolerance: 1e-12."""
    pytest.importorskip("meshio")
    from anisocontact.mesh.readers import file_arrays
    from anisocontact.mesh.write import write_mesh

    (tmp_path / "plate.inp").write_text(deck("CAX8R"))
    mesh = file_arrays(tmp_path / "plate.inp")
    for name in ("plate.msh", "plate.vtu"):
        write_mesh(mesh, tmp_path / name)
        again = file_arrays(tmp_path / name)
        assert sorted(again.facets) == sorted(mesh.facets)
        assert list(again.nodes) == list(mesh.nodes)
        ours, theirs = (m.points[np.lexsort(m.points.T)] for m in (mesh, again))
        assert theirs == pytest.approx(ours, abs=1e-12)


RINGS = """*NODE
 1, 0.95, 0.1
 2, 0.95, 0.0
 3, 1.05, 0.0
 4, 1.05, 0.1
 5, 0.95, 0.05
 6, 1.0, 0.0
 7, 1.05, 0.05
 8, 1.0, 0.1
 9, 1.05, 0.1
 10, 1.05, 0.0
 11, 1.15, 0.0
 12, 1.15, 0.1
 13, 1.05, 0.05
 14, 1.1, 0.0
 15, 1.15, 0.05
 16, 1.1, 0.1
*ELEMENT, TYPE=CAX8, ELSET=INSIDE
 1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=CAX8, ELSET=OUTSIDE
 2, 9, 10, 11, 12, 13, 14, 15, 16
*SURFACE, NAME=SLAVE
 2, S1
*SURFACE, NAME=MASTER
 1, S3
*NSET, NSET=MIDDLE
 5, 15
*SOLID SECTION, ELSET=INSIDE, MATERIAL=STEEL
*SOLID SECTION, ELSET=OUTSIDE, MATERIAL=STEEL
"""
SHRUNK = """
[mesh]
file = "rings.inp"
[idealisation]
kind = "axisymmetric"
[material.inside]
model = "linear-elastic"
E = 210e3
nu = 0.3
expansion = 12e-6
[material.outside]
model = "linear-elastic"
E = 210e3
nu = 0.3
[[contact]]
slave = "outside.slave"
master = "inside.master"
normal = { penalty = 1e7 }
friction = { coefficients = 0 }
method = "penalty"
[[step]]
name = "heat"
increments = 2
displacement = { "inside.middle" = { y = 0 }, "outside.middle" = { y = 0 } }
temperature = { inside = 727 }
"""
#: Radial displacement of the inner and the outer face in CalculiX 2.11, `ring1` of its examples.
CALCULIX = {(0.95, 0.05): 3.943400e-03, (1.15, 0.05): 4.760569e-03}


def test_rings_of_calculix(tmp_path):
    """Two concentric rings, the inner one is heated: the deck `ring1` of CalculiX.

    Requirement: the displacements that CalculiX prints. Source: reference results of its examples,
    with NLGEOM. Tolerance: 0.5 %, the size of the strains, which small strain leaves out.
    """
    from anisocontact.case import load
    from anisocontact.case.build import build

    (tmp_path / "rings.inp").write_text(RINGS)
    case = tmp_path / "case.toml"
    case.write_text(SHRUNK)
    built = build(load(str(case)))
    list(built.solver.run())
    x = built.problem.model.space.tabulate_dof_coordinates()
    u = built.problem.u.x.array.reshape(-1, 3)
    for place, wanted in CALCULIX.items():
        node = np.linalg.norm(x[:, :2] - place, axis=1).argmin()
        assert u[node, 0] == pytest.approx(wanted, rel=5e-3)
