"""Other facets of a master for a process whose slave points have moved."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from anisocontact.contact.sides import Sides
from anisocontact.contact.transfer import Transfer
from anisocontact.interface import State
from anisocontact.surfaces.facets import FacetProjections

Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]


def gather(
    sides: Sides,
    now: Floats,
    histories: Sequence[State],
    hints: Sequence[FacetProjections],
    transfer: Transfer | None,
) -> Sides:
    """Gather the facets that are near now, and number anew what names facets; collective.

    Args:
        sides: Both sides; their master is changed.
        now: Positions of the local nodes, (nodes, 3), length.
        histories: Of the points: facets in them are had as well, their numbers written in place.
        hints: Projections of the points, likewise.
        transfer: Hands forces to the master; None if nothing does.

    Returns:
        The sides with the facets that were gathered.
    """
    # some of them can be one and the same
    named = [s["facet"] for s in {id(s): s for s in histories}.values()]
    named += [h.facet for h in {id(h): h for h in hints}.values()]
    master = sides.gathered
    before = master.numbers

    def renumbered(facets: Ints) -> Ints:
        return master.renumbered(np.append(before, -1)[facets])

    over = [] if transfer is None else [transfer.facets()]
    found = sides.gather(now, _numbers([master.globally(f) for f in (*named, *over)]))
    for facets in named:
        facets[:] = renumbered(facets)
    if transfer is not None:
        transfer.gathered(found, renumbered)
    return found


def gather_named(
    sides: Sides, now: Floats, named: Sequence[Ints], transfer: Transfer | None
) -> Sides:
    """As `gather`, for a state that comes from elsewhere.

    Args:
        sides: Both sides; their master is changed.
        now: Positions of the local nodes, (nodes, 3), length.
        named: Arrays of facets of the whole group, -1 for none; those of this process are written.
        transfer: Hands forces to the master, its overlaps are to be placed anew; None if nothing
            does.

    Returns:
        The sides with the facets that were gathered.
    """
    found = sides
    if sides.gathered.distributed:
        found = sides.gather(now, _numbers(named))
    for facets in named:
        facets[:] = sides.gathered.renumbered(facets)
    if transfer is not None:
        transfer.gathered(found, np.zeros_like)
    return found


def _numbers(named: Sequence[Ints]) -> npt.NDArray[np.int64]:
    """All facets that are named, ascending."""
    numbers = np.unique(np.concatenate(list(named))).astype(np.int64)
    return numbers[numbers >= 0]
