"""The sliding rule `explicit` where no adhesion is given."""

import json

import numpy as np
import pytest

from anisocontact.cli import main

CASE = """\
title = "Dragged"

[mesh.box.block]
origin = [0, 0, 0]
size = [2, 2, 1]
cells = [2, 2, 1]

[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3

[surface.plate]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "plate"
@method@

[contact.friction]
coefficients = [0.3, 0.1]
sliding_rule = "explicit"
directions = { kind = "constant", vector = [1, 0, 0] }

[[step]]
name = "press"
increments = 1
displacement = { "block.top" = { x = 0, y = 0, z = -0.01 } }

[[step]]
name = "drag"
increments = 3
displacement = { "block.top" = { x = 0.1, y = 0.1, z = -0.01 } }

[output]
pictures = false
"""


@pytest.mark.parametrize("method", ["", 'method = "augmented"', 'pass = "single"'])
def test_explicit_slides_where_no_adhesion_is_given(tmp_path, method):
    """Requirement: steady slip at 45 degrees to the marks has the force of the closed form, and the
    run says what it has chosen.

    Source: T = -N S F S e / sqrt(SFSe . F . SFSe), the fixed point of (113), (114), (123) with (96)
    [Konyukhov Schweizerhof 2006], for S in proportion to the squares of the coefficients. Equal
    stiffnesses left no equilibrium where sliding began: such runs crawled and stopped. Tolerance:
    what is left of the way to steady slip after three increments; measured 9e-5.
    """
    case = tmp_path / "case.toml"
    case.write_text(CASE.replace("@method@", method))
    assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    x, y, normal = summary["contacts"][0]["force"]
    mu, e = np.array([0.3, 0.1]), np.full(2, 0.5**0.5)
    stiffness = mu**2
    h = stiffness * stiffness / mu**2 * e
    expected = -h / np.linalg.norm(h / mu)
    assert np.linalg.norm(np.array([x, y]) / normal - expected) < 1e-3 * np.linalg.norm(expected)
    assert any("give stiffnesses for those of the surfaces" in s for s in summary["warnings"])
