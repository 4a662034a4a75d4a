"""Names of what is opposite to slave nodes."""

from __future__ import annotations

import numpy as np

from anisocontact.contact.facet_mesh import FacetMesh
from anisocontact.contact.opposite_names import _listed
from anisocontact.contact.slave_nodes import patches


def test_a_process_may_have_no_slave_nodes() -> None:
    """Requirement: no names, and no error, where a mesh is cut so that a process has facets alone.

    Those nodes that it owns come first.
    """
    nodes = np.array([[0, 1, 2, 3], [2, 3, 4, 5]], dtype=np.int32)
    mesh, keys = FacetMesh("quad4", nodes, np.zeros(2, dtype=bool)), np.array([7, 3])
    assert _listed(patches(mesh, owned=0), keys).shape == (0, 0)
    # node 2 is on both facets, that of the smaller key comes first
    assert _listed(patches(mesh), keys)[2].tolist() == [2, 3, 4, 5, 0, 1, 2, 3]
