"""Cells handed out to processes: bodies and what touches are shared, however they lie."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.mesh import BoxSpec
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.build import Body
from anisocontact.mesh.merge import merge
from anisocontact.mesh.partition import owners

#: A block on a base, beside which it stands on one side, and two blocks side by side.
ON_TOP = {
    "block": BoxSpec((0, 0, 0), (1, 1, 0.5), (8, 8, 4)),
    "base": BoxSpec((-0.2, -0.5, -0.5), (2, 2, 0.5), (9, 11, 3)),
}
BESIDE = {
    "block": BoxSpec((0, 0, 0), (1, 1, 1), (6, 7, 6)),
    "base": BoxSpec((1, -0.5, 0), (3, 2, 1), (7, 8, 6)),
}


def _mesh(boxes: Mapping[str, BoxSpec]) -> MeshArrays:
    return merge([Body(name, box).arrays() for name, box in boxes.items()])


def _owners_of_facets(mesh: MeshArrays, name: str, found: np.ndarray) -> np.ndarray:
    """Process of the cell that each facet bounds."""
    corners = {frozenset(nodes): i for i, nodes in enumerate(np.sort(mesh.facets[name]).tolist())}
    cells = [set(nodes) for nodes in mesh.cells.tolist()]
    return np.array([next(found[c] for c, n in enumerate(cells) if f <= n) for f in corners])


@pytest.mark.parametrize(("boxes", "slave"), [(ON_TOP, "block.bottom"), (BESIDE, "block.right")])
@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_processes_share_cells_and_contact(
    boxes: Mapping[str, BoxSpec], slave: str, count: int
) -> None:
    """Each has its share of the cells and of the slave facets of bodies that meet.

    Requirement: no process waits for another that has all of the contact. Tolerances: cells are
    counted, but for rounding; planes that leave equal numbers of cells of bodies that do not stand
    centrally leave each process at least half of its share of the slave facets.
    """
    mesh = _mesh(boxes)
    found = owners(mesh, count, [slave])
    assert np.ptp(np.bincount(found, minlength=count)) <= 1
    facets = np.bincount(_owners_of_facets(mesh, slave, found), minlength=count)
    assert facets.min() >= 0.5 * facets.sum() / count


def test_body_without_facets_is_cut() -> None:
    """Where the mesh has none of the facets that touch cells alone are counted."""
    mesh = MeshArrays("tetrahedron", 1, np.eye(4, 3), np.array([[0, 1, 2, 3]]), {}, {}, 1)
    assert owners(mesh, 2, ["block.bottom"]).tolist() in ([0], [1])
