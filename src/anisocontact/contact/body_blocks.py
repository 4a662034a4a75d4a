"""What a rigid body adds to the tangent of a contact: its rows and its columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.contact.history import Snapshot
from anisocontact.contact.quadrature import FacetQuadrature, Surfaced
from anisocontact.interface import SlaveSurface
from anisocontact.rigid import RigidBody, motion_derivative, skew


@dataclass(frozen=True)
class BodyBlocks:
    """Derivatives of the forces that slave and rigid body have from each other, as residuals.

    The residual of the nodes is `-integral of t`, that of the body `integral of (t, r x t)`, `r`
    from the reference point of now. Unknowns of the body are its translation and its turn.

    Attributes:
        nodes: Local nodes of each facet, (m, k).
        node_body: Rows of the nodes, columns of the body, (m, 3 k, 6).
        body_node: Rows of the body, columns of the nodes, (m, 6, 3 k).
        body: Rows and columns of the body, (6, 6), over the points of this rank.
        held: Change of the force at each point with the motion, (n, 3, 6): where all of it is
            zero along a motion, nothing in the contact holds the body against it.
    """

    nodes: Locals
    node_body: Floats
    body_node: Floats
    body: Floats
    held: Floats


def body_blocks(
    quadrature: FacetQuadrature,
    moved: Surfaced | None,
    body: RigidBody,
    now: Snapshot,
    slave: SlaveSurface | None = None,
) -> BodyBlocks:
    """The blocks of a contact whose surface belongs to a body.

    Args:
        quadrature: Slave points.
        moved: The facets of now where the area is theirs.
        body: The body at its trial.
        now: What the points answer there.
        slave: The slave's surface, where it carries directions.
    """
    m, q, k = quadrature.basis.shape
    traction = now.response.traction
    by_motion = now.areas[:, None, None] * motion_derivative(body, now.points, now.response, slave)
    arms = skew(now.points - body.position)
    weighted = now.areas[:, None, None] * now.response.tangent
    pulls = skew(now.areas[:, None] * traction)
    # d(r x t) = r x dt - t x (dx - dd)
    by_position = np.concatenate([weighted, arms @ weighted - pulls], axis=1)
    own = np.concatenate([by_motion, arms @ by_motion], axis=1)
    own[:, 3:, :3] += pulls
    node_body = np.einsum("mqa,mqij->maij", quadrature.basis, -by_motion.reshape(m, q, 3, 6))
    body_node = np.einsum("mqb,mqij->mibj", quadrature.basis, by_position.reshape(m, q, 6, 3))
    if slave is not None:
        pull = now.areas[:, None, None, None] * now.response.tangent_slave
        both = np.concatenate([pull, arms[:, None] @ pull], axis=2).reshape(m, q, 2, 6, 3)
        body_node += np.einsum("mqdij,mqbd->mibj", both, quadrature.gradient)
        if quadrature.turn is not None:
            across = both[:, :, 1] @ quadrature.turn
            body_node += np.einsum("mqij,mqb->mibj", across, quadrature.across)
    if moved is not None:
        wrench = np.concatenate([traction, np.einsum("nij,nj->ni", arms, traction)], axis=1)
        body_node += np.einsum("mqi,mqbj->mibj", wrench.reshape(m, q, 6), moved.area_changes)
    return BodyBlocks(
        quadrature.nodes,
        node_body.reshape(m, 3 * k, 6),
        body_node.reshape(m, 6, 3 * k),
        own.sum(axis=0),
        by_motion,
    )
