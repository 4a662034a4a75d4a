"""Cells that a deformation folds over at a corner, where no quadrature point sees it."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import RunWarning
from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.mesh import Axisymmetric, Body, PlaneStrain, build_mesh, make_shape
from anisocontact.solver.system.cells import DeformedCells

CASE = """
[idealisation]
kind = "plane-strain"
[mesh.rectangle.block]
origin = [0, 0]
size = [1, 1]
cells = [1, 1]
[nodes."block.tip"]
near = [1, 1, 0]
[material.block]
model = "neo-hookean"
E = 1
nu = 0.3
[[step]]
name = "fold"
increments = 4
[step.displacement]
"block.bottom" = {{ x = 0, y = 0 }}
"block.left" = {{ x = 0, y = 0 }}
"block.tip" = {{ x = {moved}, y = {moved} }}
"""


def _square(idealisation, degree=1):
    shape = make_shape("rectangle", origin=(0, 0), size=(1.0, 1.0), cells=(1, 1), order=degree)
    return build_mesh([Body("block", shape)], idealisation=idealisation)


@pytest.mark.parametrize(("at", "folded", "inverted"), [(0.51, 0, 0), (0.49, 1, 0), (0.3, 1, 1)])
def test_a_corner_that_is_pushed_into_its_cell(at: float, folded: int, inverted: int) -> None:
    """Requirement: told from half of the way on, and inverted where a quadrature point is.

    Source: the Jacobian of a square with a corner at (a, a) is 1 + (a - 1)(x + y), 2 a - 1 at that
    corner and 1.577 a - 0.577 at the quadrature point beside it.
    """
    model = _square(PlaneStrain())
    x = np.asarray(model.space.tabulate_dof_coordinates())
    u = np.where((x[:, :1] > 0.5) & (x[:, 1:2] > 0.5), (at - 1.0) * np.array([1.0, 1.0, 0.0]), 0.0)
    cells = DeformedCells(model, ["block"])
    assert len(cells.folded(u).get("block", [])) == folded
    assert len(cells.inverted(u)) == inverted


@pytest.mark.parametrize("degree", [1, 2])
def test_corners_on_an_axis_are_not_folded(degree: int) -> None:
    """Requirement: a circle on the axis has no length, before and after, and tells nothing."""
    model = _square(Axisymmetric(), degree)
    cells = DeformedCells(model, ["block"])
    x = np.asarray(model.space.tabulate_dof_coordinates())
    assert cells.folded(0.1 * x) == {}
    assert set(cells.folded(-1.5 * x * np.array([0.0, 1.0, 0.0]))) == {"block"}


def test_a_run_says_it_once(tmp_path: Path) -> None:
    """Requirement: with the body, how many cells and where; not for the same state unfolded."""
    for moved, told in ((-0.4, 0), (-0.55, 1)):
        (tmp_path / "case.toml").write_text(CASE.format(moved=moved))
        with warnings.catch_warnings(record=True) as found:
            warnings.simplefilter("always", RunWarning)
            list(build(load(tmp_path / "case.toml")).solver.run())
        lines = [str(one.message) for one in found if "folded" in str(one.message)]
        assert len(lines) == told
        assert all("body 'block': a cell is folded over at a corner" in line for line in lines)
