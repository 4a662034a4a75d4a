"""Symmetry planes: no displacement across a plane of any direction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI, fem
from anisocontact.contact import facet_quadrature
from anisocontact.mesh import Model
from anisocontact.solver.terms.cylinders import InclinedSupport
from anisocontact.solver.terms.pressure import outward

#: Largest difference of normals of a plane; roundings of mesh files are well below.
FLAT = 1e-6
#: Share of a normal that counts as none of it along an axis.
NO_SHARE = 1e-9


class SymmetryPlanes:
    """Flat facet groups whose nodes stay in their plane, `n . u = 0`, n the normal of the group.

    Args:
        model: Mesh with named facets.
        groups: Facet groups, each in a plane.
        tied: Nodes that follow from others, which keep them in the planes.

    Attributes:
        groups: The facet groups.

    Raises:
        InputError: An unknown facet group, or one that is not flat.
    """

    def __init__(self, model: Model, groups: Sequence[str], tied: Ints) -> None:
        self.groups = list(groups)
        self._supports = [_support(model, group, tied) for group in groups]

    def supports(self) -> list[InclinedSupport]:
        """Nodes of each plane, held along its normal."""
        return self._supports


def _support(model: Model, group: str, tied: Ints) -> InclinedSupport:
    normal = _normal(model, group)
    owned, dim = model.space.dofmap.index_map.size_local, model.idealisation.dim - 1
    nodes = fem.locate_dofs_topological(model.space, dim, model.facets(group)).astype(np.int64)
    nodes = np.setdiff1d(nodes[nodes < owned], tied)
    return InclinedSupport(
        group, "normal", "displacement", nodes, normal, lambda share: np.zeros(len(nodes))
    )


def _normal(model: Model, group: str) -> Floats:
    """Unit normal of a flat facet group."""
    facets = model.facets(group, "symmetry")
    quadrature = facet_quadrature(model.space, facets, 2 * model.order, model.idealisation)
    normals = outward(model, group, quadrature)
    comm = model.mesh.comm
    total = np.asarray(comm.allreduce(quadrature.areas @ normals))
    normal = total / np.linalg.norm(total)
    off = comm.allreduce(float(np.abs(normals - normal).max(initial=0.0)), MPI.MAX)
    if not off < FLAT:
        text = f"{group!r} given, its normals differ by {off:.2g}; a symmetry plane must be flat"
        raise InputError(text, "symmetry")
    normal[np.abs(normal) < NO_SHARE] = 0.0
    return np.asarray(normal / np.linalg.norm(normal))
