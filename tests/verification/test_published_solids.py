"""Solids whose solutions are in textbooks: rubber that is twisted, a tube that yields."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.mesh import Axisymmetric, Body, build_mesh, make_shape
from anisocontact.results.paraview import BodyGrid
from anisocontact.solver import Accepted, Problem, Solver, Step, Turn


def _wall(
    inner: float, width: float, height: float, cells: tuple[int, int], lateral: bool
) -> Problem:
    shape = make_shape("rectangle", origin=(inner, 0.0), size=(width, height), cells=cells, order=2)
    model = build_mesh([Body("b", shape)], idealisation=Axisymmetric(lateral=lateral))
    rubber = make_material("mooney-rivlin", C10=0.4, C01=0.1, bulk_modulus=1e5)
    metal = make_material("plastic", E=1000.0, nu=0.4999, yield_stress=1.0)
    return Problem(model, {"b": rubber if lateral else metal})


def _run(problem: Problem, steps: list[Step]) -> list[Accepted]:
    return list(Solver(problem, steps).run())


def test_torsion_of_a_rubber_cylinder() -> None:
    """A round bar of Mooney-Rivlin rubber that is twisted by k per length and keeps its length.

    Source: [Rivlin 1949]: the energy is `pi/2 k^2 a^4 (C10 + C01)` per length, the ends are pressed
    by `pi/2 k^2 a^4 (C10 + 2 C01)` (Poynting). Tolerance: 1e-4; 8 by 4 cells of order
    2 leave 2e-5 of the force, half as many along each side 3e-4, and K = 2.5e5 C10 less.
    """
    twist, length = 0.8, 0.5
    problem = _wall(0.0, 1.0, length, (8, 4), lateral=True)
    held = Turn(axis=(0, 1, 0), angle=0.0)
    turned = Turn(axis=(0, 1, 0), angle=twist * length)
    last = _run(problem, [Step("twist", 4, rotation={"b.bottom": held, "b.top": turned})])[-1]
    energy, force = last.energies["elastic"], -last.reactions["b.top"][1]
    assert energy == pytest.approx(np.pi / 2.0 * twist**2 * 0.5 * length, rel=1e-4)
    assert force == pytest.approx(np.pi / 2.0 * twist**2 * 0.6, rel=1e-4)


def test_autofrettage_of_a_thick_tube() -> None:
    """A tube in plane strain whose inner half yields under pressure, and what stays after that.

    Source: [Hill 1950, ch. V], incompressible, k = Y/sqrt(3), yielded up to c:
    `p = k (1 - c^2/b^2 + 2 ln c/a)`, `u = k c^2 / (2 G r)`; unloading is elastic, so that the hoop
    stress at the bore is `2 k - p - p (b^2 + a^2)/(b^2 - a^2)`. Tolerance: 3e-4 of displacements,
    for 1 - 2 nu = 2e-4; the stress at the node of the bore has an error of second order, a ratio of
    3.6 to 4.4 at half the size of the cells.
    """
    k, a, b, c = 1.0 / np.sqrt(3.0), 1.0, 2.0, 1.5
    shear, pressure = 1000.0 / (2.0 * 1.4999), k * (1.0 - (c / b) ** 2 + 2.0 * np.log(c / a))
    ends = {"b.bottom": {"y": 0.0}, "b.top": {"y": 0.0}}
    steps = [
        Step("load", 5, ends, pressure={"b.left": pressure}),
        Step("unload", 1, pressure={"b.left": 0.0}),
    ]
    hoop = 2.0 * k - pressure - pressure * (b**2 + a**2) / (b**2 - a**2)
    off = []
    for cells in (8, 16):
        problem = _wall(a, b - a, 0.05, (cells, 1), lateral=False)
        x = problem.model.space.tabulate_dof_coordinates()[:, 0]
        for accepted in Solver(problem, steps).run():
            out = problem.u.x.array.reshape(-1, 3)[:, 0] * x * 2.0 * shear / k
            left = 0.0 if accepted.step == "load" else pressure * (a * b) ** 2 / (b**2 - a**2) / k
            if accepted.step == "unload" or accepted.increment == 5:
                np.testing.assert_allclose(out, c**2 - left, rtol=3e-4)
        off.append(BodyGrid(problem).stress()[np.isclose(x, a), 2].mean() - hoop)
    assert abs(off[0]) < 0.01 * abs(hoop) and 3.6 < off[0] / off[1] < 4.4
