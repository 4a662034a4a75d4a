"""Universal files: what gmsh writes, read as the same mesh as its own format."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
pytest.importorskip("gmsh")

import gmsh

from anisocontact.base.errors import InputError
from anisocontact.mesh.quality import scaled_jacobian
from anisocontact.mesh.readers import file_arrays


@pytest.fixture
def draw(tmp_path):
    """Mesh a cylinder, or a box of hexahedra, write it as UNV and as gmsh's own."""

    def made(cell: str, order: int):
        gmsh.initialize(interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            occ = gmsh.model.occ
            if cell == "tetrahedron":
                volume = (3, occ.addCylinder(0, 0, 0, 0, 0, 1, 1))
            elif cell == "prism":
                disc = [(2, occ.addDisk(0, 0, 0, 1, 1))]
                volume = occ.extrude(disc, 0.1, 0, 1, [2], recombine=True)[1]
            else:
                volume = (3, occ.addBox(0, 0, 0, 2, 1, 1))
            occ.synchronize()
            gmsh.model.addPhysicalGroup(3, [volume[1]], name="part")
            for k, (_, face) in enumerate(gmsh.model.getBoundary([volume], oriented=False)):
                gmsh.model.addPhysicalGroup(2, [face], name=f"face{k}")
            if cell == "hexahedron":
                gmsh.model.mesh.setTransfiniteAutomatic()
            gmsh.option.setNumber("Mesh.MeshSizeMax", 0.6)
            gmsh.option.setNumber("Mesh.ElementOrder", order)
            gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
            gmsh.option.setNumber("Mesh.SaveGroupsOfElements", 1)
            gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 0)
            gmsh.model.mesh.generate(3)
            for suffix in ("unv", "msh"):
                gmsh.write(str(tmp_path / f"mesh.{suffix}"))
        finally:
            gmsh.finalize()
        return tmp_path / "mesh.unv", tmp_path / "mesh.msh"

    return made


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("cell", ["tetrahedron", "prism", "hexahedron"])
def test_it_is_the_mesh_that_gmsh_has(draw, cell, order):
    """Source: gmsh, which writes both. Tolerance: the digits of the text."""
    unv, msh = (file_arrays(path) for path in draw(cell, order))
    assert unv.cell == msh.cell == ("tetrahedron" if cell == "prism" else cell)
    assert (unv.order, unv.degree) == (msh.order, msh.degree) == (order, order)
    assert len(unv.cells) == len(msh.cells)
    assert list(unv.bodies) == list(msh.bodies) == ["part"]

    def sorted_cells(mesh):
        places = mesh.points[mesh.cells].round(7)
        return places[np.lexsort(places[:, :4].mean(axis=1).T)]

    if cell != "prism":  # which diagonal is cut along goes by the numbers of nodes
        assert sorted_cells(unv) == pytest.approx(sorted_cells(msh), abs=1e-6)
    assert scaled_jacobian(unv).min() > 0.1
    assert {k: len(v) for k, v in unv.facets.items()} == {k: len(v) for k, v in msh.facets.items()}
    assert len(unv.facets) == (6 if cell == "hexahedron" else 3)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("solid part\n", "no dataset of a universal file is in it"),
        (
            "    -1\n  2411\n 1 0 0 0\n 0.0 0.0 0.0\n    -1\n",
            r"no solid element \(111, .*none at all",
        ),
        ("    -1\n  2412\n 7 111 1 1 1 4\n 1 2 3\n    -1\n", "dataset 2412 at line 2: its data"),
        (
            "    -1\n  2412\n 7 111 1 1 1 4\n 1 2 3 4\n    -1\n",
            "element 7 has node 1, which is not",
        ),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path, content, said):
    path = tmp_path / "bad.unv"
    path.write_text(content)
    with pytest.raises(InputError, match=said) as caught:
        file_arrays(path, field="mesh.file")
    assert str(caught.value).startswith("mesh.file: mesh file")
