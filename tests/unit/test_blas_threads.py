"""Threads of OpenBLAS: what the user has set stands, and threads without work take no time."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Generator, Iterator

import pytest

from anisocontact.base import blas_threads
from anisocontact.base.blas_threads import choice, one_thread, with_one_thread

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
    monkeypatch.setattr(blas_threads._SHARED, "threads", 0)
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


def numbers() -> list[int]:
    """How many threads each OpenBLAS has."""
    return [one["num_threads"] for one in blas_threads._openblas().info()]


@pytest.fixture
def three(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[int]]:
    """Each OpenBLAS with as many of three threads as it can have, in a script."""
    for name in blas_threads._NUMBER:
        monkeypatch.delenv(name, raising=False)
    with blas_threads._openblas().limit(limits=3):
        yield numbers()


def test_shared_work_has_two_threads_and_other_work_as_before(
    monkeypatch: pytest.MonkeyPatch, three: list[int]
) -> None:
    """Requirement: threads are given for the time of the block, also where it fails."""
    assert max(three) == 3
    with blas_threads.shared(blas_threads.LARGE):
        assert numbers() == three
    monkeypatch.setattr(blas_threads._SHARED, "threads", 2)
    with blas_threads.shared(blas_threads.LARGE - 1):
        assert numbers() == three
    with pytest.raises(ZeroDivisionError), blas_threads.shared(blas_threads.LARGE):
        assert max(numbers()) == 2
        raise ZeroDivisionError
    assert numbers() == three


def test_a_solver_has_one_thread_and_a_script_as_many_as_before(three: list[int]) -> None:
    """Requirement: one thread while something is found, those of the script between and after it.

    So where a script goes on, where it takes no more, and where finding fails.
    """

    def work() -> Generator[list[int]]:
        yield numbers()
        yield numbers()
        raise ZeroDivisionError

    for whole in (True, False):
        steps = with_one_thread(work())
        assert max(next(steps)) == 1
        assert numbers() == three
        if whole:
            assert max(next(steps)) == 1
            with pytest.raises(ZeroDivisionError):
                next(steps)
        else:
            steps.close()
        assert numbers() == three


def test_a_solver_leaves_threads_that_the_user_has_set(
    monkeypatch: pytest.MonkeyPatch, three: list[int]
) -> None:
    """Requirement: a number in the environment is that of the user, or of the command."""
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    with one_thread():
        assert numbers() == three


def test_increments_of_a_script_are_solved_with_one_thread(
    monkeypatch: pytest.MonkeyPatch, three: list[int]
) -> None:
    """Requirement: that is so in `Solver.run` and in `ContactProblem.solve`."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    from anisocontact.base.fenicsx import fem, ufl
    from anisocontact.bulk import make_material
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.solver import ContactProblem, Problem, Solver, Step

    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    problem = Problem(model, {"bar": make_material("linear-elastic", E=1.0, nu=0.3)})
    held = {"bar.bottom": dict.fromkeys("xyz", 0.0)}
    pull = Step("pull", 2, held, traction={"bar.top": {"z": 0.1}})
    seen: list[int] = []
    for _ in Solver(problem, [pull]).run(lambda _: seen.append(max(numbers()))):
        assert numbers() == three
    u = fem.Function(model.space)
    form = ufl.inner(u - ufl.as_vector([0, 0, 1]), ufl.TestFunction(model.space)) * ufl.dx
    own = ContactProblem(form, u)
    solve = own.newton.solve
    monkeypatch.setattr(own.newton, "solve", lambda x: seen.append(max(numbers())) or solve(x))
    own.solve()
    own.close()
    assert numbers() == three
    assert set(seen) == {1}


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
