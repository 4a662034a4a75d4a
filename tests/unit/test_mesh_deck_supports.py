"""Supports of decks of Abaqus and CalculiX as lines of a case file, and node sets beyond facets."""

from pathlib import Path

import pytest

DECK = """*NODE, NSET=ALL
 1, 1, 0, 0
 2, 2, 0, 0
 3, 0, 2, 0
 4, 0, 1, 0
 5, 1, 0, 1
 6, 2, 0, 1
 7, 0, 2, 1
 8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=RING
 1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=IN
 1, 4, 5, 8
*NSET, NSET=FLOOR
 1, 2, 3, 4, 7
*TRANSFORM, NSET=IN, TYPE=C
 0, 0, 3, 0, 0, 5
*TRANSFORM, NSET=FAR, TYPE=R
 0, 1, 0, -1, 0, 0
*NSET, NSET=FAR
 6, 7
*SOLID SECTION, ELSET=RING, MATERIAL=STEEL
*BOUNDARY
 FLOOR, 3
 IN, 2, 3
 6, 1, 1, 0.5
*STEP
*STATIC
*BOUNDARY
 IN, 1, 1, 0.005
*END STEP
"""


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


def written(folder: Path, text: str) -> Path:
    path = folder / "deck.inp"
    path.write_text(text)
    return path


def lines(path: Path) -> list[str]:
    """What `check` says of supports."""
    from anisocontact.mesh.inp import deck_supports
    from anisocontact.mesh.readers import file_arrays

    mesh = file_arrays(path)
    return deck_supports(path, list(dict.fromkeys([*mesh.facets, *mesh.nodes])))


def test_lines_of_a_step(tmp_path):
    """Requirement: the supports as the manuals have them: TYPE=C radial, tangential, axial about
    the line through both points; a set that has some nodes with and some without asks for two."""
    deck = DECK.replace("FLOOR, 3", "IN, PINNED")
    assert lines(written(tmp_path, deck)) == [
        'from the start: cylindrical = { "ring.in" = { radial = 0, tangential = 0, axial = 0, '
        "axis = [0, 0, 2], point = [0, 0, 3] } }",
        "from the start: node 6, which [nodes] can name: displacement { y = 0.5 }",
        'step 1: cylindrical = { "ring.in" = { radial = 0.005, axis = [0, 0, 2], '
        "point = [0, 0, 3] } }",
    ]
    first, *_ = lines(written(tmp_path, DECK))
    assert first == (
        "from the start: the nodes of floor have several *TRANSFORM: give each a set of its own"
    )
    turned = DECK.replace("*TRANSFORM, NSET=FAR", "*NSET, NSET=FAR\n 6, 7\n*TRANSFORM, NSET=FAR")
    said = lines(written(tmp_path, turned.replace("6, 1, 1, 0.5", "FAR, 1, 2, 0.5")))
    assert said[2] == 'from the start: displacement = { "ring.far" = { y = 0.5, x = -0.5 } }'
    askew = turned.replace("0, 1, 0, -1, 0, 0", "1, 1, 0, -1, 1, 0")
    said = lines(written(tmp_path, askew.replace("6, 1, 1, 0.5", "FAR, 1")))
    assert "directions that are no axes of space" in said[2]
    said = lines(written(tmp_path, DECK.replace("FLOOR, 3", "FLOOR, 3, SUB, what")))
    assert "*BOUNDARY of line" in said[0]
    assert "is not read" in said[0]


def test_a_support_holds_all_nodes_of_a_set(tmp_path):
    """Requirement: a set of a face and one more node holds all five, as the deck says, while its
    facets are those of the face. Source: places of the nodes."""
    from anisocontact.mesh import GmshFile, build_mesh

    model = build_mesh([GmshFile(written(tmp_path, DECK))])
    x = model.space.tabulate_dof_coordinates()[model.nodes("ring.floor")]
    wanted = [[0, 1, 0], [0, 2, 0], [0, 2, 1], [1, 0, 0], [2, 0, 0]]
    assert sorted(x.round(9).tolist()) == wanted
    assert len(model.facets("ring.floor")) == 1
