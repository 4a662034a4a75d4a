"""Rigid motions ranked by the stiffness that holds them: supports, then springs, then nothing.

A spring holds the motions that stretch it. How stiff it is in them says whether it counts: one that
the loads would stretch by more than the size of the body leaves that motion to contact.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy

from anisocontact.base.array_types import Floats
from anisocontact.solver.terms.free_modes import FREE, ConnectedBody
from anisocontact.solver.terms.term import Term

#: Stiffness of a motion over the mean diagonal of the bulk that no solution can resolve.
NOTHING = 1e-12


def stiffness(
    elastic: Term, bodies: Sequence[ConnectedBody], shape: tuple[int, ...], comm: Any
) -> Floats:
    """Stiffness that springs and elastic supports have in the rigid motions of bodies.

    Args:
        elastic: The springs.
        bodies: The bodies.
        shape: Shape of the displacement of the local nodes, (nodes, 3).
        comm: Communicator of the mesh.

    Returns:
        `-d force / d motion`, six rows and columns for each body, force/length.
    """
    matrix = np.zeros((6 * len(bodies), 6 * len(bodies)))
    rest = elastic.force(np.zeros(shape))
    for i, body in enumerate(bodies):
        for k, field in enumerate(body.fields):
            u = np.zeros(shape)
            u[body.local] = field
            matrix[:, 6 * i + k] = -work(bodies, elastic.force(u) - rest)
    return np.asarray(comm.allreduce(matrix))


def work(bodies: Sequence[ConnectedBody], force: Floats) -> Floats:
    """Work of forces on this rank on the rigid motions of bodies, (6 bodies,), force."""
    parts = [np.einsum("kni,ni->k", body.fields, force[body.local]) for body in bodies]
    return np.concatenate([np.zeros(0), *parts])


def unsupported(
    bodies: Sequence[ConnectedBody],
    free: Sequence[Floats],
    stiff: Floats,
    load: Floats,
    least: float,
    far: float = np.inf,
) -> list[Floats]:
    """Rigid motions that springs do not hold.

    Args:
        bodies: Bodies.
        free: Motions of each that no support holds, orthonormal, (k, 6).
        stiff: See `stiffness`.
        load: Work of the loads on the motions, (6 bodies,), force.
        least: Stiffness that counts as none, force/length.
        far: Sizes of the body; a motion by more than these under the loads counts as not held.

    Returns:
        What is left of the motions of each body, orthonormal, (k, 6).

    Example:
        A spring along x of 10 holds that motion against a force of 1, one of 1e-3 does not.

        >>> node, arms = np.arange(1), np.zeros((1, 3))
        >>> block = ConnectedBody(("b",), node, arms, 1, node, np.zeros((6, 1, 3)), size=1.0)
        >>> pull = np.eye(6)[0]
        >>> [len(unsupported([block], [np.eye(6)], np.diag(k * pull), pull, 1e-9, far=2.0)[0])
        ...  for k in (10.0, 1e-3)]
        [5, 6]
    """
    span = scipy.linalg.block_diag(*free)
    values, vectors = np.linalg.eigh(span @ stiff @ span.T)
    owner = np.repeat(np.arange(len(bodies)), [len(modes) for modes in free])
    sizes = (vectors**2).T @ np.array([body.size for body in bodies])[owner]
    pull = np.abs(vectors.T @ (span @ load))
    with np.errstate(over="ignore", invalid="ignore"):
        held = (values > least) & (pull <= far * sizes * values)
    loose = vectors[:, ~held]
    return [_span(loose[owner == i]) @ modes for i, modes in enumerate(free)]


def _span(columns: Floats) -> Floats:
    """Orthonormal rows that span what the columns span, (k, n)."""
    u, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(u[:, sizes > np.sqrt(FREE)].T)
