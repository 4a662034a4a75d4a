"""Surfaces of files with facets between two cells."""

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.mesh.readers import file_arrays
from anisocontact.mesh.whole import WholeMesh

PILE = [[x, y, z] for z in (0.0, 1.0, 2.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
UPPER = "5, 6, 7, 8, 9, 10, 11, 12"
FLIPPED = "9, 10, 11, 12, 5, 6, 7, 8"
MIRRORED = "5, 8, 7, 6, 9, 12, 11, 10"


def deck(tmp_path, surface: str, upper: str = UPPER, part: bool = False):
    """Two hexahedra on each other, whose common face is S2 of element 4 and S1 of element 7."""
    nodes = [f"{k}, {x}, {y}, {z}" for k, (x, y, z) in enumerate(PILE, 1)]
    lines = ["*NODE", *nodes, "*ELEMENT, TYPE=C3D8, ELSET=ALL", "4, 1, 2, 3, 4, 5, 6, 7, 8"]
    lines += [f"7, {upper}", "*SURFACE, NAME=SOLE", *surface.split("; ")]
    if part:
        lines = ["*PART, NAME=P", *lines, "*SOLID SECTION, ELSET=ALL, MATERIAL=M", "*END PART"]
        # a node of the assembly: numbers of the instances begin behind it
        lines += ["*ASSEMBLY", "*NODE", "20, 50., 0., 0."]
        lines += ["*INSTANCE, NAME=A, PART=P", "*END INSTANCE"]
        lines += ["*INSTANCE, NAME=B, PART=P", "9., 0., 0.", "*END INSTANCE", "*END ASSEMBLY"]
    path = tmp_path / "pile.inp"
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize(
    ("surface", "upper", "part", "said"),
    [
        (
            "4, S1; 7, S1",
            UPPER,
            False,
            "1 of 2 facets lie inside the mesh, such as S1 of element 7",
        ),
        ("ALL, S1", UPPER, False, "1 of 2 facets lie inside the mesh, such as S1 of element 7"),
        ("ALL, ; 4, S2", UPPER, False, "1 of 13 facets lie inside the mesh, such as S2 of elem"),
        ("4, S1; 7, S1", UPPER, True, "2 of 4 facets lie inside the mesh, such as S1 of element 7"),
        ("4, S1; 7, S2", FLIPPED, False, "1 of 2 facets lie inside the mesh, such as S2 of elem"),
        ("4, S1", "1, 2, 3, 4, 5, 6, 7, 8", False, "1 of 2 hexahedrons have the nodes of another"),
        ("ALL, S1; 4, S2", "1, 2, 3, 4, 5, 6, 7, 8", False, "1 of 2 hexahedrons have the nodes of"),
        ("4, S1", "5, 6, 7, 8, 9, 10, 11, 99", True, "element 7 of instance 'A' has node 99, "),
        ("9, S1", UPPER, True, "it names a face of element 9 of instance 'A', which is not there"),
    ],
)
def test_a_part_of_a_surface_inside_is_refused(tmp_path, surface, upper, part, said):
    """Requirement: no facet of a surface is left out in silence. Source: faces of Abaqus by nodes,
    also of a cell that is upside down: its S2 lies inside."""
    with pytest.raises(InputError) as caught:
        file_arrays(deck(tmp_path, surface, upper, part))
    assert said in str(caught.value) and "\n" not in str(caught.value)


def test_faces_that_are_free_are_taken(tmp_path):
    """Requirement: all free faces of a set, and those of cells numbered the other way round, by
    their nodes; a surface inside, as of a bolt's pre-tension, is told and is no group."""
    assert len(file_arrays(deck(tmp_path, "ALL,")).facets["body.sole"]) == 10
    for upper, face in ((MIRRORED, "S2"), (FLIPPED, "S1")):
        mesh = file_arrays(deck(tmp_path, f"7, {face}", upper))
        (facet,) = mesh.facets["body.sole"]
        assert np.array_equal(mesh.points[facet][:, 2], 4 * [2.0]), upper
    mesh = file_arrays(deck(tmp_path, "4, S2"))
    assert not mesh.facets
    said = "surface 'sole' lies inside the mesh, such as S2 of element 4: no facet group"
    assert mesh.notes == (said,)


def test_facets_by_their_nodes_are_refused_alike():
    """Requirement: as of decks where a format has no faces, in cells that are cut as well."""
    mesh = WholeMesh(np.array(PILE))
    mesh.add_cells("hexahedron", np.arange(8)[None], ["a"])
    mesh.add_cells("prism", np.array([[4, 5, 6, 8, 9, 10], [4, 6, 7, 8, 10, 11]]), ["a", "a"])
    mesh.surfaces["sole"] = [np.array([[0, 1, 2, 3]]), np.array([[8, 9, 10]])]
    assert len(mesh.arrays().facets["a.sole"]) == 3
    mesh.surfaces["layer"] = [np.array([[4, 6, 10, 8]])]
    told = [note for note in mesh.arrays().notes if "inside" in note]
    assert told == ["surface 'layer' lies inside the mesh: no facet group"]
    for inner in ([4, 6, 10, 8], [4, 5, 6, 7]):
        mesh.surfaces["sole"] = [np.array([inner, [0, 1, 2, 3]])]
        with pytest.raises(InputError, match="facets lie inside the mesh; a group must lie"):
            mesh.arrays()
