"""CAD and surfaces of triangles as bodies: volumes and areas against closed forms."""

from __future__ import annotations

import math

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
pytest.importorskip("gmsh", exc_type=(ImportError, OSError))

import gmsh

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.cli import main
from anisocontact.mesh import MeshFile, Model, build_mesh, make_selector
from anisocontact.mesh.described import described


@pytest.fixture
def draw(tmp_path):
    def draw(name, shapes, mesh=False):
        gmsh.initialize(interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            shapes(gmsh.model.occ)
            gmsh.model.occ.synchronize()
            if mesh:
                gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
                gmsh.model.mesh.generate(2)
            gmsh.write(str(tmp_path / name))
        finally:
            gmsh.finalize()
        return tmp_path / name

    return draw


def volume(model):
    return model.mesh.comm.allreduce(
        fem.assemble_scalar(fem.form(fem.Constant(model.mesh, 1.0) * ufl.dx))
    )


def test_a_cylinder_of_step(draw, capsys):
    """Requirement: volume pi r^2 h, side 2 pi r h by its place; curved cells of this size are
    off by less than 1e-4 (24 arcs of 15 degrees: 1e-5)."""
    path = draw("pin.step", lambda occ: occ.addCylinder(0, 0, 0, 0, 0, 3, 1))
    side = make_selector("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=1.0)
    model = build_mesh([MeshFile(path, rename={"body": "pin"})], {"pin.side": [side]})
    assert model.order == 2
    assert volume(model) == pytest.approx(3.0 * math.pi, rel=1e-4)
    assert model.facet_names()[:3] == ["pin.face1", "pin.face2", "pin.face3"]
    assert model.count_facets("pin.side") == model.count_facets("pin.face1")
    assert main(["check", str(path)]) == 0
    said = capsys.readouterr().out
    assert "body      body: " in said
    assert "tetrahedra of order 2, box (-1, -1, 0) to (1, 1, 3)" in said


def test_cells_of_the_size_that_is_asked_for(draw):
    path = draw("box.brep", lambda occ: occ.addBox(0, 0, 0, 2, 1, 1))
    counts = [
        build_mesh([MeshFile(path, cell_size=size)]).mesh.topology.index_map(3).size_global
        for size in (1.0, 0.25)
    ]
    assert counts[1] > 10 * counts[0]
    assert volume(build_mesh([MeshFile(path, cell_size=1.0)])) == pytest.approx(2.0, rel=1e-12)


def test_two_volumes(draw):
    def shapes(occ):
        occ.addBox(0, 0, 0, 1, 1, 1)
        occ.addBox(2, 0, 0, 1, 1, 1)

    path = draw("two.step", shapes)
    model = build_mesh([MeshFile(path, cell_size=1.0)])
    assert model.body_names() == ["body1", "body2"]
    assert "body2.face6" in model.facet_names()
    assert build_mesh([MeshFile(path, ["body2"], cell_size=1.0)]).body_names() == ["body2"]


def test_a_closed_surface_of_triangles(draw):
    """Requirement: volume and area of what the triangles bound, here a box."""
    path = draw("box.stl", lambda occ: occ.addBox(0, 0, 0, 2, 1, 1), mesh=True)
    arrays = MeshFile(path, cell_size=0.5).arrays()
    assert volume(Model.from_arrays(arrays)) == pytest.approx(2.0, rel=1e-9)
    areas = [float(line.split()[-1]) for line in described(arrays) if line.startswith("group")]
    assert sum(areas) == pytest.approx(10.0, rel=1e-5)


def test_what_is_wrong_is_one_line(tmp_path, draw):
    (tmp_path / "no.step").write_text("nothing")
    with pytest.raises(InputError, match=r"no\.step': (gmsh cannot|no volume)") as caught:
        build_mesh([MeshFile(tmp_path / "no.step")])
    assert "\n" not in str(caught.value)
    path = draw("sheet.brep", lambda occ: occ.addRectangle(0, 0, 0, 1, 1))
    with pytest.raises(InputError, match=r"sheet\.brep': no volume is in it"):
        build_mesh([MeshFile(path)])
    with pytest.raises(InputError, match=r"cell_size: given for 'part\.msh', which is a mesh"):
        build_mesh([MeshFile("part.msh", cell_size=1.0)])
