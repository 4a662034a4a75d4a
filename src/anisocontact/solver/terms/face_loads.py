"""Loads on reference points as forces on the nodes of the faces that follow them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.solver.terms.face_on_body import FaceOnBody

#: Share of the largest resistance of the nodes below which they do not take a force or moment.
NOT_TAKEN = 1e-10


def add_face_loads(faces: Sequence[FaceOnBody], wrench: Floats, out: Floats, comm: Any) -> None:
    """Add the smallest forces on nodes that together are a force and a moment; collective.

    Args:
        faces: All faces that follow a body.
        wrench: Force on it, and moment about its reference point, (6,).
        out: Forces on the local nodes, (nodes, 3).
        comm: Communicator of the mesh.
    """
    parts = [np.where(f.constrained[:, :, None], f.gathering(), 0.0) for f in faces]
    farthest = max((np.linalg.norm(f.arms, axis=1).max(initial=0.0) for f in faces), default=0.0)
    arm = max(comm.allgather(float(farthest))) or 1.0
    scale = np.repeat([1.0, 1.0 / arm], 3)
    own = sum((np.einsum("nai,naj->ij", p, p) for p in parts), np.zeros((6, 6)))
    gram = np.asarray(comm.allreduce(own)) * np.outer(scale, scale)
    taken = scale * (np.linalg.pinv(gram, rcond=NOT_TAKEN, hermitian=True) @ (scale * wrench))
    for face, part in zip(faces, parts, strict=True):
        np.add.at(out, face.nodes, part @ taken)
