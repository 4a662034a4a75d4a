"""What must not matter: where the problem lies in space, and its units."""

from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

PATH = [(0.0, 0.0, -0.01), (0.015, 0.0, -0.01), (0.015, 0.02, -0.01)]


def resultants(fe, move, interface, length=1.0, stress=1.0, cell="hexahedron"):
    """Contact forces along a path that turns, and the displacement at its end.

    `move` is a rotation of the whole problem, `length` and `stress` are the units.
    """
    from anisocontact.solver import Step

    block = fe.block(
        interface,
        size=np.array([1.0, 1.0, 0.5]) * length,
        young=1000.0 * stress,
        move=move.apply,
        cell=cell,
    )
    ends = [dict(zip("xyz", move.apply(np.array(p) * length), strict=True)) for p in PATH]
    steps = [Step(f"{i}", 4, {"block.top": end}) for i, end in enumerate(ends)]
    forces = [a.resultants["block.bottom"][0] for a in block.run(*steps, snes_rtol=1e-12)]
    statuses = block.contact.last.status
    return np.array(forces), block.problem.u.x.array.reshape(-1, 3).copy(), statuses


@cache
def still(fe, cell="hexahedron", **law):
    """The same where it is, in its own units: what others are compared with."""
    return resultants(fe, Rotation.identity(), fe.interface(angle=0.5, **law), cell=cell)


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("coefficients", [(0.3, 0.1), (0.2, 0.2)], ids=["marks", "isotropic"])
def test_rotation(fe, cell, seed, coefficients):
    """Rotating block, plane, marks and loads rotates forces and displacements.

    Requirement: 1e-9 of the largest. Source: objectivity. Tolerance: Newton stops at 1e-12 of the
    forces; the condition of the system (1e4) separates 1e-9 from it.
    """
    law = {"coefficients": coefficients, "angle": 0.5}
    forces, u, status = still(fe, cell=cell, coefficients=coefficients)
    turn = Rotation.random(random_state=seed)
    turned_plane = fe.interface(
        **law, normal=turn.apply([0.0, 0.0, 1.0]), vector=turn.apply([1.0, 0.0, 0.0])
    )
    forces_t, u_t, status_t = resultants(fe, turn, turned_plane, cell=cell)
    assert np.abs(turn.inv().apply(forces_t) - forces).max() < 1e-9 * np.abs(forces).max()
    assert np.abs(turn.inv().apply(u_t) - u).max() < 1e-9 * np.abs(u).max()
    assert np.array_equal(status, status_t)


@pytest.mark.parametrize(
    ("length", "stress"), [(1e3, 1e-6), (1e-3, 1e6), (1e9, 1e-12), (0.37, 5.1)]
)
def test_units(fe, length, stress):
    """The same problem in other units of length and stress.

    Requirement: 1e-9. Source: every tolerance is relative to a quantity of the problem.
    Tolerance: as for the rotation.
    """
    forces, u, status = still(fe)
    scale = stress / length
    law = fe.interface(angle=0.5, stiffness=(4e3 * scale, 1e3 * scale), penalty=1e4 * scale)
    forces_s, u_s, status_s = resultants(fe, Rotation.identity(), law, length, stress)
    unit = stress * length**2
    assert np.abs(forces_s / unit - forces).max() < 1e-9 * np.abs(forces).max()
    assert np.abs(u_s / length - u).max() < 1e-9 * np.abs(u).max()
    assert np.array_equal(status, status_s)
