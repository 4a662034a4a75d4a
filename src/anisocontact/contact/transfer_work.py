"""Work of an increment that gaps and slips of slave points do not see."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.contact.history import Snapshot
from anisocontact.contact.sides import Sides
from anisocontact.contact.transfer import Transfer

Floats = npt.NDArray[np.float64]


def transfer_work(
    sides: Sides,
    transfer: Transfer,
    step: Floats,
    ends: tuple[Snapshot, Snapshot],
) -> float:
    """Work over this rank, force times length.

    Gaps and slips are measured at the feet of the points, forces act on the master over the
    overlaps: the work of the force, its mean over the increment, on the difference of
    displacements.

    Args:
        sides: Both sides; the surface is where the increment ends.
        transfer: Who hands forces over, in the trial of the increment.
        step: Displacement of the nodes in the increment, (nodes, 3), length.
        ends: The points before and after the increment.
    """
    handed = transfer.handed
    force = np.where(handed[:, None], 0.5 * (ends[0].forces + ends[1].forces), 0.0)
    out = np.zeros_like(step)
    transfer.add_force(out, force)
    after = ends[1].response.state
    there = np.flatnonzero(handed & (after["facet"] >= 0))
    facet, xi = (after[name][there] for name in ("facet", "xi"))
    shape, _, _ = sides.surface.shapes(facet, xi)
    nodes = sides.master.nodes[facet]
    feet = np.einsum("nk,nki->ni", shape[:, : nodes.shape[1]], step[nodes])
    work = -float(np.sum(out * step) + np.sum(force[there] * feet))
    return work + _crossing_energy(*ends)


def _crossing_energy(before: Snapshot, now: Snapshot) -> float:
    """Stored energy of points that went off the master less that of points that came onto it.

    They come from beside it, pressed in at once, which nothing has worked for.
    """
    stored = [
        a.areas * (a.response.state["energy_normal"] + a.response.state["energy_adhesion"])
        for a in (before, now)
    ]
    was, on = (a.response.state["facet"] >= 0 for a in (before, now))
    return float(stored[0][was & ~on].sum() - stored[1][on & ~was].sum())
