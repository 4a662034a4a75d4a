"""Patch test: a pressure on the top arrives at every point of the sole."""

import numpy as np
import pytest

CELLS = [("hexahedron", 1), ("hexahedron", 2), ("tetrahedron", 1), ("tetrahedron", 2)]


@pytest.mark.parametrize(("cell", "order"), CELLS)
def test_uniform_pressure(fe, cell, order):
    """Uniaxial strain under a pressure p on the top.

    Requirement: pressure p at every slave point, displacement w = d - p/eps_N - p z/M with the
    overlap d at the start and the constrained modulus M. Source: uniform stress; exact for every
    element that holds a linear field. Tolerance: 1e-9, round-off of the factorisation of a system
    with condition 1e4. (Without an overlap nothing would hold the block at the start.)
    """
    from anisocontact.solver import Step

    pressure, penalty, overlap = 7.0, 1e4, 1e-4
    interface = fe.interface(penalty=penalty, point=(0.0, 0.0, overlap))
    block = fe.block(interface, cell=cell, order=order)
    slide = {"block.left": {"x": 0.0}, "block.right": {"x": 0.0}}
    slide |= {"block.front": {"y": 0.0}, "block.back": {"y": 0.0}}
    block.run(Step("press", 2, slide, {"block.top": {"z": -pressure}}), snes_rtol=1e-12)

    assert np.abs(block.contact.last.pressure - pressure).max() < 1e-9 * pressure
    modulus = block.material.lame + 2.0 * block.material.shear
    z = block.model.space.tabulate_dof_coordinates()[:, 2]
    w = overlap - pressure / penalty - pressure * z / modulus
    found = block.problem.u.x.array.reshape(-1, 3)
    assert np.abs(found[:, 2] - w).max() < 1e-9 * np.abs(w).max()
    assert np.abs(found[:, :2]).max() < 1e-9 * np.abs(w).max()


def test_balance_of_forces_and_moments(fe):
    """Supports and contact balance in force.

    Requirement: sum of reactions and contact force vanishes to 1e-8 of the force. Source:
    equilibrium of the block. Tolerance: Newton leaves a residual of norm 1e-10 of the forces; its
    sum over 16 nodes of the contact is at most four times that, and the rest is rounding.
    """
    from anisocontact.solver import Step

    block = fe.block(fe.interface(angle=0.3), cell="tetrahedron")
    top = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}
    steps = [Step("press", 2, top), Step("drag", 5, {"block.top": {"x": 0.02}})]
    for accepted in block.run(*steps, snes_rtol=1e-10):
        force, _ = accepted.resultants["block.bottom"]
        total = force + accepted.reactions["block.top"]
        assert np.linalg.norm(total) < 1e-8 * np.linalg.norm(force)
