"""Threads of OpenBLAS: what the user has set stands, and threads without work take no time."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from anisocontact.base import blas_threads
from anisocontact.base.blas_threads import choice

#: Products that threads share, and pauses in which they have nothing to do.
PAUSES = """
import time
import numpy
matrix, idle = numpy.ones((300, 300)), 0.0
for _ in range(10):
    matrix @ matrix
    begin = time.process_time()
    time.sleep(0.03)
    idle += time.process_time() - begin
print(idle)
"""


@pytest.fixture(autouse=True)
def restored(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blas_threads._GIVEN, "threads", 0)
    for name in ("PMI_RANK", "PMI_FD", "PMIX_RANK", "OMPI_COMM_WORLD_RANK"):
        monkeypatch.delenv(name, raising=False)


def chosen(**given: str) -> tuple[int, dict[str, str]]:
    environment = dict(given)
    return choice(environment), environment


def test_user_is_respected() -> None:
    """Requirement: a number of threads that the user has set stays (OpenBLAS reads these names)."""
    for name in ("OPENBLAS_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS"):
        assert chosen(**{name: "7"}) == (1, {name: "7", "OPENBLAS_THREAD_TIMEOUT": "4"})
    assert chosen(OPENBLAS_THREAD_TIMEOUT="20")[1]["OPENBLAS_THREAD_TIMEOUT"] == "20"


def test_a_launched_process_has_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """Requirement: processes under a launcher share the machine, each with one thread."""
    monkeypatch.setenv("PMI_RANK", "1")
    assert chosen()[0] == 1


def test_no_more_threads_than_processors(monkeypatch: pytest.MonkeyPatch) -> None:
    """Requirement: one thread where there is one processor, two where there are more."""
    for count, threads in ((1, 1), (2, 2), (64, 2)):
        monkeypatch.setattr(blas_threads, "_processors", lambda n=count: n)
        found, environment = chosen()
        assert (found, environment["OPENBLAS_NUM_THREADS"]) == (threads, "1")


def test_shared_work_has_two_threads_and_other_work_as_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Requirement: threads are given for the time of the block, also where it fails."""
    numbers: list[int] = []
    monkeypatch.setattr(blas_threads, "_setter", lambda: numbers.append)
    with blas_threads.shared(blas_threads.LARGE):
        assert numbers == []
    monkeypatch.setattr(blas_threads._GIVEN, "threads", 2)
    with blas_threads.shared(blas_threads.LARGE - 1):
        assert numbers == []
    with pytest.raises(ZeroDivisionError), blas_threads.shared(blas_threads.LARGE):
        raise ZeroDivisionError
    assert numbers == [2, 1]


def test_idle_threads_sleep() -> None:
    """Requirement: a thread without work sleeps, so that the processor is free for others.

    In ten pauses of 0.03 s a sleeping thread takes next to nothing, one that looks for work 0.2 s
    as OpenBLAS leaves it.
    """
    threads = {"OPENBLAS_NUM_THREADS": "2", "OPENBLAS_THREAD_TIMEOUT": ""}
    environment = {name: one for name, one in (os.environ | threads).items() if one}
    choice(environment)
    run = [sys.executable, "-c", PAUSES]
    told = subprocess.run(run, env=environment, capture_output=True, text=True, check=True)
    assert float(told.stdout) < 0.05
