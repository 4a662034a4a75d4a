"""The contact patch test as it is published, from case files, slave and master either way round.

A punch stands on a wider foundation of the same material whose mesh does not match. The punch and
what it leaves free of the foundation carry the same pressure, so that the stress is uniform:
-10 across the contact at every node. Sources: R. L. Taylor, P. Papadopoulos, On a patch test for
contact problems in two dimensions, in Computational Methods in Nonlinear Mechanics, 1991; M. A.
Crisfield, Re-visiting the contact patch test, Int. J. Numer. Meth. Engng 48 (2000), with elements
of order 2. The edges of the punch lie on edges of the foundation: facets beyond them are touched
by rounding alone, and so is every node at the start.

Requirement: 1e-8 of the pressure at every node, in at most four iterations without springs: as many
as the linear equations take, one more for the slip and one for what springs would leave.
Tolerance: that of Newton's method, of the forces: 1e-9 here, as at order 2 a vertex has down to a
sixth of the mean area, and its pressure may be off by as much more.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

PRESSURE, E, NU = 10.0, 1000.0, 0.3

PLANE = """
title = "Patch test"
[idealisation]
kind = "plane-strain"
[mesh.rectangle.base]
origin = [0, 0]
size = [3, 1]
cells = [{along}, {below}]
order = {order}
cell = "{cell}"
[mesh.rectangle.punch]
origin = [1, 1]
size = [1, 1]
cells = [{above}, {above}]
order = {order}
cell = "{cell}"
[group."base.left-of"]
by = "box"
low = [-0.1, 0.9, -1]
high = [1.001, 1.1, 1]
[group."base.right-of"]
by = "box"
low = [1.999, 0.9, -1]
high = [3.1, 1.1, 1]
[[step]]
name = "press"
increments = 1
pressure = {{ "punch.top" = 10, "base.left-of" = 10, "base.right-of" = 10 }}
[step.displacement]
"base.bottom" = {{ y = 0 }}
"base.left" = {{ x = 0 }}
"punch.left" = {{ x = {moved!r} }}
"""

SPACE = """
title = "Patch test"
[mesh.box.base]
origin = [0, 0, 0]
size = [3, 3, 1]
cells = [{along}, {along}, 2]
order = {order}
cell = "{cell}"
[mesh.box.punch]
origin = [1, 1, 1]
size = [1, 1, 1]
cells = [{above}, {above}, 2]
order = {order}
cell = "{cell}"
[group."base.left-of"]
by = "box"
low = [-0.1, -0.1, 0.9]
high = [1.001, 3.1, 1.1]
[group."base.right-of"]
by = "box"
low = [1.999, -0.1, 0.9]
high = [3.1, 3.1, 1.1]
[group."base.in-front"]
by = "box"
low = [0.999, -0.1, 0.9]
high = [2.001, 1.001, 1.1]
[group."base.behind"]
by = "box"
low = [0.999, 1.999, 0.9]
high = [2.001, 3.1, 1.1]
[[step]]
name = "press"
increments = 1
[step.pressure]
"punch.top" = 10
"base.left-of" = 10
"base.right-of" = 10
"base.in-front" = 10
"base.behind" = 10
[step.displacement]
"base.bottom" = {{ z = 0 }}
"base.left" = {{ x = 0 }}
"base.front" = {{ y = 0 }}
"punch.left" = {{ x = {moved!r} }}
"punch.front" = {{ y = {moved!r} }}
"""

REST = """
[material.base]
model = "linear-elastic"
E = 1000
nu = 0.3
[material.punch]
model = "linear-elastic"
E = 1000
nu = 0.3
[[contact]]
slave = "{slave}"
master = "{master}"
friction = {{ coefficients = 0 }}
"""

#: Cells and the ways in which strains of a uniform pressure go sideways.
PLACES = {
    "quadrilateral": (PLANE, 1.0 + NU),
    "triangle": (PLANE, 1.0 + NU),
    "hexahedron": (SPACE, 1.0),
    "tetrahedron": (SPACE, 1.0),
}
SIDES = ("punch.bottom", "base.top")
FACETS = [(2, 3), (3, 2)]


#: Cells, order, facets of the foundation below the punch, and of the punch.
MESHES = [
    *((cell, order, *facets) for cell in list(PLACES)[:2] for order in (1, 2) for facets in FACETS),
    *((cell, 1, *facets) for cell in list(PLACES)[2:] for facets in FACETS),
    *(pytest.param(cell, 2, 2, 3, marks=pytest.mark.slow) for cell in list(PLACES)[2:]),
]


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize(("cell", "order", "below", "above"), MESHES)
def test_uniform_stress(
    cell: str, order: int, below: int, above: int, swapped: bool, to_the_end: Callable[..., Any]
) -> None:
    """The pressure at every node, iterations, no energy of springs."""
    text, sideways = PLACES[cell]
    slave, master = SIDES[::-1] if swapped else SIDES
    run = to_the_end(
        text.format(
            cell=cell,
            order=order,
            along=3 * below,
            below=below,
            above=above,
            moved=sideways * NU * PRESSURE / E,
        )
        + REST.format(slave=slave, master=master),
        "options = { snes_rtol = 1e-9 }",
        most=5000,
    )
    (contact,) = run.problem.contacts
    pressure = contact.last.pressure
    carried = (contact.areas > 0.05 * contact.slave_points.quadrature.areas) & (pressure > 0.0)
    np.testing.assert_allclose(pressure[carried], PRESSURE, rtol=1e-8)
    assert carried.sum() > order * min(below, above)
    assert not run.cuts
    (only,) = run.accepted
    assert only.iterations <= 4
    assert abs(run.problem.stabilisation.energy) < 1e-12
