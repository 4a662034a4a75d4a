"""What Python has let go of gives back what a process has little of: communicators of MPI."""

from __future__ import annotations

import gc
import itertools

#: A problem and its mesh hold some ten communicators, of which MPICH has 2048.
EVERY = 25
#: Problems of this process, which shares its communicators.
_PROBLEMS = itertools.count(1)


def collect_unreferenced() -> None:
    """Collect garbage with every 25th problem that the process makes.

    Python looks through all that lives long ever more seldom the more of it there is: a script with
    large lists made less than 240 problems one after the other, kept none of them, and had no
    communicator for the next one.
    """
    if next(_PROBLEMS) % EVERY == 0:
        gc.collect()
