"""Curved cells that are folded over at a corner are told, whatever their points see."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import ModelWarning
from anisocontact.bulk import make_material
from anisocontact.mesh import Body, PlaneStrain, build_mesh, make_shape
from anisocontact.mesh.folded_cells import folded_cells
from anisocontact.solver import Problem, Solver, Step


def moved(share, cell):
    """A quarter of a ring with the node inside a radial edge at a share of it from its end."""
    plane = cell in ("triangle", "quadrilateral")
    name, more = ("annulus", {}) if plane else ("ring", {"length": 1.0})
    cells = (1, 2) if plane else (1, 2, 1)
    if cell in ("triangle", "tetrahedron"):
        more["cell"] = cell
    shape = make_shape(name, inner=1, outer=2, end_deg=90, cells=cells, order=2, **more)
    ideal = {"idealisation": PlaneStrain()} if plane else {}
    model = build_mesh([Body("block", shape)], **ideal)
    x = model.mesh.geometry.x
    (middle,) = np.flatnonzero((np.abs(x - (1.5, 0.0, 0.0)) < 1e-9).all(axis=1))
    x[middle, 0] = 1.0 + share
    return model


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron", "quadrilateral", "triangle"])
def test_a_node_within_a_quarter_of_its_edge(cell):
    """Requirement: told from there on, and not before.

    Source: an edge with its middle node at the share s has the derivative 4 s - 1 at its end, so
    that a cell is folded over there where s is less than a quarter.
    """
    for share in (0.5, 0.35, 0.25):
        assert folded_cells(moved(share, cell)) == []
    (line,) = folded_cells(moved(0.24, cell))
    assert line.startswith("body 'block': ")
    assert "are folded over at a corner, the first at (1, 0, 0)" in line


def test_a_run_says_it():
    model = moved(0.2, "hexahedron")
    steel = {"block": make_material("linear-elastic", E=1.0, nu=0.3)}
    held = {"block.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)
        solver = Solver(Problem(model, steel), [Step("wait", 1, held)])
    assert [line for line in solver.cautions if "folded over" in line]
