"""Cells of a mesh: sound ones pass, those that DOLFINx would crash on are one line."""

import dataclasses
import re

import numpy as np
import pytest

from anisocontact.base.errors import InputError
from anisocontact.base.shown import shown


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


def two_tetrahedra(order):
    """Two tetrahedra with a common facet, as plain arrays."""
    from anisocontact.base.fenicsx import middle_nodes
    from anisocontact.mesh.arrays import MeshArrays

    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], dtype=float)
    corners = np.array([[0, 1, 2, 3], [1, 4, 2, 3]])
    cells = corners
    if order == 2:
        edges = middle_nodes("tetrahedron")[0][0]
        pairs = np.sort(corners[:, edges].reshape(-1, 2), axis=1)
        ends, number = np.unique(pairs, axis=0, return_inverse=True)
        cells = np.hstack([corners, 5 + number.reshape(2, 6)])
        points = np.concatenate([points, points[ends].mean(axis=1)])
    bodies = {"a": np.arange(2)}
    return MeshArrays("tetrahedron", order, points, cells, bodies, {}, order)


@pytest.mark.parametrize("order", [1, 2])
def test_sound_cells_pass(order):
    """Two neighbours of either order are a mesh."""
    from anisocontact.mesh.quality import check_cells

    check_cells(two_tetrahedra(order))


def test_flat_and_inverted_cells_are_refused():
    """A corner in its opposite facet, two corners the other way round, a middle pulled through.

    Requirement: a damaged mesh is refused before DOLFINx, which would crash, sees it.
    """
    from anisocontact.mesh.quality import check_cells

    mesh = two_tetrahedra(1)
    mesh.points[0] = [1 / 3, 1 / 3, 1 / 3]
    with pytest.raises(InputError, match="body 'a': 1 of 2 cells are flat or inverted"):
        check_cells(mesh)
    mesh = two_tetrahedra(1)
    middle = mesh.points[mesh.cells[0]].mean(axis=0)
    mesh.cells[0] = mesh.cells[0, [1, 0, 2, 3]]
    where = re.escape(f"1 of 2 cells are flat or inverted, the first at {shown(middle)}")
    with pytest.raises(InputError, match=f"body 'a': {where}$"):
        check_cells(mesh)
    mesh = two_tetrahedra(2)
    # The corners stay, the middle of an edge goes through the opposite one.
    edge = next(n for n in mesh.cells[0, 4:] if n not in mesh.cells[1])
    mesh.points[edge] = 3.0 * mesh.points[mesh.cells[0, :4]].mean(axis=0) - 2.0 * mesh.points[edge]
    mesh.points[edge] += 2.0 * (mesh.points[edge] - mesh.points[0])
    with pytest.raises(InputError, match="body 'a': 1 of 2 cells are flat or inverted"):
        check_cells(mesh)


def test_needles_are_refused():
    """Their volume is large, and the angles at their tip are rounding; a tenth as long passes."""
    from anisocontact.mesh import Body, BoxSpec
    from anisocontact.mesh.quality import check_cells

    mesh = two_tetrahedra(1)
    mesh.points[0] += 1e8 * (mesh.points[0] - mesh.points[mesh.cells[0]].mean(axis=0))
    with pytest.raises(InputError, match="body 'a': 1 of 2 cells are flat or inverted"):
        check_cells(mesh)
    needle = Body("a", BoxSpec((0, 0, 0), (1, 1, 2e7), (1, 1, 1)))  # the same with right angles
    with pytest.raises(InputError, match="body 'a': 1 of 1 cells are flat or inverted"):
        check_cells(needle.arrays())
    check_cells(Body("a", BoxSpec((0, 0, 0), (1, 1, 5e6), (1, 1, 1))).arrays())


def test_nodes_too_far_away_are_refused():
    """Volumes of such cells are no numbers."""
    from anisocontact.mesh.quality import check_cells

    mesh = two_tetrahedra(1)
    mesh.points[:] *= 1e60
    with pytest.raises(InputError, match=r"nodes are up to \S*e\+60 from the origin, must be from"):
        check_cells(mesh)


def test_neighbours_that_do_not_fit_are_refused():
    """Three cells at one facet, and two middles of one edge."""
    from anisocontact.mesh.quality import check_cells

    mesh = two_tetrahedra(1)
    third = dataclasses.replace(mesh, cells=np.vstack([mesh.cells, mesh.cells[:1]]))
    with pytest.raises(InputError, match="1 facets belong to more than two cells"):
        check_cells(third)
    mesh = two_tetrahedra(2)
    shared = mesh.cells[1, np.isin(mesh.cells[1], mesh.cells[0, 4:])][-1]
    points = np.vstack([mesh.points, mesh.points[shared]])
    cells = mesh.cells.copy()
    cells[1, cells[1] == shared] = len(points) - 1
    with pytest.raises(InputError, match="do not have the same nodes on their common edges"):
        check_cells(dataclasses.replace(mesh, points=points, cells=cells))
