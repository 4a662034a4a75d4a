"""Whether displacements have got to what is prescribed, whatever force that takes."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import MPI
from anisocontact.solver.system.force_balance import GONE, ROUND_OFF, Reached

#: How far displacements may be from what is prescribed, over the largest of those.
TOLERANCE = 1e-8


def prescribed_reached(
    off: Floats, given: Floats, comm: Any, extent: float, nodal: Floats, rigid: Floats
) -> Reached:
    """Whether all that is prescribed, or follows from other unknowns, is where it is to be.

    Forces do not tell: their scale is that of bodies at rest, and where these have become 1e7 times
    as stiff, as rubber does where its chains are drawn straight, a displacement that is off by
    1e-4 is off by next to nothing in force. Collective.

    Args:
        off: How far the unknowns of this rank are from what is prescribed, length.
        given: Where they are, length.
        comm: Communicator.
        extent: Of the mesh on this rank, length. Its rounding, and that of displacements, is near
            enough: where all goes back to zero there is nothing else to compare with.
        nodal: Displacements of all nodes of this rank, length.
        rigid: Those of rigid bodies.
    """
    size = max(_largest(given), _largest(given - off))
    largest = np.array([_largest(off), size, _largest(rigid), _largest(nodal), extent])
    comm.Allreduce(MPI.IN_PLACE, largest, MPI.MAX)
    error, size, *lengths = largest
    reached = bool(error <= max(TOLERANCE * size, ROUND_OFF * max(lengths)))
    led, moved, extent = lengths
    gone = bool(moved > GONE * max(size, led, extent))
    return Reached(reached, moved if moved > extent else 0.0, gone)


def _largest(values: Floats) -> float:
    return float(np.abs(values).max(initial=0.0))
