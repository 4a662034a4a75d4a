"""The problem, and how a run says what it found.

A block 1 x 1 x 0.5 of n x n x n/2 hexahedra, neo-Hookean, E = 1000, nu = 0.3, on a rigid plane
("plane") or on a softer block 2 x 1.5 x 0.5, E = 500, of cells that do not match ("pair"), clamped
below. Its top goes down by 0.1 in 5 increments, then along x by 0.2 in 10. Coulomb friction,
mu = 0.3, penalties 1e5, tractions on the area of now, contact integrated at 2 x 2 points of a face.
"""

from __future__ import annotations

import json
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

KINDS = ("plane", "pair")
YOUNG, SOFTER, POISSON, FRICTION, PENALTY = 1000.0, 500.0, 0.3, 0.3, 1e5
DOWN, ALONG, PRESSES, DRAGS = 0.1, 0.2, 5, 10
#: What time is spent on: the linear solver, UFL's assembly, and what contact adds.
PHASES = ("linear", "assembly", "contact")


def path() -> list[tuple[float, float]]:
    """Displacement of the top along x and z after each increment."""
    down = [(0.0, -DOWN * k / PRESSES) for k in range(1, PRESSES + 1)]
    return down + [(ALONG * k / DRAGS, -DOWN) for k in range(1, DRAGS + 1)]


class Clock:
    """Seconds of wall time by phase.

    Example:
        >>> clock = Clock()
        >>> with clock.phase("contact"):
        ...     pass
        >>> list(clock.seconds)
        ['contact']
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self._inside = False

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Count what happens inside; what is counted already is not counted again."""
        if self._inside:
            yield
            return
        self._inside, start = True, time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] += time.perf_counter() - start
            self._inside = False

    def count(self, owner: object, method: str, phase: str) -> None:
        """Count the calls of a method of an object."""
        inner: Callable[..., Any] = getattr(owner, method)

        def timed(*arguments: Any, **named: Any) -> Any:
            with self.phase(phase):
                return inner(*arguments, **named)

        setattr(owner, method, timed)


def show(
    clock: Clock,
    solving: float,
    iterations: int,
    forces: list[tuple[float, float]],
    unknowns: int,
    factors: int,
) -> None:
    """Print what was found.

    Args:
        clock: Seconds by phase.
        solving: Seconds from the first increment to the last.
        iterations: Newton iterations.
        forces: Tangential and normal force after each increment.
        unknowns: Number of unknowns.
        factors: Number of factorisations.
    """
    values = {f"{name} s": clock.seconds[name] for name in PHASES}
    values |= {
        "solving s": solving,
        "iterations": iterations,
        "unknowns": unknowns,
        "factorisations": factors,
        "normal force pressed": forces[PRESSES - 1][1],
        "tangential force at the end": abs(forces[-1][0]),
    }
    print("values", json.dumps({name: float(value) for name, value in values.items()}))


def read(printed: str) -> dict[str, float]:
    """What `show` printed, among other lines.

    Raises:
        ValueError: Nothing was printed.
    """
    for line in printed.splitlines():
        if line.startswith("values "):
            found: dict[str, float] = json.loads(line.removeprefix("values "))
            return found
    raise ValueError("no values printed")
