"""A slave point whose closest point is on an edge of the master that two facets share.

Requirement: the traction and the forces follow from the accepted state and the displacements of
now, not from the way there; else two ways to equilibrium end in two states, both in balance.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.surfaces.facets import FEATURES

#: Slope of each side of the valley, and where its edge is: facets meet at 30 degrees.
SLOPE, EDGE = np.tan(np.radians(15.0)), 0.5


@pytest.fixture(scope="module")
def pair() -> tuple[Contact, np.ndarray]:
    """A small block above a base of 2 x 1 facets, with penalties at points, and all nodes."""
    block = BoxSpec((0.4, 0.4, 0.0), (0.02, 0.02, 0.02), (1, 1, 1))
    model = build_box({"block": block, "base": BoxSpec((0, 0, -0.5), (1, 1, 0.5), (2, 1, 1))})
    friction = Friction(coefficients=(0.3, 0.3))
    law = ContactLaw(NormalLaw(penalty=1e3), Adhesion(stiffness=(1e3, 1e3)), friction)
    contact = Contact(model, "block.bottom", "base.top", law, mortar=False, reach=0.5)
    return contact, model.space.tabulate_dof_coordinates()


def moved(nodes: np.ndarray, x: float) -> np.ndarray:
    """The top of the base as a valley along y, the block with its middle at x and 0.04 below it."""
    u = np.zeros_like(nodes)
    base = (nodes[:, 2] < -1e-9) | (np.abs(nodes[:, 0] - 0.41) > 0.02)
    top = base & (nodes[:, 2] > -1e-9)
    u[top, 2] = SLOPE * np.abs(nodes[top, 0] - EDGE)
    u[~base] = [x - 0.41, 0.0, -0.04]
    return u


@pytest.mark.parametrize("last", [EDGE - 0.003, EDGE + 0.003])
def test_forces_do_not_depend_on_the_way(pair: tuple[Contact, np.ndarray], last: float) -> None:
    """Come to from either facet the forces on all nodes are the same: exactly, as the place is."""
    contact, nodes = pair
    found = []
    for way in (0.40, 0.60):
        contact.update(moved(nodes, 0.40), 1.0)
        contact.update(moved(nodes, way), 1.0)
        trial = contact.update(moved(nodes, last), 1.0)
        force = np.zeros_like(nodes)
        contact.add_force(force)
        found.append((contact.projected_facets().copy(), np.array(trial.traction), force))
    assert set(found[0][0] % len(FEATURES)) == {FEATURES.index("edge")}
    assert np.abs(found[0][1]).max() > 1.0
    for first, second in zip(*found, strict=True):
        assert np.array_equal(first, second)
