"""The reference configuration that was measured, and the mesh as it is now."""

from __future__ import annotations

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI
from anisocontact.mesh.model import Model


def check_at_rest(model: Model, field: str) -> None:
    """Refuse a mesh whose nodes were moved since they were measured; collective.

    Forms integrate over the mesh of now, contacts, supports and ties keep what they measured when
    they were made.

    Args:
        model: The mesh, with its `positions`.
        field: What was made of it, for the message.

    Raises:
        InputError: A node is elsewhere.
    """
    off = np.abs(model.space.tabulate_dof_coordinates() - model.positions).max(initial=0.0)
    farthest = model.mesh.comm.allreduce(float(off), op=MPI.MAX)
    if farthest > 0.0:
        raise InputError(
            f"nodes of the mesh were moved by up to {farthest:.4g} since its names were given and "
            "contacts made: make the model, the contacts and the problem of the mesh as it is now",
            field,
        )
