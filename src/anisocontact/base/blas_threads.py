"""How many threads the libraries of dense matrices have, said before they are loaded."""

from __future__ import annotations

import os
from collections.abc import MutableMapping

from anisocontact.base.processes import launched

#: Number of threads of OpenBLAS, by the first of these that is set.
_NUMBER = ("OPENBLAS_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS")
#: How long a thread of OpenBLAS looks for work before it sleeps, and the shortest: 2^4 cycles.
_PATIENCE, _NONE = "OPENBLAS_THREAD_TIMEOUT", "4"
#: More have not been measured.
_MOST = 2


def set_blas_threads(environment: MutableMapping[str, str] = os.environ) -> None:
    """Give OpenBLAS a second processor, and have its threads sleep where there is no work.

    NumPy, SciPy, and PETSc with MUMPS bring a pool of threads each, which read the environment when
    they are loaded. Left alone an idle thread spins for 2^26 cycles, and takes its processor from
    the pool that is at work. A process that a launcher has started beside others has one thread.

    Args:
        environment: Where it is set, unless the user has.

    Example:
        >>> chosen = {"OMP_NUM_THREADS": "4"}
        >>> set_blas_threads(chosen)
        >>> chosen
        {'OMP_NUM_THREADS': '4', 'OPENBLAS_THREAD_TIMEOUT': '4'}
    """
    environment.setdefault(_PATIENCE, _NONE)
    if not any(environment.get(name) for name in _NUMBER):
        count = 1 if launched() else min(_MOST, _processors())
        environment[_NUMBER[0]] = str(count)


def _processors() -> int:
    """Number of processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
