"""Facets of a master that go on beyond their sides."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.surfaces.facets import FacetSurface

#: Corrections of a foot, and the last one that is good enough: facets are nearly flat.
MOST, ENOUGH = 12, 1e-14


def feet_on_continued(
    surface: FacetSurface, x: Floats, facets: Locals, start: Floats
) -> tuple[Floats, Floats, Floats]:
    """Where x - rho is normal to facets that go on beyond their sides, by Newton's method.

    Args:
        surface: The facets, where they are now.
        x: Points, (n, 3), length.
        facets: Facet of each, (n,).
        start: Coordinates to start from, (n, 2).

    Returns:
        Coordinates (n, 2), positions (n, 3) and unit normals (n, 3); not a number where a facet
        has no normal.
    """
    xi = start
    for _ in range(MOST):
        jet = surface.jet(facets, xi)
        rest = x - jet.position
        curved = np.einsum("nkd,nd->nk", jet.d2, rest)[:, [[0, 1], [1, 2]]]
        matrix = np.einsum("nid,njd->nij", jet.d1, jet.d1) - curved
        with np.errstate(invalid="ignore"):  # of those without a normal from before
            matrix[np.linalg.det(matrix) == 0.0] = np.nan
        step = np.linalg.solve(matrix, np.einsum("nid,nd->ni", jet.d1, rest)[..., None])[..., 0]
        xi = xi + step
        if not np.nanmax(np.abs(step), initial=0.0) > ENOUGH:
            break
    jet = surface.jet(facets, xi)
    cross = np.cross(jet.d1[:, 0], jet.d1[:, 1])
    with np.errstate(invalid="ignore"):
        return xi, jet.position, cross / np.linalg.norm(cross, axis=1)[:, None]
