"""Counts what updates of points allocate, in a process whose malloc counts.

Usage: `LD_PRELOAD=COUNTER python -m tests.verification.laws.allocations`, with the library that
`test_law_no_allocation` compiles. Prints a line for each surface, rule and tangent: its name, what
a point allocates, and how many points were open, stuck and slid.
"""

from __future__ import annotations

import ctypes

import numpy as np

from anisocontact.anisotropy import make_directions
from anisocontact.base import registry
from anisocontact.interface import Interface, State
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

#: All arrays of a batch are larger than those that NumPy keeps for the next one.
POINTS = 2_000
SURFACES = {
    "plane": {"point": (0, 0, 0), "normal": (0, 0, 1)},
    "cylinder": {"point": (0, 0, -2), "axis": (0, 1, 0), "radius": 2.0},
    "sphere": {"centre": (0, 0, -1.5), "radius": 1.5, "axis": (1, 0, 0)},
    "ellipsoid": {"centre": (0, 0, -1), "semi_axes": (2.0, 1.5, 1.0), "axis": (1, 0, 0)},
}
SAMPLES = {"pair": (0.4, 0.2), "scalar": 0.3}


def taken() -> int:
    """Allocations of this process so far."""
    count = ctypes.CDLL(None).allocations
    count.restype = ctypes.c_size_t
    return int(count())


def interface(shape: str, rule: str) -> Interface:
    """A surface about z = 0 with two direction fields, one thread."""
    entry = next(one for one in registry.sliding_rules() if one.name == rule)
    required = {p.name: SAMPLES[p.kind] for p in entry.parameters if p.required}
    marks = [make_directions("constant", vector=(1, 0.2, 0.1), angle=a) for a in (0.3, -0.2)]
    made = Interface(
        make_surface(shape, **SURFACES[shape]),
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(400.0, 100.0), directions=marks[0]),
        Friction(coefficients=(0.4, 0.2), directions=marks[1], sliding_rule=rule, **required),
    )
    made.threads = 1
    return made


def batch(law: Interface, n: int) -> tuple[State, np.ndarray]:
    """Points that have touched, and where they are next: open, near by, and far."""
    angle = np.linspace(0.0, 6.0, n)
    way = np.array([1e-6, 0.1])[np.arange(n) % 2] * np.linspace(0.5, 1.0, n)
    gap = np.where(np.arange(n) % 7 == 0, 1e-3, -2e-3)
    base = np.tile([0.05, 0.02, 0.0], (n, 1))
    surface, start = law.surface, base - [0.0, 0.0, 2e-3]
    moved = base + np.column_stack([way * np.cos(angle), way * np.sin(angle), np.zeros(n)])
    foot = surface.project(moved)
    normal = surface.geometry(foot.xi).normal
    state = law.update(law.initial_state(start), start, tangent=False).state
    return state, surface.position(foot.xi) + gap[:, None] * normal


def allocated(law: Interface, n: int, tangent: bool) -> tuple[int, list[int]]:
    """What a batch allocates, and how many of its points are open, stick and slip."""
    state, x = batch(law, n)
    before = taken()
    found = law.update(state, x, tangent=tangent)
    after = taken()
    return after - before, np.bincount(found.state["status"], minlength=3).tolist()


def report() -> None:
    """A line each, last the counter's own."""
    for shape in SURFACES:
        for entry in registry.sliding_rules():
            law = interface(shape, entry.name)
            for tangent in (False, True):
                few, _ = allocated(law, POINTS, tangent)
                many, seen = allocated(law, 2 * POINTS, tangent)
                print(shape, entry.name, (many - few) / POINTS, *seen)
    before = taken()
    kept = [np.empty(POINTS) for _ in range(100)]
    print("counter", "-", taken() - before, *[len(kept)] * 3)


if __name__ == "__main__":
    report()
