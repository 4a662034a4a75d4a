"""Exodus files: element blocks, side sets and node sets with the numbering of the format."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import dolfinx, fem, ufl
from anisocontact.mesh import GmshFile, Model, build_mesh
from anisocontact.mesh.readers import file_arrays

netcdf = pytest.importorskip("netCDF4")

#: Corners of a cube, and its nodes of order 2 in the order of the format: middles of the edges
#: below, upright and above; centre; middles of the faces below, above, left, right, front, back.
CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
MIDDLES = [
    *((1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0)),
    *((0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)),
    *((1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2)),
    *((1, 1, 1), (1, 1, 0), (1, 1, 2), (0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1)),
]
#: Sides 1 to 6 of a hexahedron: outward normals.
NORMALS = [(0, -1, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, 0, -1), (0, 0, 1)]


def write(
    path: Path,
    points: np.ndarray,
    blocks: list[tuple[str, str, np.ndarray]],
    sides: dict[str, list[tuple[int, int]]],
) -> None:
    """An Exodus file of blocks (name, element, nodes from 1 on) and side sets (element, side)."""

    def names(kind: str, given: list[str]) -> None:
        data.createDimension(f"num_{kind}", len(given))
        rows = np.array([list(n.encode().ljust(33, b"\0")) for n in given], dtype=np.uint8)
        variable = data.createVariable(f"{kind}_names", "S1", (f"num_{kind}", "len_name"))
        variable[:] = rows.view("S1")

    with netcdf.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as data:
        data.createDimension("len_name", 33)
        data.createDimension("num_nodes", len(points))
        for axis, values in zip("xyz", points.T, strict=True):
            data.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = values
        names("eb", [name for name, _, _ in blocks])
        for k, (_, element, nodes) in enumerate(blocks, 1):
            data.createDimension(f"elements{k}", nodes.shape[0])
            data.createDimension(f"nodes{k}", nodes.shape[1])
            shape = (f"elements{k}", f"nodes{k}")
            variable = data.createVariable(f"connect{k}", "i4", shape)
            variable.elem_type = element
            variable[:] = nodes
        names("ss", list(sides))
        for k, pairs in enumerate(sides.values(), 1):
            data.createDimension(f"sides{k}", len(pairs))
            for word, column in zip(("elem", "side"), np.array(pairs).T, strict=True):
                data.createVariable(f"{word}_ss{k}", "i4", (f"sides{k}",))[:] = column


def outward(model: Model, group: str) -> np.ndarray:
    """Integral of the outward normal over a facet group."""
    facets = np.sort(model.facets(group))
    tags = dolfinx.mesh.meshtags(model.mesh, 2, facets, np.ones(len(facets), np.int32))
    ds = ufl.ds(domain=model.mesh, subdomain_data=tags)(1)
    n = ufl.FacetNormal(model.mesh)
    return np.array([fem.assemble_scalar(fem.form(n[i] * ds)) for i in range(3)])


@pytest.mark.parametrize("count", [8, 20, 27])
@pytest.mark.parametrize("as_vtk", [False, True])
def test_blocks_are_bodies_and_side_sets_are_groups(tmp_path, count, as_vtk):
    """Requirement: each block a body by its name, each side of an element by its number, middle
    nodes where they are, whichever of the two orders a writer has. Tolerance: rounding."""
    cube = np.array((*CORNERS, *MIDDLES), dtype=float)[:count]
    order = np.arange(count)
    if as_vtk and count > 8:
        order[12:20] = [16, 17, 18, 19, 12, 13, 14, 15]
        order[20:] = [23, 24, 25, 26, 21, 22, 20][: count - 20]
    points = np.vstack([cube, cube + np.array([0, 0, 2])])
    rows = [order[None] + 1, order[None] + 1 + count]
    blocks = [("Grund körper", f"HEX{count}", rows[0]), ("punch", "HEX", rows[1])]
    sides = {f"s{k + 1}": [(2, k + 1)] for k in range(6)}
    path = tmp_path / "part.exo"
    write(path, points, blocks, sides | {"deck": [(1, 6)]})
    mesh = file_arrays(path)
    assert list(mesh.bodies) == ["Grund körper", "punch"]
    assert mesh.order == (1 if count == 8 else 2)
    model = build_mesh([GmshFile(path)])
    for k, normal in enumerate(NORMALS):
        assert outward(model, f"punch.s{k + 1}") == pytest.approx(4 * np.array(normal), abs=1e-12)
    assert outward(model, "Grund körper.deck") == pytest.approx([0, 0, 4], abs=1e-12)


def test_what_is_wrong_is_one_line(tmp_path):
    """Requirement: a side that an element does not have is told with its set."""
    path = tmp_path / "part.e"
    nodes = np.array([[1, 2, 3, 4]])
    points = np.array([p for p in product((0.0, 1.0), repeat=3) if sum(p) < 2])[[0, 3, 2, 1]]
    write(path, points, [("", "TETRA4", nodes)], {"top": [(1, 5)]})
    with pytest.raises(InputError, match="side set top has side 5 of a tetrahedron"):
        file_arrays(path)
    write(path, points, [("", "TETRA4", nodes)], {"top": [(1, 4)]})
    assert list(file_arrays(path).bodies) == ["body"]
