"""Input of Abaqus and CalculiX as meshes: bodies, groups, instances, mistakes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import dolfinx, fem, ufl
from anisocontact.mesh import GmshFile, Placement, PlaneStrain, Rotation, build_mesh
from anisocontact.mesh.deck_reader import read_deck
from anisocontact.mesh.readers import file_arrays

CUBE = """\
*HEADING
** a cube of side 2 and, as a set of its own, nothing else
*Node, nset=Nall
 1, 0., 0.
 2, 2., 0., 0.
 30, 2., 2., 0.
 4, 0., 2., 0.
 5, 0., 0., 2.
 6, 2., 0., 2.
 7, 2., 2., 2.
 8, 0., 2., 2.
*ELEMENT, TYPE=C3D8R, ELSET=Cube
 100, 1, 2, 30, 4,
 5, 6, 7, 8
*NSET, NSET=Low, GENERATE
 1, 2
*NSET, NSET=Low
 30, 4
*NSET, NSET=corner
 7
*SURFACE, NAME=Upper, TYPE=ELEMENT
 cube, S2
*SURFACE, NAME=side, TYPE=ELEMENT
 100, S3
*SOLID SECTION, ELSET=CUBE,
 MATERIAL=steel
*STEP
*STATIC
*END STEP
"""


def written(tmp_path: Path, text: str, name: str = "mesh.inp") -> Path:
    path = tmp_path / name
    path.write_text(text)
    return path


def areas(model, group: str) -> tuple[float, list[float]]:
    """Area of a group and its mean outward normal."""
    facets = np.sort(model.facets(group))
    model.mesh.topology.create_connectivity(2, 3)
    tags = dolfinx.mesh.meshtags(model.mesh, 2, facets, np.ones(len(facets), dtype=np.int32))
    ds = ufl.Measure("ds", domain=model.mesh, subdomain_data=tags)(1)
    n = ufl.FacetNormal(model.mesh)
    one = fem.assemble_scalar(fem.form(fem.Constant(model.mesh, 1.0) * ds))
    normal = [fem.assemble_scalar(fem.form(n[i] * ds)) for i in range(3)]
    return one, normal


def volume(model) -> float:
    dx = ufl.dx(domain=model.mesh)
    return float(fem.assemble_scalar(fem.form(fem.Constant(model.mesh, 1.0) * dx)))


def test_sections_are_bodies_and_sets_are_groups(tmp_path):
    model = build_mesh([GmshFile(written(tmp_path, CUBE))])
    assert model.body_names() == ["cube"]
    # all nodes hold all faces; one node holds none
    assert sorted(model.facet_names()) == ["cube.low", "cube.nall", "cube.side", "cube.upper"]
    assert volume(model) == pytest.approx(8.0)
    for group, area, normal in (
        ("cube.low", 4.0, [0, 0, -4]),
        ("cube.upper", 4.0, [0, 0, 4]),
        ("cube.side", 4.0, [0, -4, 0]),
        ("cube.nall", 24.0, [0, 0, 0]),
    ):
        found = areas(model, group)
        assert found[0] == pytest.approx(area)
        assert found[1] == pytest.approx(normal, abs=1e-12)


INSTANCES = """\
*PART, NAME=Brick
{nodes}*ELSET, ELSET=all
100
*SOLID SECTION, ELSET=all, MATERIAL=x
*SURFACE, NAME=Upper
all, S2
*END PART
*ASSEMBLY, NAME=a
*INSTANCE, NAME=first, PART=Brick
*END INSTANCE
*INSTANCE, NAME=second, PART=BRICK
10., 0., 0.
10., 0., 0., 10., 1., 0., 90.
*END INSTANCE
*NSET, NSET=held, INSTANCE=second
1, 2, 30, 4
*SURFACE, NAME=pressed
first.Upper_set, S1
*ELSET, ELSET=Upper_set, INSTANCE=first
100
*END ASSEMBLY
"""


def test_instances_are_placed_copies_of_parts(tmp_path):
    nodes = CUBE[CUBE.index("*Node") : CUBE.index("*NSET, NSET=Low, G")]
    text = INSTANCES.format(nodes=nodes).replace("first.Upper_set, S1", "Upper_set, S1")
    # a set may stand behind the surface that names it
    model = build_mesh([GmshFile(written(tmp_path, text))])
    assert model.body_names() == ["first", "second"]
    assert volume(model) == pytest.approx(16.0)
    assert areas(model, "first.pressed")[1] == pytest.approx([0, 0, -4], abs=1e-12)
    # turned by 90 degrees about y: up is along x, below is along -x
    assert areas(model, "second.upper")[1] == pytest.approx([4, 0, 0], abs=1e-12)
    assert areas(model, "second.held")[1] == pytest.approx([-4, 0, 0], abs=1e-12)


@pytest.mark.parametrize("before", ["*NSET, NSET=held", "*INSTANCE, NAME=second"])
def test_nodes_of_the_assembly_are_none_of_a_part(tmp_path, before):
    """Requirement: a reference point of the assembly with the number of a node of a part leaves the
    part as it is, wherever it stands. Source: Abaqus, numbers are those of a part or the assembly's
    own."""
    nodes = CUBE[CUBE.index("*Node") : CUBE.index("*NSET, NSET=Low, G")]
    text = INSTANCES.format(nodes=nodes).replace("first.Upper_set, S1", "Upper_set, S1")
    point = "*NODE\n1, 50., 60., 70.\n*NSET, NSET=rp\n1,\n"
    model = build_mesh([GmshFile(written(tmp_path, text.replace(before, point + before)))])
    assert volume(model) == pytest.approx(16.0)
    assert areas(model, "second.held")[1] == pytest.approx([-4, 0, 0], abs=1e-12)
    deck = read_deck(written(tmp_path, text.replace(before, point + before)))
    assert [deck.nodes[n] for n in deck.nodes_of("rp")] == [[50.0, 60.0, 70.0]]


def test_it_stands_where_it_is_put_and_bodies_are_renamed(tmp_path):
    path = written(tmp_path, CUBE)
    put = Placement(scale=0.5, rotate=Rotation((0, 0, 1), angle_deg=90.0), move=(1.0, 0.0, 0.0))
    model = build_mesh([GmshFile(path, rename={"cube": "block"}, placement=put)])
    assert model.body_names() == ["block"]
    assert volume(model) == pytest.approx(1.0)
    assert areas(model, "block.side")[1] == pytest.approx([1, 0, 0], abs=1e-12)


def test_a_file_may_include_others(tmp_path):
    head, tail = CUBE.split("*ELEMENT")
    written(tmp_path, head, "nodes.inp")
    path = written(tmp_path, f"*INCLUDE, INPUT=nodes.inp\n*ELEMENT{tail}")
    assert file_arrays(path).points.shape == (8, 3)


MISTAKES = [
    (CUBE.replace(" 7, 2., 2., 2.\n", ""), "element 100 has node 7, which is not there"),
    (CUBE.replace("5, 6, 7, 8", "5, 6"), "line 12: *ELEMENT: elements C3D8R need 8 nodes each"),
    (
        CUBE.replace("C3D8R", "S8R"),
        "no solid element (C3D4, C3D10, C3D8, C3D20, C3D6, C3D15, C3D5, C3D13, CPE, CPS, CAX); "
        "there are: 2",
    ),
    (CUBE.replace("2., 0., 2.", "two, 0., 2."), "line 3: *NODE: its data cannot be read"),
    (CUBE.replace("*HEADING", "*NCOPY\n1, 2"), "*NCOPY: is not read; write nodes and elements out"),
    (CUBE.replace("*HEADING", "*SYSTEM\n1, 2"), "*SYSTEM: is not read; write nodes and elements"),
    (CUBE.replace("*HEADING", "*NGEN\n1, 2"), "*NGEN: node 1 is not there"),
    (CUBE.replace("*HEADING", "1, 2, 3"), "line 1: data in front of the first keyword"),
    (CUBE.replace("*Node, nset=Nall", "*Node, INPUT=none.txt"), "none.txt' does not exist"),
    (CUBE[: CUBE.index(" 1, 0.")] + CUBE[CUBE.index("*EL") :], "no node: *NODE has no data"),
    (CUBE.replace("*HEADING", "*INCLUDE, INPUT=none.inp"), "does not exist"),
    (CUBE.replace("cube, S2", "cube, S7"), "face 'S7' given, S1 to S6 are read"),
    (CUBE.replace("cube, S2", "9, S2"), "it names a face of element 9, which is not there"),
    (CUBE.replace("cube, S2", "cube, SPOS"), "face 'SPOS' given, S1 to S6 are read"),
    (CUBE.replace("5, 6, 7, 8", "5, 6, 7.5, 8"), "7.5 given, elements and nodes have whole"),
    (
        CUBE.replace(
            "*NSET, NSET=Low, G", "*ELEMENT, TYPE=C3D4\n100, 1, 2, 30, 5\n*NSET, NSET=Low, G"
        ),
        "*ELEMENT: element 100 is given once more, as another one",
    ),
    (f"{CUBE}*NSET, NSET=back, GENERATE\n4, 1, 1\n", "4, 1, 1 given, GENERATE needs first, last"),
    (f"{CUBE}*NSET, NSET=back, GENERATE\n1, 4, 0\n", "1, 4, 0 given, GENERATE needs first, last"),
    (f"{CUBE}*NSET, NSET=back, GENERATE\n1, 2, 3, 4\n", "1, 2, 3, 4 given, GENERATE needs first"),
    (CUBE.replace("TYPE=C3D8R, ", ""), "*ELEMENT needs the option TYPE"),
    (CUBE.replace("1, 2, 30, 4,\n 5, 6, 7, 8", "1, 2, 4, 30, 5, 6, 7, 8"), "flat or inverted"),
]


@pytest.mark.parametrize(("text", "said"), MISTAKES, ids=[said for _, said in MISTAKES])
def test_what_is_wrong_is_one_line(tmp_path, text, said):
    with pytest.raises(InputError) as caught:
        file_arrays(written(tmp_path, text), field="mesh.file")
    line = str(caught.value)
    assert line.startswith("mesh.file: mesh file")
    assert said in line
    assert "\n" not in line


def test_what_is_legal_and_hardly_meant_is_said(tmp_path):
    """Requirement: a node at a second place, and a surface without faces, are no silence; the same
    node and element once more, and faces of some elements, are nothing to be told."""
    notes = file_arrays(written(tmp_path, CUBE)).notes
    again = CUBE.replace("*ELEMENT,", " 7, 2., 2., 2.\n*ELEMENT,")
    assert file_arrays(written(tmp_path, again)).notes == notes
    other = (
        again.replace("2., 2., 2.\n*EL", "2., 2., 2.5\n*EL")
        + "*SURFACE, NAME=None\nshells, S1\n*NSET, NSET=both\nLow, Lwo\n"
    )
    assert set(file_arrays(written(tmp_path, other)).notes) - set(notes) == {
        "1 nodes are given once more, at another place: the last one counts",
        "sets name others that are not there: lwo",
        "surface 'none' has no face of a solid: its set of elements is not there",
    }
    # nodes of a part count in each of its instances
    part = other[other.index("*Node") : other.index("*NSET, NSET=Low, G")]
    (said,) = (
        note
        for note in file_arrays(written(tmp_path, INSTANCES.format(nodes=part))).notes
        if "once more" in note
    )
    assert said.startswith("2 nodes are given once more")


def test_data_in_files_and_nodes_of_elements(tmp_path):
    """Requirement: data that stand in a file of their own are read, and a node set of a set of
    elements has their nodes; letters of an editor of one byte each stay apart."""
    start, end = CUBE.index(" 1, 0."), CUBE.index("*ELEMENT")
    (tmp_path / "nodes.txt").write_text(f"** nodes\n{CUBE[start:end]}")
    head = CUBE[:start].replace("nset=Nall", "nset=Nall, input=nodes.txt")
    text = head + CUBE[end:] + "*NSET, NSET=Mine, ELSET=Cube\n*NSET, NSET=\xdcber\n7\n"
    path = written(tmp_path, text)
    path.write_bytes(text.encode("latin-1"))
    deck, plain = read_deck(path), read_deck(written(tmp_path, CUBE))
    assert deck.nodes == plain.nodes
    assert sorted(deck.node_sets["MINE"]) == sorted(deck.nodes)
    assert deck.node_sets["\xdcBER"] == [7]


def test_a_case_file_takes_it(tmp_path, monkeypatch):
    """Source: the same block as a built-in shape, whose force is the same to rounding."""
    from anisocontact.case import load
    from anisocontact.case.build import build

    monkeypatch.chdir(tmp_path)
    written(tmp_path, CUBE)
    case = """
[surface.plate]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
[material.cube]
model = "linear-elastic"
E = 1000
nu = 0.3
[[contact]]
slave = "cube.{low}"
master = "plate"
friction = {{ coefficients = 0.3 }}
[[step]]
name = "press"
increments = 1
displacement = {{ "cube.{upper}" = {{ x = 0.01, y = 0, z = -0.01 }} }}
"""
    shape = "[mesh.box.cube]\norigin = [0, 0, 0]\nsize = [2, 2, 2]\ncells = [1, 1, 1]\n"
    forces = []
    for mesh, low, upper in (
        ('[mesh]\nfile = "mesh.inp"\n', "low", "upper"),
        (shape, "bottom", "top"),
    ):
        Path("case.toml").write_text(mesh + case.format(low=low, upper=upper))
        (end,) = build(load("case.toml")).solver.run()
        ((force, _),) = end.resultants.values()
        forces.append(force)
    assert forces[0] == pytest.approx(forces[1], rel=1e-9)


PLATES = """\
*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 2., 0.
6, 1., 2., 0.
7, 1., 3., 0.
8, 0., 3., 0.
*ELEMENT, TYPE=CPE4, ELSET=Lower
1, 1, 2, 3, 4
*ELEMENT, TYPE=CPE4, ELSET=Upper
2, 5, 6, 7, 8
"""


def test_sets_of_a_plane_are_bodies_where_there_is_no_section(tmp_path):
    """Requirement: sets that have every element once are bodies in the plane as in space."""
    model = build_mesh([GmshFile(written(tmp_path, PLATES))], idealisation=PlaneStrain())
    assert list(model.body_names()) == ["lower", "upper"]
