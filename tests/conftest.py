"""Problems that several tests of the finite-element level start from."""

from __future__ import annotations

import signal
from collections import defaultdict
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

# The same examples in every run: a change turns a test red, never the day. New ones with
# `pytest --hypothesis-profile=default`.
settings.register_profile("repeatable", derandomize=True)
settings.load_profile("repeatable")

# A shell starts what is in the background with Ctrl-C ignored; tests of Ctrl-C need it.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

Pair = tuple[float, float]

#: What a test may take that `make test` runs, s.
LONGEST = 5.0


#: Tests that one that is marked slow takes as long as, about.
WEIGHT = 100


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Give processes that share the tests by files the longest files first.

    One that begins with a long file as the others end works alone.
    """
    if not hasattr(config, "workerinput"):
        return
    lengths: dict[Path, int] = defaultdict(int)
    for item in items:
        lengths[item.path] += WEIGHT if item.get_closest_marker("slow") else 1
    items.sort(key=lambda item: -lengths[item.path])


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Name the tests that take too long without being marked so; it is no failure."""
    spent: dict[str, float] = defaultdict(float)
    for reports in terminalreporter.stats.values():
        for report in reports:
            if isinstance(report, pytest.TestReport) and "slow" not in report.keywords:
                spent[report.nodeid] += report.duration
    long = sorted((took, name) for name, took in spent.items() if took > LONGEST)
    if long:
        title = f"longer than {LONGEST:g} s: make them smaller, or mark them slow"
        terminalreporter.section(title)
    for took, name in reversed(long):
        terminalreporter.line(f"{took:.1f} s {name}")


def make_interface(
    *,
    stiffness: Pair = (4e3, 1e3),
    coefficients: Pair = (0.3, 0.1),
    penalty: float = 1e4,
    angle: float = 0.0,
    adhesion_angle: float | None = None,
    rule: str = "maximum-dissipation",
    point: Sequence[float] = (0.0, 0.0, 0.0),
    normal: Sequence[float] = (0.0, 0.0, 1.0),
    vector: Sequence[float] = (1.0, 0.0, 0.0),
    evolution: str = "transport",
    **of_rule: Any,
) -> Any:
    """A plane with the axes of friction at `angle`, those of adhesion there too or at their own."""
    from anisocontact.anisotropy import make_directions
    from anisocontact.interface import Interface
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.surfaces import make_surface

    of_adhesion = angle if adhesion_angle is None else adhesion_angle
    friction_axes = make_directions("constant", vector=vector, angle=angle)
    adhesion_axes = make_directions("constant", vector=vector, angle=of_adhesion)
    return Interface(
        make_surface("plane", point=point, normal=normal),
        NormalLaw(penalty=penalty),
        Adhesion(stiffness=stiffness, directions=adhesion_axes),
        Friction(coefficients=coefficients, directions=friction_axes, sliding_rule=rule, **of_rule),
        evolution=evolution,
    )


@dataclass
class Block:
    """An elastic block on a plane."""

    model: Any
    material: Any
    contact: Any
    problem: Any

    def run(self, *steps: Any, **options: Any) -> list[Any]:
        """All accepted increments."""
        from anisocontact.solver import Solver

        return list(Solver(self.problem, steps, options=options).run())


def make_block(
    interface: Any,
    *,
    cells: Sequence[int] = (3, 3, 2),
    size: Sequence[float] = (1.0, 1.0, 0.5),
    cell: str = "hexahedron",
    order: int = 1,
    young: float = 1000.0,
    nu: float = 0.3,
    move: Callable[[Any], Any] | None = None,
    **of_contact: Any,
) -> Block:
    """Block with its lowest corner in the origin; `move` takes its nodes elsewhere."""
    from anisocontact.bulk import make_material
    from anisocontact.contact import Contact
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.rigid import MovingSurface
    from anisocontact.solver import Problem

    model = build_box({"block": BoxSpec((0.0, 0.0, 0.0), size, cells, cell, order)})
    if move is not None:
        model.mesh.geometry.x[:] = move(model.mesh.geometry.x)
    material = make_material("linear-elastic", E=young, nu=nu)
    master = MovingSurface(interface, of_contact.pop("body", None))
    contact = Contact(model, "block.bottom", master, **({"mortar": False} | of_contact))
    return Block(model, material, contact, Problem(model, {"block": material}, [contact]))


def plane_tensor(values: Pair, angle: float) -> Any:
    """Symmetric tensor of the plane with eigenvalues along axes turned by `angle`, (2, 2)."""
    c, s = np.cos(angle), np.sin(angle)
    axes = np.array([[c, s], [-s, c]])
    return axes.T @ np.diag(values) @ axes


def difference_errors(
    problem: Any,
    x: Any,
    direction: Any,
    steps: Sequence[float],
    after: Callable[[], None] = lambda: None,
) -> Any:
    """Central differences of the residual against the tangent.

    Args:
        problem: A problem with a step and its level.
        x: All unknowns.
        direction: Along which the derivative is taken.
        steps: Steps of the differences.
        after: Called after each evaluation, first at x.

    Returns:
        Relative error of the derivative for each step.
    """
    matrix = problem.new_tangent()
    for _ in range(2):  # the second time the pattern is there
        problem.tangent(x, matrix)
    after()
    exact = (matrix @ direction).array.copy()
    errors = []
    for h in steps:
        ends = []
        for sign in (1.0, -1.0):
            ends.append(problem.evaluate(x + sign * h * direction).copy())
            after()
        errors.append(np.linalg.norm((ends[0] - ends[1]) / (2.0 * h) - exact))
    return np.asarray(errors) / np.linalg.norm(exact)


def errors_and_status(
    problem: Any, contact: Any, x: Any, direction: Any, steps: Sequence[float]
) -> tuple[Any, bool, Any]:
    """Errors of the differences, and whether points change their status on the way.

    Args:
        problem: A problem with a step and its level.
        contact: The contact whose points are looked at.
        x: All unknowns.
        direction: Along which the derivative is taken.
        steps: Steps of the differences.

    Returns:
        Relative errors, whether every point kept its status, and the statuses at x.
    """
    seen: list[Any] = []

    def keep() -> None:
        seen.append(contact.trial.status.copy())

    errors = difference_errors(problem, x, direction, steps, keep)
    return errors, all(np.array_equal(s, seen[0]) for s in seen), seen[0]


def tangent_errors(problem: Any, rng: np.random.Generator, size: float) -> Any:
    """Central differences of the residual against the tangent, at a random state.

    Args:
        problem: A problem with a step and its level.
        rng: Source of the state and of the direction.
        size: Standard deviation of the displacements, length.

    Returns:
        Relative error of the derivative along the direction for three steps, each half of the
        one before.
    """
    x, direction = problem.new_vector(), problem.new_vector()
    x.array[:] = size * rng.standard_normal(x.getSize())
    direction.array[:] = rng.standard_normal(x.getSize())
    return difference_errors(problem, x, direction, (2e-4, 1e-4, 5e-5))


class FiniteElements:
    """What the tests of the finite-element level share."""

    interface = staticmethod(make_interface)
    block = staticmethod(make_block)
    tensor = staticmethod(plane_tensor)
    tangent_errors = staticmethod(tangent_errors)


@pytest.fixture
def no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs of the command draw nothing: pictures take longer than a small run."""
    none = nullcontext(lambda folder: [])
    monkeypatch.setattr("anisocontact.results.report_process.report_beside", lambda wanted: none)


@pytest.fixture
def no_detours(monkeypatch: pytest.MonkeyPatch) -> None:
    """Penalties are come to in no other way: what takes too many corrections fails."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    from anisocontact.solver.stepping.compliant_penalties import CompliantPenalties
    from anisocontact.solver.stepping.graded_penalties import GradedPenalties

    for kind in (CompliantPenalties, GradedPenalties):
        monkeypatch.setattr(kind, "contacts", [])


@pytest.fixture(scope="session")
def fe() -> FiniteElements:
    """Builders of small contact problems; skips where DOLFINx is not installed."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    return FiniteElements()
