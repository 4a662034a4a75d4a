"""How many threads the libraries of dense matrices have: one, and two where it pays."""

from __future__ import annotations

import os
from collections.abc import Generator, Iterator, Mapping, MutableMapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from typing import Any

from anisocontact.base.processes import launched

#: Number of threads of OpenBLAS, by the first of these that is set.
_NUMBER = ("OPENBLAS_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS")
#: How long a thread of OpenBLAS looks for work before it sleeps, and the shortest: 2^4 cycles.
_PATIENCE, _SHORTEST = "OPENBLAS_THREAD_TIMEOUT", "4"
#: More have not been measured.
_MOST = 2
#: Rows of a matrix whose factorisation threads share: it takes 0.02 s, many times what they wait.
LARGE = 1500


@dataclass
class _SharedThreads:
    """Threads that `shared` gives; none in a process whose threads are somebody else's."""

    threads: int = 0


_SHARED = _SharedThreads()


def set_blas_threads() -> None:
    """Choose the threads of OpenBLAS for the command, once: what is set then is not the user's."""
    _SHARED.threads = _SHARED.threads or choice(os.environ)


def choice(environment: MutableMapping[str, str]) -> int:
    """Give OpenBLAS one thread, and see how many it may have where `shared` says so.

    NumPy, SciPy, and PETSc bring a pool of threads each, which read the environment when they are
    loaded. Short products gain nothing from a second thread, and wait for it where the machine has
    other work. Left alone an idle thread spins for 2^26 cycles. A process that a launcher has
    started beside others has one thread throughout.

    Args:
        environment: Where it is set, unless the user has.

    Returns:
        Threads for `shared`; 1 where the user has set a number.

    Example:
        >>> chosen = {"OMP_NUM_THREADS": "4"}
        >>> choice(chosen), chosen
        (1, {'OMP_NUM_THREADS': '4', 'OPENBLAS_THREAD_TIMEOUT': '4'})
    """
    environment.setdefault(_PATIENCE, _SHORTEST)
    if _numbered(environment):
        return 1
    environment[_NUMBER[0]] = "1"
    return 1 if launched() else min(_MOST, _processors())


@contextmanager
def shared(size: int) -> Iterator[None]:
    """Around long work of SciPy with dense matrices, which threads share.

    Nothing changes where the user has set a number of threads, or did not start the command.

    Args:
        size: Rows of a square matrix that is factorised or multiplied with as large ones.
    """
    if _SHARED.threads > 1 and size >= LARGE:
        with _openblas().limit(limits=_SHARED.threads):
            yield
    else:
        yield


@contextmanager
def one_thread() -> Iterator[None]:
    """Around the work of a solver in a script, which has loaded NumPy with threads of its own.

    What the environment says, of the user or of `choice`, stands; outside all is as it was.
    """
    if _numbered(os.environ):
        yield
    else:
        with _openblas().limit(limits=1):
            yield


def with_one_thread[T](work: Generator[T]) -> Generator[T]:
    """What a generator yields, each found with `one_thread`; who takes it has threads as before."""
    try:
        while True:
            with one_thread():
                try:
                    found = next(work)
                except StopIteration:
                    return
            yield found
    finally:
        work.close()


@cache
def _openblas() -> Any:
    """Every OpenBLAS of this process."""
    import scipy.linalg  # noqa: F401 - brings one
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController().select(internal_api="openblas")


def _numbered(environment: Mapping[str, str]) -> bool:
    """Whether the environment says how many threads OpenBLAS has."""
    return any(environment.get(name) for name in _NUMBER)


def _processors() -> int:
    """Number of processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
