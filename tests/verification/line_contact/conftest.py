"""Graded bodies in the plane that stand for half planes, and what they are pressed with."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from anisocontact.base.fenicsx import geometry
from anisocontact.contact import Contact
from anisocontact.mesh import Body, Idealisation, Model, PlaneStrain, build_mesh
from anisocontact.mesh.shapes.plane import RectangleSpec
from anisocontact.solver import Problem, Solver, Step

Floats = npt.NDArray[np.float64]

E, NU = 1000.0, 0.3
REDUCED = E / (1.0 - NU**2)
#: Size of the bodies in half-widths of the contact, which is about one: as functions of the force
#: pressures of a finite body differ by the square of its inverse.
EXTENT = 60.0


def graded(n: int, fine: float, growth: float = 1.35) -> Floats:
    """Points from 0 to `EXTENT`: n cells per unit length up to `fine`, then growing by a factor."""
    count = int(np.ceil(n * fine))
    x, step = list(np.arange(count + 1) / n), 1.0 / n
    while x[-1] < EXTENT:
        step *= growth
        x.append(x[-1] + step)
    out = np.array(x)
    tail = out[count:] - out[count]
    out[count:] = out[count] + tail * (EXTENT - out[count]) / tail[-1]
    out[-1] = EXTENT
    return out


class Lifted(RectangleSpec):
    """A rectangle with a profile, whose cells of order 2 follow it."""

    curved = True


def _block(name: str, n: int, *, upper: bool, half: bool, fine: float, **given: Any) -> Body:
    right, deep = graded(n, fine), graded(n, min(fine, 1.0))
    x = right if half else np.concatenate([-right[:0:-1], right])
    y = deep if upper else -deep[::-1]
    shape = Lifted(
        origin=(x[0], y[0]),
        size=(np.ptp(x), EXTENT),
        cells=(len(x) - 1, len(y) - 1),
        planes_x=tuple((x - x[0]) / np.ptp(x)),
        planes_y=tuple((y - y[0]) / EXTENT),
        **given,
    )
    return Body(name, shape)


def half_planes(
    facets: dict[str, int],
    *,
    height: Callable[[Floats], Floats],
    half: bool = True,
    fine: float = 1.5,
    order: int = 1,
    ideal: Idealisation | None = None,
) -> Model:
    """Bodies on y = 0: "upper" with a profile, "lower" without; those that are named.

    Args:
        facets: Facets per unit length of each.
        height: Height of the profile at x >= 0, length.
        half: Whether x >= 0 alone is meshed.
        fine: Where facets begin to grow.
        order: Of the elements.
        ideal: Plane strain if not given.
    """
    bodies = [
        _block(name, n, upper=name == "upper", half=half, fine=fine, order=order)
        for name, n in facets.items()
    ]
    model = build_mesh(bodies, idealisation=ideal or PlaneStrain())
    _, nodes, x = geometry(model.mesh)
    if "upper" in facets:
        # in the plane y = 0 there are nodes of both
        own = np.unique(nodes[model.cells("upper")])
        x[own, 1] += height(np.abs(x[own, 0])) * (1.0 - x[own, 1] / EXTENT)
    return model


def solved(
    model: Model, materials: dict[str, Any], contacts: Sequence[Contact], *steps: Step
) -> int:
    """Run; number of Newton iterations."""
    problem = Problem(model, materials, contacts)
    return sum(one.iterations for one in Solver(problem, list(steps)).run())


class Line:
    """The functions of this file, for the tests beside it."""

    lifted = Lifted
    half_planes = staticmethod(half_planes)
    solved = staticmethod(solved)


@pytest.fixture
def line() -> type[Line]:
    """Bodies in the plane."""
    return Line
