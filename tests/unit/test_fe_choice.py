"""Choice of the condensed strategy: when it is taken, and what it refuses."""

from __future__ import annotations

import resource
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.rigid import MovingSurface
from anisocontact.solver import Problem, Solver, Step
from anisocontact.solver.strategies import costs
from anisocontact.solver.strategies.choice import Choice
from anisocontact.solver.strategies.condensed import strategy

PRESS = Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})


def _choice(problem: Problem, how: str = "auto", **options: Any) -> Choice:
    return Solver(problem, [PRESS], options=options, strategy=how).choice


def test_auto_takes_condensed_for_linear_bodies(fe: Any) -> None:
    choice = _choice(fe.block(fe.interface()).problem)
    assert choice.name == "condensed"
    assert "linear" in choice.reason


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda m: m.setattr(strategy, "MOST_CONTACT", 10), "48 contact unknowns, more than 10"),
        (lambda m: m.setattr(costs, "free_memory", lambda: 1e4), "GB are free"),
    ],
)
def test_auto_says_why_it_takes_direct(
    fe: Any,
    monkeypatch: pytest.MonkeyPatch,
    change: Callable[[pytest.MonkeyPatch], None],
    reason: str,
) -> None:
    change(monkeypatch)
    choice = _choice(fe.block(fe.interface()).problem)
    assert choice.name == "direct"
    assert reason in choice.reason


@pytest.mark.parametrize(("thick", "taken"), [(1, "direct"), (2, "direct"), (4, "condensed")])
def test_sheets_that_are_touched_all_over_are_factorised(fe: Any, thick: int, taken: str) -> None:
    """Where contact unknowns are many beside all, their dense matrix is what takes the time.

    Source: measured, 20 x 20 hexahedra on a plane take with `condensed` 2.0, 1.4 and 0.6 to 0.8
    times the processor time of `direct` where they are one, two and four thick; three, 0.7.
    """
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.05 * thick), (20, 20, thick))})
    contact = Contact(model, "block.bottom", MovingSurface(fe.interface(), None))
    material = make_material("linear-elastic", E=1000.0, nu=0.3)
    choice = _choice(Problem(model, {"block": material}, [contact]))
    assert choice.name == taken
    if taken == "direct":
        assert "contact unknowns: a factorisation of all costs less" in choice.reason


def test_memory_limits_are_seen(fe: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """A limit of the address space that leaves 5 kB: `auto` says so and takes `direct`."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    used = pages * resource.getpagesize()
    monkeypatch.setattr(costs.resource, "getrlimit", lambda _: (used + 5000, -1))
    assert costs.free_memory() <= 5000
    choice = _choice(fe.block(fe.interface()).problem)
    assert choice.name == "direct"
    assert "needs 0.0 GB, 0.0 GB are free" in choice.reason


def _no_contact(fe: Any) -> Problem:
    block = fe.block(fe.interface())
    return Problem(block.model, {"block": block.material}, [])


@pytest.mark.parametrize(
    ("make", "options", "message"),
    [
        (_no_contact, {}, r"strategy: 'condensed' given, but there is no contact"),
        (
            lambda fe: fe.block(fe.interface()).problem,
            {"ksp_type": "gmres"},
            r"but the option ksp_type asks for a solver of the whole system",
        ),
    ],
)
def test_condensed_refuses(
    fe: Any, make: Callable[[Any], Problem], options: dict[str, str], message: str
) -> None:
    problem = make(fe)
    with pytest.raises(InputError, match=message):
        _choice(problem, "condensed", **options)
    assert _choice(problem, "auto", **options).name == "direct"


def test_unknown_strategy(fe: Any) -> None:
    with pytest.raises(InputError, match="auto, direct, condensed, iterative"):
        _choice(fe.block(fe.interface()).problem, "fast")
