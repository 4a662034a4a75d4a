"""A law of points in NumPy, bound to a body: what it is given, and what is kept of its answers."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import fem, ufl
from anisocontact.bulk import PointResult
from anisocontact.bulk.point_law import BodyPoints
from anisocontact.mesh import BoxSpec, build_box


class Counting:
    """`sigma = eps`, which dissipates 0.5 in each increment and counts them."""

    linear, young, history = False, 1.0, {"increments": ()}

    def __init__(self, strain):
        self.strain = strain

    def update(self, state):
        one = np.eye(9).reshape(3, 3, 3, 3)
        tangent = np.stack([0.5 * (one + one.swapaxes(2, 3))] * len(state.strain))
        half = np.full(len(state.strain), 0.5)
        after = {"increments": state.before["increments"] + 1.0}
        return PointResult(state.strain, tangent, after, stored=half, dissipated=half)


@pytest.mark.parametrize("strain", ["small", "logarithmic"])
def test_a_displacement_that_is_no_number_gives_no_stress(strain):
    """Requirement: the stress is no number at points whose displacement is none, and one elsewhere.

    Source: a law is asked with a strain of zero there, as one may raise on others, and its answer
    would pass for an equilibrium.
    """
    model = build_box({"bar": BoxSpec((0, 0, 0), (2, 1, 1), (2, 1, 1))})
    u, dt = fem.Function(model.space), fem.Constant(model.mesh, 1.0)
    points = BodyPoints(Counting(strain), model, "bar", u, dt, 2)
    places = model.space.tabulate_dof_coordinates()
    u.x.array[3 * np.flatnonzero(places[:, 0] == 2.0)] = np.nan
    points.evaluate()
    first = fem.Function(fem.functionspace(model.mesh, ("DG", 0)))
    each = ufl.TestFunction(first.function_space) * points.piola(u)[0, 0]
    found = fem.assemble_vector(fem.form(each * ufl.dx(metadata={"quadrature_degree": 2})))
    assert sorted(np.isnan(found.array).tolist()) == [False, True]


def test_what_is_dissipated_grows_and_what_is_stored_does_not():
    """Requirement: of two accepted increments the history and what both dissipated are kept."""
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    u, dt = fem.Function(model.space), fem.Constant(model.mesh, 1.0)
    points = BodyPoints(Counting("small"), model, "bar", u, dt, 2)
    for _ in range(3):  # what is tried changes nothing
        points.evaluate()
    for _ in range(2):
        points.commit()
    kept = points.variables["increments"], points.stored, points.dissipated
    for values, expected in zip(kept, (2.0, 0.5, 1.0), strict=True):
        np.testing.assert_allclose(values.x.array, expected, rtol=1e-14)
