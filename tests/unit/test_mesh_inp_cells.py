"""Cells of input files of Abaqus and CalculiX: faces, curves, and several kinds that are cut."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.unit.test_mesh_inp import CUBE, areas, volume, written

from anisocontact.base.errors import InputError
from anisocontact.mesh import GmshFile, build_mesh
from anisocontact.mesh.readers import file_arrays


@pytest.mark.parametrize(
    ("face", "normal"),
    [*enumerate([(0, 0, -1), (0, 0, 1), (0, -1, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)], 1)],
)
def test_every_face_of_a_hexahedron(tmp_path, face, normal):
    text = CUBE.replace("cube, S2", f"Cube, S{face}")
    found = areas(build_mesh([GmshFile(written(tmp_path, text))]), "cube.upper")
    assert found[1] == pytest.approx(4.0 * np.array(normal), abs=1e-12)


TET = """\
*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 0, 1, 0
4, 0, 0, 1
5, .5, 0, 0
6, .5, .5, 0
7, 0, .5, 0
8, 0, 0, .5
9, .5, 0, .5
10, 0, .5, .5
*ELEMENT, TYPE=C3D10, ELSET=tet
1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10
*SURFACE, NAME=face
1, S{face}
"""


@pytest.mark.parametrize(
    ("face", "normal"), [*enumerate([(0, 0, -1), (0, -1, 0), (1, 1, 1), (-1, 0, 0)], 1)]
)
def test_every_face_of_a_tetrahedron(tmp_path, face, normal):
    """Middle nodes off their edges would make other volumes; normals tell the faces apart."""
    model = build_mesh([GmshFile(written(tmp_path, TET.format(face=face)))])
    assert model.body_names() == ["body"]
    assert volume(model) == pytest.approx(1 / 6)
    assert areas(model, "body.face")[1] == pytest.approx(0.5 * np.array(normal), abs=1e-12)


def ring_of_twenty_nodes(n: int) -> str:
    """A quarter of a ring of radii 1 and 2 and height 1, middle nodes on its circles."""
    numbers: dict[tuple[float, ...], int] = {}
    lines = []
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    corners += [(x, y, 1) for x, y, _ in corners]
    pairs = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
    pairs += [(k, k + 4) for k in range(4)]
    local = [np.array(c, float) for c in corners]
    local += [0.5 * (local[a] + local[b]) for a, b in pairs]
    for i in range(n):
        for j in range(n):
            keys = [tuple(np.round(2 * np.add(x, (i, j, 0))).tolist()) for x in local]
            row = [numbers.setdefault(key, len(numbers) + 1) for key in keys]
            lines += [f"{len(lines) // 2 + 1}, " + ", ".join(map(str, row[:15])) + ","]
            lines += [", ".join(map(str, row[15:]))]
    nodes = []
    for (a, b, c), number in numbers.items():
        r, angle = 1 + a / (2 * n), 0.5 * np.pi * b / (2 * n)
        nodes.append(f"{number}, {r * np.cos(angle)!r}, {r * np.sin(angle)!r}, {c / 2}")
    wall = (
        f"*SURFACE, NAME=outer\n{', S4\n'.join(str(n * (n - 1) + k + 1) for k in range(n))}, S4\n"
    )
    text = "*NODE\n" + "\n".join(nodes).replace("np.float64(", "").replace(")", "")
    return text + "\n*ELEMENT, TYPE=C3D20\n" + "\n".join(lines) + "\n" + wall


def test_twenty_nodes_keep_their_curves(tmp_path):
    """Faces and cells get middle nodes where the shape functions of 20 nodes have them.

    Source: volume 3 pi / 4 and area pi of the quarter ring. Tolerance: quadratic arcs have errors
    of the fourth order: a sixteenth at half of the cells (asserted between 13 and 19).
    """
    errors = []
    for n in (1, 2):
        model = build_mesh([GmshFile(written(tmp_path, ring_of_twenty_nodes(n)))])
        assert model.order == 2
        found = volume(model), areas(model, "body.outer")[0]
        errors.append(np.abs(np.array(found) - [0.75 * np.pi, np.pi]))
    assert np.all((errors[0] / errors[1] > 13.0) & (errors[0] / errors[1] < 19.0))
    assert errors[1][0] < 1e-3 * 0.75 * np.pi


def test_cells_of_unlike_order_are_refused(tmp_path):
    more = CUBE.replace(
        "*NSET, NSET=Low, G",
        "*ELEMENT, TYPE=C3D10\n7, 1, 2, 30, 5, 6, 7, 8, 4, 1, 2\n*NSET, NSET=Low, G",
    )
    with pytest.raises(InputError, match="of 8 nodes and tetrahedrons of 10 nodes: cells of one"):
        file_arrays(
            written(tmp_path, more.replace("*SOLID SECTION, ELSET=CUBE,\n MATERIAL=steel\n", ""))
        )


def mixed(order: int) -> str:
    """Two cubes, one a hexahedron, one two prisms, with a pyramid and tetrahedra on top.

    Nodes lie where the shear x + y^2/5 has them, of order 1 the corners on straight edges.
    """
    corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1, 2)]
    corners += [(0.5, 0.5, 2), (2, 1, 2)]
    cells = {
        "C3D8": [(0, 1, 4, 3, 6, 7, 10, 9)],
        "C3D6": [(1, 2, 5, 7, 8, 11), (1, 5, 4, 7, 11, 10)],
        "C3D5": [(6, 7, 10, 9, 12)],
        "C3D4": [(7, 8, 11, 13), (7, 11, 10, 13)],
    }
    places = [tuple(float(v) for v in x) for x in corners]
    if order == 2:
        from anisocontact.mesh.tetrahedra import EDGES

        names = {"C3D8": "hexahedron", "C3D6": "prism", "C3D5": "pyramid", "C3D4": "tetrahedron"}
        known: dict[frozenset, int] = {}
        more = {"C3D8": "C3D20", "C3D6": "C3D15", "C3D5": "C3D13", "C3D4": "C3D10"}
        lifted = {}
        for kind, rows in cells.items():
            lifted[more[kind]] = []
            for row in rows:
                ends = [frozenset((row[a], row[b])) for a, b in EDGES[names[kind]]]
                for pair in ends:
                    if pair not in known:
                        known[pair] = len(places)
                        places.append(tuple(np.mean([places[k] for k in pair], axis=0)))
                lifted[more[kind]].append((*row, *(known[pair] for pair in ends)))
        cells = lifted
    bend = 0.2 * (order - 1)
    lines = ["*NODE, NSET=all"]
    lines += [f"{k}, {x + bend * y**2}, {y}, {z}" for k, (x, y, z) in enumerate(places, 1)]
    number = 1
    for kind, rows in cells.items():
        for row in rows:
            lines += [f"*ELEMENT, TYPE={kind}, ELSET=e{number}"]
            data = [number, *(k + 1 for k in row)]
            lines += [", ".join(map(str, data[k : k + 16])) + "," for k in range(0, len(data), 16)]
            number += 1
    lines += ["*SURFACE, NAME=under", "e1, S1", "e2, S1", "e3, S1"]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("order", [1, 2])
def test_cells_of_several_kinds_become_tetrahedra_that_fit(tmp_path, order):
    """A hexahedron, prisms, a pyramid and tetrahedra that share faces, straight and curved.

    Requirement: the volume is that of the cells; the boundary is theirs, so that no face inside is
    left open; a surface of a hexahedron and of prisms has its area. Tolerance: rounding; the shear
    that bends the cells of order 2 keeps the volume, and quadratic cells have it exactly.
    """
    model = build_mesh([GmshFile(written(tmp_path, mixed(order)))])
    assert model.mesh.topology.cell_name() == "tetrahedron"
    assert model.order == order
    assert volume(model) == pytest.approx(2.0 + 1.0 / 3.0 + 1.0 / 3.0, rel=1e-12)
    area, normal = areas(model, "body.under")
    assert normal == pytest.approx([0, 0, -2], abs=1e-12)
    assert area == pytest.approx(2.0, rel=1e-12)
    if order == 1:
        # 2 + 2 + 2 * 1 of the cubes' sides, the tent's 4 slopes, and the two tetrahedra's skin
        slopes = 4 * 0.5 * np.hypot(1.0, 0.5)
        roof = 0.5 + 0.5 + np.sqrt(0.5) + np.sqrt(0.5)
        assert areas(model, "body.all")[0] == pytest.approx(8.0 + slopes + roof, rel=1e-12)
