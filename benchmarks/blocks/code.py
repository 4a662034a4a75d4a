"""What a benchmark needs from a code, and codes that are a script for another Python."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Protocol

from blocks.problem import KINDS


@dataclass(frozen=True)
class Increment:
    """Forces on the top of the block after an increment.

    Attributes:
        tangential: Along the drag.
        normal: Pressure is positive.
        iterations: Newton iterations it took.
    """

    tangential: float
    normal: float
    iterations: int


class Code(Protocol):
    """A finite-element code that runs the problem as a process of its own."""

    @property
    def kinds(self) -> tuple[str, ...]:
        """Problems that it has a contact for."""

    @property
    def solver(self) -> str:
        """What solves its linear systems."""

    def version(self) -> str:
        """Its version; empty where it is not installed."""

    def command(self, kind: str, n: int, folder: Path) -> list[str]:
        """Write its input into `folder` and say how to run it there."""

    def increments(self, folder: Path) -> list[Increment]:
        """What it found, from what it wrote into `folder` and its `stdout` there."""


def show(tangential: float, normal: float, iterations: int) -> None:
    """Print an increment so that `read` finds it."""
    print("increment", float(tangential), float(normal), int(iterations), flush=True)


def read(printed: str) -> list[Increment]:
    r"""The increments among other lines.

    Example:
        >>> read("hello\nincrement 1.0 2.0 3\n")
        [Increment(tangential=1.0, normal=2.0, iterations=3)]
    """
    rows = [line.split() for line in printed.splitlines() if line.startswith("increment ")]
    return [Increment(float(t), float(n), int(k)) for _, t, n, k in rows]


def pythons() -> Iterable[str]:
    """Where other codes may be installed: `BENCH_PYTHON` (paths with colons), here, the system."""
    yield from filter(None, os.environ.get("BENCH_PYTHON", "").split(":"))
    yield from (sys.executable, "/usr/bin/python3")


@dataclass(frozen=True)
class Script:
    """A code whose run is `python -m module kind n`, in the first Python that has it.

    Attributes:
        module: The script.
        said: Python that imports the code and prints its version.
        solver: What solves its linear systems.
        kinds: Problems that it has a contact for.
    """

    module: str
    said: str
    solver: str
    kinds: tuple[str, ...] = KINDS

    def version(self) -> str:
        """Its version; empty where no Python has it."""
        return found(self.said)[1]

    def command(self, kind: str, n: int, folder: Path) -> list[str]:
        """How to run it."""
        return [found(self.said)[0], "-m", self.module, kind, str(n)]

    def increments(self, folder: Path) -> list[Increment]:
        """What it printed."""
        return read((folder / "stdout").read_text())


@cache
def found(said: str) -> tuple[str, str]:
    """The first Python that can do what `said` says, and what that printed; else empty."""
    for python in pythons():
        try:
            done = subprocess.run([python, "-c", said], capture_output=True, text=True, check=False)
        except OSError:
            continue
        if done.returncode == 0:
            return python, done.stdout.strip()
    return "", ""
