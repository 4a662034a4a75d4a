"""The main example: what a run of it must show."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "milled_block"


@pytest.fixture(scope="module")
def run(fe):
    """Accepted increments of the example, from its case file's numbers."""
    from anisocontact.bulk import make_material
    from anisocontact.contact import Contact, auto_penalty
    from anisocontact.mesh import read_gmsh
    from anisocontact.solver import Problem, Solver, Step

    case = tomllib.loads((EXAMPLE / "case.toml").read_text())
    (contact,) = case["contact"]
    model = read_gmsh(EXAMPLE / case["mesh"]["file"])
    moduli = {k: case["material"]["block"][k] for k in ("E", "nu")}
    steel = make_material("linear-elastic", **moduli)
    interface = fe.interface(
        stiffness=contact["adhesion"]["stiffness"],
        coefficients=contact["friction"]["coefficients"],
        penalty=auto_penalty(model, contact["slave"], steel),
        angle=np.radians(contact["friction"]["directions"]["angle_deg"]),
    )
    problem = Problem(model, {"block": steel}, [Contact(model, contact["slave"], interface)])
    steps = [Step(s["name"], s["increments"], s["displacement"]) for s in case["step"]]
    return problem, list(Solver(problem, steps).run())


@pytest.mark.slow
def test_newton_iterations(run):
    """Requirement: on average at most 6 Newton iterations an increment on the main example."""
    _, accepted = run
    assert np.mean([a.iterations for a in accepted]) <= 6.0


@pytest.mark.slow
def test_open_sticking_and_slipping_zones(run):
    """Requirement: the example shows points that are open, stick and slip at the same time."""
    _, accepted = run
    zones = [min(a.contacts["block.bottom"].values()) for a in accepted]
    assert max(zones) > 100


@pytest.mark.slow
def test_forces_balance(run):
    """Contact and support balance to 1e-7 of the force; Newton stops at 1e-8 in another norm."""
    _, accepted = run
    for a in accepted:
        force, _ = a.resultants["block.bottom"]
        assert np.linalg.norm(force + a.reactions["block.top"]) < 1e-7 * np.linalg.norm(force)


@pytest.mark.slow
def test_drags_end_near_steady_slip(run):
    """Where every point slides the way of the drag, the resultant is that of steady slip.

    Requirement: direction and size of steady slip. Source: closed form for maximum dissipation,
    axes and coefficients of the case. Tolerance: the start dies out over the slide in which the
    block unloads, mu N over its shear stiffness, here 2.6 um; exp(-10 / 2.6) = 2 % is left.
    """
    _, accepted = run
    m = np.array([0.12, 0.25])
    axes = np.array(
        [[np.cos(np.pi / 6), np.sin(np.pi / 6)], [-np.sin(np.pi / 6), np.cos(np.pi / 6)]]
    )
    for name, drag in (("drag along x", [1.0, 0.0]), ("drag along y", [0.0, 1.0])):
        last = [a for a in accepted if a.step == name][-1]
        force, _ = last.resultants["block.bottom"]
        e = axes @ drag
        expected = axes.T @ (-(m**2) * e / np.linalg.norm(m * e))
        error = np.linalg.norm(force[:2] / force[2] - expected) / np.linalg.norm(expected)
        assert error < 0.02
