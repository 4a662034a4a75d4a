"""How far facets are beside the curved surface that they stand for."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact.facet_mesh import (
    FacetMesh,
    FacetShapes,
    facet_corners,
    facet_mesh,
)
from anisocontact.contact.sweep import Sweep
from anisocontact.mesh import Model

#: Cosine of the angle of a facet and the mean at its vertex below which that is an edge: one of
#: the body, not of a mesh that stands for something round.
EDGE = 0.9
#: Height of the arc over a facet of order 2 that bends, over that over a flat one with the same
#: angles at its vertices: a quartic without value at its nodes instead of a parabola.
BENT = {"quad9": 0.25, "tri6": 1.0 / 3.0}
#: Corners of reference facets.
CORNERS = {3: np.array([[0.0, 0], [1, 0], [0, 1]]), 4: np.array([[0.0, 0], [1, 0], [0, 1], [1, 1]])}


def sagitta(model: Model, group: str) -> float:
    """Height of the arcs over the facets of a group, of which those of round cells are far lower.

    An arc through the vertices of a facet of normal n, with the normal m at a vertex, is
    `(m - n) . (c - v) / 2` above its middle c, v the vertex; m is the mean over the facets there.
    Over a facet that bends, whose middle nodes are on the arc, it is a share of that: on a line
    `x^2 (a^2 - x^2) / 8 R^3`, at most `a^4 / 32 R^3`, a half the length and R the radius.

    Args:
        model: Mesh with the group.
        group: Its name, "body.group".

    Returns:
        Median over the facets, 0 to rounding where the group is flat [length].

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"a": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        >>> sagitta(model, "a.top") < 1e-15
        True
    """
    sweep = Sweep.of(model)
    mesh = facet_mesh(model.space, model.facets(group), sweep)
    x = model.positions
    heights = _heights(mesh, x if sweep is None else sweep.positions(x))
    everywhere = np.concatenate(model.mesh.comm.allgather(heights))
    return float(np.median(everywhere)) if len(everywhere) else 0.0


def _heights(mesh: FacetMesh, x: Floats) -> Floats:
    """Height of the arc over each facet, (m,), length."""
    count = len(facet_corners(mesh.topology))
    shapes = FacetShapes(mesh.topology)
    nodes = mesh.nodes[:, :count]
    tangents = np.einsum("ckd,mkx->mcdx", shapes.at(CORNERS[count])[1], x[mesh.nodes])
    normals = np.cross(tangents[:, :, 0], tangents[:, :, 1])
    normals /= np.linalg.norm(normals, axis=2)[:, :, None]
    total = np.zeros_like(x)
    np.add.at(total, nodes, normals * np.where(mesh.flip, -1.0, 1.0)[:, None, None])
    mean = total[nodes] * np.where(mesh.flip, -1.0, 1.0)[:, None, None]
    mean /= np.linalg.norm(mean, axis=2)[:, :, None]
    smooth = (mean * normals).sum(axis=2) > EDGE
    arms = x[nodes].mean(axis=1)[:, None] - x[nodes]
    heights = 0.5 * np.abs(((mean - normals) * arms).sum(axis=2))
    heights = np.where(smooth, heights, 0.0).mean(axis=1)
    if shapes.order == 1:
        return np.asarray(heights)
    middle = np.einsum("k,mkx->mx", shapes.at(shapes.middle[None])[0][0], x[mesh.nodes])
    bulge = np.linalg.norm(middle - x[nodes].mean(axis=1), axis=1)
    return np.asarray(np.where(heights < bulge, BENT[mesh.topology] * heights, heights))
