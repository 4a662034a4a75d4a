"""What is doubtful of the materials of bodies, before anything is solved."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from anisocontact.bulk.linear import LinearBulk
from anisocontact.bulk.locking import locking_bodies
from anisocontact.bulk.nonlinear import NonlinearBulk
from anisocontact.bulk.stability import unstable_rubbers
from anisocontact.mesh import Model

#: Strain that makes as much stress as there is at rest from which on it is told.
_FELT = 1e-6
#: What is said of such a body.
STRESSED = "there is stress in it where it is not strained"


def doubtful_materials(
    model: Model, materials: Mapping[str, Any], bulk: LinearBulk | NonlinearBulk
) -> list[str]:
    """What is to be known of materials, a line each; collective.

    Args:
        model: The bodies.
        materials: Body name -> material.
        bulk: What the bodies are made of, at rest.

    Returns:
        Rubbers that are unstable, bodies that lock, and those that are under stress at rest.
    """
    stressed = stressed_bodies(model, bulk) if isinstance(bulk, NonlinearBulk) else []
    return [*unstable_rubbers(materials), *locking_bodies(model, materials), *stressed]


def stressed_bodies(model: Model, bulk: NonlinearBulk) -> list[str]:
    """Bodies that push at their supports where nothing is strained, a line each; collective.

    Laws with a history are not asked, which may need a time increment, nor are pressures of cells,
    which go on from where they are.
    """
    if bulk.histories or bulk.pressures:
        return []
    force = abs(bulk.force(bulk.stiffness.createVecRight()).array_r)
    per_strain = bulk.diagonal.array_r * bulk.rest_length
    said, dofs = [], model.space.dofmap
    for name in model.body_names():
        nodes = np.unique(dofs.list[model.cells(name)])
        nodes = nodes[nodes < dofs.index_map.size_local, None]
        rows = nodes * dofs.bs + np.arange(dofs.bs)
        own = [float(values[rows].max(initial=0.0)) for values in (force, per_strain)]
        pushes, stiff = np.max(model.mesh.comm.allgather(own), axis=0)
        if pushes > _FELT * stiff:
            said.append(
                f"body {name!r}: {STRESSED}, as much as a strain of about {pushes / stiff:.2g} "
                "makes: its energy is not least, or its stress not zero, at F = I"
            )
    return said
