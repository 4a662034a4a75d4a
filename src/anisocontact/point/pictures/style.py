"""Colours and small helpers that all pictures share."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from anisocontact.base.array_types import Codes, Floats
from anisocontact.interface import STATUS
from anisocontact.point.history import History

# The same as in the report of a run; told apart also without red and green, and in grey.
COLOURS = {"open": "#9ca3af", "stick": "#1d4ed8", "slip": "#f59e0b"}
#: One for each of several runs.
RUNS = ("#111827", "#0f766e", "#7c3aed", "#c2410c", "#0369a1", "#be185d", "#a16207", "#6b7280")
AXES = ("#2f7d4f", "#8f6bb3")
INK = "#222222"
UNITS = "in the units of the case"


def runs(status: Codes) -> Iterator[tuple[str, slice]]:
    """Stretches of the same status: its name and the rows; each begins where the last ended."""
    begin = 1
    for i in range(1, len(status)):
        if i + 1 == len(status) or status[i + 1] != status[i]:
            yield STATUS[status[i]], slice(begin - 1, i + 1)
            begin = i + 1


def chosen(history: History, count: int) -> list[int]:
    """Rows spread evenly over the length of the path of the reference, over time if it rests."""
    m = len(history)
    if m <= 1:
        return list(range(m))
    steps = np.linalg.norm(np.diff(history.steps["reference"], axis=0), axis=1)
    measure = steps if steps.sum() > 0.0 else np.diff(history.steps["time"])
    at = np.concatenate([[0.0], np.cumsum(measure)])
    wanted = np.linspace(0.0, at[-1], count)
    return sorted({int(np.argmin(np.abs(at - w))) for w in wanted})


def number(value: float) -> str:
    """A number in a legend."""
    return f"{value:.3g}"


def size(points: Floats) -> float:
    """Diagonal of the box around points (n, 3)."""
    return float(np.linalg.norm(np.ptp(points.reshape(-1, 3), axis=0)))


def tangential_law(interface: Any) -> Any | None:
    """The tangential law of an interface; one of a user's own need not tell it."""
    return getattr(interface, "tangential", None)
